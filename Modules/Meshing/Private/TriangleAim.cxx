// SPDX-License-Identifier: Apache-2.0
#include "Private/TriangleAim.h"

#include "Private/MeshingSteps.h"
#include "mammoray/Foundation/Error.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>

namespace mammoray
{
namespace
{
/// Measured: 8.0 GB for 4.9 million triangles of a volume of 75 million voxels.
constexpr double BytesPerTriangle = 1600;
/// Fraction of the triangles for the first attempt: too many cannot be undone.
constexpr double FirstShare = 0.1;
/// Half of the promised tolerance, because repairing the mesh changes the number slightly.
constexpr double Tolerance = 0.05;
constexpr int MostAttempts = 10;

/// Smallest memory per cell and per triangle with the cells at it.
constexpr double LeastBytesPerCell = 200;
constexpr double LeastBytesPerTriangle = 400;
/// Volume of a regular tetrahedron, and area of a regular triangle, of circumradius 1: the largest
/// possible.
constexpr double MostOfCell = 0.513;
constexpr double MostOfTriangle = 1.299;
/// Voxel steps in all directions have 1.5 times the area of the surface they follow.
constexpr double StairsFactor = 1.5;

double SizeOf(int material, double size, const std::map<int, double>& ofMaterial)
{
  const auto found = ofMaterial.find(material);
  return found == ofMaterial.end() ? size : found->second;
}

/// Calls `visit` with the materials on both sides of each face between two materials, and its area,
/// mm^2.
template <typename Visit>
void ForEachInterfaceFace(const LabelVolume& volume, const Visit& visit)
{
  const std::size_t steps[3] = { 1, static_cast<std::size_t>(volume.Size[0]),
    static_cast<std::size_t>(volume.Size[0]) * volume.Size[1] };
  for (int axis = 0; axis < 3; ++axis)
  {
    const double area = volume.VoxelVolume() / volume.Spacing[axis];
    for (std::size_t voxel = steps[axis]; voxel < volume.NumberOfVoxels(); ++voxel)
    {
      const int behind = volume.Voxels[voxel - steps[axis]];
      const int ahead = volume.Voxels[voxel];
      if (ahead != behind)
      {
        visit(behind, ahead, area);
      }
    }
  }
}

/// Area of the interfaces, mm^2. Throws InputError if there are too few voxels for the triangles.
double InterfaceArea(const LabelVolume& volume, double wanted)
{
  std::size_t faces = 0;
  double area = 0;
  ForEachInterfaceFace(volume,
    [&](int, int, double ofFace)
    {
      ++faces;
      area += ofFace;
    });
  const double most = 16.0 * static_cast<double>(faces);
  if (wanted > most)
  {
    throw InputError(
      FormattedText("triangles: expected at most %.0f, sixteen for each voxel face between "
                    "materials, found %.0f",
        most, wanted));
  }
  return area / StairsFactor;
}
}

void CheckMemory(const std::string& what, double bytes)
{
  const double memory =
    static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE));
  if (!(bytes <= memory))
  {
    throw InputError(what +
      FormattedText(" take about %.3g GB, expected at most the %.3g GB of this machine",
        bytes / 1e9, memory / 1e9));
  }
}

void CheckSizes(const LabelVolume& volume, const MeshingOptions& options)
{
  double cells = 0;
  for (const auto& [material, count] : volume.CountLabels())
  {
    const double size = SizeOf(material, options.CellSizeMm, options.CellSizeOfMaterialMm);
    cells += material == 0
      ? 0
      : static_cast<double>(count) * volume.VoxelVolume() / (MostOfCell * std::pow(size, 3));
  }
  double triangles = 0;
  ForEachInterfaceFace(volume,
    [&](int a, int b, double area)
    {
      const double size = std::min(SizeOf(a, options.FacetSizeMm, options.FacetSizeOfMaterialMm),
        SizeOf(b, options.FacetSizeMm, options.FacetSizeOfMaterialMm));
      triangles += area / (StairsFactor * MostOfTriangle * size * size);
    });
  CheckMemory(
    FormattedText("meshing: cell and facet sizes that give at least %.3g cells and %.3g triangles",
      cells, triangles),
    LeastBytesPerCell * cells + LeastBytesPerTriangle * triangles);
}

TriangleAim::TriangleAim(const LabelVolume& volume, const MeshingOptions& options)
  : TargetCount(static_cast<double>(options.Triangles))
  , Start(options)
{
  // A triangle's area is about 0.6 times the square of its circumradius.
  const double triangles =
    InterfaceArea(volume, this->TargetCount) / (0.6 * std::pow(options.FacetSizeMm, 2));
  CheckMemory(FormattedText("triangles: %.0f of them", this->TargetCount),
    BytesPerTriangle * this->TargetCount);
  this->Scale = std::sqrt(triangles / (FirstShare * this->TargetCount));
}

MeshingOptions TriangleAim::Sizes() const
{
  MeshingOptions options = this->Start;
  const auto multiply = [](std::map<int, double>& sizes, double scale)
  {
    for (auto& [material, size] : sizes)
    {
      size *= scale;
    }
  };
  options.FacetSizeMm *= this->Scale;
  options.FacetDistanceMm *= this->Scale;
  options.LayerFacetSizeMm *= this->Scale;
  multiply(options.FacetSizeOfMaterialMm, this->Scale);
  multiply(options.FacetDistanceOfMaterialMm, this->Scale);
  options.CellSizeMm *= std::max(1.0, this->Scale);
  multiply(options.CellSizeOfMaterialMm, std::max(1.0, this->Scale));
  return options;
}

TriangleAim::Verdict TriangleAim::Judge(std::size_t triangles)
{
  const auto found = static_cast<double>(triangles);
  if (std::abs(found - this->TargetCount) <= Tolerance * this->TargetCount)
  {
    return Verdict::Met;
  }
  if (++this->Attempts == MostAttempts)
  {
    throw ConvergenceError(
      FormattedText("meshing: expected %.0f triangles, reached %.0f; the facet angle, "
                    "layers and small components require others",
        this->TargetCount, found));
  }
  // The number of triangles scales with the inverse square of the size; on rough interfaces with
  // another power, which the last two attempts determine.
  double power = 2;
  if (this->LastTriangles > 0 && found != this->LastTriangles)
  {
    power = std::clamp(
      -std::log(found / this->LastTriangles) / std::log(this->Scale / this->LastScale), 0.8, 3.0);
  }
  this->LastTriangles = found;
  this->LastScale = this->Scale;
  // If far away, go half of the way to learn the power near the end: too many triangles cannot be
  // undone.
  const double aim = this->TargetCount > 3 * found ? 0.5 * this->TargetCount
                                                   : (1 - 0.5 * Tolerance) * this->TargetCount;
  this->Scale *= std::pow(std::max(found, 1.0) / aim, 1 / power);
  return found < this->TargetCount ? Verdict::TooFew : Verdict::TooMany;
}
}
