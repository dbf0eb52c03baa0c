// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_ReportPage_h
#define mammoray_ReportPage_h

#include <string>
#include <utility>
#include <vector>

namespace mammoray
{
/**
 * A whole HTML page around the sections of its body, with its style, its script and nothing to
 * load: its Content-Security-Policy allows pictures that are in it, and that style and script
 * alone. `examination`: names and texts for the head of the page.
 */
std::string PageHtml(const std::string& title, const std::string& subtitle,
  const std::vector<std::pair<std::string, std::string>>& examination, const std::string& body);
}

#endif
