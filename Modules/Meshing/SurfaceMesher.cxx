// SPDX-License-Identifier: Apache-2.0
#include "SurfaceMesher.h"

#include "Error.h"
#include "LabelSurface.h"
#include "MeshCheck.h"
#include "MeshRepair.h"
#include "Private/MeshingSteps.h"
#include "Private/TetGen.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <numbers>
#include <numeric>
#include <set>

namespace mammoray
{
#ifdef MAMMORAY_HAS_TETGEN
namespace
{
using Clock = std::chrono::steady_clock;

/// Points at the same place become one, triangles of the same corners too, flat ones go.
TriangleComplex Weld(const SurfaceMesh& surface)
{
  TriangleComplex complex;
  const auto at = [&surface](std::uint32_t id)
  {
    const double* point = &surface.Points[3 * std::size_t{ id }];
    return Vector3{ point[0], point[1], point[2] };
  };
  std::vector<std::uint32_t> order(surface.NumberOfPoints());
  std::iota(order.begin(), order.end(), std::uint32_t{ 0 });
  std::stable_sort(order.begin(), order.end(),
    [&](std::uint32_t a, std::uint32_t b) { return at(a) < at(b); });
  std::vector<std::uint32_t> first(order.size()); // the point of that place with the lowest number
  for (std::size_t n = 0; n < order.size(); ++n)
  {
    const bool same = n > 0 && at(order[n]) == at(order[n - 1]);
    first[order[n]] = same ? first[order[n - 1]] : order[n];
  }
  std::vector<std::uint32_t> newId(order.size(), 0xffffffff);
  std::set<std::array<std::uint32_t, 3>> known;
  for (std::size_t triangle = 0; triangle < surface.NumberOfTriangles(); ++triangle)
  {
    std::array<std::uint32_t, 3> ids{};
    for (int corner = 0; corner < 3; ++corner)
    {
      ids[corner] = first[surface.Triangles[3 * triangle + corner]];
    }
    std::array<std::uint32_t, 3> key = ids;
    std::sort(key.begin(), key.end());
    if (key[0] == key[1] || key[1] == key[2] || !known.insert(key).second)
    {
      continue;
    }
    for (std::uint32_t& id : ids)
    {
      std::uint32_t& fresh = newId[id];
      if (fresh == 0xffffffff)
      {
        fresh = static_cast<std::uint32_t>(complex.Points.size() / 3);
        const Vector3 point = at(id);
        complex.Points.insert(complex.Points.end(), point.begin(), point.end());
      }
      id = fresh;
    }
    complex.Triangles.push_back(ids);
  }
  return complex;
}

/**
 * How often the boundary of each material winds around a point: the sum of its triangles' solid
 * angles over 4 pi (van Oosterom and Strackee, IEEE Trans Biomed Eng 30, 1983). 1 within, 0
 * without.
 */
std::vector<double> WindingNumbers(const SurfaceMesh& surface, const Vector3& point)
{
  std::vector<double> winding(static_cast<std::size_t>(surface.NumberOfMaterials()), 0.0);
  for (std::size_t triangle = 0; triangle < surface.NumberOfTriangles(); ++triangle)
  {
    Vector3 r[3];
    double length[3];
    for (int c = 0; c < 3; ++c)
    {
      const double* at = &surface.Points[3 * std::size_t{ surface.Triangles[3 * triangle + c] }];
      r[c] = Vector3{ at[0], at[1], at[2] } - point;
      length[c] = Norm(r[c]);
    }
    const double numerator = Dot(r[0], Cross(r[1], r[2]));
    const double denominator = length[0] * length[1] * length[2] + Dot(r[0], r[1]) * length[2] +
      Dot(r[1], r[2]) * length[0] + Dot(r[2], r[0]) * length[1];
    const double share = std::atan2(numerator, denominator) / (2 * std::numbers::pi);
    winding[surface.BackMaterials[triangle]] += share;
    winding[surface.FrontMaterials[triangle]] -= share;
  }
  return winding;
}

/// Of the materials around each region the one that encloses least; 0 where there is none.
void NameRegions(const SurfaceMesh& surface, const MeshCheck& check, const MeshingOptions& options,
  std::vector<TetGenRegion>& regions, const ProgressCallback& progress)
{
  for (std::size_t index = 0; index < regions.size(); ++index)
  {
    ReportProgress(progress, 0.3 + 0.1 * static_cast<double>(index) / regions.size(),
      "naming regions");
    TetGenRegion& region = regions[index];
    const std::vector<double> winding = WindingNumbers(surface, region.Inside);
    double least = 0;
    for (const MaterialQuality& material : check.Materials)
    {
      const bool around = winding[static_cast<std::size_t>(material.Material)] > 0.5;
      if (around && (region.Material == 0 || material.VolumeMm3 < least))
      {
        region.Material = material.Material;
        least = material.VolumeMm3;
      }
    }
    const auto own = options.CellSizeOfMaterialMm.find(region.Material);
    const double radius =
      own == options.CellSizeOfMaterialMm.end() ? options.CellSizeMm : own->second;
    // A regular tetrahedron of circumradius R: edge R sqrt(8 / 3), volume edge^3 / sqrt(72).
    region.CellVolumeMm3 = std::pow(radius * std::sqrt(8.0 / 3.0), 3) / std::sqrt(72.0);
  }
}

Vector3 MiddleOf(const TriangleComplex& complex, std::size_t triangle)
{
  Vector3 middle{ 0, 0, 0 };
  for (const std::uint32_t id : complex.Triangles[triangle])
  {
    for (int a = 0; a < 3; ++a)
    {
      middle[a] += complex.Points[3 * std::size_t{ id } + a] / 3;
    }
  }
  return middle;
}

void RefuseCuts(const TriangleComplex& complex)
{
  const std::vector<std::size_t> cutting = FindCuttingTriangles(complex);
  if (!cutting.empty())
  {
    const Vector3 place = MiddleOf(complex, cutting.front());
    char text[200];
    std::snprintf(text, sizeof(text),
      "surfaces: expected triangles that meet at common edges, found %zu that cut others, the "
      "first at (%.2f, %.2f, %.2f) mm",
      cutting.size(), place[0], place[1], place[2]);
    throw InputError(text);
  }
}

TetrahedralMesh Fill(const SurfaceMesh& surface, const TriangleComplex& complex,
  const MeshCheck& check, const MeshingOptions& options, const ProgressCallback& progress,
  std::vector<TetGenRegion>& regions)
{
  ReportProgress(progress, 0.2, "finding regions");
  regions = FindRegions(complex);
  NameRegions(surface, check, options, regions, progress);
  const double dihedral =
    options.OptimisationSeconds > 0 ? std::min(options.SmallestDihedralDeg, 18.0) : 0.0;
  ReportProgress(progress, 0.4, "filling surfaces");
  TetrahedralMesh mesh =
    FillRegions(complex, regions, options.CellRadiusEdgeRatio, dihedral, progress);
  ReportProgress(progress, 0.95, "checking");
  mesh.Validate("mesh of TetGen");
  return mesh;
}

/**
 * Where the corners of a net of quads move to when its stairs are smoothed without shrinking it:
 * steps towards the mean of the neighbours and back by turns (Taubin, SIGGRAPH 1995, with a pass
 * band of 1 / 0.5 - 1 / 0.53), never farther than half a voxel along an axis.
 */
std::vector<double> SmoothPlaces(const QuadMesh& net, const Vector3& spacing, int rounds)
{
  std::vector<Vector3> places = net.Points;
  std::vector<Vector3> sums(places.size());
  std::vector<int> counts(places.size(), 0);
  for (const auto& quad : net.Quads)
  {
    for (const std::uint32_t id : quad)
    {
      counts[id] += 2;
    }
  }
  for (int step = 0; step < 2 * rounds; ++step)
  {
    std::fill(sums.begin(), sums.end(), Vector3{ 0, 0, 0 });
    for (const auto& quad : net.Quads)
    {
      for (std::size_t corner = 0; corner < 4; ++corner)
      {
        sums[quad[corner]] =
          sums[quad[corner]] + places[quad[(corner + 1) % 4]] + places[quad[(corner + 3) % 4]];
      }
    }
    const double factor = step % 2 == 0 ? 0.5 : -0.53;
    for (std::size_t point = 0; point < places.size(); ++point)
    {
      for (std::size_t a = 0; a < 3; ++a)
      {
        const double mean = sums[point][a] / counts[point];
        const double start = net.Points[point][a];
        places[point][a] = std::clamp(places[point][a] + factor * (mean - places[point][a]),
          start - 0.5 * spacing[a], start + 0.5 * spacing[a]);
      }
    }
  }
  std::vector<double> values;
  for (const Vector3& place : places)
  {
    values.insert(values.end(), place.begin(), place.end());
  }
  return values;
}

/**
 * Interfaces of the volume, smoothed as far as they do not cut each other. The smoothing keeps
 * points within their voxel; a tenth less keeps them apart.
 */
SurfaceMesh SmoothInterfaces(const LabelVolume& volume, const MeshingOptions& options,
  const ProgressCallback& progress)
{
  const QuadMesh net = ExtractInterfaces(volume, 0);
  const SurfaceMesh stairs = net.Triangulate(2 * net.Quads.size());
  const std::vector<double> smooth =
    SmoothPlaces(net, volume.Spacing, static_cast<int>(std::lround(10 * options.SmoothingVoxels)));
  SurfaceMesh surface = stairs;
  std::vector<double> share(surface.NumberOfPoints(), 0.9);
  const int mostRounds = 6;
  for (int round = 0;; ++round)
  {
    ReportProgress(progress, 0.05 + 0.02 * round, "smoothing interfaces");
    for (std::size_t value = 0; value < smooth.size(); ++value)
    {
      surface.Points[value] =
        stairs.Points[value] + share[value / 3] * (smooth[value] - stairs.Points[value]);
    }
    TriangleComplex complex{ surface.Points, {} };
    for (std::size_t triangle = 0; triangle < surface.NumberOfTriangles(); ++triangle)
    {
      const std::uint32_t* ids = &surface.Triangles[3 * triangle];
      complex.Triangles.push_back({ ids[0], ids[1], ids[2] });
    }
    const std::vector<std::size_t> cutting = FindCuttingTriangles(complex);
    if (cutting.empty() || round > mostRounds)
    {
      return surface;
    }
    for (const std::size_t triangle : cutting)
    {
      for (const std::uint32_t id : complex.Triangles[triangle])
      {
        share[id] = round + 2 < mostRounds ? 0.5 * share[id] : 0;
      }
    }
    if (round >= mostRounds)
    {
      std::fill(share.begin(), share.end(), 0.0); // the voxels' faces cannot cut each other
    }
  }
}

double Since(Clock::time_point start)
{
  return std::chrono::duration<double>(Clock::now() - start).count();
}
}

bool HasTetGen()
{
  return true;
}

MeshingResult MeshSurfaces(const SurfaceMesh& surfaces, const MeshingOptions& options,
  const ProgressCallback& progress)
{
  const auto start = Clock::now();
  options.Validate();
  const MeshCheck check = CheckSurface(surfaces);
  if (const MeshTrouble* holes = check.Find(MeshTrouble::Kind::Holes))
  {
    throw InputError("surfaces: expected closed ones, found " + holes->Text({}));
  }
  ReportProgress(progress, 0.1, "looking for cuts");
  const TriangleComplex complex = Weld(surfaces);
  RefuseCuts(complex);
  MeshingResult result;
  std::vector<TetGenRegion> regions;
  result.Mesh = Fill(surfaces, complex, check, options, progress, regions);
  MendInterfaces(result.Mesh, options.SmallestDihedralDeg, Within(progress, 0.95, 1.0));
  result.Reports = ReportMaterials({}, result.Mesh);
  for (MaterialReport& report : result.Reports)
  {
    for (const TetGenRegion& region : regions)
    {
      report.VolumeInMm3 += region.Material == report.Material ? region.VolumeMm3 : 0;
    }
  }
  result.Components = static_cast<std::size_t>(std::count_if(regions.begin(), regions.end(),
    [](const TetGenRegion& region) { return region.Material != 0; }));
  result.Seconds = Since(start);
  ReportProgress(progress, 1.0, "filling surfaces");
  return result;
}

MeshingResult MeshMaterialSurfaces(const LabelVolume& materials, const MeshingOptions& options,
  const ProgressCallback& progress)
{
  const auto start = Clock::now();
  options.Validate();
  materials.Validate("volume to mesh");
  ReportProgress(progress, 0.0, "finding components");
  MeshingResult result;
  LabelVolume volume = PrepareVolume(materials, 1);
  result.MergedVoxels = MergeTissue(volume, options.SmallestComponentMm3);
  const LabelComponents found = FindLocatedComponents(volume);
  result.Components = static_cast<std::size_t>(std::count_if(found.Components.begin(),
    found.Components.end(), [](const LabelComponent& c) { return c.Material != 0; }));
  LabelVolume grid = volume; // in the grid frame
  grid.Origin = { 0, 0, 0 };
  grid.Direction = LabelVolume().Direction;
  const SurfaceMesh surface = SmoothInterfaces(grid, options, progress);
  std::vector<TetGenRegion> regions;
  result.Mesh = Fill(surface, Weld(surface), CheckSurface(surface), options, progress, regions);
  FinishMesh(materials, options, result.Mesh, Within(progress, 0.95, 1.0));
  CheckComponents(result.Mesh, volume, found);
  PlaceInVolumeFrame(volume, result.Mesh);
  result.Reports = ReportMaterials(materials, result.Mesh);
  result.Seconds = Since(start);
  ReportProgress(progress, 1.0, "filling surfaces");
  return result;
}
#else
bool HasTetGen()
{
  return false;
}

MeshingResult MeshSurfaces(const SurfaceMesh&, const MeshingOptions&, const ProgressCallback&)
{
  throw InputError("surfaces: this build has no TetGen (MAMMORAY_USE_TETGEN was OFF)");
}

MeshingResult MeshMaterialSurfaces(const LabelVolume&, const MeshingOptions&,
  const ProgressCallback&)
{
  throw InputError("surfaces: this build has no TetGen (MAMMORAY_USE_TETGEN was OFF)");
}
#endif
}
