// SPDX-License-Identifier: Apache-2.0
#include "ProjectionTables.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace mammoray::benchmarks
{
namespace
{
using Json = nlohmann::ordered_json;

/// Published with the examples (Maul et al. 2021, RTX 2070 Super): milliseconds per image with
/// set-up and transfer, and rendering only.
struct PublishedTimes
{
  const char* Name;
  double SetUpMs;
  double RenderMs;
};
constexpr PublishedTimes Published[] = { { "test", 310, 0.9 }, { "boxes", 310, 1.4 },
  { "veins", 860, 4.1 }, { "breast", 760, 25 } };

std::string Formatted(const char* format, double value)
{
  std::array<char, 32> text{};
  std::snprintf(text.data(), text.size(), format, value);
  return text.data();
}

/// "12.3", or "-" where it was not measured.
std::string Cell(const Json& row, const std::string& key, const char* format)
{
  const Json::json_pointer pointer("/" + key);
  return row.contains(pointer) ? Formatted(format, row.at(pointer).get<double>()) : "-";
}

std::string Pixels(const Json& row)
{
  return std::to_string(row["columns"].get<int>()) + "x" + std::to_string(row["rows"].get<int>());
}

double FramesPerSecond(const Json& point, bool withSetUp)
{
  return 1e3 /
    (withSetUp ? point["setUpAndFrameMs"].get<double>() : point["frame"]["medianMs"].get<double>());
}

/// One logarithmic panel: where a size and a rate come to lie in the picture.
struct Panel
{
  double Left;
  double LowX, HighX, LowY, HighY; // decimal logarithms
  static constexpr double Top = 30, Width = 430, Height = 260;

  double X(double size) const
  {
    return this->Left + Width * (std::log10(size) - this->LowX) / (this->HighX - this->LowX);
  }
  double Y(double rate) const
  {
    return Top + Height * (this->HighY - std::log10(rate)) / (this->HighY - this->LowY);
  }
};

std::string Line(double x1, double y1, double x2, double y2, const char* colour)
{
  return "<line x1='" + Formatted("%.1f", x1) + "' y1='" + Formatted("%.1f", y1) + "' x2='" +
    Formatted("%.1f", x2) + "' y2='" + Formatted("%.1f", y2) + "' stroke='" + colour + "'/>\n";
}

std::string Text(double x, double y, const char* anchor, const std::string& text)
{
  return "<text x='" + Formatted("%.1f", x) + "' y='" + Formatted("%.1f", y) + "' text-anchor='" +
    anchor + "'>" + Escaped(text) + "</text>\n";
}

/// The lines of full powers of ten, with their figures.
std::string Grid(const Panel& panel, const std::string& title, const std::string& label)
{
  std::string svg;
  const double bottom = Panel::Top + Panel::Height;
  for (double power = std::ceil(panel.LowX); power <= panel.HighX; ++power)
  {
    const double x = panel.X(std::pow(10, power));
    svg += Line(x, Panel::Top, x, bottom, "#ddd");
    svg += Text(x, bottom + 16, "middle", Formatted("1e%.0f", power));
  }
  for (double power = std::ceil(panel.LowY); power <= panel.HighY; ++power)
  {
    const double y = panel.Y(std::pow(10, power));
    svg += Line(panel.Left, y, panel.Left + Panel::Width, y, "#ddd");
    svg += Text(panel.Left - 5, y + 4, "end", Formatted("%g", std::pow(10, power)));
  }
  svg += Text(panel.Left + Panel::Width / 2, Panel::Top - 10, "middle", title);
  svg += Text(panel.Left + Panel::Width / 2, bottom + 34, "middle", label);
  return svg;
}

std::string Curve(const Panel& panel, const Json& points, const std::string& kind, bool withSetUp,
  const char* colour)
{
  std::string line;
  std::string marks;
  for (const Json& point : points)
  {
    const double size = kind == "triangles"
      ? point["triangles"].get<double>()
      : point["columns"].get<double>() * point["rows"].get<double>();
    const std::string x = Formatted("%.1f", panel.X(size));
    const std::string y = Formatted("%.1f", panel.Y(FramesPerSecond(point, withSetUp)));
    line += (line.empty() ? "" : " ") + x + "," + y;
    marks += "<circle cx='" + x + "' cy='" + y + "' r='2.5' fill='" + colour + "'/>\n";
  }
  return "<polyline fill='none' stroke-width='1.5' stroke='" + std::string(colour) +
    (withSetUp ? "' stroke-dasharray='6 4" : "") + "' points='" + line + "'/>\n" + marks;
}
}

Table CaseTable(const Json& report)
{
  Table table{ "The four examples",
    { "example", "method", "triangles", "pixels", "frame, ms", "Embree, ms", "ratio",
      "largest difference, mm", "process to disk, ms", "refit / build",
      "bytes / triangle (with image)", "3 materials / 1", "100 energies / 1",
      "the same on the device", "8 derivatives / none", "holes seen" },
    {} };
  for (const Json& row : report["results"])
  {
    std::vector<std::string> cells{ row["example"].get<std::string>(),
      row["method"].get<std::string>(), std::to_string(row["triangles"].get<int>()), Pixels(row) };
    if (row.contains("error"))
    {
      cells.push_back(row["error"].get<std::string>());
      table.Rows.push_back(cells);
      continue;
    }
    for (const auto& [key, format] : { std::pair{ "frame/medianMs", "%.1f" },
           std::pair{ "embreeFrame/medianMs", "%.1f" }, std::pair{ "embreeRatio", "%.2f" },
           std::pair{ "embreeLargestDifferenceMm", "%.0e" }, std::pair{ "coldStartMs", "%.0f" },
           std::pair{ "refitRatio", "%.2f" }, std::pair{ "bytesPerTriangle", "%.0f" },
           std::pair{ "threeMaterialsRatio", "%.2f" }, std::pair{ "hundredEnergiesRatio", "%.2f" },
           std::pair{ "hundredEnergiesOnDeviceRatio", "%.2f" },
           std::pair{ "eightDerivativesRatio", "%.2f" }, std::pair{ "inconsistent", "%.0f" } })
    {
      cells.push_back(Cell(row, key, format));
    }
    table.Rows.push_back(cells);
  }
  return table;
}

Table UnitTable(const Json& report)
{
  Table table{ "What a unit adds to a picture, and refraction",
    { "example", "method", "pixels", "plain, ms", "heel's field", "scatter and grid",
      "noise and blur", "all of these", "refraction, geometric", "near field" },
    {} };
  for (const Json& row : report["results"])
  {
    if (!row.contains("unit"))
    {
      continue;
    }
    std::vector<std::string> cells{ row["example"].get<std::string>(),
      row["method"].get<std::string>(), Pixels(row), Cell(row, "unit/plain/medianMs", "%.0f") };
    for (const char* work : { "openField", "scatterAndGrid", "noiseAndBlur", "unit",
           "refractionGeometric", "refractionNearField" })
    {
      const std::string key = std::string("unit/") + work;
      cells.push_back(
        Cell(row, key + "/medianMs", "%.0f") + " (" + Cell(row, key + "/ratio", "%.2f") + ")");
    }
    table.Rows.push_back(cells);
  }
  return table;
}

Table PublishedTable(const Json& report)
{
  Table table{ "The paper's table 1 (RTX 2070 Super) beside this machine",
    { "example", "method", "published, with set-up, ms", "here, process to disk, ms",
      "published, rendering only, ms", "here, rendering only, ms",
      "and one picture on the host, ms", "or all path lengths, ms" },
    {} };
  for (const Json& row : report["results"])
  {
    const auto* published = std::find_if(std::begin(Published), std::end(Published),
      [&](const PublishedTimes& times) { return times.Name == row["example"]; });
    if (published != std::end(Published) && !row.contains("error"))
    {
      table.Rows.push_back({ published->Name, row["method"].get<std::string>(),
        Formatted("%.0f", published->SetUpMs), Cell(row, "coldStartMs", "%.0f"),
        Formatted("%.1f", published->RenderMs), Cell(row, "render/medianMs", "%.1f"),
        Cell(row, "picture/medianMs", "%.1f"), Cell(row, "frame/medianMs", "%.1f") });
    }
  }
  return table;
}

Table RateTable(const Json& report)
{
  Table table{ "Frames per second (the paper's figure 5)",
    { "method", "triangles", "pixels", "frames per second, with set-up", "rendering only" }, {} };
  for (const Json& sweep : report["rates"])
  {
    for (const char* kind : { "resolution", "triangles" })
    {
      for (const Json& point : sweep[kind])
      {
        table.Rows.push_back(
          { sweep["method"].get<std::string>(), std::to_string(point["triangles"].get<int>()),
            Pixels(point), Formatted("%.1f", FramesPerSecond(point, true)),
            Formatted("%.1f", FramesPerSecond(point, false)) });
      }
    }
  }
  return table;
}

std::string Markdown(const Table& table)
{
  std::string text = "\n|";
  std::string rule = "|";
  for (const std::string& name : table.Header)
  {
    text += " " + name + " |";
    rule += "---|";
  }
  text += "\n" + rule + "\n";
  for (const std::vector<std::string>& row : table.Rows)
  {
    text += "|";
    for (const std::string& cell : row)
    {
      text += " " + cell + " |";
    }
    text += "\n";
  }
  return text;
}

std::string Escaped(const std::string& text)
{
  std::string escaped;
  for (const char letter : text)
  {
    switch (letter)
    {
      case '&':
        escaped += "&amp;";
        break;
      case '<':
        escaped += "&lt;";
        break;
      case '>':
        escaped += "&gt;";
        break;
      default:
        escaped += letter;
    }
  }
  return escaped;
}

std::string Html(const Table& table)
{
  std::string html = "<h2>" + Escaped(table.Caption) + "</h2>\n<table>\n<tr>";
  for (const std::string& name : table.Header)
  {
    html += "<th>" + Escaped(name) + "</th>";
  }
  html += "</tr>\n";
  for (const std::vector<std::string>& row : table.Rows)
  {
    html += "<tr>";
    for (std::size_t column = 0; column < row.size(); ++column)
    {
      const std::size_t left = table.Header.size() - column;
      const bool reachesOver = column + 1 == row.size() && left > 1;
      html += (reachesOver ? "<td colspan='" + std::to_string(left) + "'>" : "<td>") +
        Escaped(row[column]) + "</td>";
    }
    html += "</tr>\n";
  }
  return html + "</table>\n";
}

std::string RatePicture(const Json& report)
{
  const Json& rates = report["rates"];
  if (rates.empty())
  {
    return {};
  }
  double low = INFINITY;
  double high = 0;
  for (const Json& sweep : rates)
  {
    for (const char* kind : { "resolution", "triangles" })
    {
      for (const Json& point : sweep[kind])
      {
        low = std::min({ low, FramesPerSecond(point, true), FramesPerSecond(point, false) });
        high = std::max({ high, FramesPerSecond(point, true), FramesPerSecond(point, false) });
      }
    }
  }
  const double lowY = std::floor(std::log10(low));
  const double highY = std::ceil(std::log10(high));
  const Panel byPixels{ 60, 3.5, 6.7, lowY, highY };
  const Panel byTriangles{ 560, 2.5, 6.6, lowY, highY };
  std::string svg =
    "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 1010 375' font-family='sans-serif' "
    "font-size='12'>\n<rect width='1010' height='375' fill='white'/>\n";
  const Json& first = rates[0];
  svg += Grid(byPixels,
    std::to_string(first["resolution"][0]["triangles"].get<int>()) +
      " triangles: frames per second",
    "pixels");
  svg +=
    Grid(byTriangles, Pixels(first["triangles"][0]) + " pixels: frames per second", "triangles");
  constexpr std::array colours{ "#1f77b4", "#ff7f0e" };
  // Below the panels, where no curve runs.
  const std::string y = Formatted("%.0f", Panel::Top + Panel::Height + 66);
  double x = 60;
  for (std::size_t index = 0; index < rates.size(); ++index)
  {
    const char* colour = colours.at(index % colours.size());
    for (const bool withSetUp : { false, true })
    {
      svg += Curve(byPixels, rates[index]["resolution"], "resolution", withSetUp, colour);
      svg += Curve(byTriangles, rates[index]["triangles"], "triangles", withSetUp, colour);
      svg += "<line x1='" + Formatted("%.0f", x) + "' x2='" + Formatted("%.0f", x + 30) + "' y1='" +
        y + "' y2='" + y + "' stroke='" + colour +
        (withSetUp ? "' stroke-dasharray='6 4'/>" : "'/>");
      svg += Text(x + 35, Panel::Top + Panel::Height + 70, "start",
        rates[index]["method"].get<std::string>() +
          (withSetUp ? ", with set-up" : ", rendering only"));
      x += 230;
    }
  }
  return svg + "</svg>\n";
}
}
