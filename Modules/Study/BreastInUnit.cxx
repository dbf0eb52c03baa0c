// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Study/BreastInUnit.h"

#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/MeshConversion.h"
#include "mammoray/IO/MeshIO.h"

#include "vtkDataArray.h"
#include "vtkPointData.h"
#include "vtkUnstructuredGrid.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace mammoray
{
namespace
{
/// Coordinates of a body that programs may have saved as floats, mm.
constexpr double RoundingMm = 1e-3;

double LargestDifference(const Vector3& one, const Vector3& other)
{
  const Vector3 apart = one - other;
  return std::max({ std::abs(apart[0]), std::abs(apart[1]), std::abs(apart[2]) });
}

/// Results are folders, whose files may have been mixed.
vtkSmartPointer<vtkUnstructuredGrid> ReadMeshOfResult(const ResultFile& result,
  const std::string& name)
{
  const std::string path = result.Folder + "/" + name;
  auto grid = ReadMesh(path);
  const std::optional<VolumeFromGantry> placed = FindPlacement(grid);
  const VolumeFromGantry& said = result.Placed;
  if (placed &&
    !(LargestDifference(placed->Origin, said.Origin) <= RoundingMm &&
      LargestDifference(placed->X, said.X) <= RoundingMm &&
      LargestDifference(placed->Y, said.Y) <= RoundingMm &&
      LargestDifference(placed->Z, said.Z) <= RoundingMm))
  {
    throw InputError(path + ": expected a mesh placed as " + ResultFileName +
      " says, found one of another registration");
  }
  return grid;
}

/// Whether the compressed points are the uncompressed ones displaced.
bool IsDisplaced(vtkUnstructuredGrid* uncompressed, vtkDataArray* displacement,
  vtkUnstructuredGrid* compressed)
{
  for (vtkIdType point = 0; point < uncompressed->GetNumberOfPoints(); ++point)
  {
    Vector3 from;
    Vector3 to;
    Vector3 by;
    uncompressed->GetPoint(point, from.data());
    compressed->GetPoint(point, to.data());
    displacement->GetTuple(point, by.data());
    if (!(LargestDifference(from + by, to) <= RoundingMm))
    {
      return false;
    }
  }
  return true;
}
}

void DescribeUnit(const ResultFile& result, BreastInUnit& breast)
{
  breast.Placed = result.Placed;
  breast.Unit = result.Unit;
  breast.Grid = result.Grid;
  for (const ResultParameter& parameter : result.Parameters)
  {
    breast.Parameters.push_back(parameter.Name);
  }
  breast.Covariance =
    result.ConsideredCovariance.empty() ? result.Covariance : result.ConsideredCovariance;
}

BreastInUnit ReadBreastInUnit(const ResultFile& result)
{
  BreastInUnit breast;
  breast.Uncompressed = ReadMeshOfResult(result, "uncompressed.vtu");
  vtkDataArray* displacement = breast.Uncompressed->GetPointData()->GetArray("Displacement");
  if (!displacement || displacement->GetNumberOfComponents() != 3)
  {
    throw InputError(result.Folder +
      "/uncompressed.vtu: expected the point array 'Displacement' with 3 components");
  }
  breast.Compressed = ReadMeshOfResult(result, "compressed.vtu");
  if (breast.Compressed->GetNumberOfPoints() != breast.Uncompressed->GetNumberOfPoints() ||
    breast.Compressed->GetNumberOfCells() != breast.Uncompressed->GetNumberOfCells())
  {
    throw InputError(
      result.Folder + ": expected compressed.vtu and uncompressed.vtu of the same mesh");
  }
  if (!IsDisplaced(breast.Uncompressed, displacement, breast.Compressed))
  {
    throw InputError(result.Folder +
      "/compressed.vtu: expected the points of uncompressed.vtu, displaced as its array "
      "'Displacement' says, found others");
  }
  DescribeUnit(result, breast);
  return breast;
}
}
