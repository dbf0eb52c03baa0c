// SPDX-License-Identifier: Apache-2.0
#include "mammoray/XRay/Shadow.h"

#include "mammoray/Foundation/Numbers.h"
#include "mammoray/XRay/Exposure.h"
#include "mammoray/XRay/Scene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <vector>

namespace mammoray
{
namespace
{
/// A point in homogeneous coordinates of the detector: its shadow lies at (Column, Row) / Depth.
/// Depth is positive before the source (1 of parallel rays), Gap is not negative before the
/// detector; both are affine functions of the point.
using ShadowPoint = std::array<double, 4>;

/// A half-space, in which the product with it is not negative.
using HalfSpace = std::array<double, 4>;

double Product(const HalfSpace& space, const ShadowPoint& point)
{
  double sum = 0;
  for (std::size_t index = 0; index < 4; ++index)
  {
    sum += space[index] * point[index];
  }
  return sum;
}

/// The part of a convex polygon in the half-space (Sutherland and Hodgman 1974).
void Clip(const HalfSpace& space, std::vector<ShadowPoint>& polygon)
{
  std::vector<ShadowPoint> kept;
  for (std::size_t index = 0; index < polygon.size(); ++index)
  {
    const ShadowPoint& here = polygon[index];
    const ShadowPoint& next = polygon[(index + 1) % polygon.size()];
    const double a = Product(space, here);
    const double b = Product(space, next);
    if (a >= 0)
    {
      kept.push_back(here);
    }
    if ((a < 0) != (b < 0))
    {
      ShadowPoint between;
      for (std::size_t axis = 0; axis < 4; ++axis)
      {
        between[axis] = here[axis] + a / (a - b) * (next[axis] - here[axis]);
      }
      kept.push_back(between);
    }
  }
  polygon = std::move(kept);
}

/// The area of its shadow, pixels.
double AreaOf(const std::vector<ShadowPoint>& polygon)
{
  double twice = 0;
  for (std::size_t index = 2; index < polygon.size(); ++index)
  {
    const auto at = [&](std::size_t corner, std::size_t axis)
    { return polygon[corner][axis] / polygon[corner][2] - polygon[0][axis] / polygon[0][2]; };
    twice += at(index - 1, 0) * at(index, 1) - at(index - 1, 1) * at(index, 0);
  }
  return std::abs(twice) / 2;
}

/// From points to homogeneous coordinates of the detector.
class ShadowCaster
{
public:
  ShadowCaster(const XRaySource& source, const XRayDetector& detector)
    : IsPoint(source.Type == XRaySource::Kind::Point)
    , Source(source.Position)
    , Origin(detector.Origin)
  {
    const Vector3 across = Cross(detector.ColumnStep, detector.RowStep);
    const double area2 = Dot(across, across);
    this->Column = (1 / area2) * Cross(detector.RowStep, across);
    this->Row = (1 / area2) * Cross(across, detector.ColumnStep);
    const Vector3 way = this->IsPoint ? detector.Origin - source.Position : source.Direction;
    this->Depth = (1 / Dot(across, way)) * across;
    this->Direction = source.Direction;
  }

