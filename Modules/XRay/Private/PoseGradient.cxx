// SPDX-License-Identifier: Apache-2.0
#include "Private/PoseGradient.h"

#include <array>

namespace mammoray
{
namespace
{
/// An affine function of a place.
struct AffineFunction
{
  double Constant = 0;
  Vector3 Slope{ 0, 0, 0 };
};

/// slope . (x - origin) + constant
AffineFunction FunctionAbout(const Vector3& origin, const Vector3& slope, double constant = 0)
{
  return { constant - Dot(slope, origin), slope };
}

/// Sums over hits of the loss's derivative with respect to a motion of the hit, times an affine
/// function of the hit.
class HitMoments
{
public:
  HitMoments(const std::vector<double>& points, const std::vector<double>& gradient)
  {
    for (std::size_t first = 0; first < points.size(); first += 3)
    {
      for (std::size_t axis = 0; axis < 3; ++axis)
      {
        const double part = gradient[first + axis];
        this->Whole[axis] += part;
        for (std::size_t other = 0; other < 3; ++other)
        {
          this->First[axis][other] += part * points[first + other];
        }
      }
    }
  }

  Vector3 Of(const AffineFunction& function) const
  {
    Vector3 sum = function.Constant * this->Whole;
    for (std::size_t axis = 0; axis < 3; ++axis)
    {
      sum[axis] += Dot(this->First[axis], function.Slope);
    }
    return sum;
  }

private:
  Vector3 Whole{ 0, 0, 0 };
  std::array<Vector3, 3> First{};
};

/// The vectors whose products with a place in the detector's plane, from its origin, are its column
/// and row.
struct PixelAxes
{
  Vector3 Normal;
  Vector3 Column;
  Vector3 Row;

  explicit PixelAxes(const XRayDetector& detector)
    : Normal(Cross(detector.ColumnStep, detector.RowStep))
    , Column((1 / Dot(Normal, Normal)) * Cross(detector.RowStep, Normal))
    , Row((1 / Dot(Normal, Normal)) * Cross(Normal, detector.ColumnStep))
  {
  }
};

/// Adds what the change of the distance from source to pixel adds: (L / |P - S|) d(|P - S|).
void AddDistances(const XRaySource& source, const XRayDetector& detector,
  const PathLengthImage& image, const std::vector<float>& lossByLength, PoseGradient& pose)
{
  const std::size_t pixels = image.NumberOfPixels();
  for (std::size_t pixel = 0; pixel < pixels; ++pixel)
  {
    double loss = 0;
    for (int material = 1; image.Inconsistent[pixel] == 0 && material < image.Materials; ++material)
    {
      loss += double{ lossByLength[static_cast<std::size_t>(material) * pixels + pixel] } *
        image.Material(material)[pixel];
    }
    if (loss == 0)
    {
      continue;
    }
    const auto column = static_cast<double>(pixel % static_cast<std::size_t>(image.Columns));
    const std::size_t rowsBefore = pixel / static_cast<std::size_t>(image.Columns);
    const auto row = static_cast<double>(rowsBefore);
    const Vector3 way =
      detector.Origin + column * detector.ColumnStep + row * detector.RowStep - source.Position;
    const Vector3 change = (loss / Dot(way, way)) * way;
    pose.Source = pose.Source - change;
    pose.Origin = pose.Origin + change;
    pose.ColumnStep = pose.ColumnStep + column * change;
    pose.RowStep = pose.RowStep + row * change;
  }
}
}

PoseGradient PoseGradientOf(const std::vector<double>& points, const std::vector<double>& gradient,
  const XRaySource& source, const XRayDetector& detector, const PathLengthImage& image,
  const std::vector<float>& lossByLength)
{
  const HitMoments hits(points, gradient);
  const PixelAxes axes(detector);
  PoseGradient pose;
  if (source.Type == XRaySource::Kind::Parallel)
  {
    const double length = Norm(source.Direction);
    const Vector3 along = (1 / length) * source.Direction;
    // x = P + t along; the pixel is U . (x - t along - origin).
    const Vector3 distance = (1 / Dot(axes.Normal, along)) * axes.Normal;
    const auto pixelOf = [&](const Vector3& axis)
    { return FunctionAbout(detector.Origin, axis - Dot(axis, along) * distance); };
    pose.Origin = -1.0 * hits.Of({ 1, { 0, 0, 0 } });
    pose.ColumnStep = -1.0 * hits.Of(pixelOf(axes.Column));
    pose.RowStep = -1.0 * hits.Of(pixelOf(axes.Row));
    const Vector3 turned = (-1 / length) * hits.Of(FunctionAbout(detector.Origin, distance));
    pose.Source = turned - Dot(turned, along) * along;
    return pose;
  }
  const Vector3 back = source.Position - detector.Origin;
  const Vector3 share = (-1 / Dot(axes.Normal, back)) * axes.Normal;
  // tau = share . (x - S); the pixel times tau is U . (x - S) + tau U . (S - origin).
  const auto pixelOf = [&](const Vector3& axis)
  { return FunctionAbout(source.Position, axis + Dot(axis, back) * share); };
  pose.Source = -1.0 * hits.Of(FunctionAbout(source.Position, -1.0 * share, 1));
  pose.Origin = -1.0 * hits.Of(FunctionAbout(source.Position, share));
  pose.ColumnStep = -1.0 * hits.Of(pixelOf(axes.Column));
  pose.RowStep = -1.0 * hits.Of(pixelOf(axes.Row));
  AddDistances(source, detector, image, lossByLength, pose);
  return pose;
}
}
