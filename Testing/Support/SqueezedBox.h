// SPDX-License-Identifier: Apache-2.0
// A result whose deformation is known in closed form.
#ifndef mammoray_SqueezedBox_h
#define mammoray_SqueezedBox_h

#include "Files.h"
#include "TestMeshes.h"
#include "TestResults.h"
#include "mammoray/IO/MeshConversion.h"
#include "mammoray/IO/MeshIO.h"
#include "mammoray/Study/RegisteredBreast.h"

#include "vtkDoubleArray.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkUnstructuredGrid.h"

#include <gtest/gtest.h>

#include <memory>

namespace mammoray::test
{
/// A box of 60 x 50 x 40 mm that is squeezed to half its height, 40 to 20 mm, widened by a quarter
/// and moved. One parameter, "thickness", moves all of it along x, 1 mm for each of its own.
class SqueezedBox : public ::testing::Test
{
protected:
  static constexpr double Low[3] = { -30, 0, -20 };
  static constexpr double High[3] = { 30, 50, 20 };
  static constexpr double ThicknessSigmaMm = 2;

  static Vector3 Squeezed(const Vector3& p) { return { 1.25 * p[0], p[1] + 3, 0.5 * p[2] + 12 }; }

  void SetUp() override
  {
    const TetrahedralMesh mesh =
      MakeBoxMesh({ Low[0], Low[1], Low[2] }, { High[0], High[1], High[2] }, { 3, 3, 3 });
    const auto uncompressed = ToGrid(mesh, { "air", "fat" });
    TetrahedralMesh moved = mesh;
    vtkNew<vtkDoubleArray> displacement;
    displacement->SetName("Displacement");
    displacement->SetNumberOfComponents(3);
    vtkNew<vtkDoubleArray> sensitivity;
    sensitivity->SetName("Sensitivity_thickness");
    sensitivity->SetNumberOfComponents(3);
    for (std::size_t p = 0; p < mesh.NumberOfPoints(); ++p)
    {
      const Vector3 to = Squeezed(mesh.Point(static_cast<std::int32_t>(p)));
      const Vector3 by = to - mesh.Point(static_cast<std::int32_t>(p));
      std::copy(to.begin(), to.end(), &moved.Points[3 * p]);
      displacement->InsertNextTuple(by.data());
      sensitivity->InsertNextTuple3(1, 0, 0);
    }
    uncompressed->GetPointData()->AddArray(displacement);
    uncompressed->GetPointData()->AddArray(sensitivity);
    WriteMesh(uncompressed, this->Folder.File("uncompressed.vtu"));
    WriteMesh(ToGrid(moved, { "air", "fat" }), this->Folder.File("compressed.vtu"));
    // The unit stands in the volume frame; the image's rows run against x.
    ResultFile result = MakeResultFile();
    result.Placed = {};
    result.Unit = {};
    result.Grid = { 30, 50, { 48, 1 }, { 0, 2 }, { -2, 0 } };
    result.ConsideredCovariance.clear();
    result.Covariance = OnlyThickness(ThicknessSigmaMm);
    WriteResultFile(result, this->Folder.File(""));
    this->Breast = std::make_unique<RegisteredBreast>(this->Folder.File(""));
  }

  test::TemporaryFolder Folder;
  std::unique_ptr<RegisteredBreast> Breast;
};
}

#endif
