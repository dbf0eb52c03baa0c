// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Numbers_h
#define mammoray_Numbers_h

#include "mammoray/Foundation/Error.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <istream>
#include <iterator>
#include <streambuf>
#include <string>
#include <string_view>
#include <vector>

namespace mammoray
{
/// Parses a number, independently of the locale. Returns true and sets `value` if the whole text is
/// a number.
template <typename Value>
bool ToNumber(std::string_view text, Value& value)
{
  const char* const end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, value);
  return error == std::errc() && rest == end;
}

/// As ToNumber, but accepts blanks and a plus sign before the number, as they occur in foreign
/// tables and headers.
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

/// Reads the next line without its end (LF, CRLF or CR). Returns false at the end of the text.
inline bool ReadLine(std::istream& text, std::string& line)
{
  using Bytes = std::istream::traits_type;
  line.clear();
  std::streambuf* const bytes = text.rdbuf();
  for (auto byte = bytes->sbumpc(); byte != Bytes::eof(); byte = bytes->sbumpc())
  {
    if (byte == '\r' && bytes->sgetc() == '\n')
    {
      continue;
    }
    if (byte == '\r' || byte == '\n')
    {
      return true;
    }
    line.push_back(Bytes::to_char_type(byte));
  }
  return !line.empty();
}

/// Formats a number with at most six significant digits: "0.05", "1e+09".
inline std::string NumberText(double value)
{
  char text[32];
  std::snprintf(text, sizeof text, "%g", value);
  return text;
}

/// A number for people: `digits` after the point, a typographic minus sign, no negative zero; a
/// dash if it is not finite.
inline std::string NumberText(double value, int digits)
{
  if (!std::isfinite(value))
  {
    return "–";
  }
  char buffer[400]; // the largest number has 309 digits before the point
  const auto [end, error] =
    std::to_chars(std::begin(buffer), std::end(buffer), value, std::chars_format::fixed, digits);
  const std::string text(buffer, end);
  const bool zero = text.find_first_not_of("-0.") == std::string::npos;
  return text[0] != '-' ? text : (zero ? "" : "−") + text.substr(1);
}

/// The value below which a fraction [0, 1] of the values lies: the one of that rank, rounded down,
/// not interpolated. There must be at least one value.
template <typename Value>
Value QuantileElement(std::vector<Value> values, double fraction)
{
  const auto place =
    values.begin() + static_cast<std::ptrdiff_t>(fraction * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), place, values.end());
  return *place;
}

/// Throws InputError "WHERE: expected NAME from LOW to HIGH, found VALUE" if the value is outside
/// [low, high] or NaN.
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
