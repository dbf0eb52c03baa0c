// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Private_SliceStack_h
#define mammoray_Private_SliceStack_h

#include "mammoray/Dicom/DicomHeader.h"
#include "mammoray/Foundation/Volumes.h"

#include <string>
#include <vector>

namespace mammoray
{
/// One slice of a series or of a segment.
struct VolumeSlice : SlicePlace
{
  std::string Name; // for messages
  int Columns = 0;
  int Rows = 0;
  /// Labels or intensities, along rows first.
  std::vector<float> Values;
};

/**
 * Finds the grid of at least one slice; Values are not used. Throws InputError as StackSlices does.
 */
VolumeGrid FindSliceGrid(const std::vector<VolumeSlice>& slices, bool gapsAllowed);

/**
 * Stacks at least one slice to a volume on their grid. Throws InputError unless they are parallel
 * and evenly spaced. With `gapsAllowed`, slices may be missing, which leaves 0, and may share a
 * position; where they overlap, the label with fewer pixels wins.
 */
IntensityVolume StackSlices(const std::vector<VolumeSlice>& slices, bool gapsAllowed);
}

#endif
