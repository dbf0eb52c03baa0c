// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_ReportPage_h
#define mammoray_ReportPage_h

#include <string>

namespace mammoray
{
/// A whole HTML page, with its style and nothing to load, around the sections of its body.
std::string PageHtml(const std::string& title, const std::string& subtitle,
  const std::string& body);
}

#endif
