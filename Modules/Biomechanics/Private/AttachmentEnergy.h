// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_AttachmentEnergy_h
#define mammoray_AttachmentEnergy_h

#include "Private/ElasticBody.h"
#include "Private/Energy.h"
#include "mammoray/Biomechanics/CompressionSimulation.h"
#include "mammoray/Foundation/Vector3.h"
#include "mammorayBiomechanicsModule.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace mammoray
{
/// Height over a surface with its first and second derivatives.
struct SurfaceHeight
{
  /// Height, mm; positive on the side of the moving tissue.
  double Value = 0;
  Vector3 Gradient{ 0, 0, 0 };
  /// Symmetric, 1/mm.
  std::array<Vector3, 3> Hessian{};
};

/**
 * Energy of the elastic layer between the breast and the surface of the fixed body (muscle, chest
 * wall), which does not move. Its pieces are the nodes on that surface:
 *
 *   E = sum over the nodes a of A_a [ k_n / 2 (h(x_a) - h(X_a))^2 + k_t / 2 |P_a (x_a - X_a)|^2 ]
 *
 * A_a is the undeformed area around the node, X_a its undeformed position, k_n and k_t are
 * WallStiffness, and P_a = I - n n^T projects on the surface at X_a with n = grad h(X_a) / |grad
 * h(X_a)|. h is the height over a smooth surface through the triangles between fixed and other
 * cells (implicit moving least squares, Kolluri 2008):
 *
 *   h(x) = sum_i w_i n_i . (x - c_i) / sum_i w_i,   w_i = A_i exp(-|x - c_i|^2 / r^2)
 *
 * with the triangles' centroids c_i, normals n_i and areas A_i, and r = 1.5 times the mean side. h
 * is exact for a plane and is defined beyond the border of the wall. A sliding node keeps its
 * height, however the wall curves. With k_t = 0 it slides freely; with both stiffnesses large it is
 * fixed.
 */
class MAMMORAYBIOMECHANICS_EXPORT AttachmentEnergy : public Energy
{
public:
  struct Terms
  {
    double Energy = 0;
    Vector3 Gradient{ 0, 0, 0 };
    std::array<Vector3, 3> Hessian{};
    /// Distance that the node has moved away from the wall (negative: into it) and along it, mm.
    double LiftMm = 0;
    double GlideMm = 0;
  };

  /// `fixedCells` holds one flag per cell of the body. Throws InputError if no moving tissue
  /// touches these cells.
  AttachmentEnergy(const ElasticBody& body, const std::vector<bool>& fixedCells,
    const WallStiffness& stiffness);

  std::size_t NumberOfPieces() const override { return this->NodeIndices.size(); }
  std::span<const std::int32_t> NodesOf(std::size_t n) const override
  {
    return { &this->NodeIndices[n], 1 };
  }
  /// Measures lift and glide. The projected Hessian omits the part that can be negative.
  bool Add(std::size_t n, const std::vector<double>& x, EnergyOrder order,
    PieceTerms& terms) const override;

  /// Nodes of the body on the wall, ascending.
  const std::vector<std::int32_t>& Nodes() const { return this->NodeIndices; }
  void SetStiffness(const WallStiffness& stiffness) { this->Stiffness = stiffness; }
  /// Sets another undeformed shape of the body, 3 x nodeCount; the surface stays in place.
  void SetRestPositions(const std::vector<double>& rest);

  /// The terms of the node `Nodes()[n]` at `x`. They are linear in the stiffness, so passing its
  /// derivative yields the derivative of the terms. `projected` omits the part of the Hessian that
  /// can be negative.
  Terms NodeTerms(std::size_t n, const Vector3& x, const WallStiffness& stiffness,
    bool projected = false) const;

  /// Derivative of that node's gradient with respect to its undeformed position; [row][column].
  std::array<Vector3, 3> NodeRestDerivative(std::size_t n, const Vector3& x) const;

  /// Height at a position in the frame of the mesh.
  SurfaceHeight HeightAt(const Vector3& x) const;

private:
  struct Triangle
  {
    Vector3 Middle;
    Vector3 Normal;
    double Area;
  };
  struct Node
  {
    double Area = 0;
    Vector3 Rest{ 0, 0, 0 };
    double RestHeight = 0;
    Vector3 Normal{ 0, 0, 0 };
  };
  WallStiffness Stiffness;
  std::vector<Triangle> Triangles;
  std::vector<std::int32_t> NodeIndices;
  std::vector<Node> NodeValues;
  /// 1 / r^2 of the class comment, 1/mm^2.
  double Sharpness = 1;
};
}

#endif
