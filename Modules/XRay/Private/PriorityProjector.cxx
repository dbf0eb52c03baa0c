// SPDX-License-Identifier: Apache-2.0
#include "Private/PriorityProjector.h"

#include "Grazing.h"
#include "Private/ProjectionChecks.h"
#include "Private/SampleGrid.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/ParallelFor.h"
#include "mammoray/XRay/Beam.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <mutex>

namespace mammoray
{
PriorityProjector::PriorityProjector(std::unique_ptr<PathLengthProjector> projector,
  std::vector<int> priority)
  : Projector(std::move(projector))
  , Priority(std::move(priority))
{
  for (std::size_t n = 0; n < this->Priority.size(); ++n)
  {
    const auto end = this->Priority.begin() + static_cast<std::ptrdiff_t>(n);
    if (this->Priority[n] < 1 || std::find(this->Priority.begin(), end, *end) != end)
    {
      throw InputError("priority: expected materials from 1, each once, found " +
        std::to_string(this->Priority[n]));
    }
  }
}

void PriorityProjector::SetSurface(const SurfaceMesh& surface)
{
  this->Projector->SetSurface(surface);
  this->Tree.reset();
  this->Surface = surface;
  this->Order = this->Priority;
  for (int material = 1; material < surface.NumberOfMaterials(); ++material)
  {
    if (std::find(this->Priority.begin(), this->Priority.end(), material) == this->Priority.end())
    {
      this->Order.push_back(material);
    }
  }
  std::erase_if(this->Order,
    [&](int material) { return material >= this->Surface.NumberOfMaterials(); });
  this->FindOverlaps();
}

void PriorityProjector::UpdatePoints(const std::vector<double>& points)
{
  this->Projector->UpdatePoints(points);
  this->Tree.reset();
  this->Surface.Points = points;
  this->FindOverlaps();
}

void PriorityProjector::FindOverlaps()
{
  this->LastImage.reset();
  this->Tree.emplace(this->Surface);
  this->Overlap = FindOverlap(this->Surface, *this->Tree);
}

PathLengthImage PriorityProjector::Project(const XRaySource& source, const XRayDetector& detector)
{
  this->LastImage.reset();
  PathLengthImage image = this->Projector->Project(source, detector);
  this->Correct(source, detector, {}, image);
  this->LastImage = image;
  return image;
}

PathLengthImage PriorityProjector::Project(const XRaySource& source, const XRayDetector& detector,
  const VectorFields& velocities, PathLengthDerivatives& derivatives)
{
  this->LastImage.reset();
  PathLengthImage image = this->Projector->Project(source, detector, velocities, derivatives);
  this->Correct(source, detector, { &velocities, &derivatives }, image);
  this->LastImage = image;
  return image;
}

std::vector<double> PriorityProjector::Backward(const XRaySource& source,
  const XRayDetector& detector, const std::vector<float>& lossByLength)
{
  this->LastImage.reset();
  CheckGeometry(source, detector);
  const std::size_t pixels = detector.NumberOfPixels();
  const auto materials = static_cast<std::size_t>(this->Surface.NumberOfMaterials());
  LargestLoss(lossByLength, pixels, materials);
  // Pixels that are followed here are none of the other projector's.
  std::vector<float> others = lossByLength;
  std::vector<double> gradient(this->Surface.Points.size(), 0.0);
  std::mutex adding;
  ParallelRanges(this->Overlap.Regions.empty() ? 0 : pixels, 256,
    [&](std::size_t begin, std::size_t end)
    {
      std::vector<LineHit> hits;
      std::vector<double> losses(materials);
      for (std::size_t pixel = begin; pixel < end; ++pixel)
      {
        losses[0] = 0;
        for (std::size_t material = 1; material < materials; ++material)
        {
          losses[material] = lossByLength[material * pixels + pixel];
        }
        RaySums sums;
        sums.Lengths.assign(materials, 0);
        const int good =
          this->SumPixel(source, detector, pixel, { .Losses = losses.data() }, hits, sums);
        for (std::size_t material = 1; good > 0 && material < materials; ++material)
        {
          others[material * pixels + pixel] = 0;
        }
        if (sums.Gradient.empty())
        {
          continue;
        }
        const std::lock_guard lock(adding);
        for (const auto& [point, change] : sums.Gradient)
        {
          for (std::size_t axis = 0; axis < 3; ++axis)
          {
            gradient[3 * std::size_t{ point } + axis] += change[axis] / good;
          }
        }
      }
    });
  const std::vector<double> rest = this->Projector->Backward(source, detector, others);
  std::transform(rest.begin(), rest.end(), gradient.begin(), gradient.begin(), std::plus<>());
  return gradient;
}

std::vector<float> PriorityProjector::Transmission(const Beam& beam)
{
  if (!this->LastImage)
  {
    throw InputError("projector: expected a projection before its transmission, found none");
  }
  return beam.Transmission(*this->LastImage);
}

PriorityProjector::Ray PriorityProjector::RayOf(const XRaySource& source,
  const XRayDetector& detector, double column, double row) const
{
  const Vector3 pixel = detector.Origin + column * detector.ColumnStep + row * detector.RowStep;
  if (source.Type == XRaySource::Kind::Parallel)
  {
    return { pixel, (1 / Norm(source.Direction)) * source.Direction,
      -std::numeric_limits<double>::infinity(), 0 };
  }
  const Vector3 way = pixel - source.Position;
  const double length = Norm(way);
  return { source.Position, (1 / length) * way, 0, length };
}

bool PriorityProjector::PassesRegion(const Ray& ray) const
{
  return std::any_of(this->Overlap.Regions.begin(), this->Overlap.Regions.end(),
    [&](const Box3& box)
    {
      double enter = ray.From;
      double leave = ray.To;
      for (std::size_t axis = 0; axis < 3; ++axis)
      {
        const double slack = 1e-9 * (1 + box.High[axis] - box.Low[axis]);
        const double low = box.Low[axis] - slack - ray.Begin[axis];
        const double high = box.High[axis] + slack - ray.Begin[axis];
        const double way = ray.Direction[axis];
        if (way == 0)
        {
          leave = low > 0 || high < 0 ? -std::numeric_limits<double>::infinity() : leave;
          continue;
        }
        enter = std::max(enter, std::min(low / way, high / way));
        leave = std::min(leave, std::max(low / way, high / way));
      }
      return enter <= leave;
    });
}

/// The material that counts where the ray is inside material m `insides[m]` times.
int PriorityProjector::OwnerOf(const std::vector<int>& insides) const
{
  for (const int material : this->Order)
  {
    if (insides[static_cast<std::size_t>(material)] > 0)
    {
      return material;
    }
  }
  return 0;
}

bool PriorityProjector::AddRay(const Ray& ray, const Work& work, std::vector<LineHit>& hits,
  RaySums& sums) const
{
  this->Tree->CrossLine(ray.Begin, ray.Direction, hits);
  std::vector<int> insides(sums.Lengths.size(), 0);
  RaySums own{ std::vector<double>(sums.Lengths.size(), 0.0),
    std::vector<double>(sums.Rates.size(), 0.0), {} };
  int owner = 0;
  for (const LineHit& hit : hits)
  {
    const auto [left, entered] = MaterialsAt(this->Surface, hit);
    insides[static_cast<std::size_t>(left)] -= 1;
    insides[static_cast<std::size_t>(entered)] += 1;
    const int next = this->OwnerOf(insides);
    if (next == owner)
    {
      continue;
    }
    const double t = std::clamp(hit.T, ray.From, ray.To);
    own.Lengths[static_cast<std::size_t>(owner)] += t;
    own.Lengths[static_cast<std::size_t>(next)] -= t;
    if (t == hit.T && work.Fields() > 0)
    {
      this->AddRates(ray, hit, owner, next, work, own);
    }
    if (t == hit.T && work.Losses)
    {
      this->AddGradient(ray, hit, work.Losses[owner] - work.Losses[next], own);
    }
    owner = next;
  }
  if (std::any_of(insides.begin(), insides.end(), [](int times) { return times != 0; }))
  {
    return false;
  }
  for (std::size_t n = 0; n < own.Lengths.size(); ++n)
  {
    sums.Lengths[n] += own.Lengths[n];
  }
  for (std::size_t n = 0; n < own.Rates.size(); ++n)
  {
    sums.Rates[n] += own.Rates[n];
  }
  sums.Gradient.insert(sums.Gradient.end(), own.Gradient.begin(), own.Gradient.end());
  return true;
}

/// n / (n . d) of a hit; 0 where the triangle has no area.
Vector3 PriorityProjector::SlopeAt(const Ray& ray, const LineHit& hit) const
{
  const Vector3 origin = this->Surface.Corner(hit.Triangle, 0);
  const Vector3 normal = Cross(this->Surface.Corner(hit.Triangle, 1) - origin,
    this->Surface.Corner(hit.Triangle, 2) - origin);
  const double size = Norm(normal);
  if (!(size > 0))
  {
    return { 0, 0, 0 };
  }
  const Vector3 unit = (1 / size) * normal;
  const double cosine = Dot(unit, ray.Direction);
  const double guarded =
    std::copysign(std::max(std::abs(cosine), double{ MAMMORAY_GRAZING_COSINE }), cosine);
  return (1 / guarded) * unit;
}

/// Adds dt/dp = n . v / (n . d) of a hit at which the ray passes from one material to another.
void PriorityProjector::AddRates(const Ray& ray, const LineHit& hit, int left, int entered,
  const Work& work, RaySums& sums) const
{
  const Vector3 slope = this->SlopeAt(ray, hit);
  const std::size_t materials = sums.Lengths.size();
  for (std::size_t field = 0; field < work.Fields(); ++field)
  {
    Vector3 velocity{ 0, 0, 0 };
    for (std::size_t corner = 0; corner < 3; ++corner)
    {
      const std::size_t point = this->Surface.Triangles[3 * std::size_t{ hit.Triangle } + corner];
      const double* at = &(*work.Velocities)[field][3 * point];
      velocity = velocity + hit.Weights[corner] * Vector3{ at[0], at[1], at[2] };
    }
    const double rate = Dot(slope, velocity);
    const std::size_t row = field * materials;
    sums.Rates[row + static_cast<std::size_t>(left)] += rate;
    sums.Rates[row + static_cast<std::size_t>(entered)] -= rate;
  }
}

/// The transpose of AddRates; `loss` is that of the left length less that of the entered one.
void PriorityProjector::AddGradient(const Ray& ray, const LineHit& hit, double loss,
  RaySums& sums) const
{
  const Vector3 slope = loss * this->SlopeAt(ray, hit);
  for (std::size_t corner = 0; corner < 3; ++corner)
  {
    sums.Gradient.emplace_back(this->Surface.Triangles[3 * std::size_t{ hit.Triangle } + corner],
      hit.Weights[corner] * slope);
  }
}

int PriorityProjector::SumPixel(const XRaySource& source, const XRayDetector& detector,
  std::size_t pixel, const Work& work, std::vector<LineHit>& hits, RaySums& sums) const
{
  const auto columns = static_cast<std::size_t>(detector.Columns);
  const std::size_t pixelRow = pixel / columns;
  std::vector<Ray> rays;
  for (const auto& [column, row] : SampleOffsets(detector.Samples))
  {
    rays.push_back(this->RayOf(source, detector, static_cast<double>(pixel % columns) + column,
      static_cast<double>(pixelRow) + row));
  }
  int good = 0;
  if (std::any_of(rays.begin(), rays.end(),
        [this](const Ray& ray) { return this->PassesRegion(ray); }))
  {
    for (const Ray& ray : rays)
    {
      good += this->AddRay(ray, work, hits, sums) ? 1 : 0;
    }
  }
  return good;
}

void PriorityProjector::Correct(const XRaySource& source, const XRayDetector& detector,
  const Work& work, PathLengthImage& image) const
{
  if (this->Overlap.Regions.empty())
  {
    return;
  }
  const auto materials = static_cast<std::size_t>(image.Materials);
  const std::size_t fields = work.Fields();
  const std::size_t pixels = image.NumberOfPixels();
  ParallelRanges(pixels, 256,
    [&](std::size_t begin, std::size_t end)
    {
      std::vector<LineHit> hits;
      RaySums sums;
      for (std::size_t pixel = begin; pixel < end; ++pixel)
      {
        sums.Lengths.assign(materials, 0);
        sums.Rates.assign(materials * fields, 0);
        const int good = this->SumPixel(source, detector, pixel, work, hits, sums);
        for (std::size_t material = 1; good > 0 && material < materials; ++material)
        {
          image.Lengths[material * pixels + pixel] =
            static_cast<float>(sums.Lengths[material] / good);
          for (std::size_t field = 0; field < fields; ++field)
          {
            work.Derivatives->Lengths[(field * materials + material) * pixels + pixel] =
              static_cast<float>(sums.Rates[field * materials + material] / good);
          }
        }
        if (good > 0)
        {
          image.Inconsistent[pixel] = good < detector.Samples * detector.Samples ? 1 : 0;
        }
      }
    });
}
}
