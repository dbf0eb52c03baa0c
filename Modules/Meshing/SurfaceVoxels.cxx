// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Meshing/SurfaceVoxels.h"

#include "Private/MeshingSteps.h"
#include "mammoray/Foundation/Error.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

namespace mammoray
{
namespace
{
/// Intersection of a row of voxels along x with a boundary; +1 where the row leaves the material.
struct Crossing
{
  std::size_t Row;
  double X;
  int Sign;
};

LabelVolume MakeGrid(const SurfaceMesh& surfaces, double voxelMm)
{
  LabelVolume volume;
  volume.Spacing = { voxelMm, voxelMm, voxelMm };
  double voxels = 1;
  double size[3];
  for (std::size_t a = 0; a < 3; ++a)
  {
    double low = std::numeric_limits<double>::max();
    double high = -low;
    for (std::size_t at = a; at < surfaces.Points.size(); at += 3)
    {
      low = std::min(low, surfaces.Points[at]);
      high = std::max(high, surfaces.Points[at]);
    }
    volume.Origin[a] = low - 0.5 * voxelMm;
    size[a] = std::ceil((high - low) / voxelMm) + 2;
    voxels *= size[a];
  }
  if (!(voxels <= 1e9))
  {
    char text[120];
    std::snprintf(text, sizeof(text),
      "surfaces: expected voxels of a size that makes 1e9 at most, found %g mm, which makes %.2g",
      voxelMm, voxels);
    throw InputError(text);
  }
  std::transform(size, size + 3, volume.Size.begin(),
    [](double count) { return static_cast<int>(count); });
  volume.Voxels.assign(static_cast<std::size_t>(voxels), 0);
  return volume;
}

/// A triangle projected along x, its corners in the order seen from outside the material.
class SeenTriangle
{
public:
  SeenTriangle(const SurfaceMesh& surface, std::size_t triangle, bool turned)
  {
    for (std::size_t c = 0; c < 3; ++c)
    {
      this->Ids[c] = surface.Triangles[3 * triangle + (turned ? 2 - c : c)];
      const double* at = &surface.Points[3 * std::size_t{ this->Ids[c] }];
      this->Corners[c] = { at[0], at[1], at[2] };
    }
  }
  double Least(std::size_t axis) const
  {
    return std::min({ this->Corners[0][axis], this->Corners[1][axis], this->Corners[2][axis] });
  }
  double Most(std::size_t axis) const
  {
    return std::max({ this->Corners[0][axis], this->Corners[1][axis], this->Corners[2][axis] });
  }
  /// Sign and x of the intersection with the line at y, z; sign 0 if there is none.
  std::pair<int, double> Meet(double y, double z) const
  {
    double weight[3];
    bool left[3];
    for (std::size_t c = 0; c < 3; ++c)
    {
      // Both triangles of an edge compute the same number, so that no line slips between them. A
      // line that meets the edge is treated as if y were infinitesimally larger, and z even less
      // so.
      const std::size_t a = (c + 1) % 3;
      const std::size_t b = (c + 2) % 3;
      const bool ascends = this->Ids[a] < this->Ids[b];
      const Vector3& p = this->Corners[ascends ? a : b];
      const Vector3& q = this->Corners[ascends ? b : a];
      const double side = (q[1] - p[1]) * (z - p[2]) - (q[2] - p[2]) * (y - p[1]);
      const bool beside = side != 0 ? side > 0 : p[2] != q[2] ? q[2] < p[2] : q[1] > p[1];
      left[c] = beside == ascends;
      weight[c] = std::abs(side);
    }
    const double sum = weight[0] + weight[1] + weight[2];
    if (left[0] != left[1] || left[1] != left[2] || sum == 0)
    {
      return { 0, 0.0 };
    }
    return { left[0] ? 1 : -1,
      (weight[0] * this->Corners[0][0] + weight[1] * this->Corners[1][0] +
        weight[2] * this->Corners[2][0]) /
        sum };
  }

private:
  std::uint32_t Ids[3];
  Vector3 Corners[3];
};

std::vector<Crossing> FindCrossings(const SurfaceMesh& surface, int material,
  const LabelVolume& grid)
{
  std::vector<Crossing> crossings;
  for (std::size_t triangle = 0; triangle < surface.NumberOfTriangles(); ++triangle)
  {
    const bool back = surface.BackMaterials[triangle] == material;
    const bool front = surface.FrontMaterials[triangle] == material;
    if (back == front)
    {
      continue;
    }
    const SeenTriangle seen(surface, triangle, front);
    int first[3];
    int last[3];
    for (std::size_t a = 1; a < 3; ++a)
    {
      first[a] = static_cast<int>(std::ceil((seen.Least(a) - grid.Origin[a]) / grid.Spacing[a]));
      last[a] = static_cast<int>(std::floor((seen.Most(a) - grid.Origin[a]) / grid.Spacing[a]));
    }
    for (int k = first[2]; k <= last[2]; ++k)
    {
      for (int j = first[1]; j <= last[1]; ++j)
      {
        const auto [sign, x] =
          seen.Meet(grid.Origin[1] + j * grid.Spacing[1], grid.Origin[2] + k * grid.Spacing[2]);
        if (sign != 0)
        {
          crossings.push_back({ static_cast<std::size_t>(k) * grid.Size[1] + j, x, sign });
        }
      }
    }
  }
  std::sort(crossings.begin(), crossings.end(),
    [](const Crossing& a, const Crossing& b)
    { return a.Row != b.Row ? a.Row < b.Row : a.X < b.X; });
  return crossings;
}

/// Assigns the material to the voxels with a winding number of at least 1.
void Fill(const std::vector<Crossing>& crossings, int material, LabelVolume& grid)
{
  int winding = 0;
  for (std::size_t n = 0; n + 1 < crossings.size(); ++n)
  {
    const Crossing& here = crossings[n];
    const Crossing& next = crossings[n + 1];
    winding = next.Row == here.Row ? winding - here.Sign : 0;
    if (winding <= 0)
    {
      continue;
    }
    const auto voxel = [&](double x)
    { return static_cast<int>(std::ceil((x - grid.Origin[0]) / grid.Spacing[0])); };
    std::uint16_t* row = &grid.Voxels[here.Row * static_cast<std::size_t>(grid.Size[0])];
    std::fill(row + voxel(here.X), row + voxel(next.X), static_cast<std::uint16_t>(material));
  }
}
}

LabelVolume LabelSurfaces(const SurfaceMesh& surfaces, double voxelMm,
  const ProgressCallback& progress)
{
  if (!(voxelMm > 0) || !std::isfinite(voxelMm))
  {
    throw InputError(
      "surfaces: expected voxels of a positive number of mm, found " + std::to_string(voxelMm));
  }
  constexpr const char* stage = "labelling voxels";
  ReportProgress(progress, 0.0, stage);
  std::vector<MaterialQuality> materials = CheckClosed(surfaces).Materials;
  std::stable_sort(materials.begin(), materials.end(),
    [](const auto& a, const auto& b) { return a.VolumeMm3 > b.VolumeMm3; });
  LabelVolume grid = MakeGrid(surfaces, voxelMm);
  for (std::size_t n = 0; n < materials.size(); ++n)
  {
    ReportProgress(progress, (n + 1.0) / (materials.size() + 1.0), stage);
    Fill(FindCrossings(surfaces, materials[n].Material, grid), materials[n].Material, grid);
  }
  return grid;
}
}
