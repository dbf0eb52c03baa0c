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

/// An image without arrays that lies where the detector is. The detector's steps must be at right
/// angles (InputError).
MAMMORAYIO_EXPORT vtkSmartPointer<vtkImageData> MakeDetectorImage(const XRayDetector& detector);

/**
 * The image of an exposure, lying where the detector is: point arrays "Transmission" (scalars,
 * float), "LogAttenuation" (float), "PathLength_<name>" (float, mm) per material but air,
 * "Consistency" (unsigned char, 1 = trusted). Materials without a name are called by their index.
 * The detector's steps must be at right angles (InputError).
 */
MAMMORAYIO_EXPORT vtkSmartPointer<vtkImageData> ToImage(const Exposure& exposure,
  const XRayDetector& detector, const std::vector<std::string>& materialNames);

/// Any values of a detector's pixels, row by row, as scalars of that name. Steps as above; throws
/// InputError unless there is one for each pixel.
MAMMORAYIO_EXPORT vtkSmartPointer<vtkImageData> ToImage(const std::vector<float>& values,
  const std::string& name, const XRayDetector& detector);

/// The deflection of an image with refraction, lying where the detector is: scalars "Deflection"
/// (float, radians), two components, along columns and rows. Steps as of ToImage.
MAMMORAYIO_EXPORT vtkSmartPointer<vtkImageData> ToDeflectionImage(const Exposure& exposure,
  const XRayDetector& detector);

/// What a picture shows white: the value that one pixel in a thousand exceeds, 1 where that is not
/// positive. `count` finite values, at least one.
MAMMORAYIO_EXPORT float FindWhite(const float* values, std::size_t count);

/**
 * A picture to look at, as a radiograph is read: the float array of that name, large is bright,
 * 16-bit grey, row 0 on top. Black is nothing in the beam, white FindWhite's value. Throws
 * InputError unless the extension is .png and the file can be written.
 */
MAMMORAYIO_EXPORT void WriteRadiograph(vtkImageData* image, const std::string& path,
  const std::string& arrayName = LogAttenuationArrayName);

/// Writes an image of 8 or 16 bits as a picture (PNG), its last row on top. Throws InputError when
/// it cannot be written.
MAMMORAYIO_EXPORT void WritePicture(vtkImageData* image, const std::string& path);

/// Throws InputError unless WriteProjection knows the path's extension.
MAMMORAYIO_EXPORT void CheckProjectionExtension(const std::string& path, bool pathLengths = false);

/**
 * Writes by extension, row 0 first. .vti: all arrays, with the detector's pose. .mha, .nrrd: the
 * scalars as floats with the pose, a channel per component, or, with `pathLengths`, one channel per
 * path length. .tif: the scalars as floats, row 0 on top (WriteProjectionStack). .png: the scalars,
 * [0, 1] to 16-bit grey; row 0 on top. Throws InputError on another extension and when the file
 * cannot be written.
 */
MAMMORAYIO_EXPORT void WriteProjection(vtkImageData* image, const std::string& path,
  bool pathLengths = false);

/// Projections of one size, one after the other.
struct ProjectionStack
{
  int Columns = 0;
  int Rows = 0;
  int Number = 0;
  /// Of a pixel, along columns and rows, mm.
  double ColumnSpacingMm = 1;
  double RowSpacingMm = 1;
  /// Number x Rows x Columns, columns fastest.
  std::vector<float> Values;
};

/// Throws InputError unless WriteProjectionStack knows the path's extension.
MAMMORAYIO_EXPORT void CheckStackExtension(const std::string& path);

/**
 * Writes by extension, as 32-bit floats: .tif and .tiff, a page for each projection, row 0 on top,
 * with the pixels' size as resolution (BigTIFF beyond 2 GB); .mha and .nrrd, a volume of columns,
 * rows and projections, whose third spacing is 1. Throws InputError on another extension, on values
 * that are not as many, and when the file cannot be written.
 */
MAMMORAYIO_EXPORT void WriteProjectionStack(const ProjectionStack& stack, const std::string& path);
}

#endif
