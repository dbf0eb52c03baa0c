// SPDX-License-Identifier: Apache-2.0
#include "Private/VolumeFile.h"

#include "Private/QuietStandardError.h"
#include "Private/StoredVoxels.h"
#include "mammoray/IO/AtomicFile.h"
#include "mammoray/IO/GuardedRead.h"

#include <itkMetaDataObject.h>
#include <itkMetaImageIO.h>
#include <itkNiftiImageIO.h>
#include <itkNrrdImageIO.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>

namespace mammoray
{
namespace
{
namespace fs = std::filesystem;

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

/// Does what asks ITK, with its console silenced; false with ITK's reason where it refuses.
template <typename Action>
bool CallItk(const Action& action, std::string& reason)
{
  const QuietStandardError quiet;
  const bool warned = itk::Object::GetGlobalWarningDisplay();
  itk::Object::GlobalWarningDisplayOff();
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
  return done;
}

/// The same of reading, with ITK's exception turned into ours.
template <typename Action>
void AskItk(const std::string& path, const std::string& what, const Action& action)
{
  std::string reason;
  if (!CallItk(action, reason))
  {
    throw InputError(
      path + ": expected " + what + ", found data that cannot be read (" + reason + ")");
  }
}

/// A NIfTI header's number, by the name that nifti1.h has for it.
double NiftiNumber(const itk::ImageIOBase& itk, const std::string& name)
{
  std::string text;
  itk::ExposeMetaData<std::string>(itk.GetMetaDataDictionary(), name, text);
  return std::strtod(text.c_str(), nullptr);
}

/// Size, origin and axes as ITK has them.
VolumeGrid GridOf(const itk::ImageIOBase& itk, const std::string& path)
{
  if (itk.GetNumberOfDimensions() != 3 || itk.GetNumberOfComponents() != 1)
  {
    throw InputError(path + ": expected a volume of three dimensions, one value per voxel, found " +
      std::to_string(itk.GetNumberOfDimensions()) + " dimensions, " +
      std::to_string(itk.GetNumberOfComponents()) + " value(s)");
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
    "3d-right-handed", "3d-left-handed" };
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
void TurnNifti(VolumeGrid& grid, const itk::ImageIOBase& itk, VolumeAxes axes)
{
  for (int a = 0; a < 3; ++a)
  {
    grid.Origin[a] = AsWritten(grid.Origin[a]);
    grid.Spacing[a] = AsWritten(grid.Spacing[a]);
    for (double& component : grid.Direction[a])
    {
      component = AsWritten(component);
    }
  }
  const bool turned = NiftiNumber(itk, "sform_code") > 0 || NiftiNumber(itk, "qform_code") > 0;
  Flip(grid, turned && axes == VolumeAxes::AsGiven ? Vector3{ -1, -1, 1 } : Vector3{ 1, 1, 1 });
}

StoredVoxels NiftiVoxels(const itk::ImageIOBase& itk, const std::string& path, bool compressed)
{
  const int unit = static_cast<int>(NiftiNumber(itk, "xyzt_units")) & 7;
  if (unit != 0 && unit != 2)
  {
    // ITK turns spacings of other units into mm, but not the origin.
    throw InputError(
      path + ": xyzt_units: expected mm (2) or none (0), found " + std::to_string(unit));
  }
  if (NiftiNumber(itk, "nifti_type") != 1)
  {
    throw InputError(path + ": expected NIfTI-1 in one file (magic n+1), found another form");
  }
  StoredVoxels voxels{ path, static_cast<std::uint64_t>(NiftiNumber(itk, "vox_offset")) };
  voxels.Packed = compressed ? StoredVoxels::Packing::File : StoredVoxels::Packing::None;
  return voxels;
}

template <typename T>
void Convert(const void* stored, std::size_t count,
  const std::function<void(const double* values, std::size_t count)>& sink)
{
  const auto* voxels = static_cast<const T*>(stored);
  std::vector<double> values(1 << 18);
  for (std::size_t done = 0; done < count; done += values.size())
  {
    const std::size_t step = std::min(values.size(), count - done);
    std::copy_n(voxels + done, step, values.begin());
    sink(values.data(), step);
  }
}

/// Reads all voxels and hands them over.
void DecodeAll(itk::ImageIOBase& itk, const std::string& path, const std::string& what,
  const std::function<void(const double* values, std::size_t count)>& sink)
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
  AskItk(path, what, [&] { itk.Read(buffer.get()); });
  using Type = itk::ImageIOBase::IOComponentEnum;
  switch (itk.GetComponentType())
  {
    case Type::UCHAR:
      return Convert<unsigned char>(buffer.get(), count, sink);
    case Type::CHAR:
      return Convert<signed char>(buffer.get(), count, sink);
    case Type::USHORT:
      return Convert<unsigned short>(buffer.get(), count, sink);
    case Type::SHORT:
      return Convert<short>(buffer.get(), count, sink);
    case Type::UINT:
      return Convert<unsigned int>(buffer.get(), count, sink);
    case Type::INT:
      return Convert<int>(buffer.get(), count, sink);
    case Type::ULONG:
      return Convert<unsigned long>(buffer.get(), count, sink);
    case Type::LONG:
      return Convert<long>(buffer.get(), count, sink);
    case Type::ULONGLONG:
      return Convert<unsigned long long>(buffer.get(), count, sink);
    case Type::LONGLONG:
      return Convert<long long>(buffer.get(), count, sink);
    case Type::FLOAT:
      return Convert<float>(buffer.get(), count, sink);
    case Type::DOUBLE:
      return Convert<double>(buffer.get(), count, sink);
    default:
      throw InputError(path + ": expected an integer type, float or double, found " +
        itk::ImageIOBase::GetComponentTypeAsString(itk.GetComponentType()));
  }
}

void Write(const std::string& path, const VolumeGrid& grid, itk::ImageIOBase::IOComponentEnum type,
  const void* voxels, unsigned channels = 1, bool compressed = true)
{
  const std::string extension = VolumeExtension(path);
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
  writer->SetComponentType(type);
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
  WriteAtomicFile(path,
    [&](const std::string& staged)
    {
      writer->SetFileName(staged);
      std::string reason;
      if (!CallItk([&] { writer->Write(voxels); }, reason))
      {
        throw InputError(path + ": cannot be written (" + reason + ")");
      }
    });
}

void CheckFile(const std::string& path, const std::string& what)
{
  std::error_code problem;
  if (!fs::exists(path, problem))
  {
    throw InputError(path + ": no such file");
  }
  if (!fs::is_regular_file(path) || !std::ifstream(path))
  {
    throw InputError(path + ": expected " + what + ", found something that cannot be read");
  }
  if (fs::file_size(path) == 0)
  {
    throw InputError(path + ": expected " + what + ", found an empty file");
  }
}
}

std::string VolumeExtension(const std::string& path)
{
  std::string name = fs::path(path).filename().string();
  std::transform(name.begin(), name.end(), name.begin(),
    [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return name.ends_with(".nii.gz") ? ".nii.gz" : fs::path(name).extension().string();
}

struct VolumeFile::Reader
{
  std::string Path;
  std::string What;
  itk::ImageIOBase::Pointer Itk;

  /// Lets the format's reader see the header.
  template <typename Format>
  void Open(const char* format)
  {
    const auto reader = Format::New();
    this->Itk = reader;
    bool readable = false;
    AskItk(this->Path, this->What, [&] { readable = reader->CanReadFile(this->Path.c_str()); });
    if (!readable)
    {
      throw InputError(
        this->Path + ": expected " + this->What + ", found data that is no " + format);
    }
  }
  void ReadHeader()
  {
    this->Itk->SetFileName(this->Path);
    AskItk(this->Path, this->What, [this] { this->Itk->ReadImageInformation(); });
  }
};

VolumeFile::VolumeFile(const std::string& path, const std::string& what, VolumeAxes axes)
  : Itk(new Reader{ path, what, {} })
{
  CheckFile(path, what);
  const std::string extension = VolumeExtension(path);
  StoredVoxels stored;
  std::uint64_t storedBytes = 0;
  if (extension == ".nrrd" || extension == ".nhdr")
  {
    this->Itk->Open<itk::NrrdImageIO>("NRRD");
    const TextHeader header = TextHeader::ReadNrrd(path);
    CheckNrrd(header);
    stored = StoredVoxels::OfNrrd(header);
    stored.CheckPresent(path, 0, 0);
    this->Itk->ReadHeader();
    this->HeaderGrid = GridOf(*this->Itk->Itk, path);
    TurnNrrd(this->HeaderGrid, header, axes);
  }
  else if (extension == ".mha" || extension == ".mhd")
  {
    this->Itk->Open<itk::MetaImageIO>("MetaImage");
    const TextHeader header = TextHeader::ReadMetaImage(path);
    header.CheckSizes("dimsize");
    header.CheckLengths({ "elementspacing", "elementsize", "offset", "position", "origin",
      "transformmatrix", "rotation", "orientation" });
    stored = StoredVoxels::OfMetaImage(header);
    this->Itk->ReadHeader();
    this->HeaderGrid = GridOf(*this->Itk->Itk, path);
  }
  else if (extension == ".nii" || extension == ".nii.gz")
  {
    this->Itk->Open<itk::NiftiImageIO>("NIfTI");
    this->Itk->ReadHeader();
    this->HeaderGrid = GridOf(*this->Itk->Itk, path);
    stored = NiftiVoxels(*this->Itk->Itk, path, extension == ".nii.gz");
    storedBytes = static_cast<std::uint64_t>(NiftiNumber(*this->Itk->Itk, "bitpix")) / 8;
    TurnNifti(this->HeaderGrid, *this->Itk->Itk, axes);
  }
  else
  {
    throw InputError(path + ": expected " + what +
      " (.nrrd, .nhdr, .mha, .mhd, .nii, .nii.gz), found the extension '" + extension + "'");
  }
  storedBytes = storedBytes > 0 ? storedBytes : this->Itk->Itk->GetComponentSize();
  stored.CheckPresent(path, this->NumberOfVoxels(), storedBytes);
  // ITK's formats keep up to three copies, the asking reader one of four bytes.
  AllowMemory(ReadLimits::Of({ path }).MemoryBytes +
    this->NumberOfVoxels() * (4 * std::max<std::uint64_t>(storedBytes, 8) + 8));
}

std::size_t VolumeFile::NumberOfVoxels() const
{
  std::size_t count = 1;
  for (const int size : this->HeaderGrid.Size)
  {
    count *= static_cast<std::size_t>(size);
  }
  return count;
}

VolumeFile::~VolumeFile() = default;

void VolumeFile::Decode(
  const std::function<void(const double* values, std::size_t count)>& sink) const
{
  DecodeAll(*this->Itk->Itk, this->Itk->Path, this->Itk->What, sink);
}

void WriteVolumeFile(const std::string& path, const VolumeGrid& grid, const std::uint8_t* voxels)
{
  Write(path, grid, itk::ImageIOBase::IOComponentEnum::UCHAR, voxels);
}

void WriteVolumeFile(const std::string& path, const VolumeGrid& grid, const std::uint16_t* voxels)
{
  Write(path, grid, itk::ImageIOBase::IOComponentEnum::USHORT, voxels);
}

void WriteVolumeFile(const std::string& path, const VolumeGrid& grid, const float* voxels,
  unsigned channels, bool compressed)
{
  Write(path, grid, itk::ImageIOBase::IOComponentEnum::FLOAT, voxels, channels, compressed);
}
}
