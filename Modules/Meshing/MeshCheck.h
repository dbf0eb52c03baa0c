// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_MeshCheck_h
#define mammoray_MeshCheck_h

#include "mammoray/Foundation/Progress.h"
#include "mammoray/Foundation/SurfaceMesh.h"
#include "mammoray/Foundation/TetrahedralMesh.h"
#include "mammorayMeshingModule.h"

#include <string>
#include <vector>

namespace mammoray
{
/// Something that is wrong with a mesh, with the places where it was found.
struct MAMMORAYMESHING_EXPORT MeshTrouble
{
  enum class Kind
  {
    /// Cells of no or negative volume.
    InvertedCells,
    /// Faces that more than two cells share, or that two cells share from the same side.
    OverlappingCells,
    /// Distinct points of cells at the same place: neighbours that are not joined.
    CoincidentPoints,
    /// Points that no cell uses.
    UnusedPoints,
    /// Triangles of no area.
    FlatTriangles,
    /// Edges at which the boundary of a material ends; one place per hole.
    Holes,
    /// Edges or points at which the boundary of a material, or of air, touches itself: X-rays do
    /// not mind, but tissue hangs together by a hinge there, and the boundary is no surface.
    Pinches,
    /// Pairs of triangles of a surface that go through each other (FindOverlap).
    Crossings,
    /// Parts of a surface inside of another or of themselves though their labels say air: rays
    /// count the stretch there twice.
    DoubledParts,
    /// Parts turned inside out: rays count the stretch there negatively.
    InsideOutParts
  };
  struct Place
  {
    Vector3 Point{ 0, 0, 0 };
    /// The material concerned; -1 where there is none.
    int Material = -1;
    /// Of a hole its border, of a doubled or negative part a stretch that rays count so, mm; 0 for
    /// other troubles.
    double LengthMm = 0;
  };

  Kind What = Kind::InvertedCells;
  std::size_t Count = 0;
  /// Where it was found, at most MostPlaces; the longest holes, the first ones otherwise.
  std::vector<Place> Places;
  static constexpr std::size_t MostPlaces = 20;

  /// "3 holes in the boundary of a material: ..." in one line; `names[m]` names material m.
  std::string Text(const std::vector<std::string>& names) const;
};

/// Size and quality of one material in a mesh.
struct MaterialQuality
{
  int Material = 0;
  /// mm^3; of a surface by the divergence theorem.
  double VolumeMm3 = 0;
  /// Triangles that bound the material.
  std::size_t BoundaryTriangles = 0;
  /// Their area, mm^2.
  double BoundaryAreaMm2 = 0;
  /// A plate of this volume and area is so thick, mm.
  double MeanThicknessMm() const { return 2 * this->VolumeMm3 / this->BoundaryAreaMm2; }
  /// The rest is left at 0 for surfaces.
  std::size_t Cells = 0;
  double SmallestDihedralDeg = 0;
  Vector3 SmallestDihedralPlace{ 0, 0, 0 };
  double LargestRadiusEdgeRatio = 0;
  Vector3 LargestRadiusEdgePlace{ 0, 0, 0 };
  /// Cells by their smallest dihedral angle, in steps of DihedralStepDeg from 0.
  std::vector<std::size_t> DihedralHistogram;
  /// Cells by circumradius / shortest edge, in steps of RadiusEdgeStep from 0; the last holds all
  /// above.
  std::vector<std::size_t> RadiusEdgeHistogram;
};

struct MAMMORAYMESHING_EXPORT MeshCheck
{
  static constexpr double DihedralStepDeg = 3.0;
  static constexpr double RadiusEdgeStep = 0.2;

  std::size_t Points = 0;
  /// 0 for surfaces.
  std::size_t Cells = 0;
  /// Interfaces between materials, the outside included.
  std::size_t Triangles = 0;
  /// Ascending, air left out.
  std::vector<MaterialQuality> Materials;
  /// One entry for each kind that was found, in the order of the enumeration.
  std::vector<MeshTrouble> Troubles;

  /// True when no trouble was found.
  bool Sound() const;
  /// The entry of that kind, or nothing.
  const MeshTrouble* Find(MeshTrouble::Kind kind) const;
};

/**
 * Whether a mesh is fit for X-rays and mechanics: cells not inverted and joined face to face, the
 * boundary of every material closed and without pinches; with volume and quality by material.
 * Throws InputError only when indices or materials cannot be read as a mesh.
 */
MAMMORAYMESHING_EXPORT MeshCheck CheckMesh(const TetrahedralMesh& mesh,
  const ProgressCallback& progress = {});

/**
 * The same of a surface: every material's boundary, and whether it crosses or overlaps itself.
 * Triangles with the same material on both sides bound nothing; points may lie at the same place,
 * as where closed surfaces touch.
 */
MAMMORAYMESHING_EXPORT MeshCheck CheckSurface(const SurfaceMesh& surface,
  const ProgressCallback& progress = {});
}

#endif
