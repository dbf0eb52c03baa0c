// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_ProjectionImage_h
#define mammoray_ProjectionImage_h

#include "mammoray/XRay/Exposure.h"
#include "mammorayIOModule.h"

#include "vtkSmartPointer.h"

#include <string>
#include <vector>

class vtkImageData;

namespace mammoray
{
inline constexpr const char* LogAttenuationArrayName = "LogAttenuation";

/// Returns an image without arrays at the detector's pose. Throws InputError unless the detector's
/// steps are at right angles.
MAMMORAYIO_EXPORT vtkSmartPointer<vtkImageData> MakeDetectorImage(const XRayDetector& detector);

/**
 * Returns the image of an exposure at the detector's pose. Its point arrays are "Transmission"
 * (scalars, float), "LogAttenuation" (float), "PathLength_<name>" (float, mm) for each material
 * except air, and "Consistency" (unsigned char, 1 = trusted). A material without a name is named by
 * its index. Throws as MakeDetectorImage.
 */
MAMMORAYIO_EXPORT vtkSmartPointer<vtkImageData> ToImage(const Exposure& exposure,
  const XRayDetector& detector, const std::vector<std::string>& materialNames);

/// Returns an image at the detector's pose with values, row by row, as scalars of this name. Throws
/// InputError unless there is one for each pixel, and as MakeDetectorImage.
MAMMORAYIO_EXPORT vtkSmartPointer<vtkImageData> ToImage(const std::vector<float>& values,
  const std::string& name, const XRayDetector& detector);

/// Returns an image at the detector's pose with the deflection by refraction: scalars "Deflection"
/// (float, radians) of two components, along columns and rows. Throws as MakeDetectorImage.
MAMMORAYIO_EXPORT vtkSmartPointer<vtkImageData> ToDeflectionImage(const Exposure& exposure,
  const XRayDetector& detector);

/// Returns the value that a picture shows white: one pixel in a thousand exceeds it; 1 if that
/// value is not positive. `count`: number of values, at least one, all finite.
MAMMORAYIO_EXPORT float FindWhite(const float* values, std::size_t count);

/**
 * Writes a float array as a radiograph to look at: 16-bit grey, row 0 on top, large values bright.
 * 0 is black, the value of FindWhite white. Throws InputError unless the extension is .png and the
 * file can be written.
 */
MAMMORAYIO_EXPORT void WriteRadiograph(vtkImageData* image, const std::string& path,
  const std::string& arrayName = LogAttenuationArrayName);

/// Writes an image of 8 or 16 bits as PNG, its last row on top. Throws InputError if it cannot be
/// written.
MAMMORAYIO_EXPORT void WritePicture(vtkImageData* image, const std::string& path);

/// Throws InputError unless WriteProjection knows the path's extension.
MAMMORAYIO_EXPORT void CheckProjectionExtension(const std::string& path, bool pathLengths = false);

/**
 * Writes an image by extension, row 0 first. .vti holds all arrays and the detector's pose; .mha
 * and .nrrd the pose and the scalars as floats, a channel per component, or one channel per path
 * length with `pathLengths`; .tif the scalars as floats, row 0 on top (WriteProjectionStack); .png
 * the scalars from [0, 1] to 16-bit grey, row 0 on top. Throws InputError on another extension and
 * if the file cannot be written.
 */
MAMMORAYIO_EXPORT void WriteProjection(vtkImageData* image, const std::string& path,
  bool pathLengths = false);

/// Projections of the same size, one after the other.
struct ProjectionStack
{
  int Columns = 0;
  int Rows = 0;
  int Number = 0;
  /// Distance of pixel centres along a row and along a column, mm.
  double ColumnSpacingMm = 1;
  double RowSpacingMm = 1;
  /// Number x Rows x Columns, columns fastest.
  std::vector<float> Values;
};

/// Throws InputError unless WriteProjectionStack knows the path's extension.
MAMMORAYIO_EXPORT void CheckStackExtension(const std::string& path);

/**
 * Writes 32-bit floats by extension. .tif and .tiff have a page for each projection, row 0 on top,
 * with the pixel size as resolution (BigTIFF beyond 2 GB); .mha and .nrrd are a volume of columns,
 * rows and projections, whose third spacing is 1. Throws InputError on another extension, on
 * another number of values, and if the file cannot be written.
 */
MAMMORAYIO_EXPORT void WriteProjectionStack(const ProjectionStack& stack, const std::string& path);
}

#endif
