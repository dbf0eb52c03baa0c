// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_RegistrationProblem_h
#define mammoray_RegistrationProblem_h

#include "mammoray/Foundation/Progress.h"
#include "mammoray/Registration/BreastModel.h"
#include "mammoray/Registration/RegistrationResiduals.h"
#include "mammoray/Registration/RegistrationTarget.h"
#include "mammoray/Registration/UnitPlacement.h"
#include "mammorayRegistrationModule.h"

#include <memory>
#include <optional>
#include <vector>

namespace mammoray
{
/**
 * A further projection of the compression that a view shows, as a tomosynthesis has them: one pose
 * and one equilibrium, seen from another focal spot.
 */
struct ViewProjection
{
  /// Gantry frame, mm; above the receptor.
  Vector3 FocalSpotMm{ 0, 0, 0 };
  /// As View::Levels.
  std::vector<RegistrationTarget> Levels;
};

/// One mammogram ready to register.
struct View
{
  /// At the mammogram's own resolution.
  RegistrationTarget Target;
  /// The target at each of RegistrationOptions::PixelSizesMm (MakeLevels), made once for a search.
  std::vector<RegistrationTarget> Levels;
  /// The unit that took it, at its own focal spot.
  MammographyUnit Unit;
  /// All ParameterCount, in their order.
  std::vector<RegistrationParameter> Parameters;
  /// Where the search begins: one value per parameter, free ones within their bounds. Empty: at
  /// their Start and at RegistrationOptions::RollOffsetsDeg beside it.
  std::vector<double> From;
  /// Together with Target they count as much as one mammogram. Starts are chosen by Target alone.
  std::vector<ViewProjection> Projections;
};

/// A target at each of some pixel sizes, coarse to fine, mm (CoarsenTo).
MAMMORAYREGISTRATION_EXPORT std::vector<RegistrationTarget> MakeLevels(
  const RegistrationTarget& target, const std::vector<double>& pixelSizesMm);

/**
 * A breast and the mammograms that are registered to it. Several views of one breast (CC and MLO)
 * share the model, which moves from one to the other, and the stiffness of gland.
 */
struct MAMMORAYREGISTRATION_EXPORT RegistrationProblem
{
  std::shared_ptr<BreastModel> Model;
  /// Of the model's volume frame.
  AnatomicalAxes Axes;
  /// The point of the volume frame about which units turn (FindPoseAnchor), mm.
  Vector3 Anchor{ 0, 0, 0 };
  std::vector<View> Views;
  RegistrationOptions Options;

  /// The view's unit around the breast.
  UnitPlacement PlacementOf(const View& view) const
  {
    return { this->Axes, this->Anchor, view.Unit };
  }
};

/// What the breast of a problem is made from.
struct BreastInput
{
  MaterialTable Materials;
  AnatomicalAxes Axes;
  /// Material indices; nothing: Anatomy is all that is known.
  std::optional<LabelVolume> Labels;
  /// Tetrahedra with a material each; nothing: made of Labels, cells of at most so many mm.
  std::optional<TetrahedralMesh> Anatomy;
  double AnatomyCellSizeMm = 4.0;
  /// Its Volume is taken from Labels. With Labels a mesh to simulate on is made of them where none
  /// is given.
  BreastModelOptions Mechanics;
  std::unique_ptr<PathLengthProjector> Projector;
  std::optional<Beam> XRays;
  std::optional<ScatterModel> Scatter;
};

/**
 * Makes the model of a breast, without views yet. Throws InputError on unusable input, where no
 * material of the table is fixed (the chest wall), and where meshes would have to be made in a
 * build without the Meshing module.
 */
MAMMORAYREGISTRATION_EXPORT RegistrationProblem MakeProblem(BreastInput input,
  const ProgressCallback& progress = {});
}

#endif
