// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_ElasticBody_h
#define mammoray_ElasticBody_h

#include "mammoray/Biomechanics/ElasticMaterial.h"
#include "mammoray/Foundation/TetrahedralMesh.h"
#include "mammoray/Foundation/Vector3.h"
#include "mammorayBiomechanicsModule.h"

#include <array>
#include <cstdint>
#include <functional>
#include <span>
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

/// How tetrahedra carry the displacement and share the volume constraint; see ElasticBody.
enum class ElementType
{
  Quadratic,
  PatchAveragedLinear
};

/**
 * Tetrahedra with straight sides at rest, and their elastic energy
 *
 *   E = sum over elements of [ sum_q w_q (w(J_q^(-2/3) tr F_q^T F_q - 3; mu_q, b_q) + kappa_p / 2
 * (J_q - 1)^2) + (kappa - kappa_p) / 2 V (Jbar - 1)^2 ],
 *
 * w: ShapeEnergy, q: quadrature points, w_q their weights in the undeformed element, J_q = det F_q,
 * Jbar the mean of J_q, V the undeformed volume, kappa the mean of kappa_q, kappa_p = min(kappa, r
 * mu), mu the mean of mu_q. What acts on Jbar is one constraint for the element; acting at every
 * point it would be more constraints than the nodes can meet (locking).
 *
 * - Quadratic: ten nodes, the 4-point rule of degree 2; the element is the cell (P2/P0; Boffi,
 *   Brezzi & Fortin 2013, section 8.6); r = 50: the mean alone would let the points of a cell swell
 *   and shrink against each other.
 * - PatchAveragedLinear: four nodes, one point; the element is a patch of about 8 cells (the
 * patches of de Souza Neto, Andrade Pires & Owen 2005, put as an energy, so that forces have a
 *   potential and the stiffness is symmetric); r = 0: cells whose neighbours swell against them are
 *   sheared, which costs enough. Patches depend on the mesh alone, so that states outlive a change
 *   of materials. They may hold cells of several materials: strands of gland one cell thick would
 *   lock otherwise, and the pressure, of which a patch has one, is what tissues side by side nearly
 *   have in common.
 *
 * Node order of a quadratic cell: the four corners, then the middles of (0,1) (1,2) (0,2) (0,3)
 * (1,3) (2,3), as in VTK. Energies are in kPa mm^3 = 1e-6 J, forces in kPa mm^2 = 1e-3 N.
 */
class MAMMORAYBIOMECHANICS_EXPORT ElasticBody
{
public:
  /// A triangle of the boundary: its element, the element's local nodes (3 corners, and for
  /// quadratic cells 3 middles; NodesPerFace()), its area in mm^2.
  struct BoundaryFace
  {
    std::int32_t Element = 0;
    std::array<int, 6> LocalNodes{};
    double Area = 0;
  };

  /// What ElementTerms computes of one element with n nodes; rows and columns are 3 * local node +
  /// axis.
  struct Terms
  {
    double Energy = 0;
    /// 3 n
    std::vector<double> Gradient;
    /// (3 n)^2, symmetric, both halves filled.
    std::vector<double> Hessian;
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

  /// Where the energy is defined: where J > 0 everywhere, or, with the power of J continued by a
  /// parabola below J = 0.1 and Fung's law without its exponential, at all positions, inverted
  /// cells at a finite price.
  enum class Domain
  {
    Admissible,
    Extended
  };

  /**
   * `materials` is indexed by the materials of the cells. With a `field`, mu, kappa and mu b of a
   * quadrature point (the energy to second order in the strain's square) are the arithmetic means
   * over the points of a regular lattice in the cell that lie nearest to it (by largest barycentric
   * coordinate); where the field answers 0 or a material
   * m with `ignored[m]` the cell's own material counts. Patches do not hold cells of ignored
   * materials and others: what is held would stiffen nothing but dilute the volume of the rest.
   * Throws InputError on a bad mesh or material.
   */
  ElasticBody(const TetrahedralMesh& mesh, const std::vector<ElasticMaterial>& materials,
    const MaterialField& field = {}, const std::vector<bool>& ignored = {},
    ElementType type = ElementType::Quadratic);

  /// Other constants for the materials, as many as at construction. Throws InputError.
  void SetMaterials(const std::vector<ElasticMaterial>& materials);
  const std::vector<ElasticMaterial>& Materials() const { return this->Table; }
  /**
   * Another undeformed shape of the same cells, whose materials they keep: `corners` are the
   * coordinates of the points of the linear mesh, mm; sides stay straight. The caller sees to it
   * that no cell is turned inside out (CellVolume).
   */
  void SetRestCorners(const std::vector<double>& corners);

