// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_ElasticBody_h
#define mammoray_ElasticBody_h

#include "mammoray/Biomechanics/CompressionSimulation.h"
#include "mammoray/Foundation/Meshes.h"
#include "mammoray/Foundation/Vector3.h"
#include "mammorayBiomechanicsModule.h"

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace mammoray
{
/**
 * Tetrahedra with straight sides in the undeformed body, made from a linear mesh, with elastic
 * constants at their quadrature points. ElasticEnergy is the energy of its deformation. An element
 * is the set of cells that share one volume constraint:
 *
 * - Quadratic: ten nodes and the 4-point rule of degree 2. The element is the cell.
 * - PatchAveragedLinear: four nodes and one point. The element is a patch of about 8 cells. Patches
 *   depend on the mesh alone, so states survive a change of materials. A patch may contain cells of
 *   several materials: strands of gland one cell thick would lock otherwise, and neighbouring
 *   tissues have nearly the same pressure.
 *
 * A quadratic cell lists its four corners first, then the middles of (0,1) (1,2) (0,2) (0,3) (1,3)
 * (2,3), as VTK does.
 */
class MAMMORAYBIOMECHANICS_EXPORT ElasticBody
{
public:
  /// A triangle of the boundary: its element, the element's local nodes (3 corners and, for
  /// quadratic cells, 3 mid-side nodes; see NodesPerFace()) and its undeformed area, mm^2.
  struct BoundaryFace
  {
    std::int32_t Element = 0;
    std::array<int, 6> LocalNodes{};
    double Area = 0;
  };

  /// The fraction of a cell that belongs to a material: around each quadrature point, and in the
  /// whole cell.
  struct Part
  {
    int Material = 0;
    std::array<double, 4> PointShares{};
    double CellShare = 0;
  };

  /**
   * `materials` is indexed by the materials of the cells. With a `field`, mu, kappa and mu b of a
   * quadrature point are arithmetic means over those points of a regular lattice in the cell that
   * are nearest to it (by the largest barycentric coordinate). Where the field answers 0 or a
   * material m with `ignored[m]`, the cell's own material is used. A patch never mixes cells of
   * ignored and other materials: fixed cells would dilute the volume constraint of the rest. Throws
   * InputError on an unusable mesh or material.
   */
  ElasticBody(const TetrahedralMesh& mesh, const std::vector<ElasticMaterial>& materials,
    const MaterialField& field = {}, const std::vector<bool>& ignored = {},
    ElementType type = ElementType::Quadratic);

  /// Replaces the constants of the materials, as many as at construction. Throws InputError.
  void SetMaterials(const std::vector<ElasticMaterial>& materials);
  const std::vector<ElasticMaterial>& Materials() const { return this->Table; }
  /// Sets another undeformed shape of the same cells, which keep their materials. `corners` begin
  /// with the points of the linear mesh, mm; sides stay straight. The caller ensures that no cell
  /// is inverted (see CellVolume).
  void SetRestCorners(const std::vector<double>& corners);

  ElementType Type() const { return this->Kind; }
  /// 10 or 4.
  int NodesPerCell() const { return this->Kind == ElementType::Quadratic ? 10 : 4; }
  /// 6 or 3.
  int NodesPerFace() const { return this->Kind == ElementType::Quadratic ? 6 : 3; }
  std::size_t NumberOfNodes() const { return this->Rest.size() / 3; }
  std::size_t NumberOfCells() const { return this->Volumes.size(); }
  /// Undeformed node positions, 3 x nodeCount, mm. The first nodes are the points of the linear
  /// mesh.
  const std::vector<double>& RestPositions() const { return this->Rest; }
  /// Node indices, NodesPerCell() per cell.
  const std::vector<std::int32_t>& Cells() const { return this->CellNodes; }
  /// Number of cells or of patches.
  std::size_t NumberOfElements() const { return this->ElementVolumes.size(); }
  std::span<const std::int32_t> CellsOf(std::size_t element) const
  {
    return { this->ElementCells.data() + this->CellStarts[element],
      this->ElementCells.data() + this->CellStarts[element + 1] };
  }
  /// Node indices of an element in local order.
  std::span<const std::int32_t> NodesOf(std::size_t element) const
  {
    return { this->ElementNodes.data() + this->NodeStarts[element],
      this->ElementNodes.data() + this->NodeStarts[element + 1] };
  }
  const std::vector<BoundaryFace>& Faces() const { return this->Boundary; }
  /// Undeformed volume of a cell, mm^3, and its mean density, g/cm^3.
  double CellVolume(std::size_t cell) const { return this->Volumes[cell]; }
  double CellDensity(std::size_t cell) const;
  /// Mean bulk modulus of a cell, kPa.
  double CellBulkModulus(std::size_t cell) const;
  /// Derivatives of a cell's volume, mm^3, and of a face's area, mm^2, if the undeformed nodes move
  /// with `velocities` (3 x nodeCount), per unit of the parameter.
  double CellVolumeRate(std::size_t cell, const std::vector<double>& velocities) const;
  double FaceAreaRate(const BoundaryFace& face, const std::vector<double>& velocities) const;
  /// Integral of the shape function of a cell's node 0, 1, ... over the undeformed cell, as a part
  /// of its volume.
  double IntegralOfShape(int node) const
  {
    return this->Kind == ElementType::Quadratic ? (node < 4 ? -1 / 20.0 : 1 / 5.0) : 1 / 4.0;
  }
  /// The integrals over the undeformed body of each node's shape function times a value that is
  /// constant in each cell; mm^3 times the unit of `cellValues`.
  std::vector<double> NodeIntegrals(const std::vector<double>& cellValues) const;
  /// Undeformed volume, mm^3.
  double ElementVolume(std::size_t element) const { return this->ElementVolumes[element]; }
  /// Means of the shear and of the bulk modulus of an element, kPa.
  double ElementShearModulus(std::size_t element) const { return this->Mu[element]; }
  double ElementBulkModulus(std::size_t element) const { return this->Kappa[element]; }

  /// 4 or 1.
  int PointsPerCell() const { return this->Kind == ElementType::Quadratic ? 4 : 1; }
  /// Local indices of a cell's nodes in its element, NodesPerCell() numbers.
  const int* LocalNodesOf(std::size_t cell) const
  {
    return &this->LocalNodes[this->NodesPerCell() * cell];
  }
  /// Gradients of a cell's four barycentric coordinates, 12 numbers, 1/mm.
  const double* BarycentricGradientsOf(std::size_t cell) const
  {
    return &this->BarycentricGradients[12 * cell];
  }
  /// The material law at quadrature point PointsPerCell() * cell + point.
  const ShapeEnergy& LawAt(std::size_t point) const { return this->Shape[point]; }
  std::span<const Part> PartsOf(std::size_t cell) const
  {
    return { this->Parts.data() + this->PartStarts[cell],
      this->Parts.data() + this->PartStarts[cell + 1] };
  }

private:
  void AddNodesAndCells(const TetrahedralMesh& mesh);
  /// Computes mid-side nodes, volumes and gradients from the undeformed corners.
  void MeasureRest();
  void MakeElements(const TetrahedralMesh& mesh, const std::vector<bool>& ignored);
  void SampleMaterials(const TetrahedralMesh& mesh, int materialCount, const MaterialField& field,
    const std::vector<bool>& ignored);

  ElementType Kind;
  std::vector<double> Rest;
  std::vector<std::int32_t> CellNodes;
  /// Local index of each of a cell's nodes in its element, NodesPerCell() per cell.
  std::vector<int> LocalNodes;
  /// Element e has the cells CellStarts[e] to CellStarts[e + 1] - 1, and nodes likewise.
  std::vector<std::int32_t> ElementCells;
  std::vector<std::int32_t> ElementNodes;
  std::vector<std::size_t> CellStarts;
  std::vector<std::size_t> NodeStarts;
  std::vector<BoundaryFace> Boundary;
  /// Undeformed volumes of the cells and of the elements, mm^3.
  std::vector<double> Volumes;
  std::vector<double> ElementVolumes;
  /// Gradients of the barycentric coordinates, 12 per cell, 1/mm.
  std::vector<double> BarycentricGradients;
  std::vector<ElasticMaterial> Table;
  /// Cell c has the parts PartStarts[c] to PartStarts[c + 1] - 1.
  std::vector<Part> Parts;
  std::vector<std::size_t> PartStarts;
  /// Material laws, PointsPerCell() per cell.
  std::vector<ShapeEnergy> Shape;
  /// Mean moduli of each element, kPa.
  std::vector<double> Mu;
  std::vector<double> Kappa;
};
}

#endif
