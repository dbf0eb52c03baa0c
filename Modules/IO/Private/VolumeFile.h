// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Private_VolumeFile_h
#define mammoray_Private_VolumeFile_h

#include "mammoray/Foundation/Volumes.h"
#include "mammoray/IO/LabelVolumeIO.h"

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

namespace mammoray
{
/// A file of one volume, its header read: .nrrd .nhdr .mha .mhd .nii .nii.gz (see ReadLabelFile).
class VolumeFile
{
public:
  /**
   * Throws InputError on a file that is none, or that does not hold all voxels that its header
   * promises; `what` is the expected content, for its messages.
   */
  VolumeFile(const std::string& path, const std::string& what, VolumeAxes axes);
  ~VolumeFile();

  /// The grid of the header, not yet validated.
  const VolumeGrid& Grid() const { return this->HeaderGrid; }
  /// All of which are there.
  std::size_t NumberOfVoxels() const;
  /// Hands over all values in their order, some at a time. Throws InputError on a damaged file.
  void Decode(const std::function<void(const double* values, std::size_t count)>& sink) const;

private:
  struct Reader;
  std::unique_ptr<Reader> Itk;
  VolumeGrid HeaderGrid;
};

/**
 * Writes voxels, i fastest, as a file of the format that the extension (.nrrd, .mha, .nii.gz)
 * names; the frame is called LPS. Each voxel has `channels` values, one after the other. Throws
 * InputError when it cannot be written.
 */
void WriteVolumeFile(const std::string& path, const VolumeGrid& grid, const std::uint8_t* voxels);
void WriteVolumeFile(const std::string& path, const VolumeGrid& grid, const std::uint16_t* voxels);
void WriteVolumeFile(const std::string& path, const VolumeGrid& grid, const float* voxels,
  unsigned channels = 1, bool compressed = true);

/// The extension in lower case, ".nii.gz" as one.
std::string VolumeExtension(const std::string& path);
}

#endif
