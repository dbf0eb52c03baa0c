// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Numbers_h
#define mammoray_Numbers_h

#include "mammoray/Foundation/Error.h"

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <istream>
#include <string>
#include <string_view>

namespace mammoray
{
/// True when the whole text is a number, in any locale, which `value` receives.
template <typename Value>
bool ToNumber(std::string_view text, Value& value)
{
  const char* const end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, value);
  return error == std::errc() && rest == end;
}

/// The same with blanks or a plus sign before it, as tables and headers of others have.
template <typename Value>
bool ToPaddedNumber(std::string_view text, Value& value)
{
  text.remove_prefix(std::min(text.find_first_not_of(" \t"), text.size()));
  if (text.starts_with('+') && !text.starts_with("+-"))
  {
    text.remove_prefix(1);
  }
  return ToNumber(text, value);
}

/// The next line of a text, without its end, that of Windows too; false where there is none.
inline bool ReadLine(std::istream& text, std::string& line)
{
  if (!std::getline(text, line))
  {
    return false;
  }
  if (!line.empty() && line.back() == '\r')
  {
    line.pop_back();
  }
  return true;
}

/// At most six digits, for people: "0.05", "1e+09".
inline std::string NumberText(double value)
{
  char text[32];
  std::snprintf(text, sizeof text, "%g", value);
  return text;
}

/// Throws InputError "WHERE: expected NAME from LOW to HIGH, found VALUE" unless it is; NaN is not.
inline void RequireBetween(const std::string& where, const std::string& name, double value,
  double low, double high)
{
  if (!(value >= low && value <= high))
  {
    throw InputError(where + ": expected " + name + " from " + NumberText(low) + " to " +
      NumberText(high) + ", found " + NumberText(value));
  }
}
}

#endif