  ElementType Type() const { return this->Kind; }
  /// 10 or 4.
  int NodesPerCell() const { return this->Kind == ElementType::Quadratic ? 10 : 4; }
  /// 6 or 3.
  int NodesPerFace() const { return this->Kind == ElementType::Quadratic ? 6 : 3; }
  std::size_t NumberOfNodes() const { return this->Rest.size() / 3; }
  std::size_t NumberOfCells() const { return this->Volumes.size(); }
  /// Undeformed positions, 3 x nodeCount, mm. The first nodes are the points of the linear mesh.
  const std::vector<double>& RestPositions() const { return this->Rest; }
  /// NodesPerCell() x cellCount node indices.
  const std::vector<std::int32_t>& Cells() const { return this->CellNodes; }
  /// The cells, or the patches of them.
  std::size_t NumberOfElements() const { return this->ElementVolumes.size(); }
  std::span<const std::int32_t> CellsOf(std::size_t element) const
  {
    return { this->ElementCells.data() + this->CellStarts[element],
      this->ElementCells.data() + this->CellStarts[element + 1] };
  }
  /// Node indices in local order.
  std::span<const std::int32_t> NodesOf(std::size_t element) const
  {
    return { this->ElementNodes.data() + this->NodeStarts[element],
      this->ElementNodes.data() + this->NodeStarts[element + 1] };
  }
  const std::vector<BoundaryFace>& Faces() const { return this->Boundary; }
  /// Undeformed volume of a cell, mm^3, and its mean density, g/cm^3.
  double CellVolume(std::size_t cell) const { return this->Volumes[cell]; }
  double CellDensity(std::size_t cell) const;
  /// The integrals over the undeformed body of each node's shape function times a value that is
  /// constant in each cell; mm^3 times the unit of `cellValues`.
  std::vector<double> NodeIntegrals(const std::vector<double>& cellValues) const;
  /// Undeformed volume, mm^3.
  double ElementVolume(std::size_t element) const { return this->ElementVolumes[element]; }
  /// Mean shear modulus, kPa.
  double ElementShearModulus(std::size_t element) const { return this->Mu[element]; }

  /**
   * Terms of one element at node positions `x` (3 x nodeCount, mm), up to `order`. Answers false,
   * and leaves the terms unspecified, where the energy is not defined.
   */
  bool ElementTerms(std::size_t element, const std::vector<double>& x, Order order, Terms& terms,
    Domain domain = Domain::Admissible) const;
  /// Rate of change of Terms::Gradient with the materials, at positions where no quadrature point
  /// is inverted; `velocity`: one rate per material.
  std::vector<double> GradientRate(std::size_t element, const std::vector<double>& x,
    const MaterialVelocity& velocity) const;
  /// Measures of one cell at node positions `x` where no quadrature point is inverted.
  CellMeasures MeasuresOf(std::size_t cell, const std::vector<double>& x) const;

private:
  /// How much of a cell is of a material: around each quadrature point and of the whole.
  struct Part
  {
    int Material = 0;
    std::array<double, 4> Around{};
    double Whole = 0;
  };

  int PointsPerCell() const { return this->Kind == ElementType::Quadratic ? 4 : 1; }
  /// r
  double LargestPointwiseRatio() const { return this->Kind == ElementType::Quadratic ? 50 : 0; }
  void AddNodesAndCells(const TetrahedralMesh& mesh);
  /// Middles, volumes and gradients of the cells from their corners at rest.
  void MeasureRest();
  void MakeElements(const TetrahedralMesh& mesh, const std::vector<bool>& ignored);
  void FindBoundary(const TetrahedralMesh& mesh);
  void SampleMaterials(const TetrahedralMesh& mesh, int materialCount, const MaterialField& field,
    const std::vector<bool>& ignored);
  /// The quadrature points of a cell in a deformed body.
  template <typename Cell, typename State>
  void DeformCell(std::size_t cell, const std::vector<double>& x, State* states) const;
  template <typename Cell>
  bool TermsOf(std::size_t element, const std::vector<double>& x, Order order, Domain domain,
    Terms& terms) const;
  template <typename Cell>
  std::vector<double> RateOf(std::size_t element, const std::vector<double>& x,
    const MaterialVelocity& velocity) const;
  template <typename Cell>
  CellMeasures CellMeasuresOf(std::size_t cell, const std::vector<double>& x) const;

  ElementType Kind;
  std::vector<double> Rest;
  std::vector<std::int32_t> CellNodes;
  /// Place of each of a cell's nodes in its element, NodesPerCell() per cell.
  std::vector<int> LocalNodes;
  /// Those of element e are CellStarts[e] to CellStarts[e + 1]; nodes likewise.
  std::vector<std::int32_t> ElementCells;
  std::vector<std::int32_t> ElementNodes;
  std::vector<std::size_t> CellStarts;
  std::vector<std::size_t> NodeStarts;
  std::vector<BoundaryFace> Boundary;
  /// Of the cells and of the elements.
  std::vector<double> Volumes;
  std::vector<double> ElementVolumes;
  /// Gradients of the barycentric coordinates, 12 per cell, 1/mm.
  std::vector<double> BarycentricGradients;
  std::vector<ElasticMaterial> Table;
  /// Those of cell c are PartStarts[c] to PartStarts[c + 1].
  std::vector<Part> Parts;
  std::vector<std::size_t> PartStarts;
  /// PointsPerCell() per cell.
  std::vector<ShapeEnergy> Shape;
  /// Means over each element.
  std::vector<double> Mu;
  std::vector<double> Kappa;
};
}

#endif
