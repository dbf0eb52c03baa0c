// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_AttachmentEnergy_h
#define mammoray_AttachmentEnergy_h

#include "Private/ElasticBody.h"
#include "Private/Energy.h"
#include "mammoray/Biomechanics/WallAttachment.h"
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
  /// mm; positive on the side of the tissue.
  double Value = 0;
  Vector3 Gradient{ 0, 0, 0 };
  /// Symmetric, 1/mm.
  std::array<Vector3, 3> Hessian{};
};

/**
 * Energy of the elastic layer between the breast and the surface of the held body (muscle, chest
 * wall), which does not move; its pieces are the nodes on that surface:
 *
 *   E = sum over the nodes a of A_a [ k_n / 2 (h(x_a) - h(X_a))^2 + k_t / 2 |P_a (x_a - X_a)|^2 ],
 *
 * A_a: undeformed area around the node, X_a: where it is undeformed, k_n and k_t: WallStiffness,
 * P_a = I - n n^T along the surface at X_a, n = grad h(X_a) / |grad h(X_a)|. h is the height over a
 * smooth surface through the triangles between held and other cells (implicit moving least squares,
 * Kolluri 2008):
 *
 *   h(x) = sum_i w_i n_i . (x - c_i) / sum_i w_i,   w_i = A_i exp(-|x - c_i|^2 / r^2),
 *
 * i: triangles, c_i their middles, n_i their normals, A_i their areas, r = 1.5 mean sides. It is
 * exact for a plane, and goes on beyond the border of the wall: a node that glides stays at its own
 * height, wherever the wall curves. With k_t = 0 it glides freely, and with both large it is held.
 */
class MAMMORAYBIOMECHANICS_EXPORT AttachmentEnergy : public Energy
{
public:
  struct Terms
  {
    double Energy = 0;
    Vector3 Gradient{ 0, 0, 0 };
    std::array<Vector3, 3> Hessian{};
    /// How far the node has left the wall (negative: entered it) and has glided along it, mm.
    double LiftMm = 0;
    double GlideMm = 0;
  };

  /// `heldCells`: one flag per cell of the body. Throws InputError where no tissue meets them.
  AttachmentEnergy(const ElasticBody& body, const std::vector<bool>& heldCells,
    const WallStiffness& stiffness);

  std::size_t NumberOfPieces() const override { return this->NodeIndices.size(); }
  std::span<const std::int32_t> NodesOf(std::size_t n) const override
  {
    return { &this->NodeIndices[n], 1 };
  }
  /// Measures lift and glide. The projected Hessian lacks the part that may be negative.
  bool Add(std::size_t n, const std::vector<double>& x, EnergyOrder order,
    PieceTerms& terms) const override;

  /// The nodes of the body that lie on the wall, ascending.
  const std::vector<std::int32_t>& Nodes() const { return this->NodeIndices; }
  /// Undeformed area of the wall, mm^2.
  double AreaMm2() const;
  void SetStiffness(const WallStiffness& stiffness) { this->Stiffness = stiffness; }
  /// Another undeformed shape of the body, 3 x nodeCount; the surface stays where it is.
  void SetRestPositions(const std::vector<double>& rest);

  /**
   * The terms of the node `Nodes()[n]` at `x`, linear in the stiffness: with its rate in place of
   * it, the rate of the terms. `projected`: without the part of the Hessian that may be negative.
   */
  Terms NodeTerms(std::size_t n, const Vector3& x, const WallStiffness& stiffness,
    bool projected = false) const;

  /// Derivative of that node's gradient by its undeformed position: row, column.
  std::array<Vector3, 3> NodeRestDerivative(std::size_t n, const Vector3& x) const;

  /// mm, at a point of the frame of the mesh.
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
  /// 1 / r^2
  double Sharpness = 1;
};
}

#endif
