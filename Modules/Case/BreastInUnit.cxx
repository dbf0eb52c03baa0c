// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Case/BreastInUnit.h"

#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/MeshIO.h"

#include "vtkDataArray.h"
#include "vtkPointData.h"
#include "vtkUnstructuredGrid.h"

namespace mammoray
{
void DescribeUnit(const ResultFile& result, BreastInUnit& breast)
{
  breast.Placed = result.Placed;
  breast.Unit = result.Unit;
  breast.Grid.Columns = result.Grid.Columns;
  breast.Grid.Rows = result.Grid.Rows;
  breast.Grid.Origin = result.Grid.OriginMm;
  breast.Grid.ColumnStep = result.Grid.ColumnStepMm;
  breast.Grid.RowStep = result.Grid.RowStepMm;
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
  breast.Uncompressed = ReadMesh(result.Folder + "/uncompressed.vtu");
  breast.Compressed = ReadMesh(result.Folder + "/compressed.vtu");
  vtkDataArray* displacement = breast.Uncompressed->GetPointData()->GetArray("Displacement");
  if (!displacement || displacement->GetNumberOfComponents() != 3)
  {
    throw InputError(result.Folder +
      "/uncompressed.vtu: expected the point array 'Displacement' with 3 components");
  }
  if (breast.Compressed->GetNumberOfPoints() != breast.Uncompressed->GetNumberOfPoints() ||
    breast.Compressed->GetNumberOfCells() != breast.Uncompressed->GetNumberOfCells())
  {
    throw InputError(
      result.Folder + ": expected compressed.vtu and uncompressed.vtu of the same mesh");
  }
  DescribeUnit(result, breast);
  return breast;
}
}
