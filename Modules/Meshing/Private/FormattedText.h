// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_FormattedText_h
#define mammoray_FormattedText_h

#include <cstdio>
#include <string>

namespace mammoray
{
/// A line of at most 159 characters with numbers in it, as printf writes them.
inline std::string FormattedText(const char* format, double a, double b = 0, double c = 0)
{
  char text[160];
  std::snprintf(text, sizeof(text), format, a, b, c);
  return text;
}
}

#endif
