// SPDX-License-Identifier: Apache-2.0
#include "mammoray/XRay/OverlapMeasure.h"

#include "Private/LineBundle.h"
#include "Private/ProjectionChecks.h"

#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <cstdio>

namespace mammoray
{
namespace
{
constexpr int MostRaysAcross = 200;
/// Surfaces of more triangles are searched where lines through them meet contradictions only.
constexpr std::size_t MostSearched = 20000;
/// Lines through triangles of all parts, and those that are worth it of one.
constexpr std::size_t PartLines = 40000;
constexpr std::size_t LinesPerPart = 8;

__attribute__((format(printf, 1, 2))) std::string Text(const char* format, ...)
{
  char text[240];
  va_list arguments;
  va_start(arguments, format);
  std::vsnprintf(text, sizeof(text), format, arguments);
  va_end(arguments);
  return text;
}

std::string At(const Vector3& place)
{
  return Text("(%.4g, %.4g, %.4g) mm", place[0], place[1], place[2]);
}

std::string NamesOf(const std::vector<int>& materials, const std::vector<std::string>& names)
{
  std::string text;
  for (const int material : materials)
  {
    const auto m = static_cast<std::size_t>(material);
    text += text.empty() ? "" : " in ";
    text += m < names.size() ? names[m] : "material " + std::to_string(material);
  }
  return text;
}

/// Those of up to 200 x 200 pixels, row by row.
std::vector<CrossingLine> RaysOf(const XRaySource& source, const XRayDetector& detector)
{
  const int columns = std::min(detector.Columns, MostRaysAcross);
  const int rows = std::min(detector.Rows, MostRaysAcross);
  std::vector<CrossingLine> rays;
  rays.reserve(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows));
  for (int row = 0; row < rows; ++row)
  {
    for (int column = 0; column < columns; ++column)
    {
      const double u = (column + 0.5) * detector.Columns / columns - 0.5;
      const double v = (row + 0.5) * detector.Rows / rows - 0.5;
      rays.push_back(
        LineThrough(source, detector.Origin + u * detector.ColumnStep + v * detector.RowStep));
    }
  }
  return rays;
}

/// Whether neither the rays nor lines from the source through every part meet a contradiction.
bool LooksSound(const SurfaceMesh& surface, const XRaySource& source,
  std::vector<CrossingLine> lines)
{
  const auto sample = SampleParts(surface, PartLines, LinesPerPart);
  if (!sample)
  {
    return false;
  }
  for (const std::uint32_t triangle : *sample)
  {
    Vector3 sum{ 0, 0, 0 };
    for (std::size_t corner = 0; corner < 3; ++corner)
    {
      const double* at =
        &surface.Points[3 * std::size_t{ surface.Triangles[3 * std::size_t{ triangle } + corner] }];
      sum = sum + Vector3{ at[0], at[1], at[2] };
    }
    lines.push_back(LineThrough(source, (1.0 / 3) * sum));
  }
  return !AnyContradiction(surface, source, lines).value_or(true);
}
}

std::string OverlapMeasure::Warning(const std::vector<std::string>& names) const
{
  if (this->Overlap.None())
  {
    return {};
  }
  std::string text;
  if (this->Overlap.Crossings > 0)
  {
    text +=
      Text("%zu pairs of triangles cross each other, the first at ", this->Overlap.Crossings) +
      At(this->Overlap.CrossingPlaces.front());
  }
  if (this->Overlap.DoubledParts + this->Overlap.NegativeParts > 0)
  {
    const SurfaceContradiction& first = this->Overlap.Contradictions.front();
    text += text.empty() ? "" : "; ";
    text += Text("%zu parts lie in others though their labels say air, %zu are inside out, the "
                 "first at ",
              this->Overlap.DoubledParts, this->Overlap.NegativeParts) +
      At(first.Place);
    const std::string inside = NamesOf(first.Materials, names);
    text += inside.empty() ? "" : " (" + inside + ")";
  }
  if (this->Contradicting == 0)
  {
    return text + "; no ray of this image is changed by it";
  }
  const double percent =
    100.0 * static_cast<double>(this->Contradicting) / static_cast<double>(this->Rays);
  return text + Text(percent < 10 ? "; %.2g" : "; %.0f", percent) +
    Text(" %% of the rays through the surface count %.3g mm on average twice or negatively",
      this->MeanMm) +
    Text(", the longest stretch %.3g mm at ", this->Longest.LengthMm) + At(this->Longest.Place);
}

OverlapMeasure MeasureOverlap(const SurfaceMesh& surface, const XRaySource& source,
  const XRayDetector& detector, const ProgressCallback& progress)
{
  CheckGeometry(source, detector);
  OverlapMeasure measure;
  const std::vector<CrossingLine> rays = RaysOf(source, detector);
  ReportProgress(progress, 0, "looking for overlaps");
  if (surface.NumberOfTriangles() > MostSearched && LooksSound(surface, source, rays))
  {
    return measure;
  }
  const TriangleTree tree(surface);
  measure.Overlap = FindOverlap(surface, tree, ShareOf(progress, 0.1, 0.7));
  if (measure.Overlap.None())
  {
    return measure;
  }
  ReportProgress(progress, 0.7, "measuring overlaps");
  std::vector<LineHit> hits;
  double sum = 0;
  for (const CrossingLine& ray : rays)
  {
    tree.CrossLine(ray.Begin(), ray.Direction(), hits);
    double length = 0;
    for (const SurfaceContradiction& stretch :
      FindContradictions(surface, ray.Begin(), ray.Direction(), hits))
    {
      length += stretch.LengthMm;
      if (stretch.LengthMm > measure.Longest.LengthMm)
      {
        measure.Longest = stretch;
      }
    }
    measure.Rays += hits.empty() ? 0 : 1;
    measure.Contradicting += length > 0 ? 1 : 0;
    sum += length;
  }
  measure.MeanMm = measure.Contradicting > 0 ? sum / static_cast<double>(measure.Contradicting) : 0;
  return measure;
}
}
