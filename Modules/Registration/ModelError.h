// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_ModelError_h
#define mammoray_ModelError_h

#include "mammoray/Foundation/MammographyGeometry.h"
#include "mammoray/Foundation/TetrahedralMesh.h"
#include "mammorayRegistrationModule.h"

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

namespace mammoray
{
struct ViewResult;

/// Distance of tissue from where a result places it, mm: median and 95 % quantile.
struct ExpectedError
{
  double MedianMm = 0;
  double Most95Mm = 0;
};

/**
 * What a model of tissue gets wrong beyond the parameters that are found (stiffness, chest wall,
 * segmentation, the shape without load): standard deviation of each coordinate of a compressed
 * point, by so much anywhere, mm, and by this share of its deformation, which is its displacement
 * less the rigid motion of the tissue between the plates. So much holds 95 % of the coordinates of
 * virtual studies of patients' anatomies, and more of phantoms' (docs/accuracy.md, "How sure").
 */
inline constexpr double ModelErrorMm = 0.3;
inline constexpr double ModelErrorShare = 0.12;

/// The model's own error, by the deformation of one compressed breast.
class MAMMORAYREGISTRATION_EXPORT ModelError
{
public:
  /// `points`: those of the anatomy when compressed, 3 x pointCount, volume frame, mm.
  ModelError(const TetrahedralMesh& anatomy, const std::vector<double>& points,
    const VolumeFromGantry& placed);

  /// Standard deviation of each coordinate of a point, mm; `rest`, `compressed`: its places.
  double SigmaMm(const Vector3& rest, const Vector3& compressed) const;

  /// Cells that stand for equal shares of the tissue between the plates; of all tissue if none lies
  /// in front of the plates' edge.
  const std::vector<std::size_t>& CellsBetween() const { return this->Cells; }

private:
  std::vector<std::size_t> Cells;
  /// Rigid motion nearest to theirs: rest -> Rotation rest + Shift, row by row.
  std::array<Vector3, 3> Rotation{};
  Vector3 Shift{ 0, 0, 0 };
};

/// Of the tissue between the plates, by the covariance of the parameters (ConsideredCovariance,
/// else Covariance) and the model's own error; nothing where the result has neither covariance.
MAMMORAYREGISTRATION_EXPORT std::optional<ExpectedError> ExpectedErrorOf(
  const TetrahedralMesh& anatomy, const ViewResult& result);
}

#endif
