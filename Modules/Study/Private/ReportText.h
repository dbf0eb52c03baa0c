// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_ReportText_h
#define mammoray_ReportText_h

#include "mammoray/Foundation/Numbers.h"
#include "mammoray/Study/LayeredPicture.h"

#include <string>

namespace mammoray
{
/// The unit of a parameter as people write it.
std::string UnitText(const std::string& unit);

/// What a parameter of the search is called in a sentence.
std::string ParameterTitle(const std::string& name);

/// The text with HTML's own characters as entities.
std::string Escape(const std::string& text);

/// Bytes as base64.
std::string Base64(const std::string& bytes);

/// A figure that holds its picture: `alt` in words, title and caption as HTML.
std::string FigureHtml(const LayeredPicture& picture, const std::string& alt,
  const std::string& title, const std::string& caption);
}

#endif
