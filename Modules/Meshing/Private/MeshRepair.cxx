// SPDX-License-Identifier: Apache-2.0
#include "Private/MeshRepair.h"

#include "Private/CellImprovement.h"
#include "Private/MeshingSteps.h"
#include "Private/PinchRepair.h"

namespace mammoray
{
std::size_t MendInterfaces(TetrahedralMesh& mesh, double smallestDihedralDeg,
  const ProgressCallback& progress)
{
  mesh.Validate("mesh");
  EditableMesh edited(mesh);
  const std::size_t pinched = RepairPinches(edited, Within(progress, 0.0, 0.5));
  if (pinched > 0)
  {
    ImproveCells(edited, smallestDihedralDeg, 0, Within(progress, 0.5, 1.0));
    mesh = edited.Finish();
  }
  return pinched;
}
}
