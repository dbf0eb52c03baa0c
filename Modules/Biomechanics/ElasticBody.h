// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_ElasticBody_h
#define mammoray_ElasticBody_h

#include "ElasticMaterial.h"
#include "TetrahedralMesh.h"
#include "Vector3.h"
#include "mammorayBiomechanicsModule.h"

#include <array>
#include <cstdint>
#include <functional>
#include <vector>

namespace mammoray
{
/// Means over the quadrature points of a deformed cell.
struct CellMeasures
{
  /// det F: deformed over undeformed volume.
  double J = 1;
  /// Von Mises' measure of the Cauchy stress, kPa.
  double VonMisesKPa = 0;
};

/// Material index at a position of the undeformed body (mm, frame of the mesh); 0 = outside.
using MaterialField = std::function<int(const Vector3&)>;

/**
 * Quadratic tetrahedra with straight sides at rest, made from linear ones, and their elastic energy
 *
 *   E = sum over cells of [ sum_q w_q (w(J_q^(-2/3) tr F_q^T F_q - 3; mu_q, b_q) + kappa / 2 (J_q -
 * 1)^2) ],
 *
 * w: ShapeEnergy, q: the 4-point rule of degree 2, w_q its weights in the undeformed cell, J_q =
 * det F_q, kappa the mean of kappa_q. Of kappa, no more than 50 mu is used so; the rest acts on the
 * mean of J_q - 1 over the cell: four constraints in every cell would be too many for the nodes
 * there are, one is not (the P2/P0 element; Boffi, Brezzi & Fortin 2013, section 8.6). The mean
 * alone would let the quadrature points of one cell swell and shrink against each other.
 *
 * Node order of a cell: the four corners, then the middles of (0,1) (1,2) (0,2) (0,3) (1,3) (2,3),
 * as in VTK. Energies are in kPa mm^3 = 1e-6 J, forces in kPa mm^2 = 1e-3 N.
 */
class MAMMORAYBIOMECHANICS_EXPORT ElasticBody
{
public:
  static constexpr int NodesPerCell = 10;
  static constexpr int PointsPerCell = 4;
  static constexpr int UnknownsPerCell = 3 * NodesPerCell;
  /// Corners at the ends of the side that the fifth to the tenth node are the middles of.
  static constexpr int Edges[6][2] = { { 0, 1 }, { 1, 2 }, { 0, 2 }, { 0, 3 }, { 1, 3 }, { 2, 3 } };
  /// Local nodes of the face opposite to each corner: its corners, anticlockwise from outside, then
  /// the middles of its first, second and third side.
  static constexpr int FaceNodes[4][6] = { { 1, 2, 3, 5, 9, 8 }, { 0, 3, 2, 7, 9, 6 },
    { 0, 1, 3, 4, 8, 7 }, { 0, 2, 1, 6, 5, 4 } };

  /// A triangle of the boundary: its cell, the cell's local nodes (3 corners, 3 middles), its area
  /// in mm^2.
  struct BoundaryFace
  {
    std::int32_t Cell = 0;
    std::array<int, 6> LocalNodes{};
    double Area = 0;
  };

  /// What CellTerms computes of one cell; rows and columns are 3 * local node + axis.
  struct Terms
  {
    double Energy = 0;
    std::array<double, UnknownsPerCell> Gradient{};
    /// Symmetric, both halves filled.
    std::array<double, UnknownsPerCell * UnknownsPerCell> Hessian{};
    /// Smallest and largest det F, and Jbar * V, mm^3.
    double SmallestJ = 1;
    double LargestJ = 1;
    double Volume = 0;
  };
  enum class Order
  {
    Energy,
    Gradient,
    Hessian,
    /// Hessian whose negative curvatures are replaced by zero, quadrature point by quadrature
    /// point.
    ProjectedHessian
  };

