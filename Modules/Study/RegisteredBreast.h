// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_RegisteredBreast_h
#define mammoray_RegisteredBreast_h

#include "mammoray/Foundation/Vector3.h"
#include "mammoray/Registration/Registration.h"
#include "mammoray/Study/BreastInUnit.h"
#include "mammoray/XRay/PathLengthProjector.h"
#include "mammorayStudyModule.h"

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

class vtkUnstructuredGrid;

namespace mammoray
{
/// An ellipse of one standard deviation.
struct UncertaintyEllipse
{
  double MajorMm = 0;
  double MinorMm = 0;
  /// The major axis goes this far from the direction of increasing columns towards increasing rows;
  /// degrees,
  /// (-90, 90].
  double AngleDeg = 0;
};

/// Half axes of the ellipse that holds a place with a probability of 95 %, in standard deviations:
/// the root of chi squared's quantile for two degrees of freedom, -2 ln 0.05.
inline constexpr double Deviations95 = 2.4477468306808166;

/// Points of the ellipse around a place of the receptor, gantry x and y, mm; half its axes are
/// `deviations` of its standard deviations. `grid`: the mammogram's, to which its angle refers.
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
  /// They follow from the covariance of the registration's parameters, those held fixed with their
  /// priors, and from the model's own error (ModelErrorMm); empty where the registration has no
  /// covariance. Of the point's shadow, and of the point between the plates: mm^2, gantry frame,
  /// row by row.
  std::optional<UncertaintyEllipse> Uncertainty;
  std::optional<std::array<double, 9>> Covariance;
  /// What of that, each way, is the model's own error, as a standard deviation, mm; 0 where there
  /// is no covariance.
  double ModelSigmaMm = 0;
};

/// How a point moves with the tissue.
struct CarriedPoint
{
  /// Of Carry, it leads from the breast at rest into the compressed one; volume frame, mm.
  Vector3 Displacement{ 0, 0, 0 };
  /// More than a millimetre outside the breast; moved with the nearest tissue.
  bool Outside = false;
};

/// A stretch of an X-ray in one material; points of the line of sight carried back into the
/// uncompressed breast.
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

/// A registered breast, to find points of the one image in the other.
class MAMMORAYSTUDY_EXPORT RegisteredBreast
{
public:
  /// Reads the folder that 'mammoray register' wrote for one mammogram. Throws InputError that
  /// names the file.
  explicit RegisteredBreast(const std::string& folder);
  /// Throws InputError where the grids do not belong together.
  explicit RegisteredBreast(const BreastInUnit& breast);
  ~RegisteredBreast();
  RegisteredBreast(RegisteredBreast&&) noexcept;
  RegisteredBreast& operator=(RegisteredBreast&&) noexcept;

  /// Where a point of the label volume's frame (mm) is seen. Throws InputError when it lies more
  /// than a millimetre outside the breast.
  ImagedPoint ToMammogram(const Vector3& point) const;

  /// Where tissue at a point of the label volume's frame (mm) goes.
  CarriedPoint Carry(const Vector3& point) const;

  /// Where tissue at a point of the compressed breast (volume frame, mm) came from: the
  /// displacement leads back, to the breast at rest.
  CarriedPoint CarryBack(const Vector3& point) const;

  /**
   * What lies behind a pixel (continuous position): the tissues that the X-ray crosses, from the
   * source towards the receptor, in steps of at most `stepMm` (positive). Empty where it misses the
   * breast. Throws InputError outside the image.
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

/// Where a registered mammogram shows something: continuous column and row.
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
  /// How far the X-rays' curves through the tissue at rest pass each other there, mm: what
  /// registrations or marks are off by at least.
  double GapMm = 0;
};

/**
 * The tissue at rest that lies behind a pixel of one mammogram and behind one of another of the
 * same breast: each X-ray leads through the compressed breast, whose tissue is a curve in the
 * breast at rest; the middle between the curves where they are nearest, to `stepMm`. One picture
 * alone tells nothing of the place along its X-ray. Nothing where an X-ray misses the breast.
 * Throws InputError where a pixel lies outside its mammogram.
 */
MAMMORAYSTUDY_EXPORT std::optional<TissueInTwoViews> FindInTwoViews(const SeenInView& first,
  const SeenInView& second, double stepMm = 0.5);
}

#endif
