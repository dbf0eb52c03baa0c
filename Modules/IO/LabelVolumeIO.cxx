// SPDX-License-Identifier: Apache-2.0
#include "mammoray/IO/LabelVolumeIO.h"

#include "Private/DicomVolume.h"
#include "Private/DisplacementTransform.h"
#include "Private/GuardedRead.h"
#include "Private/VolumeFile.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

namespace mammoray
{
namespace
{
/// Whether DICOM's readers are to be asked; throws InputError where nothing is.
bool IsDicom(const std::string& path)
{
  std::error_code problem;
  if (!std::filesystem::exists(path, problem))
  {
    throw InputError(path + ": no such file");
  }
  return std::filesystem::is_directory(path) || VolumeExtension(path) == ".dcm";
}

/// Both ways between processes.
template <typename Parcel, typename Volume>
void Exchange(Parcel& parcel, Volume&& volume)
{
  parcel(volume.Size, volume.Origin, volume.Spacing, volume.Direction, volume.Voxels);
}

LabelVolume DecodeLabels(const std::string& path, VolumeAxes axes)
{
  const VolumeFile file(path, "a label volume", axes);
  LabelVolume volume;
  static_cast<VolumeGrid&>(volume) = file.Grid();
  volume.Voxels.reserve(file.NumberOfVoxels());
  file.Decode(
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
  const VolumeFile file(path, "a volume", axes);
  IntensityVolume volume;
  static_cast<VolumeGrid&>(volume) = file.Grid();
  volume.Voxels.reserve(file.NumberOfVoxels());
  file.Decode([&](const double* values, std::size_t count)
    { volume.Voxels.insert(volume.Voxels.end(), values, values + count); });
  return volume;
}
}

LabelVolume ReadLabelVolume(const std::string& path, VolumeAxes axes)
{
  if (IsDicom(path))
  {
    return ReadDicomLabels(path);
  }
  LabelVolume volume;
  ReadGuarded(
    path, "a label volume", ReadLimits::Of({ path }),
    [&](ParcelWriter& parcel) { Exchange(parcel, DecodeLabels(path, axes)); },
    [&](ParcelReader& parcel) { Exchange(parcel, volume); });
  volume.Validate(path);
  return volume;
}

IntensityVolume ReadIntensityVolume(const std::string& path, VolumeAxes axes)
{
  if (IsDicom(path))
  {
    return ReadDicomIntensities(path);
  }
  IntensityVolume volume;
  ReadGuarded(
    path, "a volume", ReadLimits::Of({ path }),
    [&](ParcelWriter& parcel) { Exchange(parcel, DecodeIntensities(path, axes)); },
    [&](ParcelReader& parcel) { Exchange(parcel, volume); });
  volume.Validate(path);
  return volume;
}

IntensityVolume ReadIntensitySlices(const std::vector<DicomSlice>& slices,
  const ProgressCallback& progress)
{
  return ReadDicomIntensities(slices, progress);
}

IntensityVolume ReadIntensitySeries(const std::vector<std::string>& files,
  const ProgressCallback& progress)
{
  std::vector<DicomSlice> slices;
  slices.reserve(files.size());
  for (const std::string& file : files)
  {
    slices.push_back({ file });
  }
  return ReadDicomIntensities(slices, progress);
}

void CheckLabelVolumeExtension(const std::string& path)
{
  const std::string extension = VolumeExtension(path);
  if (extension != ".nrrd" && extension != ".mha" && extension != ".nii.gz")
  {
    throw InputError(path +
      ": expected the extension .nrrd, .mha or .nii.gz for a volume, found '" + extension + "'");
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

void CheckDisplacementExtension(const std::string& path)
{
  const std::string extension = VolumeExtension(path);
  if (!IsTransformExtension(extension) && extension != ".nrrd" && extension != ".mha" &&
    extension != ".nii.gz")
  {
    throw InputError(path +
      ": expected the extension .nrrd, .mha, .nii.gz, .h5 or .tfm for a displacement, found '" +
      extension + "'");
  }
}

void WriteDisplacement(const DisplacementField& field, const std::string& path)
{
  CheckDisplacementExtension(path);
  field.ValidateGrid(path, field.Vectors.size() / 3);
  const auto bad = std::find_if_not(field.Vectors.begin(), field.Vectors.end(),
    [](float value) { return std::isfinite(value); });
  if (field.Vectors.size() % 3 != 0 || bad != field.Vectors.end())
  {
    throw InputError(path + ": expected three finite numbers for each voxel, found " +
      (bad != field.Vectors.end() ? "others" : std::to_string(field.Vectors.size()) + " numbers"));
  }
  if (IsTransformExtension(VolumeExtension(path)))
  {
    WriteDisplacementTransform(field, path);
    return;
  }
  WriteVolumeFile(path, field, field.Vectors.data(), 3);
}
}
