// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_DicomSegmentationWriter_h
#define mammoray_DicomSegmentationWriter_h

#include "mammoray/IO/DicomIdentity.h"
#include "mammorayIOModule.h"

#include <string>
#include <vector>

namespace mammoray
{
/// A lesion's shadow on an image.
struct DicomSegment
{
  /// Shown to the reader, at most 64 bytes.
  std::string Label;
  /// 1 inside, 0 outside; Rows * Columns values of the image, row by row.
  std::vector<unsigned char> Mask;
};

/**
 * Writes lesions on a projection image as a binary DICOM segmentation (PS3.3 section A.51), one
 * frame and segment each, numbered from 1, on the image's own pixels. Projections have no place in
 * space: each frame refers to the image as its source, locations preserved, and so lies over it.
 * `identity` says patient and study; the image's study for viewers to find both together.
 *
 * Throws InputError without segments, on a mask of another size, an unusable label, and when the
 * file cannot be written.
 */
MAMMORAYIO_EXPORT void WriteSegmentation(const std::vector<DicomSegment>& segments,
  const DicomReference& image, const DicomIdentity& identity, const std::string& path);
}

#endif
