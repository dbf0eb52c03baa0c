// SPDX-License-Identifier: Apache-2.0
#include "Private/BreastMark.h"

#include "Private/OpenedResult.h"
#include "mammoray/Study/RegisteredBreast.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <numbers>

namespace mammoray
{
namespace
{
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

constexpr double MarkDeviations[] = { 1, 2 };

/// Ellipses around a place: on the receptor, in the compressed breast and at rest.
struct UncertaintyLoops
{
  std::vector<std::vector<ReceptorPoint>> Receptor;
  std::vector<Loop> Compressed;
  std::vector<Loop> Rest;
};

UncertaintyLoops LoopsAround(const LiveMammogram& live, const Vector3& rest,
  const ImagedPoint& imaged)
{
  UncertaintyLoops loops;
  if (!imaged.Uncertainty)
  {
    return loops;
  }
  const VolumeFromGantry placed = live.Placed();
  const Vector3 source = placed.ToGantry(live.SourcePosition());
  const ReceptorGrid& grid = live.Grid(1);
  const ReceptorPoint at = grid.PositionOf(imaged.Column, imaged.Row);
  // From the receptor back to the point's height.
  const double share = 1 - placed.ToGantry(imaged.Compressed)[2] / source[2];
  for (const double deviations : MarkDeviations)
  {
    loops.Receptor.push_back(EllipsePoints(*imaged.Uncertainty, at, grid, deviations));
    Loop& there = loops.Compressed.emplace_back();
    Loop& before = loops.Rest.emplace_back();
    for (const auto& [x, y] : loops.Receptor.back())
    {
      there.push_back(placed.Point(source + share * (Vector3{ x, y, 0 } - source)));
      // As far from the point as between the plates; the tissue's turn and stretch left out.
      before.push_back(rest + there.back() - imaged.Compressed);
    }
  }
  return loops;
}
}

BreastMark::BreastMark(BreastScene& atRest,
  const std::vector<std::unique_ptr<OpenedMammogram>>& mammograms)
  : AtRest(atRest)
  , Mammograms(mammograms)
{
  for (const auto& mammogram : mammograms)
  {
    this->Breast(*mammogram); // so that the first mark need not wait for it
  }
}

void BreastMark::Set(const Vector3& point)
{
  this->Point = point;
  this->Pixel.reset();
}

void BreastMark::Set(const std::array<double, 2>& pixel, std::size_t mammogram)
{
  this->Point.reset();
  this->Pixel = pixel;
  this->PixelOf = mammogram;
}

void BreastMark::Clear()
{
  this->Point.reset();
  this->Pixel.reset();
}

const RegisteredBreast& BreastMark::Breast(const OpenedMammogram& mammogram)
{
  std::shared_ptr<const RegisteredBreast>& known = this->Breasts[&mammogram];
  if (!known)
  {
    known = std::make_shared<const RegisteredBreast>(mammogram.Live.InUnit());
  }
  return *known;
}

void BreastMark::DrawAtRest(const std::vector<Vector3>& point, const std::vector<Vector3>& line,
  const std::vector<Loop>& loops)
{
  this->AtRest.SetMark(point, line, loops);
  this->Lines = loops;
  for (Loop& loop : this->Lines)
  {
    loop.push_back(loop.front());
  }
  this->Lines.push_back(line);
}

void BreastMark::Update(bool moved)
{
  if (moved)
  {
    this->Breasts.clear();
  }
  this->Found.clear();
  this->Centre.reset();
  if (this->Point)
  {
    this->UpdatePoint();
  }
  else if (this->Pixel)
  {
    this->UpdatePixel();
  }
  else
  {
    this->DrawNothing();
  }
}

void BreastMark::DrawNothing()
{
  this->DrawAtRest({}, {}, {});
  for (const auto& each : this->Mammograms)
  {
    OpenedMammogram& mammogram = *each;
    mammogram.Squeezed.SetMark({}, {}, {});
    mammogram.Pane.SetMark({}, {});
  }
}

void BreastMark::UpdatePoint()
{
  char text[240];
  for (const auto& each : this->Mammograms)
  {
    OpenedMammogram& mammogram = *each;
    const RegisteredBreast& breast = this->Breast(mammogram);
    const ImagedPoint imaged = breast.ToMammogram(*this->Point);
    if (this->Found.empty())
    {
      std::snprintf(text, sizeof text, "(%.1f, %.1f, %.1f) mm in %s", (*this->Point)[0],
        (*this->Point)[1], (*this->Point)[2], imaged.Material.c_str());
      this->Found = text;
    }
    std::snprintf(text, sizeof text, "%spixel (%.1f, %.1f)%s, %s", mammogram.Prefix().c_str(),
      imaged.Column, imaged.Row, imaged.InImage ? "" : ", beside the picture",
      UncertaintyText(imaged.Uncertainty).c_str());
    this->Found += "\n";
    this->Found += text;
    const UncertaintyLoops loops = LoopsAround(mammogram.Live, *this->Point, imaged);
    mammogram.Squeezed.SetMark({ imaged.Compressed }, { imaged.Compressed }, loops.Compressed);
    mammogram.Pane.SetMark({ mammogram.Live.Grid(1).PositionOf(imaged.Column, imaged.Row) },
      loops.Receptor);
    this->DrawAtRest({ *this->Point }, { *this->Point }, loops.Rest);
  }
  this->Centre = this->Point;
}

/// The tissues along the X-ray; the uncertainty in its middle.
void BreastMark::UpdatePixel()
{
  OpenedMammogram& marked = *this->Mammograms[this->PixelOf];
  const auto [column, row] = *this->Pixel;
  const RegisteredBreast& breast = this->Breast(marked);
  const std::vector<RaySegment> stretches = breast.ToVolume(column, row, 1.0);
  char text[240];
  std::snprintf(text, sizeof text, "%spixel (%.1f, %.1f): ", marked.Prefix().c_str(), column, row);
  this->Found = text;
  std::map<std::string, double> lengths;
  std::vector<Vector3> curve;
  for (const RaySegment& stretch : stretches)
  {
    lengths[stretch.Material] += stretch.LengthMm;
    curve.insert(curve.end(), stretch.Uncompressed.begin(), stretch.Uncompressed.end());
  }
  if (curve.empty())
  {
    this->Found += "the X-ray misses the breast";
    this->DrawNothing();
    marked.Pane.SetMark({ marked.Live.Grid(1).PositionOf(column, row) }, {});
    return;
  }
  for (const auto& [material, length] : lengths)
  {
    std::snprintf(text, sizeof text, "%s %.1f, ", material.c_str(), length);
    this->Found += text;
  }
  this->Found.replace(this->Found.size() - 2, 2, " mm");
  const std::vector<Vector3> places = Thinned(curve);
  this->Centre = curve[curve.size() / 2];
  this->Found += '\n';
  this->Found += UncertaintyText(breast.ToMammogram(places[places.size() / 2]).Uncertainty);
  for (const auto& each : this->Mammograms)
  {
    OpenedMammogram& mammogram = *each;
    if (&mammogram == &marked)
    {
      this->DrawLine(mammogram, breast, places, true);
    }
    else
    {
      this->DrawLine(mammogram, this->Breast(mammogram), places, false);
    }
  }
}

/// Points of the breast at rest, along the ray of a pixel of this mammogram or of another.
void BreastMark::DrawLine(OpenedMammogram& mammogram, const RegisteredBreast& breast,
  const std::vector<Vector3>& places, bool ofPixel)
{
  std::vector<Vector3> squeezed;
  std::vector<Loop> squeezedLoops;
  std::vector<Loop> restLoops;
  std::vector<ReceptorPoint> seen;
  std::vector<std::vector<ReceptorPoint>> receptorLoops;
  for (std::size_t index = 0; index < places.size(); ++index)
  {
    const ImagedPoint imaged = breast.ToMammogram(places[index]);
    squeezed.push_back(imaged.Compressed);
    seen.push_back(mammogram.Live.Grid(1).PositionOf(imaged.Column, imaged.Row));
    const UncertaintyLoops loops = LoopsAround(mammogram.Live, places[index], imaged);
    squeezedLoops.insert(squeezedLoops.end(), loops.Compressed.begin(), loops.Compressed.end());
    restLoops.insert(restLoops.end(), loops.Rest.begin(), loops.Rest.end());
    if (index == places.size() / 2)
    {
      receptorLoops = loops.Receptor;
    }
  }
  mammogram.Squeezed.SetMark({}, squeezed, squeezedLoops);
  if (ofPixel)
  {
    const ReceptorGrid& grid = mammogram.Live.Grid(1);
    mammogram.Pane.SetMark({ grid.PositionOf((*this->Pixel)[0], (*this->Pixel)[1]) },
      receptorLoops);
    this->DrawAtRest({}, places, restLoops);
  }
  else
  {
    // In the middle of the line, as far as it may lie off to the sides.
    mammogram.Pane.SetMark({}, receptorLoops, seen);
  }
}
}
