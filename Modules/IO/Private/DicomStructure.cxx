// SPDX-License-Identifier: Apache-2.0
#include "Private/DicomStructure.h"

#include <zlib.h>

#include <cstdint>
#include <cstring>
#include <fstream>
#include <iterator>
#include <string_view>
#include <vector>

namespace mammoray
{
namespace
{
constexpr std::uint32_t UndefinedLength = 0xffffffff;
constexpr int DeepestSequence = 32;

struct Syntax
{
  bool Explicit = true;
  bool BigEndian = false;
};

/// A cursor over bytes that never leaves them.
struct Cursor
{
  std::string_view Bytes;
  std::size_t At = 0;

  std::size_t Left() const { return this->Bytes.size() - this->At; }
  std::uint32_t Number(int size, bool bigEndian)
  {
    std::uint32_t value = 0;
    for (int i = 0; i < size; ++i)
    {
      const auto byte = static_cast<unsigned char>(this->Bytes[this->At + i]);
      value |= static_cast<std::uint32_t>(byte) << 8 * (bigEndian ? size - 1 - i : i);
    }
    this->At += size;
    return value;
  }
};

bool WalkElements(Cursor& cursor, const Syntax& syntax, bool inItem, int depth);

/// The items of a sequence, or the fragments of compressed pixel data, to its end or its delimiter.
bool WalkItems(Cursor& cursor, const Syntax& syntax, bool delimited, bool fragments, int depth)
{
  while (cursor.Left() > 0)
  {
    if (cursor.Left() < 8)
    {
      return false;
    }
    const std::uint32_t group = cursor.Number(2, syntax.BigEndian);
    const std::uint32_t element = cursor.Number(2, syntax.BigEndian);
    const std::uint32_t length = cursor.Number(4, syntax.BigEndian);
    if (group == 0xfffe && element == 0xe0dd)
    {
      return delimited;
    }
    if (group != 0xfffe || element != 0xe000)
    {
      return false;
    }
    if (length == UndefinedLength)
    {
      if (fragments || !WalkElements(cursor, syntax, true, depth + 1))
      {
        return false;
      }
      continue;
    }
    if (length > cursor.Left())
    {
      return false;
    }
    Cursor item{ cursor.Bytes.substr(cursor.At, length) };
    if (!fragments && !WalkElements(item, syntax, false, depth + 1))
    {
      return false;
    }
    cursor.At += length;
  }
  return !delimited;
}

/// Elements to the end of the bytes, or to the item's delimiter where it has one.
bool WalkElements(Cursor& cursor, const Syntax& syntax, bool delimited, int depth)
{
  if (depth > DeepestSequence)
  {
    return false;
  }
  while (cursor.Left() > 0)
  {
    if (cursor.Left() < 8)
    {
      return false;
    }
    const std::uint32_t group = cursor.Number(2, syntax.BigEndian);
    const std::uint32_t element = cursor.Number(2, syntax.BigEndian);
    if (group == 0xfffe)
    {
      cursor.Number(4, syntax.BigEndian);
      return delimited && element == 0xe00d;
    }
    std::string_view representation;
    std::uint32_t length = 0;
    if (syntax.Explicit)
    {
      representation = cursor.Bytes.substr(cursor.At, 2);
      cursor.At += 2;
      for (const char letter : representation)
      {
        if (letter < 'A' || letter > 'Z')
        {
          return false;
        }
      }
      // PS3.5 section 7.1.2: these have two reserved bytes and a length of four.
      static constexpr std::string_view Long = "OB OD OF OL OV OW SQ SV UC UN UR UT UV";
      if (Long.find(representation) != std::string_view::npos)
      {
        cursor.At += 2;
        if (cursor.Left() < 4)
        {
          return false;
        }
        length = cursor.Number(4, syntax.BigEndian);
      }
      else
      {
        length = cursor.Number(2, syntax.BigEndian);
      }
    }
    else
    {
      length = cursor.Number(4, syntax.BigEndian);
    }
    const bool pixels = group == 0x7fe0 && element == 0x0010;
    if (length == UndefinedLength)
    {
      // PS3.5 section 6.2.2: an unknown sequence of undefined length is in implicit VR little
      // endian.
      const Syntax nested = representation == "UN" ? Syntax{ false, false } : syntax;
      if (!WalkItems(cursor, nested, true, pixels, depth))
      {
        return false;
      }
    }
    else if (length > cursor.Left())
    {
      return false;
    }
    else
    {
      Cursor value{ cursor.Bytes.substr(cursor.At, length) };
      if (representation == "SQ" && !WalkItems(value, syntax, false, false, depth))
      {
        return false;
      }
      cursor.At += length;
    }
  }
  return !delimited;
}

/// Raw deflate (PS3.5 annex A.5); nothing when the stream does not end.
bool Inflate(std::string_view compressed, std::string& inflated)
{
  z_stream stream{};
  if (inflateInit2(&stream, -MAX_WBITS) != Z_OK)
  {
    return false;
  }
  stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(compressed.data()));
  stream.avail_in = static_cast<uInt>(compressed.size());
  std::vector<char> block(1 << 20);
  int state = Z_OK;
  while (state == Z_OK)
  {
    stream.next_out = reinterpret_cast<Bytef*>(block.data());
    stream.avail_out = static_cast<uInt>(block.size());
    state = inflate(&stream, Z_NO_FLUSH);
    inflated.append(block.data(), block.size() - stream.avail_out);
  }
  inflateEnd(&stream);
  return state == Z_STREAM_END;
}
}

