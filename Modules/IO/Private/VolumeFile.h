// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Private_VolumeFile_h
#define mammoray_Private_VolumeFile_h

#include "mammoray/Foundation/Volumes.h"
#include "mammoray/IO/LabelVolumeIO.h"

#include <functional>
#include <map>
#include <string>

namespace mammoray
{
using TakeValues = std::function<void(const double* values, std::size_t count)>;

/**
 * Reads a file of one volume (.nrrd .nhdr .mha .mhd .nii .nii.gz; see ReadLabelFile). `begin` gets
 * the grid, not yet validated, and the number of values per voxel, then `take` all values in their
 * order, those of a voxel one after the other, some at a time. Throws
 * InputError on a file that is none, that is damaged, or that does not hold all voxels that its
 * header promises; `what` is the expected content, for its messages.
 */
void ReadVolumeFile(const std::string& path, const std::string& what, VolumeAxes axes,
  const std::function<void(const VolumeGrid& grid, std::size_t channels)>& begin,
  const TakeValues& take);

/// Returns true for the extensions of the formats that WriteVolumeFile writes.
inline bool IsVolumeExtension(const std::string& extension)
{
  return extension == ".nrrd" || extension == ".mha" || extension == ".nii.gz";
}

/**
 * Writes voxels (std::uint8_t, std::uint16_t or float), i fastest, as a file of the format that the
 * extension (.nrrd, .mha, .nii.gz) names; the frame is called LPS. Each voxel has `channels`
 * values, one after the other. `pairs` go into the header of a .nrrd. Throws InputError when it
 * cannot be written.
 */
template <typename T>
void WriteVolumeFile(const std::string& path, const VolumeGrid& grid, const T* voxels,
  unsigned channels = 1, bool compressed = true,
  const std::map<std::string, std::string>& pairs = {});
}

#endif
