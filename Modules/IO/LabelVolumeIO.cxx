// SPDX-License-Identifier: Apache-2.0
#include "mammoray/IO/LabelVolumeIO.h"

#include "Private/DicomVolume.h"
#include "Private/VolumeFile.h"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <filesystem>
#include <fstream>
#include <limits>
#include <sstream>
#include <type_traits>
#include <utility>

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

/// windowBits as zlib's deflateInit2 has them: 15 makes zlib's format, 15 + 16 gzip's.
std::string Deflate(std::string bytes, int windowBits, const std::string& path)
{
  z_stream stream{};
  if (deflateInit2(&stream, 6, Z_DEFLATED, windowBits, 8, Z_DEFAULT_STRATEGY) != Z_OK)
  {
    throw InputError(path + ": compression cannot start");
  }
  std::string packed;
  std::vector<unsigned char> buffer(1 << 18);
  std::size_t consumed = 0;
  int state = Z_OK;
  while (state != Z_STREAM_END)
  {
    if (stream.avail_in == 0)
    {
      const std::size_t step = std::min<std::size_t>(bytes.size() - consumed, 1u << 30);
      stream.next_in = reinterpret_cast<unsigned char*>(bytes.data()) + consumed;
      stream.avail_in = static_cast<uInt>(step);
      consumed += step;
    }
    stream.next_out = buffer.data();
    stream.avail_out = static_cast<uInt>(buffer.size());
    state = deflate(&stream, consumed == bytes.size() ? Z_FINISH : Z_NO_FLUSH);
    packed.append(reinterpret_cast<char*>(buffer.data()), buffer.size() - stream.avail_out);
  }
  deflateEnd(&stream);
  return packed;
}

/// A type of voxels in the words of the formats.
struct VoxelType
{
  const char* Nrrd;
  const char* MetaImage;
  std::int16_t Nifti;
  std::int16_t Bits;
};
constexpr VoxelType SmallLabels{ "uint8", "MET_UCHAR", 2, 8 };
constexpr VoxelType LargeLabels{ "uint16", "MET_USHORT", 512, 16 };
constexpr VoxelType Floats{ "float", "MET_FLOAT", 16, 32 };

/// The lowest bytes of each voxel, the lowest first.
template <typename Voxel>
std::string VoxelBytes(const std::vector<Voxel>& voxels, const VoxelType& type)
{
  using Bits = std::conditional_t<sizeof(Voxel) == 4, std::uint32_t, std::uint16_t>;
  std::string bytes;
  bytes.reserve(voxels.size() * type.Bits / 8);
  for (const Voxel voxel : voxels)
  {
    const Bits bits = std::bit_cast<Bits>(voxel);
    for (int shift = 0; shift < type.Bits; shift += 8)
    {
      bytes.push_back(static_cast<char>((bits >> shift) & 255));
    }
  }
  return bytes;
}

/// A vector with its parentheses and separators.
std::string VectorText(const Vector3& v, const char* open, const char* between, const char* close)
{
  std::ostringstream text;
  text.precision(17);
  text << open << v[0] << between << v[1] << between << v[2] << close;
  return text.str();
}

std::string NrrdHeader(const VolumeGrid& volume, const VoxelType& type)
{
  std::ostringstream text;
  text << "NRRD0004\ntype: " << type.Nrrd
       << "\ndimension: 3\nspace: left-posterior-superior\nsizes: " << volume.Size[0] << ' '
       << volume.Size[1] << ' ' << volume.Size[2] << "\nspace directions:";
  for (int a = 0; a < 3; ++a)
  {
    text << VectorText(volume.Spacing[a] * volume.Direction[a], " (", ",", ")");
  }
  text << "\nkinds: domain domain domain\nendian: little\nencoding: gzip\nspace origin: "
       << VectorText(volume.Origin, "(", ",", ")") << "\n\n";
  return text.str();
}

std::string MetaImageHeader(const VolumeGrid& volume, const VoxelType& type, std::size_t dataBytes)
{
  std::ostringstream text;
  text << "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\n"
       << "CompressedData = True\nCompressedDataSize = " << dataBytes << "\nTransformMatrix =";
  for (int a = 0; a < 3; ++a)
  {
    text << VectorText(volume.Direction[a], " ", " ", "");
  }
  text << VectorText(volume.Origin, "\nOffset = ", " ", "")
       << VectorText(volume.Spacing, "\nCenterOfRotation = 0 0 0\nElementSpacing = ", " ", "")
       << "\nDimSize = " << volume.Size[0] << ' ' << volume.Size[1] << ' ' << volume.Size[2]
       << "\nElementType = " << type.MetaImage << "\nElementDataFile = LOCAL\n";
  return text.str();
}

