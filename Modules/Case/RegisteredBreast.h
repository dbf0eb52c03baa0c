// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_RegisteredBreast_h
#define mammoray_RegisteredBreast_h

#include "mammoray/Foundation/LabelVolume.h"
#include "mammoray/Foundation/MammographyGeometry.h"
#include "mammoray/Registration/RegistrationTarget.h"
#include "mammoray/XRay/PathLengthProjector.h"
#include "mammorayCaseModule.h"

#include "vtkSmartPointer.h"

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

class vtkUnstructuredGrid;

namespace mammoray
{
/// The point arrays of uncompressed.vtu that hold the derivatives of the compressed positions, seen
/// from the unit, are called this and the parameter's name; mm per mm or degree.
inline constexpr const char* SensitivityArrayPrefix = "Sensitivity_";

/// An ellipse of one standard deviation.
struct UncertaintyEllipse
{
  double MajorMm = 0;
  double MinorMm = 0;
  /// Of the major axis, from the direction of increasing columns towards increasing rows; degrees,
  /// (-90, 90].
  double AngleDeg = 0;
};

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
  /// By the covariance of the registration's parameters, those held fixed with their priors, which
  /// knows nothing of what the model leaves out; empty where the registration has none.
  std::optional<UncertaintyEllipse> Uncertainty;
};

/// A lesion's shadow on the mammogram.
struct ImagedLesion
{
  /// Of its voxels, and their centre in the volume frame, mm^3 and mm.
  double VolumeMm3 = 0;
  Vector3 Centre{ 0, 0, 0 };
  ImagedPoint ImagedCentre;
  /// Shadow on the receptor, the part in the image.
  double AreaMm2 = 0;
  /// 1 in the shadow; Rows * Columns values of the mammogram, row by row.
  std::vector<unsigned char> Shadow;
  /// Longest way of an X-ray in the lesion, mm.
  double LargestThicknessMm = 0;
  /// Share of its surface's points that lie outside the breast, and were moved with the nearest
  /// tissue.
  double ShareOutside = 0;
  /// Closed polygons around the shadow, continuous column and row; first and last point are the
  /// same.
  std::vector<std::vector<std::array<double, 2>>> Outlines;
};

/// A stretch of an X-ray in one material; points of the line of sight carried back into the
/// uncompressed breast.
struct TissueStretch
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

/// A breast at rest and compressed, and the unit that images it.
struct BreastInUnit
{
  /// The same linear tetrahedra in both, volume frame, mm, with the cell array "Material". The
  /// uncompressed one may have point arrays called SensitivityArrayPrefix and a parameter.
  vtkSmartPointer<vtkUnstructuredGrid> Uncompressed;
  vtkSmartPointer<vtkUnstructuredGrid> Compressed;
  VolumeFromGantry Placed;
  MammographyUnit Unit;
  /// The mammogram's pixel grid; its pictures are not used.
  RegistrationTarget Grid;
  /// Of a registration, in its order: parameters, what was found, and the covariance of what is
  /// free and of what is held with a prior, which is empty where it is not known.
  std::vector<std::string> Parameters;
  std::vector<double> Values;
  std::vector<double> Covariance;
};

/// The folders of the single mammograms in what 'mammoray register' wrote: the folder itself for
/// one, those within for several. Throws InputError that names the file.
MAMMORAYCASE_EXPORT std::vector<std::string> RegistrationFolders(const std::string& folder);

/// The first reason why the match in the folder of one mammogram is not to be trusted; "" where
/// there is none. Throws InputError that names the file.
MAMMORAYCASE_EXPORT std::string DistrustOf(const std::string& folder);

/// Reads the folder that 'mammoray register' wrote for one mammogram. Throws InputError that names
/// the file.
MAMMORAYCASE_EXPORT BreastInUnit ReadRegistration(const std::string& folder);

/**
 * The result of a registration, read from the folder that 'mammoray register' wrote, to find points
 * of the one image in the other.
 */
class MAMMORAYCASE_EXPORT RegisteredBreast
{
public:
  /// Throws InputError that names the file.
  explicit RegisteredBreast(const std::string& folder);
  /// Throws InputError where the grids do not belong together.
  explicit RegisteredBreast(const BreastInUnit& breast);
  ~RegisteredBreast();
  RegisteredBreast(RegisteredBreast&&) noexcept;
  RegisteredBreast& operator=(RegisteredBreast&&) noexcept;

  /// Where a point of the label volume's frame (mm) is seen. Throws InputError when it lies more
  /// than a millimetre outside the breast.
  ImagedPoint ToMammogram(const Vector3& point) const;

  /**
   * Where a lesion is seen: the voxels of `lesions` (frame of the registered label volume) with the
   * label `label`, as a closed surface that is compressed with the breast and projected on the
   * mammogram's pixels. The projector is given that surface. Throws InputError when there is no
   * such voxel or the lesion lies outside the breast, and DeviceError.
   */
  ImagedLesion ToMammogram(const LabelVolume& lesions, int label,
    PathLengthProjector& projector) const;

  /**
   * What lies behind a pixel (continuous position): the tissues that the X-ray crosses, from the
   * source towards the receptor, in steps of at most `stepMm` (positive). Empty where it misses the
   * breast. Throws InputError outside the image.
   */
  std::vector<TissueStretch> ToVolume(double column, double row, double stepMm = 0.25) const;

  /// The tetrahedra before and between the plates, of the same points and cells, volume frame.
  vtkUnstructuredGrid* Uncompressed() const;
  vtkUnstructuredGrid* Compressed() const;
  /// Of the mammogram, volume frame: the focus and the pixels that were registered.
  XRaySource Source() const;
  XRayDetector Detector() const;

private:
  struct Internals;
  std::unique_ptr<Internals> Internal;
};
}

#endif
