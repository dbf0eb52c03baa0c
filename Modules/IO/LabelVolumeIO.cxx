// SPDX-License-Identifier: Apache-2.0
#include "mammoray/IO/LabelVolumeIO.h"

#include "Private/InputFile.h"
#include "Private/LabelNames.h"
#include "Private/VolumeFile.h"
#include "Private/VolumePlacement.h"
#include "mammoray/IO/AtomicFile.h"
#include "mammoray/IO/GuardedRead.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <set>
#include <sstream>
#include <utility>

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
std::vector<Segment> SegmentsOf(const std::string& path)
{
  const std::string extension = ExtensionOf(path);
  return extension == ".nrrd" || extension == ".nhdr" ? ReadSegments(TextHeader::ReadNrrd(path))
                                                      : std::vector<Segment>();
}

/**
 * Makes one volume of the layers of segments, which lie over each other: each voxel gets the
 * smallest of its segments, as of DICOM segmentations, so that a lesion shows within a gland within
 * a breast. Labels are the segments' own if no two are the same, otherwise their numbers from 1.
 * `layered`: the values of a voxel's layers one after the other, on the grid of `volume`.
 */
void FlattenLayers(const std::string& path, const std::vector<Segment>& segments,
  std::size_t layers, const std::vector<std::uint16_t>& layered, LabelVolume& volume)
{
  std::map<std::pair<std::size_t, int>, std::size_t> segmentOf;
  std::set<int> labels;
  for (const Segment& segment : segments)
  {
    const auto layer = static_cast<std::size_t>(segment.Layer);
    if (layer >= layers)
    {
      throw InputError(path + ": expected a layer from 0 to " + std::to_string(layers - 1) +
        " for segment '" + segment.Name + "', found " + std::to_string(layer));
    }
    segmentOf[{ layer, segment.Label }] = static_cast<std::size_t>(&segment - segments.data());
    labels.insert(segment.Label);
  }
  std::vector<std::size_t> counts(segments.size(), 0);
  // Of each value, its segment; none of 0.
  constexpr std::size_t none = ~std::size_t{ 0 };
  const auto find = [&](std::size_t at)
  {
    const auto found = segmentOf.find({ at % layers, layered[at] });
    if (layered[at] != 0 && found == segmentOf.end())
    {
      throw InputError(path + ": " + volume.VoxelName(at / layers) + " of layer " +
        std::to_string(at % layers) + " holds " + std::to_string(layered[at]) +
        ", which no segment of the header has");
    }
    return layered[at] == 0 ? none : found->second;
  };
  for (std::size_t at = 0; at < layered.size(); ++at)
  {
    if (const std::size_t segment = find(at); segment != none)
    {
      ++counts[segment];
    }
  }
  const bool areOwn = labels.size() == segments.size();
  std::size_t shared = 0;
  volume.Voxels.assign(layered.size() / layers, 0);
  for (std::size_t voxel = 0; voxel < volume.Voxels.size(); ++voxel)
  {
    std::size_t smallest = none;
    for (std::size_t layer = 0; layer < layers; ++layer)
    {
      const std::size_t segment = find(voxel * layers + layer);
      shared += segment != none && smallest != none ? 1 : 0;
      smallest = segment != none && (smallest == none || counts[segment] < counts[smallest])
        ? segment
        : smallest;
    }
    if (smallest != none)
    {
      volume.Voxels[voxel] =
        static_cast<std::uint16_t>(areOwn ? segments[smallest].Label : smallest + 1);
    }
  }
  for (std::size_t segment = 0; segment < segments.size(); ++segment)
  {
    volume.Names[areOwn ? segments[segment].Label : static_cast<int>(segment) + 1] =
      segments[segment].Name;
  }
  if (shared > 0)
  {
    Note({ path,
      "its segments overlap in " + std::to_string(shared) +
        " voxels, which are given to the smaller segment" });
  }
}

LabelVolume DecodeLabels(const std::string& path, VolumeAxes axes)
{
  LabelVolume volume;
  std::vector<std::uint16_t> layered;
  std::size_t layers = 1;
  std::vector<Segment> segments;
  ReadVolumeFile(
    path, "a label volume", axes,
    [&](const VolumeGrid& grid, std::size_t channels)
    {
      static_cast<VolumeGrid&>(volume) = grid;
      layers = channels;
      segments = layers > 1 ? SegmentsOf(path) : segments;
      if (layers > 1 && segments.empty())
      {
        throw InputError(path + ": expected one label per voxel, found " + std::to_string(layers) +
          " and no segments in the header that they belong to");
      }
      layered.reserve(grid.Index(0, 0, grid.Size[2]) * layers);
    },
    [&](const double* values, std::size_t count)
    {
      for (std::size_t n = 0; n < count; ++n)
      {
        if (!IsLabel(values[n]))
        {
          throw NoLabel(path + ": " + volume.VoxelName(layered.size() / layers), values[n]);
        }
        layered.push_back(static_cast<std::uint16_t>(values[n]));
      }
    });
  if (layers > 1)
  {
    FlattenLayers(path, segments, layers, layered, volume);
  }
  else
  {
    volume.Voxels = std::move(layered);
    volume.Names = ReadLabelNames(path);
  }
  Straighten(path, volume);
  return volume;
}

IntensityVolume DecodeIntensities(const std::string& path, VolumeAxes axes)
{
  IntensityVolume volume;
  ReadVolumeFile(
    path, "a volume", axes,
    [&](const VolumeGrid& grid, std::size_t channels)
    {
      if (channels != 1)
      {
        throw InputError(
          path + ": expected one value per voxel, found " + std::to_string(channels));
      }
      static_cast<VolumeGrid&>(volume) = grid;
      volume.Voxels.reserve(grid.Index(0, 0, grid.Size[2]));
    },
    [&](const double* values, std::size_t count)
    { volume.Voxels.insert(volume.Voxels.end(), values, values + count); });
  Straighten(path, volume);
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
