// SPDX-License-Identifier: Apache-2.0
#include "mammoray/XRay/OverlapMeasure.h"

#include "Private/ProjectionChecks.h"
#include "mammoray/Foundation/ParallelFor.h"

#include <algorithm>
#include <cstdarg>
#include <cstdio>

namespace mammoray
{
namespace
{
constexpr int MostRaysAcross = 200;
/// Crossings in surfaces of more triangles are searched only if a line meets a contradiction.
constexpr std::size_t MostSearched = 20000;

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

/// Follows rays of up to 200 x 200 pixels and sums up the segments that contradict.
void FollowRays(const SurfaceMesh& surface, const TriangleTree& tree, const XRaySource& source,
  const XRayDetector& detector, OverlapMeasure& measure)
{
  const bool isPoint = source.Type == XRaySource::Kind::Point;
  const auto columns = static_cast<std::size_t>(std::min(detector.Columns, MostRaysAcross));
  const auto rows = static_cast<std::size_t>(std::min(detector.Rows, MostRaysAcross));
  std::vector<std::vector<SurfaceContradiction>> stretches(columns * rows);
  std::vector<unsigned char> isHit(columns * rows);
  ParallelRanges(columns * rows, 64,
    [&](std::size_t begin, std::size_t end)
    {
      std::vector<LineHit> hits;
      for (std::size_t ray = begin; ray < end; ++ray)
      {
        const double column = static_cast<double>(ray % columns);
        const std::size_t line = ray / columns;
        const double u = (column + 0.5) * detector.Columns / static_cast<double>(columns) - 0.5;
        const double v =
          (static_cast<double>(line) + 0.5) * detector.Rows / static_cast<double>(rows) - 0.5;
        const Vector3 pixel = detector.Origin + u * detector.ColumnStep + v * detector.RowStep;
        const Vector3 way = isPoint ? pixel - source.Position : source.Direction;
        const Vector3 direction = (1 / Norm(way)) * way;
        tree.CrossLine(pixel, direction, hits);
        isHit[ray] = hits.empty() ? 0 : 1;
        stretches[ray] = FindContradictions(surface, pixel, direction, hits);
      }
    });
  double sum = 0;
  for (std::size_t ray = 0; ray < stretches.size(); ++ray)
  {
    double length = 0;
    for (const SurfaceContradiction& stretch : stretches[ray])
    {
      length += stretch.LengthMm;
      if (stretch.LengthMm > measure.Longest.LengthMm)
      {
        measure.Longest = stretch;
      }
    }
    measure.Rays += isHit[ray];
    measure.Contradicting += length > 0 ? 1 : 0;
    sum += length;
  }
  measure.MeanMm = measure.Contradicting > 0 ? sum / static_cast<double>(measure.Contradicting) : 0;
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
  ReportProgress(progress, 0, "looking for overlaps");
  const TriangleTree tree(surface);
  const bool isLarge = surface.NumberOfTriangles() > MostSearched;
  if (isLarge)
  {
    FollowRays(surface, tree, source, detector, measure);
  }
  measure.Overlap =
    FindOverlap(surface, tree, ShareOf(progress, 0.1, 0.8), !isLarge || measure.Contradicting > 0);
  if (measure.Overlap.None())
  {
    return {};
  }
  if (!isLarge)
  {
    ReportProgress(progress, 0.8, "measuring overlaps");
    FollowRays(surface, tree, source, detector, measure);
  }
  return measure;
}
}
