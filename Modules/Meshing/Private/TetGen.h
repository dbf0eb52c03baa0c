// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_TetGen_h
#define mammoray_TetGen_h

#include "mammoray/Foundation/Progress.h"
#include "mammoray/Foundation/TetrahedralMesh.h"

#include <array>
#include <cstdint>
#include <vector>

namespace mammoray
{
/// Triangles that meet at common points and edges only: what TetGen fills.
struct TriangleComplex
{
  std::vector<double> Points;
  std::vector<std::array<std::uint32_t, 3>> Triangles;
};

/// A connected space between the triangles.
struct TetGenRegion
{
  /// A point well within.
  Vector3 Inside{ 0, 0, 0 };
  double VolumeMm3 = 0;
  /// 0: air.
  int Material = 0;
  /// Upper bound of its cells, mm^3.
  double CellVolumeMm3 = 0;
};

/// Triangles that cut others, as indices; empty when there are none.
std::vector<std::size_t> FindCuttingTriangles(const TriangleComplex& complex);

/// The spaces that the triangles enclose, materials left at 0.
std::vector<TetGenRegion> FindRegions(const TriangleComplex& complex);

/// What is asked of the cells; TetGen's -q and -Y.
struct TetGenQuality
{
  /// Largest circumradius / shortest edge.
  double Ratio = 2;
  /// A goal; 0 leaves it out.
  double DihedralDeg = 0;
  /// Triangles may be divided, and flat parts of the surface be triangulated anew.
  bool DividesTriangles = false;
  /// Regions of material 0 are filled, too, without a bound on the cells' volume.
  bool KeepsAir = false;
};

/// Tetrahedra of the regions that have a material, or of all. `progress` is asked while cells are
/// refined.
TetrahedralMesh FillRegions(const TriangleComplex& complex,
  const std::vector<TetGenRegion>& regions, const TetGenQuality& quality,
  const ProgressCallback& progress);
}

#endif
