// SPDX-License-Identifier: Apache-2.0
#include "Private/VolumeFile.h"

#include "Private/InputFile.h"
#include "Private/QuietStandardError.h"
#include "Private/StoredVoxels.h"
#include "Private/VolumePlacement.h"
#include "mammoray/IO/AtomicFile.h"
#include "mammoray/IO/GuardedRead.h"

#include <itkMetaImageIO.h>
#include <itkNiftiImageIO.h>
#include <itkNrrdImageIO.h>

#include <algorithm>
#include <charconv>
#include <cstdint>
#include <iterator>

namespace mammoray
{
namespace
{
/// ITK's reason in one line: without the class and address before it and the calls around it.
std::string ReasonOf(const itk::ExceptionObject& error)
{
  std::string text = error.GetDescription();
  text.erase(text.find_last_not_of("\n ") + 1);
  // NRRD's library tells the cause last, after the functions that it went through.
  if (const auto last = text.rfind("\n[nrrd] "); last != std::string::npos)
  {
    text.erase(0, last + 8);
  }
  else if (const auto object = text.find("): "); object != std::string::npos)
  {
    text.erase(0, object + 3);
  }
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

/// Calls `action`, which calls ITK, with ITK's console silenced. ITK's exception becomes an
/// InputError: `refusal`, then the reason.
template <typename Action>
void CallItk(const std::string& refusal, const Action& action)
{
  const QuietStandardError quiet;
  const bool warned = itk::Object::GetGlobalWarningDisplay();
  itk::Object::GlobalWarningDisplayOff();
  std::string reason;
  bool done = true;
  try
  {
    action();
  }
  catch (const itk::ExceptionObject& error)
  {
    reason = ReasonOf(error);
    done = false;
  }
  itk::Object::SetGlobalWarningDisplay(warned);
  if (!done)
  {
    throw InputError(refusal + " (" + reason + ")");
  }
}

/// Size, origin and axes as ITK has them.
VolumeGrid GridOf(const itk::ImageIOBase& itk, const std::string& path)
{
  if (itk.GetNumberOfDimensions() != 3)
  {
    throw InputError(path + ": expected a volume of three dimensions, found " +
      std::to_string(itk.GetNumberOfDimensions()) + " dimensions");
  }
  if (itk.GetComponentType() == itk::ImageIOBase::IOComponentEnum::UNKNOWNCOMPONENTTYPE)
  {
    throw InputError(path + ": expected voxels of an integer type, float or double, found others");
  }
  VolumeGrid grid;
  for (unsigned a = 0; a < 3; ++a)
  {
    const itk::SizeValueType size = itk.GetDimensions(a);
    if (size < 1 || size > 0x7fffffff)
    {
      throw InputError(path + ": expected at least one voxel along axis " + std::to_string(a) +
        ", found " + std::to_string(size));
    }
    grid.Size[a] = static_cast<int>(size);
    grid.Origin[a] = itk.GetOrigin(a);
    grid.Spacing[a] = itk.GetSpacing(a);
    const std::vector<double> axis = itk.GetDirection(a);
    std::copy_n(axis.begin(), 3, grid.Direction[a].begin());
  }
  return grid;
}

/// Multiplies the patient's axes by 1 or -1 each.
void Flip(VolumeGrid& grid, const Vector3& signs)
{
  for (int c = 0; c < 3; ++c)
  {
    // No negative zeros.
    grid.Origin[c] = signs[c] * grid.Origin[c] + 0.0;
    for (Vector3& axis : grid.Direction)
    {
      axis[c] = signs[c] * axis[c] + 0.0;
    }
  }
}

/// ITK turns RAS and LAS into LPS, of LAS the wrong axis (5.2), and keeps no word of what they
/// were.
void TurnNrrd(VolumeGrid& grid, const TextHeader& header, VolumeAxes axes)
{
  const std::string space = header.Value("space");
  Vector3 byItk{ 1, 1, 1 };
  Vector3 toLps{ 1, 1, 1 };
  if (space == "right-anterior-superior" || space == "ras")
  {
    byItk = { -1, -1, 1 };
    toLps = { -1, -1, 1 };
  }
  else if (space == "left-anterior-superior" || space == "las")
  {
    byItk = { -1, 1, 1 };
    toLps = { 1, -1, 1 };
  }
  else if ((space.empty() || space == "scanner-xyz") && axes == VolumeAxes::Patient)
  {
    Note({ header.Path,
      "its field 'space' is " + (space.empty() ? "missing" : space) + ": " + AxesNotSaid });
  }
  Flip(grid, byItk);
  if (axes == VolumeAxes::Patient)
  {
    Flip(grid, toLps);
  }
}

void CheckNrrd(const TextHeader& header)
{
  header.CheckSizes("sizes");
  static const char* const spaces[] = { "", "right-anterior-superior", "ras",
    "left-anterior-superior", "las", "left-posterior-superior", "lps", "scanner-xyz",
    "3d-right-handed" };
  if (std::find(std::begin(spaces), std::end(spaces), header.Value("space")) == std::end(spaces))
  {
    header.Refuse("space",
      "left-posterior-superior, right-anterior-superior or another one in three dimensions");
  }
  if (const std::string units = header.Value("spaceunits");
      !units.empty() && units != "\"mm\" \"mm\" \"mm\"")
  {
    header.Refuse("spaceunits", "\"mm\" \"mm\" \"mm\"");
  }
  if (header.Fields.count("spacedirections") == 0 && header.Fields.count("spacings") == 0)
  {
    throw InputError(
      header.Path + ": expected the NRRD field 'space directions' or 'spacings', found neither");
  }
  header.CheckLengths({ "spacedirections", "spacings", "spaceorigin" });
}

/// Headers hold floats: their rounding (0.2 -> 0.200000003) is taken back where seven digits say it
/// all.
double AsWritten(double value)
{
  char text[32] = "";
  const char* const end =
    std::to_chars(std::begin(text), std::end(text), value, std::chars_format::general, 7).ptr;
  double shorter = 0;
  std::from_chars(text, end, shorter);
  return static_cast<float>(shorter) == static_cast<float>(value) ? shorter : value;
}

/// ITK turns NIfTI's RAS into LPS where the header tells a frame at all.
void TurnNifti(VolumeGrid& grid, const NiftiHeader& header, const std::string& path,
  VolumeAxes axes)
{
  TakeNiftiPlacement(path, header, grid);
  for (int a = 0; a < 3; ++a)
  {
    grid.Origin[a] = AsWritten(grid.Origin[a]);
    grid.Spacing[a] = AsWritten(grid.Spacing[a]);
    for (double& component : grid.Direction[a])
    {
      component = AsWritten(component);
    }
  }
  const bool turned = header.At<std::int16_t>(254) > 0 || header.At<std::int16_t>(252) > 0;
  Flip(grid, turned && axes == VolumeAxes::AsGiven ? Vector3{ -1, -1, 1 } : Vector3{ 1, 1, 1 });
}

/// ITK refuses sheared axes only after it has read all else.
void ReadNiftiInformation(itk::ImageIOBase& itk)
{
  try
  {
    itk.ReadImageInformation();
  }
  catch (const itk::ExceptionObject& error)
  {
    if (std::string(error.GetDescription()).find("orthonormal") == std::string::npos)
    {
      throw;
    }
  }
}

StoredVoxels NiftiVoxels(const NiftiHeader& header, const std::string& path)
{
  const double offset = header.Number(108);
  StoredVoxels voxels{ path, offset > 0 && offset < 1e9 ? static_cast<std::uint64_t>(offset) : 0 };
  voxels.Packed = header.IsPacked() ? StoredVoxels::Packing::File : StoredVoxels::Packing::None;
  return voxels;
}

template <typename T>
void Convert(const void* stored, std::size_t count, const TakeValues& take)
{
  const auto* voxels = static_cast<const T*>(stored);
  std::vector<double> values(1 << 18);
  for (std::size_t done = 0; done < count; done += values.size())
  {
    const std::size_t step = std::min(values.size(), count - done);
    std::copy_n(voxels + done, step, values.begin());
    take(values.data(), step);
  }
}

/// Reads all voxels and passes them on.
void DecodeAll(itk::ImageIOBase& itk, const std::string& path, const std::string& refusal,
  const TakeValues& take)
{
  itk::ImageIORegion region(itk.GetNumberOfDimensions());
  for (unsigned a = 0; a < itk.GetNumberOfDimensions(); ++a)
  {
    region.SetSize(a, itk.GetDimensions(a));
  }
  itk.SetIORegion(region);
  const auto count = static_cast<std::size_t>(itk.GetImageSizeInComponents());
  const auto bytes = static_cast<std::size_t>(itk.GetImageSizeInBytes());
  const auto buffer = std::make_unique_for_overwrite<unsigned char[]>(bytes);
  CallItk(refusal, [&] { itk.Read(buffer.get()); });
  using Type = itk::ImageIOBase::IOComponentEnum;
  switch (itk.GetComponentType())
  {
    case Type::UCHAR:
      return Convert<unsigned char>(buffer.get(), count, take);
    case Type::CHAR:
      return Convert<signed char>(buffer.get(), count, take);
    case Type::USHORT:
      return Convert<unsigned short>(buffer.get(), count, take);
    case Type::SHORT:
      return Convert<short>(buffer.get(), count, take);
    case Type::UINT:
      return Convert<unsigned int>(buffer.get(), count, take);
    case Type::INT:
      return Convert<int>(buffer.get(), count, take);
    case Type::ULONG:
      return Convert<unsigned long>(buffer.get(), count, take);
    case Type::LONG:
      return Convert<long>(buffer.get(), count, take);
    case Type::ULONGLONG:
      return Convert<unsigned long long>(buffer.get(), count, take);
    case Type::LONGLONG:
      return Convert<long long>(buffer.get(), count, take);
    case Type::FLOAT:
      return Convert<float>(buffer.get(), count, take);
    case Type::DOUBLE:
      return Convert<double>(buffer.get(), count, take);
    default:
      throw InputError(path + ": expected an integer type, float or double, found " +
        itk::ImageIOBase::GetComponentTypeAsString(itk.GetComponentType()));
  }
}

/// The reader of a format, which must recognise the file.
template <typename Format>
itk::ImageIOBase::Pointer Open(const std::string& path, const std::string& what,
  const std::string& refusal, const char* format)
{
  const auto reader = Format::New();
  bool readable = false;
  CallItk(refusal, [&] { readable = reader->CanReadFile(path.c_str()); });
  if (!readable)
  {
    throw InputError(path + ": expected " + what + ", found data that is no " + format);
  }
  reader->SetFileName(path);
  return reader.GetPointer();
}
}

void ReadVolumeFile(const std::string& path, const std::string& what, VolumeAxes axes,
  const std::function<void(const VolumeGrid& grid, std::size_t channels)>& begin,
  const TakeValues& take)
{
  CheckReadable(path, what);
  const std::string refusal = path + ": expected " + what + ", found data that cannot be read";
  const std::string extension = ExtensionOf(path);
  itk::ImageIOBase::Pointer itk;
  VolumeGrid grid;
  StoredVoxels stored;
  std::uint64_t storedBytes = 0;
  const auto readHeader = [&]
  {
    CallItk(refusal, [&] { itk->ReadImageInformation(); });
    grid = GridOf(*itk, path);
    storedBytes = itk->GetComponentSize();
  };
  if (extension == ".nrrd" || extension == ".nhdr")
  {
    itk = Open<itk::NrrdImageIO>(path, what, refusal, "NRRD");
    const TextHeader header = TextHeader::ReadNrrd(path);
    CheckNrrd(header);
    stored = StoredVoxels::OfNrrd(header);
    stored.CheckPresent(path, 0, 0);
    readHeader();
    TurnNrrd(grid, header, axes);
  }
  else if (extension == ".mha" || extension == ".mhd")
  {
    itk = Open<itk::MetaImageIO>(path, what, refusal, "MetaImage");
    const TextHeader header = TextHeader::ReadMetaImage(path);
    header.CheckSizes("dimsize");
    header.CheckLengths({ "elementspacing", "elementsize", "offset", "position", "origin",
      "transformmatrix", "rotation", "orientation" });
    stored = StoredVoxels::OfMetaImage(header);
    readHeader();
  }
  else if (extension == ".nii" || extension == ".nii.gz")
  {
    const NiftiHeader header(path);
    itk = Open<itk::NiftiImageIO>(path, what, refusal, "NIfTI");
    CallItk(refusal, [&] { ReadNiftiInformation(*itk); });
    grid = GridOf(*itk, path);
    stored = NiftiVoxels(header, path);
    const int bits = header.At<std::int16_t>(72);
    // Of colours and complex numbers these are the bits of all components.
    const auto type = header.At<std::int16_t>(70);
    const bool isOne = type != 128 && type != 2304 && type != 32 && type != 1792;
    storedBytes =
      bits >= 8 && isOne ? static_cast<std::uint64_t>(bits) / 8 : itk->GetComponentSize();
    TurnNifti(grid, header, path, axes);
  }
  else
  {
    throw InputError(path + ": expected " + what +
      " (.nrrd, .nhdr, .mha, .mhd, .nii, .nii.gz), found the extension '" + extension + "'");
  }
  const std::size_t channels = itk->GetNumberOfComponents();
  const std::uint64_t count = itk->GetImageSizeInPixels() * channels;
  stored.CheckPresent(path, count, storedBytes);
  // ITK's formats keep up to three copies, the asking reader one of four bytes.
  AllowMemory(ReadLimits::Of({ path }).MemoryBytes +
    count * (4 * std::max<std::uint64_t>(storedBytes, 8) + 8));
  begin(grid, channels);
  DecodeAll(*itk, path, refusal, take);
}

template <typename T>
void WriteVolumeFile(const std::string& path, const VolumeGrid& grid, const T* voxels,
  unsigned channels, bool compressed, const std::map<std::string, std::string>& pairs)
{
  const std::string extension = ExtensionOf(path);
  itk::ImageIOBase::Pointer writer = itk::NrrdImageIO::New().GetPointer();
  if (extension == ".mha")
  {
    writer = itk::MetaImageIO::New().GetPointer();
  }
  else if (extension == ".nii.gz")
  {
    writer = itk::NiftiImageIO::New().GetPointer();
  }
  writer->SetUseCompression(compressed);
  writer->SetPixelType(
    channels == 1 ? itk::CommonEnums::IOPixel::SCALAR : itk::CommonEnums::IOPixel::VECTOR);
  writer->SetNumberOfComponents(channels);
  writer->SetComponentType(itk::ImageIOBase::MapPixelType<T>::CType);
  writer->SetNumberOfDimensions(3);
  itk::ImageIORegion region(3);
  for (unsigned a = 0; a < 3; ++a)
  {
    if (extension == ".nii.gz" && grid.Size[a] > 32767)
    {
      throw InputError(path + ": NIfTI holds at most 32767 voxels along an axis, found " +
        std::to_string(grid.Size[a]) + "; .nrrd and .mha hold more");
    }
    const auto size = static_cast<itk::SizeValueType>(grid.Size[a]);
    region.SetSize(a, size);
    writer->SetDimensions(a, size);
    writer->SetSpacing(a, grid.Spacing[a]);
    writer->SetOrigin(a, grid.Origin[a]);
    writer->SetDirection(a,
      std::vector<double>(grid.Direction[a].begin(), grid.Direction[a].end()));
  }
  writer->SetIORegion(region);
  for (const auto& [key, value] : pairs)
  {
    itk::EncapsulateMetaData<std::string>(writer->GetMetaDataDictionary(), key, value);
  }
  WriteAtomicFile(path,
    [&](const std::string& staged)
    {
      writer->SetFileName(staged);
      CallItk(path + ": cannot be written", [&] { writer->Write(voxels); });
    });
}

template void WriteVolumeFile(const std::string&, const VolumeGrid&, const std::uint8_t*, unsigned,
  bool, const std::map<std::string, std::string>&);
template void WriteVolumeFile(const std::string&, const VolumeGrid&, const std::uint16_t*, unsigned,
  bool, const std::map<std::string, std::string>&);
template void WriteVolumeFile(const std::string&, const VolumeGrid&, const float*, unsigned, bool,
  const std::map<std::string, std::string>&);
}