  ShadowPoint operator()(const Vector3& point) const
  {
    if (!this->IsPoint)
    {
      const double gap = Dot(this->Depth, this->Origin - point);
      const Vector3 hit = point + gap * this->Direction - this->Origin;
      return { Dot(this->Column, hit), Dot(this->Row, hit), 1, gap };
    }
    const Vector3 from = point - this->Source;
    const double depth = Dot(this->Depth, from);
    const Vector3 way = this->Source - this->Origin;
    return { depth * Dot(this->Column, way) + Dot(this->Column, from),
      depth * Dot(this->Row, way) + Dot(this->Row, from), depth, 1 - depth };
  }

private:
  const bool IsPoint;
  const Vector3 Source;
  const Vector3 Origin;
  Vector3 Direction{};
  /// Dual to the detector's steps.
  Vector3 Column{};
  Vector3 Row{};
  Vector3 Depth{};
};

/// A unit in which the file's numbers may be: one that makes the shadow fit.
std::string OtherUnit(double widthMm, double pixels, double field)
{
  const std::pair<const char*, double> units[] = { { "metres", 1000 }, { "inches", 25.4 },
    { "centimetres", 10 }, { "micrometres", 1e-3 } };
  const bool isSmall = pixels < 2;
  const bool isLarge = pixels > 20 * field;
  for (const auto& [name, scale] : units)
  {
    const double scaled = scale * pixels;
    if ((isSmall || isLarge) && scaled >= 2 && scaled <= 5 * field)
    {
      return "; " + NumberText(widthMm) + " mm wide: a file in " + name + "?";
    }
  }
  return {};
}
}

Shadow MeasureShadow(const SurfaceMesh& surface, const XRaySource& source,
  const XRayDetector& detector)
{
  Shadow shadow;
  const ShadowCaster cast(source, detector);
  const double columns = detector.Columns - 0.5;
  const double rows = detector.Rows - 0.5;
  constexpr double leastDepth = 1e-6; // of the way from source to detector
  const HalfSpace beforeSource{ 0, 0, 1, 0 };
  const std::array<HalfSpace, 5> seen{ { { 0, 0, 0, 1 }, { 1, 0, 0.5, 0 }, { -1, 0, columns, 0 },
    { 0, 1, 0.5, 0 }, { 0, -1, rows, 0 } } };
  std::array<Extent, 3> extents;
  double all = 0;
  double onPixels = 0;
  std::vector<ShadowPoint> polygon;
  for (std::size_t triangle = 0; triangle < surface.NumberOfTriangles(); ++triangle)
  {
    if (surface.FrontMaterials[triangle] == surface.BackMaterials[triangle])
    {
      continue;
    }
    shadow.HasMaterial = true;
    polygon.clear();
    for (std::size_t corner = 0; corner < 3; ++corner)
    {
      const Vector3 point = surface.Corner(triangle, corner);
      for (std::size_t axis = 0; axis < 3; ++axis)
      {
        extents[axis].Add(point[axis]);
      }
      polygon.push_back(cast(point));
      polygon.back()[2] -= leastDepth;
    }
    Clip(beforeSource, polygon);
    for (ShadowPoint& point : polygon)
    {
      point[2] += leastDepth;
      shadow.Columns.Add(point[0] / point[2]);
      shadow.Rows.Add(point[1] / point[2]);
    }
    shadow.IsBeforeSource = shadow.IsBeforeSource || !polygon.empty();
    all += AreaOf(polygon);
    for (std::size_t space = 0; space < seen.size() && !polygon.empty(); ++space)
    {
      Clip(seen[space], polygon);
      shadow.IsBeforeDetector = shadow.IsBeforeDetector || (space == 0 && !polygon.empty());
    }
    onPixels += AreaOf(polygon);
  }
  shadow.Share = all > 0 ? std::min(onPixels / all, 1.0) : 0;
  for (const Extent& extent : extents)
  {
    shadow.WidthMm = std::max(shadow.WidthMm, extent.High - extent.Low);
  }
  return shadow;
}

std::string Shadow::Reason(const XRayDetector& detector) const
{
  if (!this->HasMaterial)
  {
    return "every triangle has the same material on both sides; are all regions 0?";
  }
  if (!this->IsBeforeSource)
  {
    return "the object lies behind the source";
  }
  if (!this->IsBeforeDetector)
  {
    return "the object lies behind the detector";
  }
  const double wide = this->Columns.High - this->Columns.Low;
  const double high = this->Rows.High - this->Rows.Low;
  char text[200];
  std::snprintf(text, sizeof text,
    "the object's shadow reaches from column %.4g to %.4g and row %.4g to %.4g of %d x %d pixels",
    this->Columns.Low, this->Columns.High, this->Rows.Low, this->Rows.High, detector.Columns,
    detector.Rows);
  return text +
    OtherUnit(this->WidthMm, std::max(wide, high), std::max(detector.Columns, detector.Rows));
}

std::string ShadowWarning(const Scene& scene, const Exposure& exposure, bool wantsAll)
{
  const std::vector<float>& lengths = exposure.Lengths->Lengths;
  const bool isEmpty =
    std::none_of(lengths.begin(), lengths.end(), [](float length) { return length != 0; });
  const bool isLine = scene.Detector.Columns == 1 || scene.Detector.Rows == 1;
  if (!isEmpty && (!wantsAll || isLine))
  {
    return {};
  }
  const Shadow shadow = MeasureShadow(*Assemble(scene), scene.Source, scene.Detector);
  if (isEmpty)
  {
    return "the picture is empty: " + shadow.Reason(scene.Detector);
  }
  if (shadow.Share >= 1 - 1e-6)
  {
    return {};
  }
  char share[32];
  std::snprintf(share, sizeof share, "%.3g %%", 100 * shadow.Share);
  return std::string(share) +
    " of the shadow falls on the detector: " + shadow.Reason(scene.Detector);
}
}
