// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Private_HeaderWords_h
#define mammoray_Private_HeaderWords_h

#include <algorithm>
#include <cctype>
#include <initializer_list>
#include <map>
#include <regex>
#include <string>
#include <vector>

namespace mammoray
{
/// A text of a header in lower case, everything but letters, digits and '+' turned into one blank.
inline std::string HeaderWords(const std::string& text)
{
  std::string words;
  for (const char letter : text)
  {
    const auto c = static_cast<unsigned char>(letter);
    // Letters beyond ASCII stay as they are.
    const bool kept = std::isalnum(c) != 0 || c >= 0x80 || letter == '+';
    if (kept)
    {
      words.push_back(static_cast<char>(std::tolower(c)));
    }
    else if (!words.empty() && words.back() != ' ')
    {
      words.push_back(' ');
    }
  }
  return words;
}

/// The first match of a pattern of whole words in HeaderWords; empty where there is none.
inline std::string FindWords(const std::string& words, const char* pattern)
{
  // Made once: that takes longer than all looking.
  thread_local std::map<std::string, std::regex> made;
  const auto [whole, isNew] = made.try_emplace(pattern);
  if (isNew)
  {
    whole->second = std::regex(std::string("(?:^| )(") + pattern + ")(?= |$)");
  }
  std::smatch match;
  return std::regex_search(words, match, whole->second) ? match[1].str() : std::string();
}

/// The side that HeaderWords name in one of several languages, 'L' or 'R', where given also by a
/// further pattern for each; '?' where they name none or both.
inline char SideInWords(const std::string& words, const char* alsoLeft = nullptr,
  const char* alsoRight = nullptr)
{
  const auto names = [&words](const char* pattern, const char* also)
  { return !FindWords(words, pattern).empty() || (also && !FindWords(words, also).empty()); };
  const bool left = names("left|lt|links|gauche|esquerd\\w*|izquierd\\w*|sinistr\\w*", alsoLeft);
  const bool right = names("right|rt|rechts|droit\\w*|direit\\w*|derech\\w*|destr\\w*", alsoRight);
  return left == right ? '?' : left ? 'L' : 'R';
}

/// The first of a header's values that is one of these; empty where none is.
inline std::string FindValue(const std::vector<std::string>& values,
  std::initializer_list<const char*> wanted)
{
  const auto found = std::find_if(values.begin(), values.end(),
    [&](const std::string& value)
    { return std::find(wanted.begin(), wanted.end(), value) != wanted.end(); });
  return found == values.end() ? std::string() : *found;
}

/// The first value that holds one of these parts.
inline std::string FindPart(const std::vector<std::string>& values,
  std::initializer_list<const char*> parts)
{
  for (const std::string& value : values)
  {
    for (const char* part : parts)
    {
      if (value.find(part) != std::string::npos)
      {
        return value;
      }
    }
  }
  return {};
}
}

#endif
