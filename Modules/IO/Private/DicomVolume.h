// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_DicomVolume_h
#define mammoray_DicomVolume_h

#include "mammoray/Foundation/IntensityVolume.h"
#include "mammoray/Foundation/LabelVolume.h"
#include "mammoray/Foundation/Progress.h"
#include "mammoray/IO/LabelVolumeIO.h"

#include <string>
#include <vector>

namespace mammoray
{
/**
 * Labels from DICOM, in LPS, oblique and anisotropic grids kept. A folder is a series of slices
 * whose values are the labels, evenly spaced and of one series. A file is a segmentation (DICOM
 * SEG, binary or fractional, not compressed): labels are the segment numbers, of overlapping
 * segments the smaller one, fractions count from a half; slices that the file leaves out are empty.
 * Throws InputError, one line with the file, on anything else.
 */
LabelVolume ReadDicomLabels(const std::string& path);

/**
 * A series of slices in a folder, or the frames of one MR object, with their intensities after
 * rescaling, otherwise as above. Throws InputError on a file of a single image too.
 */
IntensityVolume ReadDicomIntensities(const std::string& path);

/// The same of slices that are named, in any order, of one series.
IntensityVolume ReadDicomIntensities(const std::vector<DicomSlice>& slices,
  const ProgressCallback& progress);
}

#endif
