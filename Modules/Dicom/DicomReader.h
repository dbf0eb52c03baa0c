// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_DicomReader_h
#define mammoray_DicomReader_h

#include "mammoray/Foundation/Mammogram.h"
#include "mammoray/Foundation/Progress.h"
#include "mammoray/Foundation/Volumes.h"
#include "mammoray/IO/LabelVolumeIO.h"
#include "mammorayDicomModule.h"

#include <cstddef>
#include <string>
#include <vector>

namespace mammoray
{
/**
 * Reads a DICOM mammogram (modality MG, MONOCHROME1 or MONOCHROME2). Transfer syntaxes: implicit
 * and explicit VR, big endian, deflated, RLE, JPEG, JPEG-LS and JPEG 2000. If the file holds the
 * projections of a tomosynthesis, the projection whose source is nearest to the mean source
 * position is returned.
 *
 * Pixel spacing is that at the receptor: Imager Pixel Spacing, or Pixel Spacing times Estimated
 * Radiographic Magnification Factor. What is `given` takes the place of what the header lacks: the
 * spacing, the view and the side of a digitised film. Nothing that identifies the patient is read.
 *
 * Throws InputError, one line that names the file, if it is missing, truncated, not DICOM, not a
 * mammogram, in colour, a stack of reconstructed slices, or without a usable pixel spacing; then
 * the message names all that is lacking of a description.
 */
MAMMORAYDICOM_EXPORT Mammogram ReadMammogram(const std::string& path,
  const PictureDescription& given = {});

/**
 * Reads the projections of one compression from a Breast Projection X-Ray Image (PS3.3 A.74), in
 * the order of its frames. Each has SourceFootPixel and SourceToDetectorMm, computed from the
 * isocenter reference system (C.8.31.6). Pixels have 8 or 16 bits; 2 to 200 frames are accepted.
 * Any other mammogram yields itself, as ReadMammogram does.
 *
 * Throws InputError as ReadMammogram does, and if the positions of source and detector are missing.
 */
MAMMORAYDICOM_EXPORT std::vector<Mammogram> ReadProjections(const std::string& path,
  const PictureDescription& given = {});

/// Index of the projection whose source is nearest to the mean source position. `projections` must
/// not be empty.
MAMMORAYDICOM_EXPORT std::size_t MiddleProjection(const std::vector<Mammogram>& projections);

/**
 * Reads a label volume from DICOM or from a volume file (ReadLabelFile). DICOM is always in LPS. A
 * folder is read as a series whose pixel values are the labels. A .dcm file is read as an
 * uncompressed segmentation (binary, fractional or label map): labels are segment numbers, Names
 * their labels, fractions count from half of the maximum value, and where segments overlap the
 * smaller one wins. Throws InputError, one line that names the file, on anything else, on fractions
 * without a maximum value, and on values beyond it.
 */
MAMMORAYDICOM_EXPORT LabelVolume ReadLabelVolume(const std::string& path,
  VolumeAxes axes = VolumeAxes::Patient);

/// Reads an MRI or another image with any finite values, from the same formats except SEG; a .dcm
/// file may be a multi-frame MR object. Throws InputError as ReadLabelVolume does.
MAMMORAYDICOM_EXPORT IntensityVolume ReadIntensityVolume(const std::string& path,
  VolumeAxes axes = VolumeAxes::Patient);

/// A slice of a DICOM series: a file, or one frame of an enhanced multi-frame MR object.
struct DicomSlice
{
  std::string Path;
  /// Frame number, from 1. 0: the file is a single slice.
  int Frame = 0;
};

/**
 * Reads the slices of one series, in any order, evenly spaced and at distinct positions (see
 * FindSliceOrder). Values are rescaled; the grid is in DICOM LPS. Throws InputError, one line that
 * names the file, on anything else, and Interrupted.
 */
MAMMORAYDICOM_EXPORT IntensityVolume ReadIntensitySlices(const std::vector<DicomSlice>& slices,
  const ProgressCallback& progress = {});

/// Reads a series from files that are one slice each. Throws as ReadIntensitySlices does.
MAMMORAYDICOM_EXPORT IntensityVolume ReadIntensitySeries(const std::vector<std::string>& files,
  const ProgressCallback& progress = {});
}

#endif
