// SPDX-License-Identifier: Apache-2.0
#include "Private/BreastMark.h"

#include "mammoray/Case/RegisteredBreast.h"
#include "mammoray/Registration/RegistrationTarget.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <numbers>

namespace mammoray
{
namespace
{
/// Points of the ellipse on the receptor, `deviations` of its standard deviations large; gantry x,
/// y.
std::vector<ReceptorPoint> LoopOf(const UncertaintyEllipse& ellipse, const ReceptorPoint& middle,
  const RegistrationTarget& grid, double deviations)
{
  constexpr int Steps = 48;
  const double columnLength = std::hypot(grid.ColumnStep[0], grid.ColumnStep[1]);
  const double rowLength = std::hypot(grid.RowStep[0], grid.RowStep[1]);
  const double turn = ellipse.AngleDeg * std::numbers::pi / 180;
  std::vector<ReceptorPoint> loop;
  for (int step = 0; step < Steps; ++step)
  {
    const double angle = 2 * std::numbers::pi * step / Steps;
    const double major = deviations * ellipse.MajorMm * std::cos(angle);
    const double minor = deviations * ellipse.MinorMm * std::sin(angle);
    const double alongColumns = major * std::cos(turn) - minor * std::sin(turn);
    const double alongRows = major * std::sin(turn) + minor * std::cos(turn);
    loop.push_back({ middle[0] + alongColumns * grid.ColumnStep[0] / columnLength +
        alongRows * grid.RowStep[0] / rowLength,
      middle[1] + alongColumns * grid.ColumnStep[1] / columnLength +
        alongRows * grid.RowStep[1] / rowLength });
  }
  return loop;
}

std::string UncertaintyText(const std::optional<UncertaintyEllipse>& uncertainty)
{
  if (!uncertainty)
  {
    return "uncertainty unknown";
  }
  char text[80];
  std::snprintf(text, sizeof text, "+- %.2f x %.2f mm (1 sd)", uncertainty->MajorMm,
    uncertainty->MinorMm);
  return text;
}

/// Some of the points, the first and the last among them.
std::vector<Vector3> Thinned(const std::vector<Vector3>& curve)
{
  constexpr std::size_t Most = 9;
  std::vector<Vector3> places;
  for (std::size_t place = 0; place < std::min(Most, curve.size()); ++place)
  {
    places.push_back(curve[place * (curve.size() - 1) / (Most - 1)]);
  }
  return places;
}
}

BreastMark::BreastMark(LiveMammogram& live, BreastScene& squeezed, BreastScene& atRest,
  MammogramPane& pane)
  : Live(live)
  , Squeezed(squeezed)
  , AtRest(atRest)
  , Pane(pane)
{
}

void BreastMark::Set(const Vector3& point)
{
  this->Point = point;
  this->Pixel.reset();
}

void BreastMark::Set(const std::array<double, 2>& pixel)
{
  this->Point.reset();
  this->Pixel = pixel;
}

void BreastMark::Clear()
{
  this->Point.reset();
  this->Pixel.reset();
}

void BreastMark::Update()
{
  this->Found.clear();
  if (!this->Point && !this->Pixel)
  {
    this->DrawNothing();
    this->Pane.SetMark({}, {});
    return;
  }
  const RegisteredBreast breast(this->Live.InUnit());
  if (this->Point)
  {
    this->UpdatePoint(breast);
  }
  else
  {
    this->UpdatePixel(breast);
  }
}

void BreastMark::DrawNothing()
{
  this->Squeezed.SetMark({}, {}, {});
  this->AtRest.SetMark({}, {}, {});
}

void BreastMark::UpdatePoint(const RegisteredBreast& breast)
{
  const ImagedPoint imaged = breast.ToMammogram(*this->Point);
  char text[240];
  std::snprintf(text, sizeof text, "(%.1f, %.1f, %.1f) mm in %s; pixel (%.1f, %.1f)%s\n%s",
    (*this->Point)[0], (*this->Point)[1], (*this->Point)[2], imaged.Material.c_str(), imaged.Column,
    imaged.Row, imaged.InImage ? "" : ", beside the picture",
    UncertaintyText(imaged.Uncertainty).c_str());
  this->Draw(breast, { *this->Point }, imaged.Column, imaged.Row);
  this->Found = text;
}

/// The tissues along the X-ray; the uncertainty in its middle.
void BreastMark::UpdatePixel(const RegisteredBreast& breast)
{
  const auto [column, row] = *this->Pixel;
  const std::vector<TissueStretch> stretches = breast.ToVolume(column, row, 1.0);
  char text[240];
  std::snprintf(text, sizeof text, "pixel (%.1f, %.1f): ", column, row);
  this->Found = text;
  std::map<std::string, double> lengths;
  std::vector<Vector3> curve;
  for (const TissueStretch& stretch : stretches)
  {
    lengths[stretch.Material] += stretch.LengthMm;
    curve.insert(curve.end(), stretch.Uncompressed.begin(), stretch.Uncompressed.end());
  }
  if (curve.empty())
  {
    this->Found += "the X-ray misses the breast";
    this->DrawNothing();
    this->Pane.SetMark({ PixelPosition(this->Live.Grid(1), column, row) }, {});
    return;
  }
  for (const auto& [material, length] : lengths)
  {
    std::snprintf(text, sizeof text, "%s %.1f, ", material.c_str(), length);
    this->Found += text;
  }
  this->Found.replace(this->Found.size() - 2, 2, " mm");
  const std::vector<Vector3> places = Thinned(curve);
  this->Found += '\n';
  this->Found += UncertaintyText(breast.ToMammogram(places[places.size() / 2]).Uncertainty);
  this->Draw(breast, places, column, row);
}

/// Points of the breast at rest.
void BreastMark::Draw(const RegisteredBreast& breast, const std::vector<Vector3>& points,
  double column, double row)
{
  constexpr double Deviations[] = { 1, 2 };
  const RegistrationTarget& grid = this->Live.Grid(1);
  const VolumeFromGantry placed = this->Live.Placed();
  const Vector3 source = placed.ToGantry(this->Live.SourcePosition());
  std::vector<Vector3> squeezed;
  std::vector<Loop> squeezedLoops;
  std::vector<Loop> restLoops;
  std::vector<std::vector<ReceptorPoint>> receptorLoops;
  const std::size_t middle = points.size() / 2;
  for (std::size_t index = 0; index < points.size(); ++index)
  {
    const ImagedPoint imaged = breast.ToMammogram(points[index]);
    squeezed.push_back(imaged.Compressed);
    if (!imaged.Uncertainty)
    {
      continue;
    }
    const ReceptorPoint at = PixelPosition(grid, imaged.Column, imaged.Row);
    // From the receptor back to the point's height.
    const double share = 1 - placed.ToGantry(imaged.Compressed)[2] / source[2];
    for (const double deviations : Deviations)
    {
      const std::vector<ReceptorPoint> loop = LoopOf(*imaged.Uncertainty, at, grid, deviations);
      Loop there;
      Loop before;
      for (const auto& [x, y] : loop)
      {
        there.push_back(placed.Point(source + share * (Vector3{ x, y, 0 } - source)));
        // As far from the point as between the plates; the tissue's turn and stretch left out.
        before.push_back(points[index] + there.back() - imaged.Compressed);
      }
      squeezedLoops.push_back(there);
      restLoops.push_back(before);
      if (index == middle)
      {
        receptorLoops.push_back(loop);
      }
    }
  }
  const bool single = points.size() == 1;
  this->Squeezed.SetMark(single ? squeezed : std::vector<Vector3>{}, squeezed, squeezedLoops);
  this->AtRest.SetMark(single ? points : std::vector<Vector3>{}, points, restLoops);
  this->Pane.SetMark({ PixelPosition(grid, column, row) }, receptorLoops);
}
}
