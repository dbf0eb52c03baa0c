// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_RegistrationProblem_h
#define mammoray_RegistrationProblem_h

#include "mammoray/Foundation/PoseParameters.h"
#include "mammoray/Foundation/Progress.h"
#include "mammoray/Registration/BreastModel.h"
#include "mammoray/Registration/RegistrationTarget.h"
#include "mammorayRegistrationModule.h"

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace mammoray
{
/// A parameter of one search; see PoseParameter for its name and unit.
struct RegistrationParameter
{
  std::string Name;
  std::string Unit;
  double Start = 0;
  double Lower = 0;
  double Upper = 0;
  /// Step that makes the parameters of the optimiser comparable. Positive.
  double Scale = 1;
  /// Standard deviation of the prior around Start; 0: no prior.
  double PriorSigma = 0;
  /// Not optimised: stays at Start.
  bool Fixed = false;
};

/// Features of the pictures that are compared inside the breast.
enum class PictureComparison
{
  /// Log attenuation less its mean, over its standard deviation, both of all pixels: the least
  /// squares of normalised cross-correlation.
  Global,
  /// The same in a window around each pixel: what changes slowly, such as scatter or a display
  /// curve, cancels.
  Local,
  /// Differences of neighbouring pixels of the globally normalised picture. It matches where
  /// structures overlap: a search compares globally until then.
  Gradient
};

/// "global", "local" or "gradient".
MAMMORAYREGISTRATION_EXPORT const char* NameOf(PictureComparison comparison);

struct RegistrationOptions
{
  /// Rolls beside the start at which a search may begin, degrees: of all, the one whose picture
  /// matches best once the outlines meet. Those outside the bounds are left out.
  std::vector<double> RollOffsetsDeg{ -15.0, 15.0 };
  /// Edge lengths of the compared pixels, coarse to fine, mm.
  std::vector<double> PixelSizesMm{ 3.0, 1.5 };
  /// Rays per coarse pixel along each of its sides.
  int Samples = 6;
  /// Number of directions, over a half circle, in which the outlines are compared.
  int OutlineDirections = 120;
  /**
   * Standard deviation of the model's error on the outline, mm, and on the compared features of the
   * picture, in root mean squares of the target's; and the distance over which these errors are
   * correlated, mm: neighbouring samples share their weight. Once gradients are compared, the
   * deviations are estimated from the residuals instead (Private/ResidualGroups.h).
   */
  double OutlineSigmaMm = 1.0;
  double IntensitySigma = 0.5;
  PictureComparison Comparison = PictureComparison::Gradient;
  /// Edge of the windows of PictureComparison::Local, mm.
  double WindowMm = 20.0;
  double CorrelationLengthMm = 5.0;
  /// Pixels nearer than this to the outline are left out of the comparison of intensities, mm.
  double IntensityMarginMm = 3.0;
  /// Residuals larger than this many standard deviations have a linear cost (Huber).
  double RobustWidth = 2.0;
  int MaximumIterations = 15;
};

/// All of PoseParameters around a start, with their bounds, scales and priors there.
MAMMORAYREGISTRATION_EXPORT std::vector<RegistrationParameter> DefaultParameters(
  const BreastPose& start);

/// True for the parameter that all views of one breast share: its stiffness. The others describe
/// the position of the breast in the unit, which differs between exposures.
MAMMORAYREGISTRATION_EXPORT bool IsShared(int parameter);

/**
 * A further projection of the compression that a view shows, as a tomosynthesis has them: one pose
 * and one equilibrium, seen from another focal spot.
 */
struct ViewProjection
{
  /// Gantry frame, mm; above the receptor.
  Vector3 FocalSpotMm{ 0, 0, 0 };
  /// The targets at each pixel size, as in View::Levels.
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
  /// The frame of all poses (FindPoseFrame).
  PoseFrame Frame;
  std::vector<View> Views;
  RegistrationOptions Options;

  /// The view's unit around the breast.
  UnitPlacement PlacementOf(const View& view) const { return { this->Frame, view.Unit }; }
  /// Throws InputError unless a search can begin with this problem.
  void Validate() const;
};

/// Input from which MakeProblem makes the model of a breast.
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
