// SPDX-License-Identifier: Apache-2.0
// VTK's readers drop or alter the directions of these formats and trust sizes in the header, so the
// three headers are read here, and one decoder serves them all.
#include "Private/VolumeFile.h"

#include <zlib.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <map>
#include <sstream>

namespace mammoray
{
namespace
{
namespace fs = std::filesystem;

std::size_t BytesOf(ScalarType type)
{
  switch (type)
  {
    case ScalarType::Int8:
    case ScalarType::UInt8:
      return 1;
    case ScalarType::Int16:
    case ScalarType::UInt16:
      return 2;
    case ScalarType::Int32:
    case ScalarType::UInt32:
    case ScalarType::Float:
      return 4;
    default:
      return 8;
  }
}

std::string Number(double value)
{
  std::ostringstream text;
  text.precision(17);
  text << value;
  return text.str();
}

std::string Lower(std::string text)
{
  std::transform(text.begin(), text.end(), text.begin(),
    [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return text;
}

std::string Trim(const std::string& text)
{
  const char* const blanks = " \t\r\n";
  const auto first = text.find_first_not_of(blanks);
  return first == std::string::npos ? std::string()
                                    : text.substr(first, text.find_last_not_of(blanks) - first + 1);
}

/// All numbers of a text, parentheses and commas read as blanks; false when something else is in
/// it.
bool ReadNumbers(std::string text, std::size_t count, double* numbers)
{
  for (char& c : text)
  {
    c = c == '(' || c == ')' || c == ',' ? ' ' : c;
  }
  std::istringstream stream(text);
  std::string word;
  std::size_t found = 0;
  while (stream >> word)
  {
    char* end = nullptr;
    const double value = std::strtod(word.c_str(), &end);
    if (*end != 0 || !std::isfinite(value) || found == count)
    {
      return false;
    }
    numbers[found++] = value;
  }
  return found == count;
}

void ReadSize(const std::string& path, const std::string& key, const std::string& text,
  std::array<std::int64_t, 3>& size)
{
  double numbers[3];
  bool good = ReadNumbers(text, 3, numbers);
  for (int a = 0; good && a < 3; ++a)
  {
    good = numbers[a] >= 1 && numbers[a] <= std::numeric_limits<int>::max() &&
      numbers[a] == std::floor(numbers[a]);
    size[a] = good ? static_cast<std::int64_t>(numbers[a]) : 0;
  }
  if (!good)
  {
    throw InputError(
      path + ": " + key + ": expected three whole numbers of at least 1, found '" + text + "'");
  }
}

/// A file, or what it decompresses to, read from start to end.
class ByteSource
{
public:
  ByteSource(const std::string& path, std::uint64_t offset, bool compressed)
    : Path(path)
    , File(path, std::ios::binary)
    , Compressed(compressed)
  {
    if (!fs::is_regular_file(path) || !this->File)
    {
      throw InputError(path + ": cannot be opened for reading");
    }
    this->File.seekg(static_cast<std::streamoff>(offset));
    // 32: gzip or zlib, told by the first bytes.
    if (compressed && inflateInit2(&this->Stream, 15 + 32) != Z_OK)
    {
      throw InputError(path + ": decompression cannot start");
    }
  }
  ~ByteSource()
  {
    if (this->Compressed)
    {
      inflateEnd(&this->Stream);
    }
  }
  ByteSource(const ByteSource&) = delete;
  ByteSource& operator=(const ByteSource&) = delete;

  /// Number of bytes read; fewer than asked for at the end only.
  std::size_t Read(unsigned char* bytes, std::size_t count)
  {
    if (!this->Compressed)
    {
      this->File.read(reinterpret_cast<char*>(bytes), static_cast<std::streamsize>(count));
      return static_cast<std::size_t>(this->File.gcount());
    }
    this->Stream.next_out = bytes;
    this->Stream.avail_out = static_cast<uInt>(count);
    while (this->Stream.avail_out > 0 && !this->Ended)
    {
      if (this->Stream.avail_in == 0)
      {
        this->File.read(reinterpret_cast<char*>(this->Input.data()),
          static_cast<std::streamsize>(this->Input.size()));
        this->Stream.next_in = this->Input.data();
        this->Stream.avail_in = static_cast<uInt>(this->File.gcount());
        if (this->Stream.avail_in == 0)
        {
          break;
        }
      }
      const int state = inflate(&this->Stream, Z_NO_FLUSH);
      this->Ended = state == Z_STREAM_END;
      if (state != Z_OK && state != Z_STREAM_END && state != Z_BUF_ERROR)
      {
        throw InputError(this->Path + ": expected compressed voxels, found damaged data (" +
          (this->Stream.msg ? this->Stream.msg : "not gzip or zlib") + ")");
      }
    }
    return count - this->Stream.avail_out;
  }

  /// False while compressed data has not come to its end.
  bool Complete() const { return !this->Compressed || this->Ended; }

  void Skip(std::uint64_t count)
  {
    unsigned char sink[4096];
    while (count > 0)
    {
      const std::size_t step = std::min<std::uint64_t>(count, sizeof(sink));
      if (this->Read(sink, step) != step)
      {
        return;
      }
      count -= step;
    }
  }

private:
  std::string Path;
  std::ifstream File;
  bool Compressed;
  bool Ended = false;
  z_stream Stream{};
  std::vector<unsigned char> Input = std::vector<unsigned char>(1 << 16);
};

template <typename T>
T Load(const unsigned char* bytes, bool swapBytes)
{
  unsigned char ordered[sizeof(T)];
  std::memcpy(ordered, bytes, sizeof(T));
  if (swapBytes)
  {
    std::reverse(ordered, ordered + sizeof(T));
  }
  T value;
  std::memcpy(&value, ordered, sizeof(T));
  return value;
}

double LoadScalar(ScalarType type, const unsigned char* bytes, bool swapBytes)
{
  switch (type)
  {
    case ScalarType::Int8:
      return Load<std::int8_t>(bytes, false);
    case ScalarType::UInt8:
      return *bytes;
    case ScalarType::Int16:
      return Load<std::int16_t>(bytes, swapBytes);
    case ScalarType::UInt16:
      return Load<std::uint16_t>(bytes, swapBytes);
    case ScalarType::Int32:
      return Load<std::int32_t>(bytes, swapBytes);
    case ScalarType::UInt32:
      return Load<std::uint32_t>(bytes, swapBytes);
    case ScalarType::Int64:
      return static_cast<double>(Load<std::int64_t>(bytes, swapBytes));
    case ScalarType::UInt64:
      return static_cast<double>(Load<std::uint64_t>(bytes, swapBytes));
    case ScalarType::Float:
      return Load<float>(bytes, swapBytes);
    default:
      return Load<double>(bytes, swapBytes);
  }
}

// -- NRRD (teem's "Definition of NRRD File Format") --

ScalarType NrrdType(const std::string& path, const std::string& name)
{
  static const std::map<std::string, ScalarType> types = { { "signed char", ScalarType::Int8 },
    { "int8", ScalarType::Int8 }, { "int8_t", ScalarType::Int8 }, { "uchar", ScalarType::UInt8 },
    { "unsigned char", ScalarType::UInt8 }, { "uint8", ScalarType::UInt8 },
    { "uint8_t", ScalarType::UInt8 }, { "short", ScalarType::Int16 },
    { "short int", ScalarType::Int16 }, { "signed short", ScalarType::Int16 },
    { "signed short int", ScalarType::Int16 }, { "int16", ScalarType::Int16 },
    { "int16_t", ScalarType::Int16 }, { "ushort", ScalarType::UInt16 },
    { "unsigned short", ScalarType::UInt16 }, { "unsigned short int", ScalarType::UInt16 },
    { "uint16", ScalarType::UInt16 }, { "uint16_t", ScalarType::UInt16 },
    { "int", ScalarType::Int32 }, { "signed int", ScalarType::Int32 },
    { "int32", ScalarType::Int32 }, { "int32_t", ScalarType::Int32 },
    { "uint", ScalarType::UInt32 }, { "unsigned int", ScalarType::UInt32 },
    { "uint32", ScalarType::UInt32 }, { "uint32_t", ScalarType::UInt32 },
    { "longlong", ScalarType::Int64 }, { "long long", ScalarType::Int64 },
    { "long long int", ScalarType::Int64 }, { "signed long long", ScalarType::Int64 },
    { "signed long long int", ScalarType::Int64 }, { "int64", ScalarType::Int64 },
    { "int64_t", ScalarType::Int64 }, { "ulonglong", ScalarType::UInt64 },
    { "unsigned long long", ScalarType::UInt64 }, { "unsigned long long int", ScalarType::UInt64 },
    { "uint64", ScalarType::UInt64 }, { "uint64_t", ScalarType::UInt64 },
    { "float", ScalarType::Float }, { "double", ScalarType::Double } };
  const auto found = types.find(Lower(name));
  if (found == types.end())
  {
    throw InputError(
      path + ": type: expected an integer type, float or double, found '" + name + "'");
  }
  return found->second;
}

VolumeHeader ReadNrrdHeader(const std::string& path, VolumeAxes axes)
{
  std::ifstream file(path, std::ios::binary);
  std::string line;
  char magic[4] = {};
  file.read(magic, 4);
  if (std::memcmp(magic, "NRRD", 4) != 0)
  {
    throw InputError(path + ": expected an NRRD file, found other data");
  }
  std::getline(file, line);
  std::map<std::string, std::string> fields;
  while (std::getline(file, line) && !Trim(line).empty())
  {
    const auto colon = line.find(':');
    if (line[0] == '#' || colon == std::string::npos)
    {
      if (line[0] != '#')
      {
        throw InputError(path + ": expected 'field: value' in the header, found other data");
      }
      continue;
    }
    if (line.compare(colon, 2, ":=") == 0)
    {
      continue; // key/value pairs carry no geometry
    }
    std::string field = Lower(Trim(line.substr(0, colon)));
    field = field == "datafile" ? "data file"
      : field == "byteskip"     ? "byte skip"
      : field == "lineskip"     ? "line skip"
                                : field;
    fields[field] = Trim(line.substr(colon + 1));
  }
  const std::uint64_t headerEnd = file.good() ? static_cast<std::uint64_t>(file.tellg()) : 0;
  const auto need = [&](const char* field)
  {
    if (!fields.count(field))
    {
      throw InputError(path + ": expected the NRRD field '" + field + "', found none");
    }
    return fields[field];
  };
  const auto refuse = [&](const std::string& field, const std::string& expected)
  {
    return InputError(
      path + ": " + field + ": expected " + expected + ", found '" + fields[field] + "'");
  };

  VolumeHeader header;
  if (need("dimension") != "3")
  {
    throw refuse("dimension", "3");
  }
  ReadSize(path, "sizes", need("sizes"), header.Size);
  header.Type = NrrdType(path, need("type"));
  const std::string encoding = Lower(need("encoding"));
  header.Compressed = encoding == "gzip" || encoding == "gz";
  if (!header.Compressed && encoding != "raw")
  {
    throw refuse("encoding", "raw or gzip");
  }
  if (BytesOf(header.Type) > 1)
  {
    const std::string endian = Lower(need("endian"));
    if (endian != "little" && endian != "big")
    {
      throw refuse("endian", "little or big");
    }
    header.BigEndian = endian == "big";
  }

  // Geometry.
  if (fields.count("space directions"))
  {
    double numbers[9];
    if (!ReadNumbers(fields["space directions"], 9, numbers))
    {
      throw refuse("space directions", "three vectors (x,y,z)");
    }
    for (int a = 0; a < 3; ++a)
    {
      header.Axis[a] = { numbers[3 * a], numbers[3 * a + 1], numbers[3 * a + 2] };
    }
    if (fields.count("space origin") &&
      !ReadNumbers(fields["space origin"], 3, header.Origin.data()))
    {
      throw refuse("space origin", "a point (x,y,z)");
    }
  }
  else if (fields.count("spacings"))
  {
    double numbers[3];
    if (!ReadNumbers(fields["spacings"], 3, numbers))
    {
      throw refuse("spacings", "three numbers");
    }
    for (int a = 0; a < 3; ++a)
    {
      header.Axis[a][a] = numbers[a];
    }
  }
  else
  {
    throw InputError(
      path + ": expected the NRRD field 'space directions' or 'spacings', found neither");
  }
  if (fields.count("space units"))
  {
    std::string units = Lower(fields["space units"]);
    if (units != "\"mm\" \"mm\" \"mm\"")
    {
      throw refuse("space units", "\"mm\" \"mm\" \"mm\"");
    }
  }
  if (fields.count("space") && axes == VolumeAxes::Patient)
  {
    const std::string space = Lower(fields["space"]);
    Vector3 sign{ 1, 1, 1 };
    if (space == "right-anterior-superior" || space == "ras")
    {
      sign = { -1, -1, 1 };
    }
    else if (space == "left-anterior-superior" || space == "las")
    {
      sign = { 1, -1, 1 };
    }
    else if (space != "left-posterior-superior" && space != "lps" && space != "scanner-xyz" &&
      space != "3d-right-handed" && space != "3d-left-handed")
    {
      throw refuse("space",
        "left-posterior-superior, right-anterior-superior or another one in three dimensions");
    }
    for (int c = 0; c < 3; ++c)
    {
      header.Origin[c] *= sign[c];
      for (Vector3& axis : header.Axis)
      {
        axis[c] *= sign[c];
      }
    }
  }

  // Data.
  header.DataPath = path;
  header.FileOffset = headerEnd;
  if (fields.count("data file"))
  {
    const std::string name = fields["data file"];
    if (name.empty() || name.substr(0, 4) == "LIST" || name.find('%') != std::string::npos)
    {
      throw refuse("data file", "the name of one file");
    }
    header.DataPath = (fs::path(path).parent_path() / name).string();
    header.FileOffset = 0;
  }
  else if (headerEnd == 0)
  {
    throw InputError(path + ": expected voxels after the header, found the end of the file");
  }
  if (fields.count("line skip") && fields["line skip"] != "0")
  {
    throw refuse("line skip", "0");
  }
  if (fields.count("byte skip") && fields["byte skip"] != "0")
  {
    double skip = 0;
    if (!ReadNumbers(fields["byte skip"], 1, &skip) || skip < -1 || skip > 1e15 ||
      skip != std::floor(skip) || (skip < 0 && header.Compressed))
    {
      throw refuse("byte skip", "a whole number of at least 0 (or -1 with raw encoding)");
    }
    if (skip >= 0)
    {
      header.DataOffset = static_cast<std::uint64_t>(skip);
    }
    else
    {
      // -1: the voxels are the last bytes of the file.
      std::error_code problem;
      const double fileBytes = static_cast<double>(fs::file_size(header.DataPath, problem));
      const double wanted = static_cast<double>(header.Size[0]) * header.Size[1] * header.Size[2] *
        static_cast<double>(BytesOf(header.Type));
      header.FileOffset =
        !problem && fileBytes >= wanted ? static_cast<std::uint64_t>(fileBytes - wanted) : 0;
    }
  }
  return header;
}

// -- MetaImage --

VolumeHeader ReadMetaImageHeader(const std::string& path)
{
  std::ifstream file(path, std::ios::binary);
  std::map<std::string, std::string> fields;
  std::string line;
  std::uint64_t headerEnd = 0;
  while (std::getline(file, line))
  {
    const auto equals = line.find('=');
    if (equals == std::string::npos || equals > 100)
    {
      break;
    }
    const std::string key = Trim(line.substr(0, equals));
    fields[key] = Trim(line.substr(equals + 1));
    if (key == "ElementDataFile")
    {
      headerEnd = file.good() ? static_cast<std::uint64_t>(file.tellg()) : 0;
      break;
    }
  }
  const auto refuse = [&](const std::string& field, const std::string& expected)
  {
    return InputError(
      path + ": " + field + ": expected " + expected + ", found '" + fields[field] + "'");
  };
  const auto need = [&](const char* field)
  {
    if (!fields.count(field))
    {
      throw InputError(path + ": expected the MetaImage field '" + field + "', found none");
    }
    return fields[field];
  };
  const auto isTrue = [&](const char* field)
  {
    const std::string value = Lower(fields.count(field) ? fields[field] : "false");
    return value == "true" || value == "1";
  };
  if (need("NDims") != "3")
  {
    throw refuse("NDims", "3");
  }
  VolumeHeader header;
  ReadSize(path, "DimSize", need("DimSize"), header.Size);
  static const std::map<std::string, ScalarType> types = { { "MET_CHAR", ScalarType::Int8 },
    { "MET_UCHAR", ScalarType::UInt8 }, { "MET_SHORT", ScalarType::Int16 },
    { "MET_USHORT", ScalarType::UInt16 }, { "MET_INT", ScalarType::Int32 },
    { "MET_UINT", ScalarType::UInt32 }, { "MET_LONG", ScalarType::Int32 },
    { "MET_ULONG", ScalarType::UInt32 }, { "MET_LONG_LONG", ScalarType::Int64 },
    { "MET_ULONG_LONG", ScalarType::UInt64 }, { "MET_FLOAT", ScalarType::Float },
    { "MET_DOUBLE", ScalarType::Double } };
  const auto type = types.find(need("ElementType"));
  if (type == types.end())
  {
    throw refuse("ElementType", "an integer type, MET_FLOAT or MET_DOUBLE");
  }
  header.Type = type->second;
  if (fields.count("ElementNumberOfChannels") && fields["ElementNumberOfChannels"] != "1")
  {
    throw refuse("ElementNumberOfChannels", "1");
  }
  if (fields.count("BinaryData") && !isTrue("BinaryData"))
  {
    throw refuse("BinaryData", "True");
  }
  header.BigEndian = isTrue("BinaryDataByteOrderMSB") || isTrue("ElementByteOrderMSB");
  header.Compressed = isTrue("CompressedData");

  double numbers[9];
  const char* spacing = fields.count("ElementSpacing") ? "ElementSpacing" : "ElementSize";
  double step[3];
  if (!ReadNumbers(need(spacing), 3, step))
  {
    throw refuse(spacing, "three numbers");
  }
  for (const char* name : { "TransformMatrix", "Rotation", "Orientation" })
  {
    if (fields.count(name))
    {
      if (!ReadNumbers(fields[name], 9, numbers))
      {
        throw refuse(name, "nine numbers");
      }
      for (int a = 0; a < 3; ++a)
      {
        header.Axis[a] = { numbers[3 * a], numbers[3 * a + 1], numbers[3 * a + 2] };
      }
      break;
    }
  }
  for (int a = 0; a < 3; ++a)
  {
    if (!(step[a] > 0))
    {
      throw refuse(spacing, "three positive numbers");
    }
    header.Axis[a] = step[a] * header.Axis[a];
  }
  for (const char* name : { "Offset", "Origin", "Position" })
  {
    if (fields.count(name))
    {
      if (!ReadNumbers(fields[name], 3, header.Origin.data()))
      {
        throw refuse(name, "three numbers");
      }
      break;
    }
  }

  const std::string dataFile = need("ElementDataFile");
  header.DataPath = path;
  if (dataFile == "LOCAL")
  {
    header.FileOffset = headerEnd;
    if (headerEnd == 0)
    {
      throw InputError(path + ": expected voxels after the header, found the end of the file");
    }
  }
  else if (dataFile.empty() || dataFile.substr(0, 4) == "LIST" ||
    dataFile.find('%') != std::string::npos)
  {
    throw refuse("ElementDataFile", "LOCAL or the name of one file");
  }
  else
  {
    header.DataPath = (fs::path(path).parent_path() / dataFile).string();
  }
  if (fields.count("HeaderSize") && fields["HeaderSize"] != "0")
  {
    double size = 0;
    if (!ReadNumbers(fields["HeaderSize"], 1, &size) || size < 0 || size != std::floor(size) ||
      size > 1e15)
    {
      throw refuse("HeaderSize", "a whole number of at least 0");
    }
    header.FileOffset += static_cast<std::uint64_t>(size);
  }
  return header;
}

// -- NIfTI-1 (nifti1.h, "Official definition of the nifti1 header") --

VolumeHeader ReadNiftiHeader(const std::string& path, bool compressed, VolumeAxes axes)
{
  unsigned char raw[348] = {};
  {
    ByteSource source(path, 0, compressed);
    const std::size_t got = source.Read(raw, sizeof(raw));
    if (got != sizeof(raw))
    {
      throw InputError(
        path + ": expected a NIfTI header of 348 bytes, found " + std::to_string(got));
    }
  }
  const bool nativeBig = std::endian::native == std::endian::big;
  bool swapBytes = false;
  const auto integer = [&](int offset) { return Load<std::int16_t>(raw + offset, swapBytes); };
  const auto real = [&](int offset)
  { return static_cast<double>(Load<float>(raw + offset, swapBytes)); };
  if (Load<std::int32_t>(raw, false) != 348)
  {
    swapBytes = true;
    const auto headerBytes = Load<std::int32_t>(raw, true);
    if (headerBytes == 540 || Load<std::int32_t>(raw, false) == 540)
    {
      throw InputError(path + ": expected NIfTI-1, found NIfTI-2");
    }
    if (headerBytes != 348)
    {
      throw InputError(path + ": expected a NIfTI file, found other data");
    }
  }
  if (std::memcmp(raw + 344, "n+1", 4) != 0)
  {
    throw InputError(path + ": expected NIfTI-1 in one file (magic n+1), found another form");
  }
  VolumeHeader header;
  header.BigEndian = swapBytes != nativeBig;
  header.DataPath = path;
  header.Compressed = compressed;
  const int dimensions = integer(40);
  for (int a = 1; a <= 7; ++a)
  {
    const int size = integer(40 + 2 * a);
    const bool used = a <= dimensions;
    if (dimensions < 3 || dimensions > 7 || (used && size < 1) || (used && a > 3 && size != 1))
    {
      throw InputError(path + ": dim: expected a volume of three dimensions, found " +
        std::to_string(dimensions) + " with size " + std::to_string(size) + " along dimension " +
        std::to_string(a));
    }
    if (a <= 3)
    {
      header.Size[a - 1] = size;
    }
  }
  static const std::map<int, ScalarType> types = { { 2, ScalarType::UInt8 },
    { 4, ScalarType::Int16 }, { 8, ScalarType::Int32 }, { 16, ScalarType::Float },
    { 64, ScalarType::Double }, { 256, ScalarType::Int8 }, { 512, ScalarType::UInt16 },
    { 768, ScalarType::UInt32 }, { 1024, ScalarType::Int64 }, { 1280, ScalarType::UInt64 } };
  const auto type = types.find(integer(70));
  if (type == types.end())
  {
    throw InputError(path + ": datatype: expected an integer or real type, found code " +
      std::to_string(integer(70)));
  }
  header.Type = type->second;
  const double offset = real(108);
  if (!(offset >= 348 && offset <= 1e9))
  {
    throw InputError(path + ": vox_offset: expected at least 348, found " + Number(offset));
  }
  header.DataOffset = static_cast<std::uint64_t>(offset);
  if (real(112) != 0 && std::isfinite(real(112)) && std::isfinite(real(116)))
  {
    header.Slope = real(112);
    header.Intercept = real(116);
  }

  const double pixdim[4] = { real(76), real(80), real(84), real(88) };
  const int qformCode = integer(252);
  const int sformCode = integer(254);
  if (sformCode > 0)
  {
    for (int c = 0; c < 3; ++c)
    {
      for (int a = 0; a < 3; ++a)
      {
        header.Axis[a][c] = real(280 + 16 * c + 4 * a);
      }
      header.Origin[c] = real(280 + 16 * c + 12);
    }
  }
  else
  {
    double b = 0;
    double c = 0;
    double d = 0;
    double handedness = 1;
    if (qformCode > 0)
    {
      b = real(256);
      c = real(260);
      d = real(264);
      handedness = pixdim[0] < 0 ? -1 : 1;
      header.Origin = { real(268), real(272), real(276) };
    }
    const double squares = b * b + c * c + d * d;
    if (!(squares <= 1.0 + 1e-5))
    {
      throw InputError(path + ": qform: expected a unit quaternion, found (" + Number(b) + ", " +
        Number(c) + ", " + Number(d) + ")");
    }
    const double a = std::sqrt(std::max(0.0, 1.0 - squares));
    header.Axis = { { { a * a + b * b - c * c - d * d, 2 * (b * c + a * d), 2 * (b * d - a * c) },
      { 2 * (b * c - a * d), a * a + c * c - b * b - d * d, 2 * (c * d + a * b) },
      { 2 * (b * d + a * c), 2 * (c * d - a * b), a * a + d * d - b * b - c * c } } };
    for (int axis = 0; axis < 3; ++axis)
    {
      header.Axis[axis] = (axis == 2 ? handedness : 1) * pixdim[axis + 1] * header.Axis[axis];
    }
  }
  const int lengthUnit = raw[123] & 7; // 0 unknown, 1 m, 2 mm, 3 um
  const double scale = lengthUnit == 1 ? 1000.0 : lengthUnit == 3 ? 0.001 : 1.0;
  const bool patient = axes == VolumeAxes::Patient && (sformCode > 0 || qformCode > 0);
  for (int c = 0; c < 3; ++c)
  {
    const double factor = (patient && c < 2 ? -1 : 1) * scale;
    header.Origin[c] *= factor;
    for (Vector3& axis : header.Axis)
    {
      axis[c] *= factor;
    }
  }
  // Headers hold floats: their rounding (0.2 -> 0.200000003) is taken back where seven digits say
  // it all.
  const auto asWritten = [](double& value)
  {
    std::ostringstream text;
    text.precision(7);
    text << value;
    const double shorter = std::strtod(text.str().c_str(), nullptr);
    value = static_cast<float>(shorter) == static_cast<float>(value) ? shorter : value;
    value = value == 0 ? 0 : value; // no negative zeros
  };
  for (int c = 0; c < 3; ++c)
  {
    asWritten(header.Origin[c]);
    for (Vector3& axis : header.Axis)
    {
      asWritten(axis[c]);
    }
  }
  return header;
}

VolumeHeader ReadHeader(const std::string& path, const std::string& what, VolumeAxes axes)
{
  if (!fs::is_regular_file(path) || !std::ifstream(path))
  {
    throw InputError(path + ": expected " + what + ", found something that cannot be read");
  }
  if (fs::file_size(path) == 0)
  {
    throw InputError(path + ": expected " + what + ", found an empty file");
  }
  const std::string extension = VolumeExtension(path);
  if (extension == ".nrrd" || extension == ".nhdr")
  {
    return ReadNrrdHeader(path, axes);
  }
  if (extension == ".mha" || extension == ".mhd")
  {
    return ReadMetaImageHeader(path);
  }
  if (extension == ".nii" || extension == ".nii.gz")
  {
    return ReadNiftiHeader(path, extension == ".nii.gz", axes);
  }
  throw InputError(path + ": expected " + what +
    " (.nrrd, .nhdr, .mha, .mhd, .nii, .nii.gz, DICOM), found the extension '" + extension + "'");
}

VolumeGrid GridOf(const std::string& path, const VolumeHeader& header)
{
  VolumeGrid grid;
  grid.Origin = header.Origin;
  for (int a = 0; a < 3; ++a)
  {
    grid.Size[a] = static_cast<int>(header.Size[a]);
    // Axis-aligned steps keep their digits: sqrt(0.2^2) is not 0.2.
    const Vector3& axis = header.Axis[a];
    const double longest = std::max({ std::abs(axis[0]), std::abs(axis[1]), std::abs(axis[2]) });
    const double sum = std::abs(axis[0]) + std::abs(axis[1]) + std::abs(axis[2]);
    grid.Spacing[a] = sum == longest ? longest : Norm(axis);
    if (!(grid.Spacing[a] > 0) || !std::isfinite(grid.Spacing[a]))
    {
      throw InputError(path + ": expected a step between voxels along axis " + std::to_string(a) +
        ", found one of length " + Number(grid.Spacing[a]));
    }
    for (int c = 0; c < 3; ++c)
    {
      grid.Direction[a][c] = axis[c] / grid.Spacing[a];
    }
  }
  return grid;
}
}

std::string VolumeExtension(const std::string& path)
{
  const std::string name = Lower(fs::path(path).filename().string());
  return name.ends_with(".nii.gz") ? ".nii.gz" : fs::path(name).extension().string();
}

bool IsLabel(double value)
{
  return value >= 0 && value <= 65535 && value == std::floor(value);
}

InputError NoLabel(const std::string& place, double value)
{
  return InputError(
    place + " holds " + Number(value) + ", expected a label, a whole number from 0 to 65535");
}

VolumeFile::VolumeFile(const std::string& path, const std::string& what, VolumeAxes axes)
  : Path(path)
  , Header(ReadHeader(path, what, axes))
  , HeaderGrid(GridOf(path, this->Header))
{
}

void VolumeFile::Decode(
  const std::function<void(const double* values, std::size_t count)>& sink) const
{
  const std::string& path = this->Path;
  const VolumeHeader& header = this->Header;
  const std::size_t scalarBytes = BytesOf(header.Type);
  // Sizes are below 2^31, so only the last product can pass 2^64.
  const auto slice =
    static_cast<std::uint64_t>(header.Size[0]) * static_cast<std::uint64_t>(header.Size[1]);
  if (slice > (std::uint64_t{ 1 } << 48) / static_cast<std::uint64_t>(header.Size[2]))
  {
    throw InputError(path + ": the header promises more voxels than can be held");
  }
  const std::uint64_t voxelCount = slice * static_cast<std::uint64_t>(header.Size[2]);
  const std::uint64_t expected = voxelCount * scalarBytes;

  std::error_code problem;
  const std::uint64_t fileBytes = fs::file_size(header.DataPath, problem);
  if (problem)
  {
    throw InputError(path + ": the data file " + header.DataPath + " is missing");
  }
  const std::uint64_t skipped = std::min(header.FileOffset, fileBytes);
  const auto tooShort = [&](std::uint64_t found)
  {
    return InputError(path + ": expected " + std::to_string(voxelCount) + " voxels of " +
      std::to_string(scalarBytes) + " bytes, found " + std::to_string(found) + " bytes" +
      (header.DataPath == path ? "" : " in " + header.DataPath));
  };
  // Deflate cannot shrink data by more than 1032 : 1 (zlib's technical details).
  const std::uint64_t most = (fileBytes - skipped) * (header.Compressed ? 1032 : 1) + 64;
  if (!header.Compressed && fileBytes - skipped < expected + header.DataOffset)
  {
    throw tooShort(fileBytes - skipped);
  }
  if (most < expected)
  {
    throw InputError(path + ": expected " + std::to_string(voxelCount) +
      " voxels, found a file of " + std::to_string(fileBytes) + " bytes, too short to hold them");
  }

  ByteSource source(header.DataPath, header.FileOffset, header.Compressed);
  source.Skip(header.DataOffset);
  const bool swapBytes = header.BigEndian != (std::endian::native == std::endian::big);
  const std::size_t chunkVoxels = 1 << 18;
  std::vector<unsigned char> bytes(chunkVoxels * scalarBytes);
  std::vector<double> values(chunkVoxels);
  for (std::uint64_t done = 0; done < voxelCount;)
  {
    const std::size_t wanted = std::min<std::uint64_t>(chunkVoxels, voxelCount - done);
    const std::size_t got = source.Read(bytes.data(), wanted * scalarBytes);
    if (got != wanted * scalarBytes)
    {
      throw tooShort(done * scalarBytes + got);
    }
    for (std::size_t voxel = 0; voxel < wanted; ++voxel)
    {
      values[voxel] =
        header.Slope * LoadScalar(header.Type, bytes.data() + voxel * scalarBytes, swapBytes) +
        header.Intercept;
    }
    sink(values.data(), wanted);
    done += wanted;
  }
  // One byte further makes zlib compare its checksum.
  if (source.Read(bytes.data(), 1) == 0 && !source.Complete())
  {
    throw InputError(
      path + ": expected the end of the compressed voxels, found the end of the file");
  }
}
}
