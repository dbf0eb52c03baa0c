// SPDX-License-Identifier: Apache-2.0
#include "Damage.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstring>
#include <vector>

namespace mammoray::hardening
{
namespace
{
constexpr std::array<std::uint64_t, 15> Integers{ 0, 1, 2, 7, 0x7f, 0x80, 0xff, 0x7fff, 0x8000,
  0xffff, 0x7fffffff, 0x80000000, 0xffffffff, 0x7fffffffffffffff, 0xffffffffffffffff };

constexpr std::array<const char*, 20> Texts{ "0", "-1", "1e400", "-1e308", "1e-320", "nan", "inf",
  "99999999999", "2147483648", "4294967296", "3200", "65536", "1e9", "0x10", "", "-", "1.5",
  "\x1b[2J", "a\nmammoray: forged", "%s%n" };

std::size_t Below(std::mt19937_64& random, std::size_t count)
{
  return count > 0 ? random() % count : 0;
}

std::size_t Place(const std::string& bytes, std::mt19937_64& random)
{
  const bool early = random() % 2 == 0;
  return Below(random, early ? std::min<std::size_t>(bytes.size(), 1024) : bytes.size());
}

void ChangeInteger(std::string& bytes, std::mt19937_64& random)
{
  const std::size_t size = std::size_t{ 1 } << Below(random, 4);
  const std::uint64_t value = Integers[Below(random, Integers.size())];
  const bool bigEndian = random() % 2 == 0;
  const std::size_t at = Place(bytes, random);
  for (std::size_t byte = 0; byte < size && at + byte < bytes.size(); ++byte)
  {
    bytes[at + byte] =
      static_cast<char>((value >> (8 * (bigEndian ? size - 1 - byte : byte))) & 0xff);
  }
}

/// The next number in text after a place.
void ChangeText(std::string& bytes, std::mt19937_64& random)
{
  const auto isDigit = [](char letter)
  { return std::isdigit(static_cast<unsigned char>(letter)) != 0 || letter == '.'; };
  const auto from = bytes.begin() + static_cast<std::ptrdiff_t>(Place(bytes, random));
  const auto first = std::find_if(from, bytes.end(), isDigit);
  const auto last = std::find_if_not(first, bytes.end(), isDigit);
  bytes.replace(first, last, Texts[Below(random, Texts.size())]);
}

void ChangePiece(std::string& bytes, std::mt19937_64& random)
{
  const std::size_t at = Place(bytes, random);
  const std::size_t count = std::min(bytes.size() - at, std::size_t{ 1 } << Below(random, 10));
  const std::string piece = bytes.substr(at, count);
  switch (Below(random, 4))
  {
    case 0:
      bytes.erase(at, count);
      break;
    case 1:
      bytes.insert(at, piece);
      break;
    case 2:
      bytes.erase(at, count);
      bytes.insert(Place(bytes, random), piece);
      break;
    default:
      for (std::size_t byte = 0; byte < std::min<std::size_t>(count, 16); ++byte)
      {
        bytes.insert(at, 1, static_cast<char>(random() & 0xff));
      }
  }
}
}

std::string Damage(const std::string& bytes, std::mt19937_64& random)
{
  std::string damaged = bytes;
  for (std::size_t change = 1 + Below(random, 8); change > 0 && !damaged.empty(); --change)
  {
    switch (Below(random, 12))
    {
      case 0:
      case 1:
      case 2:
        damaged[Place(damaged, random)] ^= static_cast<char>(1 << Below(random, 8));
        break;
      case 3:
      case 4:
        damaged[Place(damaged, random)] = static_cast<char>(random() & 0xff);
        break;
      case 5:
      case 6:
        ChangeInteger(damaged, random);
        break;
      case 7:
      case 8:
        ChangeText(damaged, random);
        break;
      case 9:
        damaged.resize(Below(random, damaged.size()));
        break;
      default:
        ChangePiece(damaged, random);
    }
  }
  return damaged;
}

std::string WithDicomInteger(const std::string& bytes, int which)
{
  // Samples per Pixel, Planar Configuration, Rows, Columns, Bits Allocated, Bits Stored, High Bit,
  // Pixel Representation.
  constexpr std::array<int, 8> elements{ 0x02, 0x06, 0x10, 0x11, 0x100, 0x101, 0x102, 0x103 };
  constexpr std::array<int, 19> values{ 0, 1, 2, 3, 4, 5, 7, 8, 12, 16, 17, 31, 32, 33, 64, 255,
    256, 32768, 65535 };
  const int element = elements[static_cast<std::size_t>(which) / values.size()];
  const int value = values[static_cast<std::size_t>(which) % values.size()];
  const std::string head{ '\x28', '\0', static_cast<char>(element & 0xff),
    static_cast<char>(element >> 8), 'U', 'S', '\2', '\0' };
  const std::size_t at = bytes.find(head);
  if (at == std::string::npos)
  {
    return {};
  }
  std::string changed = bytes;
  changed[at + head.size()] = static_cast<char>(value & 0xff);
  changed[at + head.size() + 1] = static_cast<char>(value >> 8);
  return changed;
}
}
