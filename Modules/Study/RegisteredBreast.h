// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_RegisteredBreast_h
#define mammoray_RegisteredBreast_h

#include "mammoray/Foundation/Vector3.h"
#include "mammoray/Registration/Registration.h"
#include "mammoray/Study/ResultFile.h"
#include "mammoray/XRay/PathLengthProjector.h"
#include "mammorayStudyModule.h"

#include "vtkSmartPointer.h"

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

class vtkUnstructuredGrid;

namespace mammoray
{
/// Prefix, followed by a parameter's name, of the point arrays of uncompressed.vtu with the
/// derivatives of the compressed positions, seen from the unit; mm per mm or degree.
inline constexpr const char* SensitivityArrayPrefix = "Sensitivity_";

/// A breast at rest and compressed, and the unit that images it.
struct BreastInUnit
{
  /// The same linear tetrahedra in both, volume frame, mm, with the cell array "Material". The
  /// uncompressed grid may have sensitivities (SensitivityArrayPrefix).
  vtkSmartPointer<vtkUnstructuredGrid> Uncompressed;
  vtkSmartPointer<vtkUnstructuredGrid> Compressed;
  VolumeFromGantry Placed;
  MammographyUnit Unit;
  /// The mammogram's pixels.
  ReceptorGrid Grid;
  /// Names of the parameters of a registration in its order, and their covariance including fixed
  /// ones that have a prior, row by row; empty if it is unknown.
  std::vector<std::string> Parameters;
  std::vector<double> Covariance;
};

/// Fills all but the meshes from a result.
MAMMORAYSTUDY_EXPORT void DescribeUnit(const ResultFile& result, BreastInUnit& breast);

/// Reads the breast of a result and its meshes from the result's folder. Throws InputError, which
/// names the file, also if the two are not one mesh, displaced by the uncompressed mesh's point
/// array "Displacement" (mm), or if their placement is not the result's.
MAMMORAYSTUDY_EXPORT BreastInUnit ReadBreastInUnit(const ResultFile& result);

/// An ellipse of one standard deviation.
struct UncertaintyEllipse
{
  double MajorMm = 0;
  double MinorMm = 0;
  /// Angle of the major axis from the direction of increasing columns towards increasing rows;
  /// degrees, (-90, 90].
  double AngleDeg = 0;
};

/// Half axes of the ellipse that holds a place with a probability of 95 %, in standard deviations:
/// the root of chi squared's quantile for two degrees of freedom, -2 ln 0.05.
inline constexpr double Deviations95 = 2.4477468306808166;

/// Points of the ellipse around a place of the receptor, gantry x and y, mm, with half axes of
/// `deviations` standard deviations. `grid`: the mammogram's, to which its angle refers.
MAMMORAYSTUDY_EXPORT std::vector<std::array<double, 2>> EllipsePoints(
  const UncertaintyEllipse& ellipse, const std::array<double, 2>& middle, const ReceptorGrid& grid,
  double deviations);

/// Where a point of the volume lies in the mammogram.
struct ImagedPoint
{
  std::string Material;
  /// In the compressed breast, volume frame, mm.
  Vector3 Compressed{ 0, 0, 0 };
  /// Gantry x and y on the receptor, mm.
  std::array<double, 2> ReceptorMm{ 0, 0 };
  /// Continuous position in the mammogram; pixel centres at whole numbers, from 0.
  double Column = 0;
  double Row = 0;
  bool InImage = false;
  /// Uncertainty of the point's shadow, and covariance of the point between the plates (mm^2,
  /// gantry frame, row by row), from the covariance of the registration's parameters, including
  /// fixed ones that have a prior, and from the model's own error (ModelError). Empty if the
  /// registration has no covariance.
  std::optional<UncertaintyEllipse> Uncertainty;
  std::optional<std::array<double, 9>> Covariance;
  /// Standard deviation of the model's own error in each direction, which is part of that, mm; 0
  /// without a covariance.
  double ModelSigmaMm = 0;
};

/// How a point moves with the tissue.
struct CarriedPoint
{
  /// Volume frame, mm.
  Vector3 Displacement{ 0, 0, 0 };
  /// More than a millimetre outside the breast; moved with the nearest tissue.
  bool Outside = false;
};

/// Part of an X-ray in one material, carried back into the uncompressed breast.
struct RaySegment
{
  std::string Material;
  /// Along the ray in the compressed breast, mm above the receptor plane.
  double EntryHeightMm = 0;
  double ExitHeightMm = 0;
  /// Length of the ray in it, mm.
  double LengthMm = 0;
  /// One point for each step, in the volume frame, from the source towards the receptor, mm.
  std::vector<Vector3> Uncompressed;
};

/// A registered breast: finds points of the MRI in the mammogram and the other way round.
class MAMMORAYSTUDY_EXPORT RegisteredBreast
{
public:
  /// Reads the folder that 'mammoray register' wrote for one mammogram. Throws InputError that
  /// names the file.
  explicit RegisteredBreast(const std::string& folder);
  /// Throws InputError if the grids have different numbers of points or cells.
  explicit RegisteredBreast(const BreastInUnit& breast);
  ~RegisteredBreast();
  RegisteredBreast(RegisteredBreast&&) noexcept;
  RegisteredBreast& operator=(RegisteredBreast&&) noexcept;

  /// Finds a point of the label volume's frame (mm) in the mammogram. Throws InputError if it lies
  /// more than a millimetre outside the breast.
  ImagedPoint ToMammogram(const Vector3& point) const;

  /// Displacement of tissue at a point of the label volume's frame (mm) into the compressed breast.
  CarriedPoint Carry(const Vector3& point) const;

  /// Displacement of tissue at a point of the compressed breast (volume frame, mm) back to where it
  /// is at rest.
  CarriedPoint CarryBack(const Vector3& point) const;

  /**
   * Finds the tissues that the X-ray of a pixel (continuous position) crosses, from the source
   * towards the receptor, in steps of at most `stepMm` (positive). Empty if it misses the breast.
   * Throws InputError outside the image.
   */
  std::vector<RaySegment> ToVolume(double column, double row, double stepMm = 0.25) const;

  /// The tetrahedra before and between the plates, of the same points and cells, volume frame.
  vtkUnstructuredGrid* Uncompressed() const;
  vtkUnstructuredGrid* Compressed() const;
  /// The focus and the pixels of the mammogram that was registered, volume frame.
  XRaySource Source() const;
  XRayDetector Detector() const;

private:
  struct Internals;
  std::unique_ptr<Internals> Internal;
};

/// A place in a registered mammogram: continuous column and row.
struct SeenInView
{
  const RegisteredBreast* Breast = nullptr;
  std::array<double, 2> Pixel{ 0, 0 };
};

/// Tissue that two mammograms show.
struct TissueInTwoViews
{
  /// At rest, frame of the label volume, mm.
  Vector3 Point{ 0, 0, 0 };
  /// Distance there between the two X-rays' curves through the tissue at rest, mm: a lower bound of
  /// the errors of registrations or marks.
  double GapMm = 0;
};

/**
 * Finds the tissue at rest that two mammograms of one breast show at a pixel each. The tissue that
 * an X-ray crosses between the plates is a curve in the breast at rest; the result is the middle
 * between the two curves where they are nearest, to `stepMm`. Nothing if an X-ray misses the
 * breast. Throws InputError if a pixel lies outside its mammogram.
 */
MAMMORAYSTUDY_EXPORT std::optional<TissueInTwoViews> FindInTwoViews(const SeenInView& first,
  const SeenInView& second, double stepMm = 0.5);
}

#endif
