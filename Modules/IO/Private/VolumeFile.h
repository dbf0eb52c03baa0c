// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_VolumeFile_h
#define mammoray_VolumeFile_h

#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/VolumeGrid.h"
#include "mammoray/IO/LabelVolumeIO.h"

#include <cstdint>
#include <functional>
#include <string>

namespace mammoray
{
enum class ScalarType
{
  Int8,
  UInt8,
  Int16,
  UInt16,
  Int32,
  UInt32,
  Int64,
  UInt64,
  Float,
  Double
};

/// What a header says.
struct VolumeHeader
{
  std::array<std::int64_t, 3> Size{ 0, 0, 0 };
  Vector3 Origin{ 0, 0, 0 };
  /// Axis[a]: step from voxel to voxel along a, mm.
  std::array<Vector3, 3> Axis{ { { 1, 0, 0 }, { 0, 1, 0 }, { 0, 0, 1 } } };
  ScalarType Type = ScalarType::UInt8;
  bool BigEndian = false;
  /// value = Slope * stored + Intercept
  double Slope = 1;
  double Intercept = 0;
  std::string DataPath;
  /// Bytes to skip in the file, before any decompression.
  std::uint64_t FileOffset = 0;
  /// Bytes to skip after decompression.
  std::uint64_t DataOffset = 0;
  bool Compressed = false;
};

/// A file of one volume, its header read: .nrrd .nhdr .mha .mhd .nii .nii.gz (see ReadLabelVolume).
class VolumeFile
{
public:
  /// Throws InputError on a file that is none; `what` is the expected content, for its messages.
  VolumeFile(const std::string& path, const std::string& what, VolumeAxes axes);

  /// The grid of the header, not yet validated.
  const VolumeGrid& Grid() const { return this->HeaderGrid; }
  /**
   * Hands over all values in their order, some at a time. Throws InputError on a short or damaged
   * file.
   */
  void Decode(const std::function<void(const double* values, std::size_t count)>& sink) const;

private:
  std::string Path;
  VolumeHeader Header;
  VolumeGrid HeaderGrid;
};

/// The extension in lower case, ".nii.gz" as one.
std::string VolumeExtension(const std::string& path);

/// True for what LabelVolume holds: a whole number from 0 to 65535.
bool IsLabel(double value);

/// The error for another value; `place` says where it is.
InputError NoLabel(const std::string& place, double value);
}

#endif
