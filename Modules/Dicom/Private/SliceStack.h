// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Private_SliceStack_h
#define mammoray_Private_SliceStack_h

#include "mammoray/Foundation/IntensityVolume.h"

#include <string>
#include <vector>

namespace mammoray
{
/// One slice of a series, or of one segment.
struct VolumeSlice
{
  std::string Name; // for messages
  int Columns = 0;
  int Rows = 0;
  /// Centre of the first pixel and unit vectors, mm, DICOM LPS.
  Vector3 Position{ 0, 0, 0 };
  Vector3 AlongRow{ 1, 0, 0 };
  Vector3 AlongColumn{ 0, 1, 0 };
  /// Distance of rows, then of columns, mm, as DICOM has it.
  double RowSpacing = 0;
  double ColumnSpacing = 0;
  /// Distance of slices that the file tells, mm; 0 where it does not.
  double SliceSpacing = 0;
  /// Labels or intensities, along rows first.
  std::vector<float> Values;
};

/**
 * The grid that slices, at least one, lie on; their values are not looked at. Throws as
 * StackSlices.
 */
VolumeGrid FindSliceGrid(const std::vector<VolumeSlice>& slices, bool gapsAllowed);

/**
 * The slices, at least one, on the grid that they lie on, 0 where there is none. With `gapsAllowed`
 * slices may share a place, of overlapping ones the label that claims less is kept, and places may
 * be left out. Throws InputError when they do not lie in parallel at even distances.
 */
IntensityVolume StackSlices(const std::vector<VolumeSlice>& slices, bool gapsAllowed);
}

#endif
