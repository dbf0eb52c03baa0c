// SPDX-License-Identifier: Apache-2.0
#include "mammoray/IO/LabelVolumeIO.h"

#include "Private/InputFile.h"
#include "Private/VolumeFile.h"
#include "mammoray/IO/GuardedRead.h"

#include <algorithm>
#include <cmath>
#include <sstream>

namespace mammoray
{
/// Passes a volume between a reader's process and this one.
template <typename Volume>
requires std::is_base_of_v<VolumeGrid, Volume>
void Exchange(Parcel& parcel, Volume& volume)
{
  parcel(static_cast<VolumeGrid&>(volume), volume.Voxels);
}

namespace
{
LabelVolume DecodeLabels(const std::string& path, VolumeAxes axes)
{
  LabelVolume volume;
  ReadVolumeFile(
    path, "a label volume", axes,
    [&](const VolumeGrid& grid)
    {
      static_cast<VolumeGrid&>(volume) = grid;
      volume.Voxels.reserve(grid.Index(0, 0, grid.Size[2]));
    },
    [&](const double* values, std::size_t count)
    {
      for (std::size_t n = 0; n < count; ++n)
      {
        if (!IsLabel(values[n]))
        {
          throw NoLabel(path + ": " + volume.VoxelName(volume.Voxels.size()), values[n]);
        }
        volume.Voxels.push_back(static_cast<std::uint16_t>(values[n]));
      }
    });
  return volume;
}

IntensityVolume DecodeIntensities(const std::string& path, VolumeAxes axes)
{
  IntensityVolume volume;
  ReadVolumeFile(
    path, "a volume", axes,
    [&](const VolumeGrid& grid)
    {
      static_cast<VolumeGrid&>(volume) = grid;
      volume.Voxels.reserve(grid.Index(0, 0, grid.Size[2]));
    },
    [&](const double* values, std::size_t count)
    { volume.Voxels.insert(volume.Voxels.end(), values, values + count); });
  return volume;
}
}

bool IsLabel(double value)
{
  return value >= 0 && value <= 65535 && value == std::floor(value);
}

InputError NoLabel(const std::string& place, double value)
{
  std::ostringstream text;
  text.precision(17);
  text << place << " holds " << value << ", expected a label, a whole number from 0 to 65535";
  return InputError(text.str());
}

LabelVolume ReadLabelFile(const std::string& path, VolumeAxes axes)
{
  LabelVolume volume = ReadGuarded(path, "a label volume", ReadLimits::Of({ path }),
    [&] { return DecodeLabels(path, axes); });
  volume.Validate(path);
  return volume;
}

IntensityVolume ReadIntensityFile(const std::string& path, VolumeAxes axes)
{
  IntensityVolume volume = ReadGuarded(path, "a volume", ReadLimits::Of({ path }),
    [&] { return DecodeIntensities(path, axes); });
  volume.Validate(path);
  return volume;
}

void CheckLabelVolumeExtension(const std::string& path)
{
  if (!IsVolumeExtension(ExtensionOf(path)))
  {
    throw InputError(path +
      ": expected the extension .nrrd, .mha or .nii.gz for a volume, found '" + ExtensionOf(path) +
      "'");
  }
}

void WriteLabelVolume(const LabelVolume& volume, const std::string& path)
{
  volume.Validate(path);
  CheckLabelVolumeExtension(path);
  if (std::all_of(volume.Voxels.begin(), volume.Voxels.end(), [](auto v) { return v < 256; }))
  {
    const std::vector<std::uint8_t> small(volume.Voxels.begin(), volume.Voxels.end());
    WriteVolumeFile(path, volume, small.data());
    return;
  }
  WriteVolumeFile(path, volume, volume.Voxels.data());
}

void WriteIntensityVolume(const IntensityVolume& volume, const std::string& path)
{
  volume.Validate(path);
  CheckLabelVolumeExtension(path);
  WriteVolumeFile(path, volume, volume.Voxels.data());
}
}
