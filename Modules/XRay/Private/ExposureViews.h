// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_ExposureViews_h
#define mammoray_ExposureViews_h

#include "mammoray/XRay/Exposure.h"
#include "mammorayXRayModule.h"

#include <vector>

namespace mammoray
{
/// The rays from one point of the focal spot to one sample of every pixel.
struct ExposureView
{
  XRaySource Source;
  /// Samples is 1.
  XRayDetector Detector;
  /// Offset of the point from the middle of the spot along the detector's columns and rows, mm.
  double SpotColumnMm = 0;
  double SpotRowMm = 0;
  /// Offset of the sample from the middle of the pixel, in pixels.
  double SampleColumn = 0;
  double SampleRow = 0;
};

/// The views of an exposure, which have equal weights. Throws InputError on a focal spot with a
/// parallel beam.
std::vector<ExposureView> ViewsOf(const XRaySource& source, const XRayDetector& detector,
  const ExposureOptions& options);

/// The detector's blur (see ExposureOptions::HasBlur): convolves rows and columns; beyond its
/// borders the image continues with its border values.
MAMMORAYXRAY_EXPORT void BlurImage(const XRayDetector& detector, const ExposureOptions& options,
  std::vector<double>& image);
/// The transpose of BlurImage.
MAMMORAYXRAY_EXPORT void TransposeBlur(const XRayDetector& detector, const ExposureOptions& options,
  std::vector<double>& image);
}

#endif
