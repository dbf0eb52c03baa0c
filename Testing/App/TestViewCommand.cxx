// SPDX-License-Identifier: Apache-2.0
#include "CommandTest.h"
#include "MadeUpStudy.h"
#include "SmallBreast.h"
#include "SurfaceShapes.h"
#include "VirtualDisplay.h"

#include "mammoray/XRay/PathLengthProjector.h"

#include "vtkPolyData.h"

#include <cstdio>
#include <filesystem>

namespace
{
using namespace mammoray;

class ViewCommand : public test::CommandTest
{
protected:
  void SetUp() override
  {
    const ViewInput input = test::WriteSmallBreast(this->Folder);
    this->MeshArguments = "view --mesh " + input.Mesh + " --materials " + input.Materials +
      " --orientation LAS --pixel-spacing 0.5";
  }
  std::string WriteResult() { return test::WriteSmallResult(this->Folder); }
  bool CanShow() { return test::VirtualDisplay::Instance().Works() && !ListDevices().empty(); }
  std::string MeshArguments;
};

TEST_F(ViewCommand, WritesAScreenshotOfAMesh)
{
  if (!this->CanShow())
  {
    GTEST_SKIP() << "no Vulkan device or no Xvfb";
  }
  const std::string picture = this->Folder.File("view.png");
  ASSERT_EQ(this->Run(this->MeshArguments + " --pixel 60 80 --screenshot " + picture), 0)
    << this->Errors;
  EXPECT_THAT(this->Output, testing::HasSubstr("pixel (60.0, 80.0): "));
  EXPECT_GT(std::filesystem::file_size(picture), 10000u);
  this->ExpectRefused(this->MeshArguments + " --screenshot " + picture, "exists already");
}

TEST_F(ViewCommand, TakesOneOfTheVolumesOfAFolderAsFuseDoes)
{
  test::MadeUpStudy files;
  files.AddSlices(test::MadeUpMr("1.2.4", "t1"), 30);
  files.AddSlices(test::MadeUpMr("1.2.5", "t1_spair"), 50);
  const std::string folder = files.File("DICOM");
  const std::string listing =
    "expected one volume, found 2: 1 't1' (30 slices of 70 x 40), 2 't1_spair' (50 slices of 70 x "
    "40); set --series";
  for (const std::string& command :
    { this->MeshArguments + " --screenshot " + this->Folder.File("a.png"),
      "fuse --result " + this->WriteResult() + " -o " + this->Folder.File("a.nrrd") })
  {
    // fuse warns of the doubtful result before.
    EXPECT_EQ(this->Run(command + " --image " + folder), 1) << command;
    EXPECT_THAT(this->Errors, testing::HasSubstr(listing));
    EXPECT_EQ(this->Run(command + " --image " + folder + " --series 3"), 1) << command;
    EXPECT_THAT(this->Errors, testing::HasSubstr("expected a volume from 1 to 2, found 3"));
  }
  ViewInput input = test::WriteSmallBreast(this->Folder);
  input.Image = folder;
  input.ImageSeries = 2;
  EXPECT_EQ(ReadViewedBreasts(input).front().Image->Size[2], 50);
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

TEST_F(ViewCommand, ShowsSurfacesAndScenes)
{
  if (!this->CanShow())
  {
    GTEST_SKIP() << "no Vulkan device or no Xvfb";
  }
  SurfaceMesh box;
  shapes::AddBox(box, { -50, -50, -100 }, { 50, 50, 100 }, 1);
  const std::string file = this->Folder.File("box.stl");
  WriteMesh(ToPolyData(box, {}), file);
  const std::string scene = this->Folder.Write("scene.json", R"({ "unit": "um",
    "source": { "beam-direction": [0, 1, 0] },
    "detector": { "origin": [-63, 500, 63], "column-direction": [1, 0, 0],
      "row-direction": [0, 0, -1], "columns": 64, "rows": 64, "pixel-spacing": 2 },
    "beam": { "kev": 30 },
    "samples": [ { "file": "box.stl", "unit": "um", "material": "Ti" } ] })");
  const std::string picture = this->Folder.File("view.png");
  const std::string output = " --overwrite --size 600 500 --screenshot " + picture;
  ASSERT_EQ(this->Run("view --scene " + scene + " --pixel 32 32" + output), 0) << this->Errors;
  EXPECT_EQ(this->Errors, "");
  EXPECT_THAT(this->Output, testing::HasSubstr("pixel (32.0, 32.0): transmission "));
  EXPECT_THAT(this->Output, testing::HasSubstr(", Ti 100 um\n"));
  EXPECT_GT(std::filesystem::file_size(picture), 5000u);
  ASSERT_EQ(this->Run("view --surface Ti=" + file + " --kev 100 --pixel 255 255" + output), 0)
    << this->Errors;
  EXPECT_THAT(this->Output, testing::HasSubstr(", Ti 100.0 mm\n"));
  ASSERT_EQ(this->Run("view --surface Ti=" + file + " --unit um --kev 30 --pixel 255 255" + output),
    0)
    << this->Errors;
  EXPECT_THAT(this->Output, testing::HasSubstr(", Ti 100 um\n"));
  ASSERT_EQ(this->Run("view --scene " + scene + " --kev 20" + output), 0) << this->Errors;
  this->ExpectRefused("view --scene " + scene + " --blend 0.2" + output,
    "--blend: expected a breast");
  this->ExpectRefused("view --scene " + scene + " --pixel 64 0" + output, "64 x 64");
  this->ExpectRefused(this->MeshArguments + " --kev 20" + output, "--kev: expected --surface");
  this->ExpectRefused("view --scene " + this->Folder.Write("none.json", "{}") + output,
    "expected samples to look at");
  this->ExpectRefused("view --scene " + this->Folder.Write("half.json", R"({
      "source": { "position": [0, -500, 0] },
      "samples": [ { "file": "box.stl", "unit": "um", "material": "Ti" } ] })") +
      output,
    "expected both source and detector, or neither");
}

TEST_F(ViewCommand, RefusesInOneLine)
{
  const std::string picture = " --screenshot " + this->Folder.File("view.png");
  this->ExpectRefused(this->MeshArguments + picture, "expected a display, found none",
    "env -u DISPLAY");
  this->ExpectRefused(this->MeshArguments + picture, "cannot open the display :12345",
    "DISPLAY=:12345");
  this->ExpectRefused(this->MeshArguments, "expected --screenshot; 'mammoray app' opens a window");
  this->ExpectRefused("view --mesh " + this->Folder.File("none.vtu") + " --materials victre" +
      picture,
    "none.vtu: no such file");
  this->ExpectRefused("view --result " + this->Folder.File("none") + picture,
    "result.json: no such file");
  this->ExpectRefused("view --mesh " + this->Folder.File("breast.vtu") + picture,
    "expected a material table beside a mesh; set --materials");
  this->ExpectRefused("view --mesh " + this->Folder.File("breast.vtu") + " --materials victre" +
      picture,
    "material 'wall' is not in the material table 'VICTRE phantoms'");
  this->ExpectRefused(this->MeshArguments + " --screenshot " + this->Folder.File("view.gif"),
    "expected the extension .png");
  this->ExpectRefused("app " + this->Folder.File("none"), "none: no such file or folder");
  this->ExpectRefused("app --mammogram " + this->Folder.File("none.dcm"), "none.dcm: no such file");
  EXPECT_EQ(this->Run("view"), 2);
  EXPECT_EQ(this->Run(this->MeshArguments + " --blend 2"), 2);
  EXPECT_FALSE(std::filesystem::exists(this->Folder.File("view.png")));
}
}
