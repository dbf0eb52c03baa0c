// SPDX-License-Identifier: Apache-2.0
#include "Private/StoredVoxels.h"

#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/Numbers.h"

#include <zlib.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <sstream>
#include <vector>

namespace mammoray
{
namespace
{
namespace fs = std::filesystem;

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

/// Adds the field or pair of a line; returns a field's key, empty where the line has none.
std::string AddField(TextHeader& header, const std::string& line, char separator)
{
  const auto at = line.find(separator);
  if (at == std::string::npos || line[0] == '#')
  {
    return {};
  }
  if (line.compare(at, 2, ":=") == 0)
  {
    header.Pairs[line.substr(0, at)] = Trim(line.substr(at + 2));
    return {};
  }
  std::string key = Lower(line.substr(0, at));
  key.erase(std::remove_if(key.begin(), key.end(), [](unsigned char c) { return std::isspace(c); }),
    key.end());
  header.Fields[key] = Trim(line.substr(at + 1));
  return key;
}

/// The file that a header names, beside it.
std::string DataFile(const TextHeader& header, const std::string& key)
{
  const std::string& name = header.Fields.at(key);
  if (name.empty() || name.substr(0, 4) == "LIST" || name.find('%') != std::string::npos)
  {
    header.Refuse(key, "the name of one file");
  }
  return (fs::path(header.Path).parent_path() / name).string();
}

/// Number of bytes, up to `enough`, that a file holds from a place on in zlib's or gzip's format;
/// fewer where the data is damaged or has no end.
std::uint64_t CountInflated(const std::string& path, std::uint64_t offset, std::uint64_t enough)
{
  std::ifstream file(path, std::ios::binary);
  file.seekg(static_cast<std::streamoff>(offset));
  z_stream stream{};
  // 32: zlib or gzip, told by the first bytes.
  if (inflateInit2(&stream, MAX_WBITS + 32) != Z_OK)
  {
    return 0;
  }
  std::vector<unsigned char> input(1 << 16);
  std::vector<unsigned char> output(1 << 18);
  std::uint64_t count = 0;
  int state = Z_OK;
  while (state == Z_OK || (state == Z_STREAM_END && count < enough))
  {
    if (stream.avail_in == 0)
    {
      file.read(reinterpret_cast<char*>(input.data()), static_cast<std::streamsize>(input.size()));
      stream.next_in = input.data();
      stream.avail_in = static_cast<uInt>(file.gcount());
      if (stream.avail_in == 0)
      {
        break;
      }
    }
    if (state == Z_STREAM_END)
    {
      inflateReset(&stream); // another gzip member follows
    }
    stream.next_out = output.data();
    stream.avail_out = static_cast<uInt>(output.size());
    state = inflate(&stream, Z_NO_FLUSH);
    count += output.size() - stream.avail_out;
  }
  inflateEnd(&stream);
  return state == Z_STREAM_END ? count : std::min(count, enough - 1);
}
}

TextHeader TextHeader::ReadNrrd(const std::string& path)
{
  TextHeader header;
  header.Path = path;
  std::ifstream file(path, std::ios::binary);
  std::string line;
  std::getline(file, line); // the magic word
  while (std::getline(file, line) && !Trim(line).empty())
  {
    AddField(header, line, ':');
  }
  header.Bytes = file.good() ? static_cast<std::uint64_t>(file.tellg()) : fs::file_size(path);
  return header;
}

TextHeader TextHeader::ReadMetaImage(const std::string& path)
{
  TextHeader header;
  header.Path = path;
  std::ifstream file(path, std::ios::binary);
  std::string line;
  while (std::getline(file, line) && AddField(header, line, '=') != "elementdatafile")
  {
  }
  header.Bytes = file.good() ? static_cast<std::uint64_t>(file.tellg()) : fs::file_size(path);
  return header;
}

std::string TextHeader::Value(const std::string& key) const
{
  const auto found = this->Fields.find(key);
  return found == this->Fields.end() ? std::string() : Lower(found->second);
}

void TextHeader::Refuse(const std::string& key, const std::string& expected) const
{
  const auto found = this->Fields.find(key);
  throw InputError(this->Path + ": " + key + ": expected " + expected + ", found " +
    (found == this->Fields.end() ? "nothing" : "'" + found->second + "'"));
}

void TextHeader::CheckSizes(const std::string& key) const
{
  std::istringstream sizes(this->Value(key));
  double product = 1;
  for (double size = 0; sizes >> size;)
  {
    product *= size;
    if (size > std::numeric_limits<int>::max() || product > 0x1p48)
    {
      throw InputError(this->Path + ": the header promises more voxels than can be held");
    }
    if (!(size >= 1))
    {
      this->Refuse(key, "whole numbers of at least 1");
    }
  }
}

void TextHeader::CheckLengths(const std::vector<std::string>& keys) const
{
  constexpr double most = 1e6; // mm; beyond a root of the largest number ITK's norms are none
  for (const std::string& key : keys)
  {
    std::string text = this->Value(key);
    std::replace_if(
      text.begin(), text.end(),
      [](char letter) { return letter == '(' || letter == ')' || letter == ','; }, ' ');
    std::istringstream words(text);
    for (std::string word; words >> word;)
    {
      if (word == "none") // an axis that is none of space
      {
        continue;
      }
      double length = 0;
      if (!ToPaddedNumber(word, length) || !(std::abs(length) <= most))
      {
        this->Refuse(key, "numbers of mm up to 1e6");
      }
    }
  }
}

StoredVoxels StoredVoxels::OfNrrd(const TextHeader& header)
{
  const std::string encoding = header.Value("encoding");
  if (encoding != "raw" && encoding != "gzip" && encoding != "gz")
  {
    header.Refuse("encoding", "raw or gzip");
  }
  StoredVoxels voxels{ header.Path, header.Bytes };
  voxels.Packed = encoding == "raw" ? Packing::None : Packing::Voxels;
  if (header.Fields.count("datafile") != 0)
  {
    voxels.Path = DataFile(header, "datafile");
    voxels.Offset = 0;
  }
  return voxels;
}

StoredVoxels StoredVoxels::OfMetaImage(const TextHeader& header)
{
  if (const std::string binary = header.Value("binarydata"); binary == "false" || binary == "0")
  {
    header.Refuse("binarydata", "True");
  }
  StoredVoxels voxels{ header.Path, header.Bytes };
  const std::string compressed = header.Value("compresseddata");
  voxels.Packed = compressed == "true" || compressed == "1" ? Packing::Voxels : Packing::None;
  if (header.Value("elementdatafile") == "local")
  {
    // MetaIO inflates from the file's start then, and answers zeros.
    if (voxels.Packed != Packing::None && header.Fields.count("compresseddatasize") == 0)
    {
      header.Refuse("compresseddatasize", "the number of bytes behind the header");
    }
  }
  else
  {
    if (header.Fields.count("elementdatafile") == 0)
    {
      header.Refuse("elementdatafile", "LOCAL or the name of one file");
    }
    voxels.Path = DataFile(header, "elementdatafile");
    voxels.Offset = 0;
  }
  return voxels;
}

void StoredVoxels::CheckPresent(const std::string& header, std::uint64_t voxelCount,
  std::uint64_t voxelBytes) const
{
  std::error_code problem;
  const std::uint64_t fileBytes = fs::file_size(this->Path, problem);
  if (problem)
  {
    throw InputError(header + ": the data file " + this->Path + " is missing");
  }
  const std::uint64_t needed =
    voxelCount * voxelBytes + (this->Packed == Packing::Voxels ? 0 : this->Offset);
  const std::uint64_t found = this->Packed == Packing::None
    ? fileBytes
    : CountInflated(this->Path, this->Packed == Packing::File ? 0 : this->Offset, needed);
  if (found < needed)
  {
    throw InputError(header + ": expected " + std::to_string(voxelCount) + " voxels of " +
      std::to_string(voxelBytes) + " bytes, found " +
      (this->Packed == Packing::None
          ? std::to_string(fileBytes - std::min(this->Offset, fileBytes)) + " bytes"
          : std::string("compressed data that is too short or damaged")) +
      (this->Path == header ? "" : " in " + this->Path));
  }
}
}
