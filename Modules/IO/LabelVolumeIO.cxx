// SPDX-License-Identifier: Apache-2.0
#include "mammoray/IO/LabelVolumeIO.h"

#include "Private/InputFile.h"
#include "Private/LabelNames.h"
#include "Private/VolumeFile.h"
#include "mammoray/IO/AtomicFile.h"
#include "mammoray/IO/GuardedRead.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <sstream>

namespace mammoray
{
/// Passes a volume between a reader's process and this one.
static void Exchange(Parcel& parcel, LabelVolume& volume)
{
  std::vector<int> labels;
  std::vector<std::string> names;
  for (const auto& [label, name] : volume.Names)
  {
    labels.push_back(label);
    names.push_back(name);
  }
  parcel(static_cast<VolumeGrid&>(volume), volume.Voxels, labels, names);
  for (std::size_t index = 0; index < labels.size(); ++index)
  {
    volume.Names[labels[index]] = names[index];
  }
}

static void Exchange(Parcel& parcel, IntensityVolume& volume)
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
  volume.Names = ReadLabelNames(path);
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

bool HoldsLabelNames(const std::string& path)
{
  return ExtensionOf(path) == ".nrrd" &&
    ExtensionOf(std::filesystem::path(path).stem().string()) == ".seg";
}

void WriteLabelVolume(const LabelVolume& volume, const std::string& path)
{
  volume.Validate(path);
  CheckLabelVolumeExtension(path);
  const bool isNamed = !volume.Names.empty();
  const auto pairs =
    isNamed && HoldsLabelNames(path) ? SegmentPairs(volume) : std::map<std::string, std::string>();
  if (std::all_of(volume.Voxels.begin(), volume.Voxels.end(), [](auto v) { return v < 256; }))
  {
    const std::vector<std::uint8_t> small(volume.Voxels.begin(), volume.Voxels.end());
    WriteVolumeFile(path, volume, small.data(), 1, true, pairs);
  }
  else
  {
    WriteVolumeFile(path, volume, volume.Voxels.data(), 1, true, pairs);
  }
  if (isNamed && !HoldsLabelNames(path))
  {
    WriteAtomicFile(LabelDescriptionOf(path), LabelDescription(volume));
  }
}

void WriteIntensityVolume(const IntensityVolume& volume, const std::string& path)
{
  volume.Validate(path);
  CheckLabelVolumeExtension(path);
  WriteVolumeFile(path, volume, volume.Voxels.data());
}
}
