// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Benchmarks_ProjectionTables_h
#define mammoray_Benchmarks_ProjectionTables_h

#include <nlohmann/json.hpp>

#include <string>
#include <vector>

/// What a report of benchmarkProjection says, as tables and as the picture of its rates.
namespace mammoray::benchmarks
{
struct Table
{
  std::string Caption;
  std::vector<std::string> Header;
  /// A row may be shorter than the header: a case that failed says why in one long cell.
  std::vector<std::vector<std::string>> Rows;
};

/// Every example and projector; times in ms, and ratios of one run.
Table CaseTable(const nlohmann::ordered_json& report);

/// The paper's table 1 beside ours, ms.
/// What a realistic unit and refraction add to a plain picture of `breast`, as times and as ratios
/// to it.
Table UnitTable(const nlohmann::ordered_json& report);

Table PublishedTable(const nlohmann::ordered_json& report);

/// Frames per second against resolution and against triangles; no rows where none were measured.
Table RateTable(const nlohmann::ordered_json& report);

std::string Markdown(const Table& table);
std::string Html(const Table& table);
/// Text with the characters that HTML has a use for replaced.
std::string Escaped(const std::string& text);

/**
 * The same rates as the paper's figure 5, SVG: two logarithmic panels, rendering only (lines) and
 * with set-up (dashes). Drawn here since machines that are tried may have neither a display nor
 * Python. Empty where none were measured.
 */
std::string RatePicture(const nlohmann::ordered_json& report);
}

#endif
