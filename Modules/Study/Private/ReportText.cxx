// SPDX-License-Identifier: Apache-2.0
#include "Private/ReportText.h"

#include "mammoray/Foundation/PoseParameters.h"

#include "vtkBase64Utilities.h"

#include <cstddef>
#include <vector>

namespace mammoray
{
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

std::string Base64(const std::string& bytes)
{
  std::vector<unsigned char> encoded(bytes.size() / 3 * 4 + 8);
  const unsigned long length =
    vtkBase64Utilities::Encode(reinterpret_cast<const unsigned char*>(bytes.data()),
      static_cast<unsigned long>(bytes.size()), encoded.data());
  return { encoded.begin(), encoded.begin() + static_cast<std::ptrdiff_t>(length) };
}

std::string FigureHtml(const LayeredPicture& picture, const std::string& alt,
  const std::string& title, const std::string& caption)
{
  const std::string size =
    std::to_string(picture.Width) + "\" height=\"" + std::to_string(picture.Height) + "\"";
  std::string html = "<figure><div class=\"layers\"><img alt=\"" + Escape(alt) + "\" width=\"" +
    size + " src=\"data:image/png;base64," + Base64(picture.Png) + "\">";
  if (!picture.Lines.empty())
  {
    html += "<svg class=\"lines\" viewBox=\"0 0 " + std::to_string(picture.Width) + ' ' +
      std::to_string(picture.Height) + "\">\n" + picture.Lines + "</svg>";
  }
  return html + "</div>\n<figcaption><b>" + title + "</b><span>" + caption +
    "</span></figcaption></figure>\n";
}
}