std::string FindDicomDamage(const std::string& path)
{
  std::ifstream file(path, std::ios::binary);
  std::string bytes(132, '\0');
  file.read(bytes.data(), 132);
  if (file.gcount() < 132 || bytes.compare(128, 4, "DICM") != 0)
  {
    return "found no DICOM header";
  }
  // The magic word came first, so that a huge file of another kind is not read in full.
  bytes.append(std::istreambuf_iterator<char>(file), {});
  const std::string damaged = "found a DICOM file that is cut short or damaged";

  // Meta information (group 2) is explicit little endian; its first element tells its length.
  Cursor cursor{ bytes, 132 };
  if (cursor.Left() < 12 || cursor.Number(4, false) != 0x00000002)
  {
    return damaged;
  }
  cursor.At += 4; // UL, length 4
  const std::uint32_t metaBytes = cursor.Number(4, false);
  if (metaBytes > cursor.Left())
  {
    return damaged;
  }
  const std::string_view meta = cursor.Bytes.substr(cursor.At, metaBytes);
  Cursor metaCursor{ meta };
  if (!WalkElements(metaCursor, Syntax{}, false, 0))
  {
    return damaged;
  }
  std::string transferSyntax;
  const std::string_view key("\x02\x00\x10\x00UI", 6);
  const std::size_t at = meta.find(key);
  if (at == std::string_view::npos || at + 8 > meta.size())
  {
    return damaged;
  }
  Cursor value{ meta, at + 6 };
  const std::uint32_t length = value.Number(2, false);
  transferSyntax = meta.substr(value.At, length);
  transferSyntax.erase(transferSyntax.find_last_not_of(std::string_view("\0 ", 2)) + 1);

  Syntax syntax;
  syntax.Explicit = transferSyntax != "1.2.840.10008.1.2";
  syntax.BigEndian = transferSyntax == "1.2.840.10008.1.2.2";
  std::string_view data = cursor.Bytes.substr(cursor.At + metaBytes);
  std::string inflated;
  if (transferSyntax == "1.2.840.10008.1.2.1.99")
  {
    if (!Inflate(data, inflated))
    {
      return damaged;
    }
    data = inflated;
  }
  Cursor dataCursor{ data };
  return !data.empty() && WalkElements(dataCursor, syntax, false, 0) ? std::string() : damaged;
}
}