  /**
   * `materials` is indexed by the materials of the cells. With a `field`, mu, kappa and mu b of a
   * quadrature point (the energy to second order in the strain's square) are the arithmetic means
   * over the points of a regular lattice in the cell that lie nearest to it (by largest barycentric
   * coordinate); where the field answers 0 or a material
   * m with `ignored[m]` the cell's own material counts. Throws InputError on a bad mesh or
   * material.
   */
  ElasticBody(const TetrahedralMesh& mesh, const std::vector<ElasticMaterial>& materials,
    const MaterialField& field = {}, const std::vector<bool>& ignored = {});

  /// Other constants for the materials, as many as at construction. Throws InputError.
  void SetMaterials(const std::vector<ElasticMaterial>& materials);
  const std::vector<ElasticMaterial>& Materials() const { return this->Table; }
  /**
   * Another undeformed shape of the same cells, whose materials they keep: the first coordinates of
   * `corners` are those of the points of the linear mesh, mm; sides stay straight. The caller sees
   * to it that no cell is turned inside out (CellVolume).
   */
  void SetRestCorners(const std::vector<double>& corners);

  std::size_t NumberOfNodes() const { return this->Rest.size() / 3; }
  std::size_t NumberOfCells() const { return this->CellNodes.size() / NodesPerCell; }
  /// Undeformed positions, 3 x nodeCount, mm. The first nodes are the points of the linear mesh.
  const std::vector<double>& RestPositions() const { return this->Rest; }
  /// 10 x cellCount node indices.
  const std::vector<std::int32_t>& Cells() const { return this->CellNodes; }
  const std::vector<BoundaryFace>& Faces() const { return this->Boundary; }
  /// Undeformed volume of a cell, mm^3.
  double CellVolume(std::size_t cell) const { return this->Volumes[cell]; }
  /// Mean shear and bulk modulus of a cell, kPa.
  double CellShearModulus(std::size_t cell) const;
  double CellBulkModulus(std::size_t cell) const { return this->Kappa[cell]; }
  /// Mean density of a cell, g/cm^3.
  double CellDensity(std::size_t cell) const;
  /// The integrals over the undeformed body of each node's shape function times a value that is
  /// constant in each cell; mm^3 times the unit of `cellValues`.
  std::vector<double> NodeIntegrals(const std::vector<double>& cellValues) const;

  /**
   * Terms of one cell at node positions `x` (3 x nodeCount, mm), up to `order`. Answers false, and
   * leaves the terms unspecified, where a quadrature point or the cell as a whole is inverted (J <=
   * 0).
   */
  bool CellTerms(std::size_t cell, const std::vector<double>& x, Order order, Terms& terms) const;
  /// Rate of change of Terms::Gradient with the materials, at positions where no quadrature point
  /// is inverted; `velocity`: one rate per material.
  std::array<double, UnknownsPerCell> GradientRate(std::size_t cell, const std::vector<double>& x,
    const MaterialVelocity& velocity) const;
  /// Measures of one cell at node positions `x` where no quadrature point is inverted.
  CellMeasures MeasuresOf(std::size_t cell, const std::vector<double>& x) const;

private:
  /// Middles, volumes, gradients and areas from the corners' rest positions.
  void MeasureRest();

  std::vector<double> Rest;
  std::vector<std::int32_t> CellNodes;
  std::vector<BoundaryFace> Boundary;
  std::vector<double> Volumes;
  /// Gradients of the barycentric coordinates, 12 per cell, 1/mm.
  std::vector<double> BarycentricGradients;
  std::vector<ElasticMaterial> Table;
  /// How much of a cell is of a material: around each quadrature point and of the whole.
  struct Part
  {
    int Material = 0;
    std::array<double, PointsPerCell> Around{ 1, 1, 1, 1 };
    double Whole = 1;
  };
  /// Those of cell c are PartStarts[c] to PartStarts[c + 1].
  std::vector<Part> Parts;
  std::vector<std::size_t> PartStarts;
  /// 4 per cell.
  std::vector<ShapeEnergy> Shape;
  /// 1 per cell.
  std::vector<double> Kappa;
};
}

#endif
