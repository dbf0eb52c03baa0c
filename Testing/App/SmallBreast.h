// SPDX-License-Identifier: Apache-2.0
// A small breast to look at.
#ifndef mammoray_SmallBreast_h
#define mammoray_SmallBreast_h

#include "TestMeshes.h"
#include "TestResults.h"
#include "mammoray/App/ViewedBreast.h"
#include "mammoray/IO/MeshConversion.h"
#include "mammoray/IO/MeshIO.h"

#include "Files.h"
#include "vtkDoubleArray.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkUnstructuredGrid.h"

#include <filesystem>
#include <memory>
#include <string>

namespace mammoray::test
{
inline constexpr const char* SmallTable = R"({ "materials": [
  { "name": "air", "labels": [0] },
  { "name": "fat", "labels": [1], "attenuation": "adipose", "density_g_per_cm3": 0.92,
    "youngs_modulus_kpa": 6, "poisson_ratio": 0.48 },
  { "name": "wall", "labels": [2], "attenuation": "muscle", "density_g_per_cm3": 1.05,
    "held": true },
  { "name": "gland", "labels": [3], "attenuation": "glandular", "density_g_per_cm3": 1.03,
    "youngs_modulus_kpa": 12, "poisson_ratio": 0.48 } ] })";

/// x lateral (left), y anterior, z up; gland in the middle.
inline TetrahedralMesh SmallBreastMesh()
{
  TetrahedralMesh mesh = MakeHalfEllipsoidMesh(40, 45, 38, 6);
  for (std::size_t cell = 0; cell < mesh.NumberOfCells(); ++cell)
  {
    Vector3 middle{ 0, 0, 0 };
    for (int corner = 0; corner < 4; ++corner)
    {
      middle = middle + 0.25 * mesh.Point(mesh.Cells[4 * cell + corner]);
    }
    if (mesh.Materials[cell] == 1 && Norm(middle - Vector3{ 5, 20, 3 }) < 14)
    {
      mesh.Materials[cell] = 3;
    }
  }
  return mesh;
}

/// Writes mesh and table, and says how to look at them.
inline ViewInput WriteSmallBreast(const test::TemporaryFolder& folder)
{
  ViewInput input;
  input.Mesh = folder.File("breast.vtu");
  WriteMesh(ToGrid(SmallBreastMesh(), { "air", "fat", "wall", "gland" }), input.Mesh);
  input.Materials = folder.Write("table.json", SmallTable);
  input.Orientation = "LAS";
  input.PixelSpacingMm = 0.5;
  return input;
}

/// A volume around the small breast whose grey is its x.
inline std::shared_ptr<IntensityVolume> Ramp()
{
  auto volume = std::make_shared<IntensityVolume>();
  volume->Size = { 60, 40, 60 };
  volume->Spacing = { 2, 2, 2 };
  volume->Origin = { -60, -20, -60 };
  volume->ForEachVoxel([&](int i, int, int, std::size_t) { volume->Voxels.push_back(i); });
  return volume;
}

/// A folder as 'mammoray register' writes it: the breast squeezed to 0.7 of its height. Its table
/// is that of WriteSmallBreast, which is not shipped.
inline std::string WriteSmallResult(const test::TemporaryFolder& where)
{
  const std::string folder = where.File("result");
  std::filesystem::create_directory(folder);
  const auto grid = ToGrid(SmallBreastMesh(), { "air", "fat", "wall", "gland" });
  vtkNew<vtkDoubleArray> displacement;
  displacement->SetName("Displacement");
  displacement->SetNumberOfComponents(3);
  vtkNew<vtkDoubleArray> sensitivity;
  sensitivity->SetName("Sensitivity_thickness");
  sensitivity->SetNumberOfComponents(3);
  for (vtkIdType id = 0; id < grid->GetNumberOfPoints(); ++id)
  {
    double point[3];
    grid->GetPoint(id, point);
    displacement->InsertNextTuple3(0.15 * point[0], 0, -0.3 * point[2]);
    sensitivity->InsertNextTuple3(0.01 * point[0], 0, 0.01 * point[2]);
  }
  grid->GetPointData()->AddArray(displacement);
  grid->GetPointData()->AddArray(sensitivity);
  WriteMesh(grid, folder + "/uncompressed.vtu");
  for (vtkIdType id = 0; id < grid->GetNumberOfPoints(); ++id)
  {
    double point[3];
    grid->GetPoint(id, point);
    grid->GetPoints()->SetPoint(id, 1.15 * point[0], point[1], 0.7 * point[2]);
  }
  WriteMesh(grid, folder + "/compressed.vtu");
  BreastPose pose;
  pose.ThicknessMm = 54;
  pose.RollDeg = 4;
  pose.AnteriorMm = 5;
  ResultFile result = MakeResultFile();
  result.Axes = AnatomicalAxes::FromCode("LAS");
  result.Anchor = { 0, 15, 0 };
  SetPose(result, pose);
  result.Placed = PlaceUnit({ result.Axes, result.Anchor }, {}, pose);
  result.Unit = {};
  result.Grid = { 120, 240, { 59.75, 0.25 }, { 0.0, 0.5 }, { -0.5, 0.0 } };
  result.ConsideredCovariance.clear();
  result.Covariance = OnlyThickness(2);
  result.Inputs = { { MaterialTableRole, "table.json", "none" } };
  WriteResultFile(result, folder);
  return folder;
}
}

#endif
