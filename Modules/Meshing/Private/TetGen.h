// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_TetGen_h
#define mammoray_TetGen_h

#include "mammoray/Foundation/Meshes.h"
#include "mammoray/Foundation/Progress.h"

#include <array>
#include <cstdint>
#include <vector>

namespace mammoray
{
/// Triangles that meet only at common points and edges: the input of TetGen.
struct TriangleComplex
{
  std::vector<double> Points;
  std::vector<std::array<std::uint32_t, 3>> Triangles;
};

/// A connected region between the triangles.
struct TetGenRegion
{
  /// A point well inside the region.
  Vector3 Inside{ 0, 0, 0 };
  double VolumeMm3 = 0;
  /// Material; 0 is air.
  int Material = 0;
  /// Upper bound of the volume of its cells, mm^3.
  double CellVolumeMm3 = 0;
};

/// The regions that the triangles enclose; Material stays 0.
std::vector<TetGenRegion> FindRegions(const TriangleComplex& complex);

/// Requirements on the cells; TetGen's switches -q and -Y.
struct TetGenQuality
{
  /// Largest circumradius / shortest edge.
  double Ratio = 2;
  /// Smallest dihedral angle, a goal, degrees; 0 for none.
  double DihedralDeg = 0;
  /// If true, triangles may be subdivided and flat parts of the surface may be triangulated again.
  bool DividesTriangles = false;
  /// If true, regions of material 0 are filled too, without a bound on the cells' volume.
  bool KeepsAir = false;
};

/// Fills the regions that have a material, or all regions. `progress` is called while cells are
/// refined.
TetrahedralMesh FillRegions(const TriangleComplex& complex,
  const std::vector<TetGenRegion>& regions, const TetGenQuality& quality,
  const ProgressCallback& progress);
}

#endif
