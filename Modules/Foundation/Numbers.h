// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Numbers_h
#define mammoray_Numbers_h

#include <charconv>
#include <cstdio>
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

/// At most six digits, for people: "0.05", "1e+09".
inline std::string NumberText(double value)
{
  char text[32];
  std::snprintf(text, sizeof text, "%g", value);
  return text;
}
}

#endif
