// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Foundation/SpellingSuggestions.h"

#include <algorithm>
#include <cctype>
#include <numeric>
#include <sstream>
#include <utility>

namespace mammoray
{
namespace
{
std::string LowerCase(std::string text)
{
  std::transform(text.begin(), text.end(), text.begin(),
    [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
  return text;
}

std::size_t LevenshteinDistance(const std::string& a, const std::string& b)
{
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{ 0 });
  for (std::size_t i = 0; i < a.size(); ++i)
  {
    std::size_t diagonal = row[0];
    row[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j)
    {
      const std::size_t replaced = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({ replaced, row[j] + 1, row[j + 1] + 1 });
    }
  }
  return row.back();
}

/// Whether `text` has all the words of `wanted`, two or more of three letters, in any order.
bool HasWords(const std::string& text, const std::string& wanted)
{
  std::istringstream words(wanted);
  std::size_t count = 0;
  for (std::string word; words >> word;)
  {
    if (word.size() >= 3 && text.find(word) == std::string::npos)
    {
      return false;
    }
    count += word.size() >= 3 ? 1 : 0;
  }
  return count >= 2;
}

std::string Joined(const std::vector<std::string>& names, const std::string& last)
{
  std::string text;
  for (std::size_t index = 0; index < names.size(); ++index)
  {
    text += (index == 0 ? "" : index + 1 == names.size() ? last : ", ") + names[index];
  }
  return text;
}
}

std::vector<std::string> SpellingSuggestions(const std::string& name,
  const std::vector<std::string>& known, std::size_t count)
{
  const std::string wanted = LowerCase(name);
  std::vector<std::pair<std::size_t, std::string>> ranked;
  for (const std::string& candidate : known)
  {
    const std::string other = LowerCase(candidate);
    const std::size_t distance = LevenshteinDistance(wanted, other);
    const bool holds = std::min(wanted.size(), other.size()) >= 3 &&
      (other.find(wanted) != std::string::npos || wanted.find(other) != std::string::npos);
    if (holds || HasWords(other, wanted) || distance <= std::max<std::size_t>(1, wanted.size() / 3))
    {
      ranked.emplace_back(distance, candidate);
    }
  }
  std::stable_sort(ranked.begin(), ranked.end(),
    [](const auto& a, const auto& b) { return a.first < b.first; });
  if (!ranked.empty() && ranked.front().first == 0 && ranked.front().second != name)
  {
    count = 1;
  }
  std::vector<std::string> names;
  for (std::size_t index = 0; index < std::min(count, ranked.size()); ++index)
  {
    names.push_back(ranked[index].second);
  }
  return names;
}

std::string SpellingHint(const std::string& name, const std::vector<std::string>& known)
{
  const std::vector<std::string> near = SpellingSuggestions(name, known);
  if (!near.empty())
  {
    return "did you mean " + Joined(near, " or ") + "?";
  }
  return "known are " + (known.empty() ? "none" : Joined(known, ", "));
}
}
