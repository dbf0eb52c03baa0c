// SPDX-License-Identifier: Apache-2.0
#include "Private/MeshVoxels.h"

#include "mammoray/Foundation/Error.h"

#include <algorithm>
#include <cmath>

namespace mammoray
{
namespace
{
constexpr double MostVoxels = 2147483648.0; // 2^31: 4 GiB

/// The grid around a mesh, without voxels yet.
LabelVolume GridAround(const TetrahedralMesh& mesh, double spacingMm)
{
  LabelVolume volume;
  volume.Spacing = { spacingMm, spacingMm, spacingMm };
  double count = 1;
  for (int axis = 0; axis < 3; ++axis)
  {
    double low = mesh.Point(mesh.Cells[0])[axis];
    double high = low;
    for (const std::int32_t point : mesh.Cells)
    {
      low = std::min(low, mesh.Points[3 * static_cast<std::size_t>(point) + axis]);
      high = std::max(high, mesh.Points[3 * static_cast<std::size_t>(point) + axis]);
    }
    const double voxels = std::ceil((high - low) / spacingMm) + 2;
    count *= voxels;
    if (!(count <= MostVoxels))
    {
      throw InputError("voxels: expected at most 2^31 of " + std::to_string(spacingMm) +
        " mm around the mesh, found more");
    }
    volume.Size[axis] = static_cast<int>(voxels);
    volume.Origin[axis] = 0.5 * (low + high - (voxels - 1) * spacingMm);
  }
  volume.Voxels.resize(static_cast<std::size_t>(count));
  return volume;
}

/// Inverse of the matrix with these columns, by rows.
std::array<Vector3, 3> Inverse(const Vector3& a, const Vector3& b, const Vector3& c)
{
  const double factor = 1 / Dot(a, Cross(b, c));
  return { factor * Cross(b, c), factor * Cross(c, a), factor * Cross(a, b) };
}

/// Gives the voxels whose centres lie in a cell its material.
void FillCell(const TetrahedralMesh& mesh, std::size_t cell, LabelVolume& volume)
{
  std::array<Vector3, 4> corners;
  std::array<int, 3> first{};
  std::array<int, 3> last{};
  for (std::size_t corner = 0; corner < 4; ++corner)
  {
    corners[corner] = mesh.Point(mesh.Cells[4 * cell + corner]);
  }
  for (int axis = 0; axis < 3; ++axis)
  {
    const auto [low, high] =
      std::minmax({ corners[0][axis], corners[1][axis], corners[2][axis], corners[3][axis] });
    const double spacing = volume.Spacing[axis];
    first[axis] = static_cast<int>(std::ceil((low - volume.Origin[axis]) / spacing - 1e-9));
    last[axis] = static_cast<int>(std::floor((high - volume.Origin[axis]) / spacing + 1e-9));
  }
  // Barycentric coordinates of the corners 1 to 3.
  const std::array<Vector3, 3> weights =
    Inverse(corners[1] - corners[0], corners[2] - corners[0], corners[3] - corners[0]);
  // A centre on a face, up to rounding, belongs to the cell that comes last.
  constexpr double Slack = -1e-9;
  for (int k = first[2]; k <= last[2]; ++k)
  {
    for (int j = first[1]; j <= last[1]; ++j)
    {
      for (int i = first[0]; i <= last[0]; ++i)
      {
        const Vector3 offset = volume.PointAt(i, j, k) - corners[0];
        const double b = Dot(weights[0], offset);
        const double c = Dot(weights[1], offset);
        const double d = Dot(weights[2], offset);
        if (b >= Slack && c >= Slack && d >= Slack && 1 - b - c - d >= Slack)
        {
          volume.Voxels[volume.Index(i, j, k)] = static_cast<std::uint16_t>(mesh.Materials[cell]);
        }
      }
    }
  }
}
}

LabelVolume Voxelize(const TetrahedralMesh& mesh, double spacingMm)
{
  if (!(spacingMm > 0) || !std::isfinite(spacingMm))
  {
    throw InputError("voxels: expected a positive spacing, found " + std::to_string(spacingMm));
  }
  if (mesh.Cells.empty())
  {
    throw InputError("voxels: expected a mesh with cells, found none");
  }
  LabelVolume volume = GridAround(mesh, spacingMm);
  for (std::size_t cell = 0; cell < mesh.NumberOfCells(); ++cell)
  {
    FillCell(mesh, cell, volume);
  }
  return volume;
}
}
