// SPDX-License-Identifier: Apache-2.0
#include "CommandTest.h"
#include "SmallBreast.h"
#include "TestResults.h"
#include "VirtualDisplay.h"

#include "mammoray/XRay/PathLengthProjector.h"

#include "vtkDoubleArray.h"
#include "vtkPointData.h"
#include "vtkPoints.h"

namespace
{
using namespace mammoray;

class ViewCommand : public testing_support::CommandTest
{
protected:
  void SetUp() override
  {
    const ViewInput input = test::WriteSmallBreast(this->Folder);
    this->MeshArguments = "view --mesh " + input.Mesh + " --materials " + input.Materials +
      " --orientation LAS --pixel-spacing 0.5";
  }
  /// A folder as 'mammoray register' writes it: the breast squeezed to 0.7 of its height.
  std::string WriteResult()
  {
    const std::string folder = this->Folder.File("result");
    std::filesystem::create_directory(folder);
    const auto grid = ToGrid(test::SmallBreastMesh(), { "air", "fat", "wall", "gland" });
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
    ResultFile result = test::MakeResultFile();
    result.Axes = AnatomicalAxes::FromCode("LAS");
    result.Anchor = { 0, 15, 0 };
    test::SetPose(result, pose);
    result.Placed = PlaceUnit(result.Axes, result.Anchor, {}, pose);
    result.Unit = {};
    result.Grid = { 120, 240, { 59.75, 0.25 }, { 0.0, 0.5 }, { -0.5, 0.0 } };
    result.ConsideredCovariance.clear();
    result.Covariance = test::OnlyThickness(2);
    result.Inputs = { { MaterialTableRole, "table.json", "none" } };
    WriteResultFile(result, folder);
    return folder;
  }
  bool CanShow()
  {
    return testing_support::VirtualDisplay::Instance().Works() && !ListDevices().empty();
  }
  std::string MeshArguments;
};

TEST_F(ViewCommand, WritesAScreenshotOfAMesh)
{
  if (!this->CanShow())
  {
    GTEST_SKIP() << "no Vulkan device or no Xvfb";
  }
  const std::string picture = this->Folder.File("view.png");
  ASSERT_EQ(this->Run(this->MeshArguments + " --pixel 60 80 --benchmark 2 --screenshot " + picture),
    0)
    << this->Errors;
  EXPECT_THAT(this->Output, testing::HasSubstr("frames per second"));
  EXPECT_THAT(this->Output, testing::HasSubstr("pixel (60.0, 80.0): "));
  EXPECT_GT(std::filesystem::file_size(picture), 10000u);
  this->ExpectRefused(this->MeshArguments + " --screenshot " + picture, "exists already");
}

TEST_F(ViewCommand, LocatesInAResult)
{
  if (!this->CanShow())
  {
    GTEST_SKIP() << "no Vulkan device or no Xvfb";
  }
  const std::string folder = this->WriteResult();
  const std::string picture = this->Folder.File("view.png");
  this->ExpectRefused("view --result " + folder + " --screenshot " + picture,
    "table.json, which is not a shipped one");
  ASSERT_EQ(this->Run("view --result " + folder + " --materials " +
              this->Folder.File("table.json") + " --point 20 20 5 --screenshot " + picture),
    0)
    << this->Errors;
  // As 'mammoray locate' says it.
  const std::string seen = this->Output;
  ASSERT_EQ(this->Run("locate --result " + folder + " --point 20 20 5"), 0);
  double column = 0;
  double row = 0;
  double major = 0;
  double minor = 0;
  ASSERT_EQ(
    std::sscanf(this->Output.c_str() + this->Output.find("pixel"), "pixel %lf %lf", &column, &row),
    2);
  ASSERT_EQ(std::sscanf(this->Output.c_str() + this->Output.find("uncertainty"),
              "uncertainty %lf x %lf", &major, &minor),
    2);
  char expected[80];
  std::snprintf(expected, sizeof expected, "pixel (%.1f, %.1f)", column, row);
  EXPECT_THAT(seen, testing::HasSubstr(expected));
  std::snprintf(expected, sizeof expected, "+- %.2f x %.2f mm (1 sd)", major, minor);
  EXPECT_THAT(seen, testing::HasSubstr(expected));
  EXPECT_GT(major, 0.05);
}

TEST_F(ViewCommand, RefusesInOneLine)
{
  const std::string picture = " --screenshot " + this->Folder.File("view.png");
  this->ExpectRefused(this->MeshArguments + picture, "expected a display, found none",
    "env -u DISPLAY");
  this->ExpectRefused(this->MeshArguments + picture, "cannot open the display :12345",
    "DISPLAY=:12345");
  this->ExpectRefused("view --mesh " + this->Folder.File("none.vtu") + " --materials victre",
    "none.vtu: no such file");
  this->ExpectRefused("view --result " + this->Folder.File("none"), "result.json: no such file");
  this->ExpectRefused("view --mesh " + this->Folder.File("breast.vtu"), "expected --materials");
  this->ExpectRefused("view --mesh " + this->Folder.File("breast.vtu") + " --materials victre",
    "material 2 is 'wall'");
  this->ExpectRefused(this->MeshArguments + " --pictures " + this->Folder.File("none"),
    "no such folder");
  this->ExpectRefused(this->MeshArguments + " --screenshot " + this->Folder.File("view.gif"),
    "expected the extension .png");
  EXPECT_EQ(this->Run("view"), 2);
  EXPECT_EQ(this->Run(this->MeshArguments + " --blend 2"), 2);
  EXPECT_FALSE(std::filesystem::exists(this->Folder.File("view.png")));
}
}
