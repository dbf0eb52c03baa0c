// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_MeshCheck_h
#define mammoray_MeshCheck_h

#include "mammoray/Foundation/Meshes.h"
#include "mammoray/Foundation/Progress.h"
#include "mammorayMeshingModule.h"

#include <string>
#include <vector>

namespace mammoray
{
/// A kind of defect of a mesh, with the places where it was found.
struct MAMMORAYMESHING_EXPORT MeshDefect
{
  enum class Kind
  {
    /// Cells with zero or negative volume.
    InvertedCells,
    /// Faces that more than two cells share, or that two cells share from the same side.
    OverlappingCells,
    /// Distinct points at the same position: neighbouring cells that are not connected.
    CoincidentPoints,
    /// Points that no cell uses.
    UnusedPoints,
    /// Triangles with zero area.
    FlatTriangles,
    /// Triangles that bound a material once more, with the same corners in either sense. Where two
    /// closed bodies share a face, it is there once for each and no defect.
    DoubledTriangles,
    /// Triangles turned against most of those that are joined to them.
    TurnedTriangles,
    /// Borders, every edge of which lies at the place of another one: the boundary closes, but its
    /// parts have points of their own. One place per border.
    OpenSeams,
    /// Edges where the boundary of a material ends; one place per hole.
    Holes,
    /// Edges or points where the boundary of a material, or of air, touches itself. X-rays are not
    /// affected, but the tissue is connected only by a hinge there, and the boundary is no
    /// manifold.
    Pinches,
    /// Pairs of triangles of a surface that intersect each other (FindOverlap).
    Crossings,
    /// Parts of a surface inside another part or inside themselves although their labels say air;
    /// rays count the segment twice.
    DoubledParts,
    /// Parts that are inside out; rays count the segment negatively.
    InsideOutParts
  };
  struct Place
  {
    Vector3 Point{ 0, 0, 0 };
    /// The material concerned; -1 if there is none.
    int Material = -1;
    /// Length of a hole's or a seam's border, or of the segment of a ray that is counted wrongly,
    /// mm; 0 for other kinds.
    double LengthMm = 0;
  };

  Kind What = Kind::InvertedCells;
  std::size_t Count = 0;
  /// At most MostPlaces places: the longest holes and seams, otherwise the first places.
  std::vector<Place> Places;
  static constexpr std::size_t MostPlaces = 20;

  /// One line of text such as "3 holes in the boundary of a material: ..."; `names[m]` is the name
  /// of material m.
  std::string Text(const std::vector<std::string>& names) const;
};

/// Size and quality of one material in a mesh.
struct MaterialQuality
{
  int Material = 0;
  /// Volume, mm^3; for a surface by the divergence theorem.
  double VolumeMm3 = 0;
  /// Number of triangles that bound the material.
  std::size_t BoundaryTriangles = 0;
  /// Area of these triangles, mm^2.
  double BoundaryAreaMm2 = 0;
  /// Thickness of a plate with this volume and boundary area, mm.
  double MeanThicknessMm() const { return 2 * this->VolumeMm3 / this->BoundaryAreaMm2; }
  /// The members from here on are 0 for surfaces.
  std::size_t Cells = 0;
  double SmallestDihedralDeg = 0;
  Vector3 SmallestDihedralPlace{ 0, 0, 0 };
  double LargestRadiusEdgeRatio = 0;
  Vector3 LargestRadiusEdgePlace{ 0, 0, 0 };
  /// Histogram of the cells' smallest dihedral angles, in bins of DihedralStepDeg from 0.
  std::vector<std::size_t> DihedralHistogram;
  /// Histogram of circumradius / shortest edge, in bins of RadiusEdgeStep from 0; the last bin
  /// contains all larger values.
  std::vector<std::size_t> RadiusEdgeHistogram;
};

struct MAMMORAYMESHING_EXPORT MeshCheck
{
  static constexpr double DihedralStepDeg = 3.0;
  static constexpr double RadiusEdgeStep = 0.2;

  std::size_t Points = 0;
  /// Number of cells; 0 for surfaces.
  std::size_t Cells = 0;
  /// Number of interface triangles between materials, including the outside.
  std::size_t Triangles = 0;
  /// Materials, ascending, without air.
  std::vector<MaterialQuality> Materials;
  /// Defects, one entry per kind found, in the order of the enumeration.
  std::vector<MeshDefect> Defects;

  /// True if no defect was found.
  bool Sound() const;
  /// The entry of this kind, or null.
  const MeshDefect* Find(MeshDefect::Kind kind) const;
};

/// Checks a mesh for X-rays and mechanics: cells are not inverted and are connected face to face,
/// and the boundary of every material is closed and manifold. Also measures volume and quality by
/// material. Throws InputError only if indices or materials do not form a mesh.
MAMMORAYMESHING_EXPORT MeshCheck CheckMesh(const TetrahedralMesh& mesh,
  const ProgressCallback& progress = {});

/// Checks a surface: the boundary of every material, and whether the surface intersects or overlaps
/// itself. Volumes are those with turned triangles turned back. Triangles with the same material on
/// both sides bound nothing. Distinct points may coincide where closed surfaces touch.
MAMMORAYMESHING_EXPORT MeshCheck CheckSurface(const SurfaceMesh& surface,
  const ProgressCallback& progress = {});
}

#endif
