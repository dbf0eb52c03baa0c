// SPDX-License-Identifier: Apache-2.0
// Where a volume lies, if its file says it twice or its axes are not at right angles.
#ifndef mammoray_Private_VolumePlacement_h
#define mammoray_Private_VolumePlacement_h

#include "mammoray/Foundation/Volumes.h"
#include "mammorayIOModule.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstring>
#include <iterator>
#include <string>

namespace mammoray
{
/// Text of the note for a file that names no patient frame.
inline constexpr const char* AxesNotSaid =
  "it does not say where the patient's left, back and head are; its axes are taken as LPS unless "
  "an orientation is set";

/// The header of a NIfTI-1 file of its own (magic n+1), which may be compressed.
class MAMMORAYIO_EXPORT NiftiHeader
{
public:
  /// Throws InputError on another file and on one that ends within the header.
  explicit NiftiHeader(const std::string& path);

  /// The value at an offset of nifti1.h, in this machine's order of bytes.
  template <typename T>
  T At(std::size_t offset) const
  {
    char bytes[sizeof(T)];
    std::copy_n(this->Bytes.begin() + static_cast<std::ptrdiff_t>(offset), sizeof(T), bytes);
    if (this->IsSwapped)
    {
      std::reverse(std::begin(bytes), std::end(bytes));
    }
    T value;
    std::memcpy(&value, bytes, sizeof value);
    return value;
  }
  double Number(std::size_t offset) const { return static_cast<double>(this->At<float>(offset)); }
  /// Whether the file is compressed, whatever its name.
  bool IsPacked() const { return this->Packed; }

private:
  static constexpr int Length = 348;
  std::array<char, Length> Bytes{};
  bool IsSwapped = false;
  bool Packed = false;
};

/**
 * Replaces the grid that ITK made of a NIfTI-1 header, DICOM LPS, by the one that the header
 * states: the sform if its code is 1 (scanner) or there is no qform, otherwise the qform. ITK makes
 * their axes orthonormal. Throws InputError if sform and qform are mirror images of each other.
 * Notes if they differ otherwise by more than half a voxel, and if the size of a voxel is not that
 * of pixdim. If the header has neither, keeps the grid and notes that its axes count as LPS.
 */
MAMMORAYIO_EXPORT void TakeNiftiPlacement(const std::string& path, const NiftiHeader& header,
  VolumeGrid& grid);

/**
 * Resamples a volume whose axes are up to 17 degrees off right angles (cosine 0.3) to the nearest
 * axes that are, in steps of the same lengths, labels by the nearest voxel, intensities
 * trilinearly, and notes it. The new grid holds all of the old one; 0 beyond it. Does nothing to
 * other axes.
 */
MAMMORAYIO_EXPORT void Straighten(const std::string& path, LabelVolume& volume);
void Straighten(const std::string& path, IntensityVolume& volume);
}

#endif