/// NIfTI-1 in one file, the frame by its sform; RAS, as NIfTI's always is.
std::string NiftiHeader(const VolumeGrid& volume, const VoxelType& type, const std::string& path)
{
  constexpr int headerBytes = 348;
  constexpr int dataOffset = 352; // after four bytes that announce no extension
  std::string header(dataOffset, '\0');
  const auto put = [&](std::size_t offset, auto value)
  {
    auto bytes = std::bit_cast<std::array<char, sizeof(value)>>(value);
    if (std::endian::native == std::endian::big)
    {
      std::reverse(bytes.begin(), bytes.end());
    }
    std::copy(bytes.begin(), bytes.end(), header.begin() + static_cast<std::ptrdiff_t>(offset));
  };
  put(0, std::int32_t{ headerBytes });
  put(40, std::int16_t{ 3 });
  put(70, type.Nifti);
  put(72, type.Bits);
  put(76, 1.0f);
  put(108, static_cast<float>(dataOffset));
  put(112, 1.0f);
  header[123] = 2;             // mm
  put(254, std::int16_t{ 1 }); // sform: the scanner's frame
  for (std::size_t a = 0; a < 3; ++a)
  {
    if (volume.Size[a] > std::numeric_limits<std::int16_t>::max())
    {
      throw InputError(path + ": NIfTI holds at most 32767 voxels along an axis, found " +
        std::to_string(volume.Size[a]) + "; .nrrd and .mha hold more");
    }
    put(42 + 2 * a, static_cast<std::int16_t>(volume.Size[a]));
    put(80 + 4 * a, static_cast<float>(volume.Spacing[a]));
  }
  for (std::size_t a = 3; a < 7; ++a)
  {
    put(42 + 2 * a, std::int16_t{ 1 });
  }
  for (std::size_t c = 0; c < 3; ++c)
  {
    const double sign = c < 2 ? -1 : 1;
    for (std::size_t a = 0; a < 3; ++a)
    {
      put(280 + 16 * c + 4 * a,
        static_cast<float>(sign * volume.Spacing[a] * volume.Direction[a][c]));
    }
    put(292 + 16 * c, static_cast<float>(sign * volume.Origin[c]));
  }
  header.replace(344, 3, "n+1");
  return header;
}

/// Writes by extension; `voxels`: their bytes.
void WriteVolume(const VolumeGrid& grid, const VoxelType& type, std::string voxels,
  const std::string& path)
{
  CheckLabelVolumeExtension(path);
  constexpr int zlibFormat = 15;
  constexpr int gzipFormat = 15 + 16;
  const std::string extension = VolumeExtension(path);
  std::string bytes;
  if (extension == ".nrrd")
  {
    bytes = NrrdHeader(grid, type) + Deflate(std::move(voxels), gzipFormat, path);
  }
  else if (extension == ".mha")
  {
    const std::string packed = Deflate(std::move(voxels), zlibFormat, path);
    bytes = MetaImageHeader(grid, type, packed.size()) + packed;
  }
  else
  {
    bytes = Deflate(NiftiHeader(grid, type, path) + voxels, gzipFormat, path);
  }
  std::ofstream file(path, std::ios::binary);
  file << bytes;
  file.close();
  if (!file)
  {
    throw InputError(path + ": cannot be written");
  }
}
}

LabelVolume ReadLabelVolume(const std::string& path, VolumeAxes axes)
{
  if (IsDicom(path))
  {
    return ReadDicomLabels(path);
  }
  const VolumeFile file(path, "a label volume", axes);
  LabelVolume volume;
  static_cast<VolumeGrid&>(volume) = file.Grid();
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
  volume.Validate(path);
  return volume;
}

IntensityVolume ReadIntensityVolume(const std::string& path, VolumeAxes axes)
{
  if (IsDicom(path))
  {
    return ReadDicomIntensities(path);
  }
  const VolumeFile file(path, "a volume", axes);
  IntensityVolume volume;
  static_cast<VolumeGrid&>(volume) = file.Grid();
  file.Decode([&](const double* values, std::size_t count)
    { volume.Voxels.insert(volume.Voxels.end(), values, values + count); });
  volume.Validate(path);
  return volume;
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
  const bool small = std::all_of(volume.Voxels.begin(), volume.Voxels.end(),
    [](std::uint16_t v) { return v < 256; });
  const VoxelType& type = small ? SmallLabels : LargeLabels;
  WriteVolume(volume, type, VoxelBytes(volume.Voxels, type), path);
}

void WriteIntensityVolume(const IntensityVolume& volume, const std::string& path)
{
  volume.Validate(path);
  WriteVolume(volume, Floats, VoxelBytes(volume.Voxels, Floats), path);
}
}
