// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Meshing/SurfaceMesher.h"

#include "Private/EditableMesh.h"
#include "Private/MeshingSteps.h"
#include "Private/TetGen.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/TriangleTree.h"
#include "mammoray/Meshing/MeshCheck.h"

#include <algorithm>
#include <chrono>
#include <numeric>
#include <set>

namespace mammoray
{
#ifdef MAMMORAY_HAS_TETGEN
namespace
{
using Clock = std::chrono::steady_clock;

/// Merges coinciding points and triangles and removes degenerate triangles.
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

/// Winding number of the boundary of each material around a point: 1 inside, 0 outside.
std::vector<int> WindingNumbers(const SurfaceMesh& surface, const TriangleTree& tree,
  const Vector3& point)
{
  std::vector<LineHit> hits;
  tree.CrossLine(point, { 1, 0, 0 }, hits);
  std::vector<int> winding(static_cast<std::size_t>(surface.NumberOfMaterials()), 0);
  for (const LineHit& hit : hits)
  {
    if (hit.T > 0)
    {
      const auto [before, behind] = MaterialsAt(surface, hit);
      ++winding[static_cast<std::size_t>(before)];
      --winding[static_cast<std::size_t>(behind)];
    }
  }
  return winding;
}

/// Gives each region the surrounding material that encloses least; 0 if there is none.
void NameRegions(const SurfaceMesh& surface, const MeshCheck& check, const MeshingOptions& options,
  std::vector<TetGenRegion>& regions, const ProgressCallback& progress)
{
  const TriangleTree tree(surface);
  for (std::size_t index = 0; index < regions.size(); ++index)
  {
    ReportProgress(progress, 0.3 + 0.1 * static_cast<double>(index) / regions.size(),
      "naming regions");
    TetGenRegion& region = regions[index];
    const std::vector<int> winding = WindingNumbers(surface, tree, region.Inside);
    double least = 0;
    for (const MaterialQuality& material : check.Materials)
    {
      const bool around = winding[static_cast<std::size_t>(material.Material)] > 0;
      if (around && (region.Material == 0 || material.VolumeMm3 < least))
      {
        region.Material = material.Material;
        least = material.VolumeMm3;
      }
    }
    const auto own = options.CellSizeOfMaterialMm.find(region.Material);
    const double radius =
      own == options.CellSizeOfMaterialMm.end() ? options.CellSizeMm : own->second;
    // A regular tetrahedron of circumradius R has edge R sqrt(8 / 3) and volume edge^3 / sqrt(72).
    region.CellVolumeMm3 = std::pow(radius * std::sqrt(8.0 / 3.0), 3) / std::sqrt(72.0);
  }
}

/// Adds a bounding box that is far enough away not to influence the cells at the surfaces.
void Surround(TriangleComplex& complex)
{
  Vector3 low{ 1e300, 1e300, 1e300 };
  Vector3 high{ -1e300, -1e300, -1e300 };
  for (std::size_t value = 0; value < complex.Points.size(); ++value)
  {
    low[value % 3] = std::min(low[value % 3], complex.Points[value]);
    high[value % 3] = std::max(high[value % 3], complex.Points[value]);
  }
  const double margin = 0.5 * Norm(high - low);
  const auto base = static_cast<std::uint32_t>(complex.Points.size() / 3);
  for (int corner = 0; corner < 8; ++corner)
  {
    for (int axis = 0; axis < 3; ++axis)
    {
      complex.Points.push_back(
        (corner >> axis & 1) != 0 ? high[axis] + margin : low[axis] - margin);
    }
  }
  constexpr std::uint32_t sides[6][4] = { { 0, 1, 3, 2 }, { 4, 5, 7, 6 }, { 0, 1, 5, 4 },
    { 2, 3, 7, 6 }, { 0, 2, 6, 4 }, { 1, 3, 7, 5 } };
  for (const auto& side : sides)
  {
    complex.Triangles.push_back({ base + side[0], base + side[1], base + side[2] });
    complex.Triangles.push_back({ base + side[0], base + side[2], base + side[3] });
  }
}

/// Returns TetGen's cells; cells of enclosed air have material 0. `check` is that of the surface.
TetrahedralMesh Fill(const SurfaceMesh& surface, const MeshCheck& check,
  const TriangleComplex& complex, TetGenQuality quality, const MeshingOptions& options,
  const ProgressCallback& progress, std::vector<TetGenRegion>& regions)
{
  if (const MeshDefect* crossings = check.Find(MeshDefect::Kind::Crossings))
  {
    throw InputError("surfaces: expected triangles that do not cut others, found " +
        crossings->Text({}),
      { "Surfaces", std::to_string(crossings->Count), { "SurfaceVoxelsMm" } });
  }
  ReportProgress(progress, 0.2, "finding regions");
  regions = FindRegions(complex);
  NameRegions(surface, check, options, regions, progress);
  quality.Ratio = options.CellRadiusEdgeRatio;
  quality.DihedralDeg =
    options.OptimisationSeconds > 0 ? std::min(options.SmallestDihedralDeg, 18.0) : 0.0;
  ReportProgress(progress, 0.4, "filling surfaces");
  return FillRegions(complex, regions, quality, progress);
}

double Since(Clock::time_point start)
{
  return std::chrono::duration<double>(Clock::now() - start).count();
}
}

MeshingResult MeshSurfaces(const SurfaceMesh& surfaces, const MeshingOptions& options,
  const ProgressCallback& progress)
{
  const auto start = Clock::now();
  options.Validate();
  const MeshCheck check = CheckClosed(surfaces);
  ReportProgress(progress, 0.1, "filling surfaces");
  const TriangleComplex complex = Weld(surfaces);
  MeshingResult result;
  std::vector<TetGenRegion> regions;
  TetGenQuality quality;
  quality.DividesTriangles = true;
  EditableMesh edited(Fill(surfaces, check, complex, quality, options, progress, regions));
  RepairPinches(edited, ShareOf(progress, 0.9, 0.93));
  ImproveCells(edited, options.SmallestDihedralDeg, 0, ShareOf(progress, 0.93, 0.99));
  result.Mesh = edited.Finish();
  ReportProgress(progress, 0.99, "checking");
  result.Mesh.Validate("mesh of TetGen");
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
  MeshingOptions forSurfaces = options;
  forSurfaces.OptimisationSeconds = 0;
  MeshingResult result = MeshMaterials(materials, forSurfaces, ShareOf(progress, 0.0, 0.4));
  const SurfaceMesh surface = ExtractInterfaces(result.Mesh);
  std::vector<TetGenRegion> regions;
  TriangleComplex complex = Weld(surface);
  Surround(complex);
  TetGenQuality quality;
  quality.KeepsAir = true; // for FinishMesh: only points with cells on all sides may move
  result.Mesh = Fill(surface, CheckSurface(surface), complex, quality, options,
    ShareOf(progress, 0.4, 0.8), regions);
  FinishMesh(materials, options, result.Mesh, ShareOf(progress, 0.8, 1.0));
  result.Mesh.Validate("mesh of TetGen");
  result.Reports = ReportMaterials(materials, result.Mesh);
  result.Seconds = Since(start);
  return result;
}
#else
MeshingResult MeshSurfaces(const SurfaceMesh&, const MeshingOptions&, const ProgressCallback&)
{
  throw InputError("surfaces: this build has no TetGen (MAMMORAY_USE_TETGEN was OFF)",
    { "Surfaces", "", { "SurfaceVoxelsMm" } });
}

MeshingResult MeshMaterialSurfaces(const LabelVolume&, const MeshingOptions&,
  const ProgressCallback&)
{
  throw InputError("surfaces: this build has no TetGen (MAMMORAY_USE_TETGEN was OFF)");
}
#endif
}
