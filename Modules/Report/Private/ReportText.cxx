// SPDX-License-Identifier: Apache-2.0
#include "Private/ReportText.h"

#include "mammoray/Foundation/PoseParameters.h"

#include <cmath>
#include <locale>
#include <sstream>

namespace mammoray
{
std::string NumberText(double value, int digits)
{
  if (!std::isfinite(value))
  {
    return "–";
  }
  std::ostringstream stream;
  stream.imbue(std::locale::classic());
  stream.setf(std::ios::fixed);
  stream.precision(digits);
  stream << value;
  const std::string text = stream.str();
  const bool zero = text.find_first_not_of("-0.") == std::string::npos;
  return text[0] != '-' ? text : (zero ? "" : "−") + text.substr(1);
}

std::string UnitText(const std::string& unit)
{
  return unit == "deg" ? "°" : unit;
}

std::string ParameterTitle(const std::string& name)
{
  for (const PoseParameter& parameter : PoseParameters)
  {
    if (name == parameter.Name)
    {
      return parameter.Title;
    }
  }
  return name;
}

std::string Escape(const std::string& text)
{
  std::string escaped;
  for (const char c : text)
  {
    escaped += c == '&' ? "&amp;"
      : c == '<'        ? "&lt;"
      : c == '>'        ? "&gt;"
      : c == '"'        ? "&quot;"
                        : std::string(1, c);
  }
  return escaped;
}
}
