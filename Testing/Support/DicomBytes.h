// SPDX-License-Identifier: Apache-2.0
// DICOM files byte by byte, independent of the libraries that read them.
#ifndef mammoray_Testing_DicomBytes_h
#define mammoray_Testing_DicomBytes_h

#include <cstdint>
#include <cstdio>
#include <string>
#include <vector>

namespace mammoray::test
{
inline std::string Little(std::uint32_t value, int bytes)
{
  std::string text;
  for (int n = 0; n < bytes; ++n)
  {
    text.push_back(static_cast<char>(value >> 8 * n & 255));
  }
  return text;
}

inline std::string Us(std::uint32_t value)
{
  return Little(value, 2);
}

/// An element in explicit VR little endian (PS3.5 section 7.1.2).
inline std::string Element(std::uint32_t group, std::uint32_t element, const std::string& vr,
  std::string value)
{
  if (value.size() % 2 != 0)
  {
    value.push_back(vr == "UI" || vr == "OB" ? '\0' : ' ');
  }
  const bool wide = vr == "OB" || vr == "OW" || vr == "SQ";
  const auto length = static_cast<std::uint32_t>(value.size());
  return Little(group, 2) + Little(element, 2) + vr +
    (wide ? Little(0, 2) + Little(length, 4) : Little(length, 2)) + value;
}

inline std::string Sequence(std::uint32_t group, std::uint32_t element,
  const std::vector<std::string>& items)
{
  std::string value;
  for (const std::string& item : items)
  {
    value += Little(0xfffe, 2) + Little(0xe000, 2) +
      Little(static_cast<std::uint32_t>(item.size()), 4) + item;
  }
  return Element(group, element, "SQ", value);
}

/// Numbers with '\' between them.
inline std::string Join(const std::vector<double>& values)
{
  std::string text;
  for (const double value : values)
  {
    char number[32];
    std::snprintf(number, sizeof(number), "%.10g", value);
    text.append(text.empty() ? "" : "\\");
    text.append(number);
  }
  return text;
}

/// Preamble, meta information and a data set of explicit VR little endian.
inline std::string DicomBytes(const std::string& storageClass, const std::string& instance,
  const std::string& data)
{
  const std::string meta = Element(2, 1, "OB", std::string("\0\1", 2)) +
    Element(2, 2, "UI", storageClass) + Element(2, 3, "UI", instance) +
    Element(2, 0x10, "UI", "1.2.840.10008.1.2.1");
  std::string file(128, '\0');
  file += "DICM";
  return file + Element(2, 0, "UL", Little(static_cast<std::uint32_t>(meta.size()), 4)) + meta +
    data;
}
}

#endif
