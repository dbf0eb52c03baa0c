// SPDX-License-Identifier: Apache-2.0
#include "mammoray/XRay/Shadow.h"

#include "mammoray/Foundation/Numbers.h"
#include "mammoray/XRay/Exposure.h"
#include "mammoray/XRay/Scene.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <utility>
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

/// "part 2 (Al)", the second sample.
std::string PartName(const Scene& scene, std::size_t index)
{
  const int material = scene.Samples[index].Material;
  const std::vector<Material>& materials = scene.Materials.Materials;
  return "part " + std::to_string(index + 1) +
    (material > 0 ? " (" + materials[static_cast<std::size_t>(material)].Name + ")"
                  : std::string());
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
      shadow.Box.Add(point);
      polygon.push_back(cast(point));
      shadow.IsBehindSource = shadow.IsBehindSource || polygon.back()[2] < -leastDepth;
      shadow.IsBehindDetector = shadow.IsBehindDetector || polygon.back()[3] < -leastDepth;
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
    shadow.AreaPixels += AreaOf(polygon);
    for (std::size_t space = 0; space < seen.size() && !polygon.empty(); ++space)
    {
      Clip(seen[space], polygon);
      shadow.IsBeforeDetector = shadow.IsBeforeDetector || (space == 0 && !polygon.empty());
    }
    shadow.SeenPixels += AreaOf(polygon);
  }
  shadow.HoldsSource = source.Type == XRaySource::Kind::Point && shadow.HasMaterial;
  for (std::size_t axis = 0; axis < 3; ++axis)
  {
    shadow.HoldsSource = shadow.HoldsSource && source.Position[axis] > shadow.Box.Low[axis] &&
      source.Position[axis] < shadow.Box.High[axis];
  }
  return shadow;
}

double Shadow::Share() const
{
  return this->AreaPixels > 0 ? std::min(this->SeenPixels / this->AreaPixels, 1.0) : 0;
}

double Shadow::WidthPixels() const
{
  return std::max({ this->Columns.Length(), this->Rows.Length(), 0.0 });
}

void Shadow::Add(const Shadow& other)
{
  this->AreaPixels += other.AreaPixels;
  this->SeenPixels += other.SeenPixels;
  for (const auto& [mine, added] :
    { std::pair{ &this->Columns, &other.Columns }, std::pair{ &this->Rows, &other.Rows } })
  {
    mine->Low = std::min(mine->Low, added->Low);
    mine->High = std::max(mine->High, added->High);
  }
  this->Box.Add(other.Box);
  this->HasMaterial = this->HasMaterial || other.HasMaterial;
  this->IsBeforeSource = this->IsBeforeSource || other.IsBeforeSource;
  this->IsBeforeDetector = this->IsBeforeDetector || other.IsBeforeDetector;
  this->IsBehindSource = this->IsBehindSource || other.IsBehindSource;
  this->IsBehindDetector = this->IsBehindDetector || other.IsBehindDetector;
  this->HoldsSource = this->HoldsSource || other.HoldsSource;
}

std::string Shadow::Reason(const XRayDetector& detector, const std::string& subject) const
{
  if (!this->HasMaterial)
  {
    return "every triangle has the same material on both sides; are all regions 0?";
  }
  if (!this->IsBeforeSource)
  {
    return subject + " lies behind the source";
  }
  if (!this->IsBeforeDetector)
  {
    return subject + " lies behind the detector";
  }
  double widthMm = 0;
  for (std::size_t axis = 0; axis < 3; ++axis)
  {
    widthMm = std::max(widthMm, this->Box.High[axis] - this->Box.Low[axis]);
  }
  const int field = std::max(detector.Columns, detector.Rows);
  // Near the source the shadow is endless, so that its range tells nothing.
  if (this->HoldsSource || this->IsBehindSource)
  {
    return (this->HoldsSource ? "the source lies within the box around " + subject
                              : subject + " lies in part behind the source") +
      OtherUnit(widthMm, widthMm / Norm(detector.ColumnStep), field);
  }
  const bool isWithin = this->Columns.Low >= -0.5 && this->Columns.High <= detector.Columns - 0.5 &&
    this->Rows.Low >= -0.5 && this->Rows.High <= detector.Rows - 0.5;
  std::string behind =
    this->IsBehindDetector ? subject + " lies in part behind the detector's plane" : std::string();
  if (this->IsBehindDetector && isWithin)
  {
    return behind;
  }
  char text[200];
  std::snprintf(text, sizeof text,
    "'s shadow reaches from column %.4g to %.4g and row %.4g to %.4g of %d x %d pixels",
    this->Columns.Low, this->Columns.High, this->Rows.Low, this->Rows.High, detector.Columns,
    detector.Rows);
  return behind + (behind.empty() ? "" : "; ") + subject + text +
    OtherUnit(widthMm, this->WidthPixels(), field);
}

std::string ShadowWarning(const Scene& scene, const Exposure& exposure, bool wantsAll)
{
  const std::vector<float>& lengths = exposure.Lengths->Lengths;
  const bool isEmpty =
    std::none_of(lengths.begin(), lengths.end(), [](float length) { return length != 0; });
  const bool isLine = scene.Detector.Columns == 1 || scene.Detector.Rows == 1;
  const bool areSeveral = scene.Samples.size() > 1;
  if (!isEmpty && !areSeveral && (!wantsAll || isLine))
  {
    return {};
  }
  std::string lines;
  const auto add = [&lines](const std::string& line)
  { lines += (lines.empty() ? "" : "\n") + line; };
  Shadow seen;
  for (std::size_t index = 0; index < scene.Samples.size(); ++index)
  {
    Scene alone;
    alone.Materials = scene.Materials;
    alone.Samples = { scene.Samples[index] };
    const Shadow shadow = MeasureShadow(*Assemble(alone), scene.Source, scene.Detector);
    const std::string subject = areSeveral ? PartName(scene, index) : std::string("the object");
    const bool isBetween = shadow.IsBeforeSource && shadow.IsBeforeDetector;
    if (areSeveral && shadow.HasMaterial && shadow.SeenPixels <= 0 && !(isLine && isBetween))
    {
      add("nothing is seen of " + subject + ": " + shadow.Reason(scene.Detector, "the part"));
      continue;
    }
    if (!isEmpty && !isLine && wantsAll && shadow.WidthPixels() < 1)
    {
      add(shadow.Reason(scene.Detector, subject));
    }
    seen.Add(shadow);
  }
  const bool isBetween =
    seen.HasMaterial && !seen.HoldsSource && !seen.IsBehindSource && !seen.IsBehindDetector;
  if (isEmpty && lines.empty() && isBetween && seen.Share() > 0.5 && seen.Columns.Length() >= 2 &&
    seen.Rows.Length() >= 2)
  {
    return "the picture is empty, though the object's shadow falls on the detector: its triangles "
           "enclose nothing, as a check of the mesh tells, or it is thinner than a pixel";
  }
  if (isEmpty)
  {
    return "the picture is empty: " + (lines.empty() ? seen.Reason(scene.Detector) : lines);
  }
  if (wantsAll && !isLine && seen.HasMaterial && seen.Share() < 1 - 1e-6)
  {
    char share[64] = "";
    // What lies behind the source or the detector has no shadow that could be counted.
    if (isBetween)
    {
      std::snprintf(share, sizeof share,
        "%.3g %% of the shadow falls on the detector: ", 100 * seen.Share());
    }
    add(share + seen.Reason(scene.Detector));
  }
  return lines;
}
}
