// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Foundation/Error.h"

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <mutex>
#include <set>

namespace mammoray
{
namespace
{
/// Bytes of the UTF-8 letter at a place (RFC 3629) that may be shown; 0 where there is none.
std::size_t ShownBytes(const std::string& text, std::size_t at)
{
  const auto byte = [&](std::size_t index) -> std::uint32_t
  { return index < text.size() ? static_cast<unsigned char>(text[index]) : 0; };
  const std::uint32_t first = byte(at);
  if (first < 0x80)
  {
    return first >= 0x20 && first != 0x7f ? 1 : 0;
  }
  const std::size_t count = first >> 5 == 6 ? 2 : first >> 4 == 14 ? 3 : first >> 3 == 30 ? 4 : 0;
  std::uint32_t letter = count > 0 ? first & (0x7fU >> count) : 0;
  for (std::size_t index = 1; index < count; ++index)
  {
    if (byte(at + index) >> 6 != 2)
    {
      return 0;
    }
    letter = letter << 6 | (byte(at + index) & 0x3f);
  }
  constexpr std::uint32_t least[] = { 0, 0, 0x80, 0x800, 0x10000 };
  const bool isControl = letter < 0xa0 || letter == 0x2028 || letter == 0x2029;
  const bool turns = letter == 0x61c || letter == 0x200e || letter == 0x200f ||
    (letter >= 0x202a && letter <= 0x202e) || (letter >= 0x2066 && letter <= 0x2069);
  const bool isLetter =
    letter >= least[count] && letter <= 0x10ffff && (letter < 0xd800 || letter > 0xdfff);
  return isLetter && !isControl && !turns ? count : 0;
}

thread_local NoteKeeper* Innermost = nullptr;
}

void Note(const InputNote& note)
{
  const InputNote shown{ EscapeControls(note.File), EscapeControls(note.Text),
    EscapeControls(note.Names) };
  for (NoteKeeper* keeper = Innermost; keeper; keeper = keeper->Outer)
  {
    keeper->Notes.push_back(shown);
    if (!keeper->PassesOn)
    {
      return;
    }
  }
  // Files are read more than once, a spectrum for each picture.
  static std::mutex access;
  static std::set<std::string> said;
  const std::lock_guard<std::mutex> alone(access);
  if (said.insert(shown.Line()).second)
  {
    std::fprintf(stderr, "warning: %s\n", shown.Line().c_str());
  }
}

NoteKeeper::NoteKeeper(Others others)
  : PassesOn(others == Others::Told)
  , Outer(Innermost)
{
  Innermost = this;
}

NoteKeeper::~NoteKeeper()
{
  Innermost = this->Outer;
}

std::vector<std::string> NoteKeeper::Lines() const
{
  std::vector<std::string> lines;
  for (const InputNote& note : this->Notes)
  {
    lines.push_back(note.Line());
  }
  return lines;
}

std::string EscapeControls(const std::string& text)
{
  std::string shown;
  for (std::size_t at = 0; at < text.size();)
  {
    const std::size_t count = ShownBytes(text, at);
    if (count > 0)
    {
      shown.append(text, at, count);
      at += count;
      continue;
    }
    char escaped[8];
    std::snprintf(escaped, sizeof escaped, "\\x%02x", static_cast<unsigned char>(text[at]));
    shown += escaped;
    ++at;
  }
  return shown;
}
}
