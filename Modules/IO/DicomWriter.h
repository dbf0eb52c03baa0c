// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_DicomWriter_h
#define mammoray_DicomWriter_h

#include "mammoray/Foundation/IntensityVolume.h"
#include "mammoray/Foundation/Mammogram.h"
#include "mammoray/IO/DicomHeader.h"
#include "mammoray/IO/DicomIdentity.h"
#include "mammorayIOModule.h"

#include <optional>
#include <string>
#include <vector>

namespace mammoray
{
struct DicomMammogramOptions
{
  DicomIdentity Identity;
  /// The mammogram that the image imitates; empty: the file refers to none.
  std::optional<DicomReference> Imitated;
  std::string SeriesDescription = "Synthetic mammogram";
  /// How the image was computed, a sentence or two, at most 1024 bytes.
  std::string Derivation;
};

/**
 * Writes a synthetic image as a DICOM mammogram (Digital Mammography X-Ray Image, PS3.3 section
 * A.26; For Presentation or For Processing as the mammogram says), marked as derived, 16 bits, not
 * compressed. ReadMammogram gives the same mammogram back. Its pixels must be whole numbers from 0
 * to 65535. A presentation's window reaches from 0 to FindWhite's value.
 *
 * The file holds nothing of the patient but what Identity says, and no private elements.
 *
 * Throws InputError when laterality, view or patient orientation is unknown (a mammogram must say
 * them), pixels or spacings are unusable, or the file cannot be written.
 */
MAMMORAYIO_EXPORT void WriteMammogram(const Mammogram& mammogram,
  const DicomMammogramOptions& options, const std::string& path);

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

/// A unique identifier that no other object, series or study has.
MAMMORAYIO_EXPORT std::string NewDicomUid();

/**
 * Writes a volume (DICOM LPS) as a series of MR images (PS3.3 section A.4), one for each layer of
 * its grid, 16 bits, not compressed, numbered from 1. What the header says of patient, series and
 * sequence is written as it is, what it says of places and sizes comes from the volume; an empty
 * UID is made anew. ReadDicomHeader and ReadIntensitySeries give both back. Throws InputError
 * unless there is a path for each layer, on values that do not round to 0 to 65535, and when a file
 * cannot be written.
 */
MAMMORAYIO_EXPORT void WriteMrSeries(const IntensityVolume& volume, const DicomHeader& header,
  const std::vector<std::string>& paths);
}

#endif
