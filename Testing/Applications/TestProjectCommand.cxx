// SPDX-License-Identifier: Apache-2.0
#include "CommandTest.h"
#include "DicomTesting.h"
#include "SurfaceShapes.h"
#include "mammoray/Dicom/DicomReader.h"
#include "mammoray/IO/MeshConversion.h"
#include "mammoray/IO/MeshIO.h"
#include "mammoray/XRay/PathLengthProjector.h"

#include "vtkPolyData.h"
#include "vtkUnstructuredGrid.h"

#include <sys/mount.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

using namespace mammoray;
using test::ReadFile;

namespace
{
bool HasDevice()
{
  const auto devices = ListDevices();
  return !devices.empty();
}

class ProjectCommand : public test::CommandTest
{
protected:
  void SetUp() override
  {
    // A brick of 40 x 60 x 20 mm (x, y, z) of fat, LPS.
    TetrahedralMesh mesh;
    for (int corner = 0; corner < 8; ++corner)
    {
      mesh.Points.insert(mesh.Points.end(),
        { (corner & 1) != 0 ? 40.0 : 0.0, (corner & 2) != 0 ? 60.0 : 0.0,
          (corner & 4) != 0 ? 20.0 : 0.0 });
    }
    mesh.Cells = { 0, 1, 2, 4, 3, 2, 1, 7, 5, 4, 7, 1, 6, 7, 4, 2, 1, 2, 4, 7 };
    mesh.Materials.assign(5, 1);
    WriteMesh(ToGrid(mesh, { "air", "fat" }), this->Mesh);
    this->Folder.Write("table.json", R"({"materials": [{"name": "air", "labels": [0]},
      {"name": "fat", "labels": [1], "attenuation": "adipose", "density_g_per_cm3": 0.92}]})");
  }

  std::string Mesh = this->Folder.File("mesh.vtu");
  std::string Image = this->Folder.File("image.mha");
  std::string Inputs =
    "project --mesh " + this->Mesh + " --materials " + this->Folder.File("table.json");
};
}

TEST_F(ProjectCommand, UnitAroundABrickMatchesClosedForm)
{
  if (!HasDevice())
  {
    GTEST_SKIP() << "no Vulkan device";
  }
  // CC: the source is superior (+z), columns run to anterior (-y), rows to the patient's right
  // (-x). The receptor's edge is at y = 60, its plane 12 mm (half of 20, and 2) below the middle, z
  // = -2.
  const std::string geometry = " --kev 20 --thickness 20 --columns 5 --rows 3 --pixel-spacing 2";
  ASSERT_EQ(this->Run(this->Inputs + geometry + " -o " + this->Image + " --path-lengths " +
              this->Folder.File("lengths.mha")),
    0)
    << this->Errors;
  EXPECT_EQ(this->Errors, "");
  const std::vector<float> transmission = MhaValues(this->Image);
  const std::vector<float> lengths = MhaValues(this->Folder.File("lengths.mha"));
  ASSERT_EQ(transmission.size(), 15u);
  ASSERT_EQ(lengths.size(), 15u);
  for (int row = 0; row < 3; ++row)
  {
    for (int column = 0; column < 5; ++column)
    {
      const double x = 2.0 * (1 - row);
      const double y = 2.0 * (column + 0.5);
      const double expected = 20 * std::sqrt(x * x + y * y + 650 * 650) / 650;
      const auto pixel = static_cast<std::size_t>(5 * row + column);
      ASSERT_NEAR(lengths[pixel], expected, 1e-5);                             // a float of 20 mm
      ASSERT_NEAR(transmission[pixel], std::exp(-0.0512551 * expected), 1e-5); // six digits of mu
    }
  }
  EXPECT_THAT(ReadFile(this->Image), testing::HasSubstr("Offset = 22 59 -2"));

  // The configuration that the same options print gives the same image.
  ASSERT_EQ(this->Run(this->Inputs + geometry + " -o " + this->Image + " --print-config"), 0);
  const std::string config = this->Folder.Write("config.json", this->Output);
  const std::string before = ReadFile(this->Image);
  std::filesystem::remove(this->Image);
  ASSERT_EQ(this->Run("project --config " + config), 0) << this->Errors;
  EXPECT_EQ(ReadFile(this->Image), before);
  for (const char* name : { "image.png", "image.vti", "image.nrrd", "image.tif" })
  {
    EXPECT_EQ(this->Run(this->Inputs + geometry + " -o " + this->Folder.File(name)), 0)
      << this->Errors;
    EXPECT_GT(std::filesystem::file_size(this->Folder.File(name)), 60u);
  }
}

TEST_F(ProjectCommand, WritesADicomMammogram)
{
  const std::string path = this->Folder.File("image.dcm");
  const std::string options = this->Inputs +
    " --kev 20 --thickness 21 --columns 5 --rows 3 --pixel-spacing 2 --overwrite -o " + path;
  this->ExpectRefused(options, "expected --side left or right");
  this->ExpectRefused(options + " --side left --patient-id 'a\\b'", "--patient-id");
  EXPECT_EQ(this->Run(options + " --side B"), 2);
  EXPECT_FALSE(std::filesystem::exists(path));
  if (!HasDevice())
  {
    GTEST_SKIP() << "no Vulkan device";
  }
  this->ExpectRefused(options + " --side left --roll 135", "expected --view");
  ASSERT_EQ(this->Run(options + " --side left --patient-name Phantom^Brick"), 0) << this->Errors;
  test::ExpectValidDicom(path);
  EXPECT_EQ(test::DicomTextOf(path, 0x0010, 0x0010), "Phantom^Brick");
  const Mammogram mammogram = ReadMammogram(path);
  EXPECT_EQ(mammogram.View, "CC");
  EXPECT_EQ(mammogram.RowDirection, "A");
  EXPECT_EQ(mammogram.ColumnDirection, "R");
  EXPECT_EQ(mammogram.BodyPartThicknessMm, 21);
  EXPECT_EQ(mammogram.SourceToPatientMm, 648);
  EXPECT_NEAR(*mammogram.SourceToDetectorMm, 650, 1e-6); // ten digits
  EXPECT_EQ(mammogram.ColumnSpacingMm, 2);
  // Straight below the source but for 1 mm: 20 mm of fat, times 4000, rounded.
  EXPECT_NEAR(mammogram.Pixels[5], 4000 * 0.0512551 * 20, 1);
  ASSERT_EQ(this->Run(options + " --side right --roll 50 --for-processing"), 0) << this->Errors;
  test::ExpectValidDicom(path);
  const Mammogram right = ReadMammogram(path);
  EXPECT_EQ(right.View, "MLO");
  EXPECT_EQ(right.RowDirection, "P"); // hung with its chest wall at the right
}

TEST_F(ProjectCommand, CompositionsReplaceTables)
{
  if (!HasDevice())
  {
    GTEST_SKIP() << "no Vulkan device";
  }
  const std::string geometry = this->Inputs +
    " --kev 20 --thickness 20 --columns 1 --rows 1 --pixel-spacing 0.01 --overwrite -o " +
    this->Image;
  // 20 mm of water, 0.810 / cm at 20 keV (NIST), three digits; twice as dense.
  ASSERT_EQ(this->Run(geometry + " --set attenuations.fat=H2O@1"), 0) << this->Errors;
  const float water = MhaValues(this->Image).front();
  EXPECT_NEAR(-std::log(water), 1.62, 0.002);
  ASSERT_EQ(this->Run(geometry + " --set 'attenuations.fat=H:0.1119 O:0.8881@2'"), 0)
    << this->Errors;
  EXPECT_NEAR(-std::log(MhaValues(this->Image).front()), -2 * std::log(water), 1e-3);
  this->ExpectRefused(geometry + " --set attenuations.fat=Watr", "unknown attenuation 'Watr'");
  this->ExpectRefused(geometry + " --set attenuations.fat", "KEY=VALUE");
  this->ExpectRefused(geometry + " --set attenuations.bone=Ca@2", "bone");
}

TEST_F(ProjectCommand, OverlapIsToldAndFollowsTheRule)
{
  if (!HasDevice())
  {
    GTEST_SKIP() << "no Vulkan device";
  }
  // Slabs of fat, 0 to 10 mm, and of stone, 5 to 12 mm, each a box that says air around it.
  SurfaceMesh slabs;
  shapes::AddBox(slabs, { -50, -50, 0 }, { 50, 50, 10 }, 1);
  shapes::AddBox(slabs, { -50, -50, 5 }, { 50, 50, 12 }, 2);
  const std::string surface = this->Folder.File("slabs.vtp");
  WriteMesh(ToPolyData(slabs, { "air", "fat", "stone" }), surface);
  this->Folder.Write("table.json", R"({"materials": [{"name": "air", "labels": [0]},
      {"name": "fat", "labels": [1], "attenuation": "adipose", "density_g_per_cm3": 0.92, "fixed": true},
      {"name": "stone", "labels": [2], "attenuation": "CaC2O4", "density_g_per_cm3": 2}]})");
  const std::string options = "project --mesh " + surface + " --materials " +
    this->Folder.File("table.json") +
    " --kev 20 --beam-direction 0 0 -1 --detector-origin 0 0 -1 --column-direction 1 0 0 "
    "--row-direction 0 1 0 --columns 3 --rows 2 --overwrite -o " +
    this->Image + " --path-lengths " + this->Folder.File("lengths.mha");
  ASSERT_EQ(this->Run(options), 0) << this->Errors;
  EXPECT_THAT(this->Errors, testing::StartsWith("mammoray: warning: "));
  EXPECT_THAT(this->Errors,
    testing::HasSubstr("2 parts lie in others though their labels say air"));
  EXPECT_THAT(this->Errors, testing::HasSubstr("100 % of the rays"));
  EXPECT_THAT(this->Errors, testing::HasSubstr("5 mm on average"));
  EXPECT_EQ(std::count(this->Errors.begin(), this->Errors.end(), '\n'), 1) << this->Errors;
  const auto lengths = [&] { return MhaValues(this->Folder.File("lengths.mha")); };
  EXPECT_THAT(lengths().front(), testing::FloatNear(10, 1e-4f));
  EXPECT_THAT(lengths().back(), testing::FloatNear(7, 1e-4f));
  ASSERT_EQ(this->Run(options + " --set overlap-priority=stone"), 0) << this->Errors;
  EXPECT_EQ(this->Errors, "");
  EXPECT_THAT(lengths().front(), testing::FloatNear(5, 1e-4f));
  EXPECT_THAT(lengths().back(), testing::FloatNear(7, 1e-4f));
  ASSERT_EQ(this->Run(options + " --set overlap-priority=fat"), 0) << this->Errors;
  EXPECT_THAT(lengths().front(), testing::FloatNear(10, 1e-4f));
  EXPECT_THAT(lengths().back(), testing::FloatNear(2, 1e-4f));
  this->ExpectRefused(options + " --set overlap-priority=bone", "bone");
}

TEST_F(ProjectCommand, ASmallOverlapInALargeSurfaceIsTold)
{
  if (!HasDevice())
  {
    GTEST_SKIP() << "no Vulkan device";
  }
  SurfaceMesh bodies;
  shapes::AddSphere(bodies, { 0, 0, 0 }, 40, 6, 1);
  ASSERT_GT(bodies.NumberOfTriangles(), 20000u);
  const std::string surface = this->Folder.File("bodies.vtp");
  const std::string options = "project --mesh " + surface + " --materials " +
    this->Folder.Write("table.json", R"({"materials": [{"name": "air", "labels": [0]},
      {"name": "fat", "labels": [1], "attenuation": "adipose", "density_g_per_cm3": 0.92, "fixed": true},
      {"name": "stone", "labels": [2], "attenuation": "CaC2O4", "density_g_per_cm3": 2}]})") +
    " --kev 20 --beam-direction 0 0 -1 --detector-origin -40 -40 -50 --column-direction 1 0 0 "
    "--row-direction 0 1 0 --columns 8 --rows 8 --pixel-spacing 10 --overwrite -o " +
    this->Image;
  WriteMesh(ToPolyData(bodies, { "air", "fat" }), surface);
  ASSERT_EQ(this->Run(options), 0) << this->Errors;
  EXPECT_EQ(this->Errors, "");
  shapes::AddSphere(bodies, { 5.3, 5.2, -8 }, 0.1, 1, 2); // between the rays of all pixels
  WriteMesh(ToPolyData(bodies, { "air", "fat", "stone" }), surface);
  ASSERT_EQ(this->Run(options), 0) << this->Errors;
  EXPECT_THAT(this->Errors,
    testing::HasSubstr("1 parts lie in others though their labels say air"));
  EXPECT_THAT(this->Errors, testing::HasSubstr("no ray of this image is changed by it"));
}

TEST_F(ProjectCommand, TubeFiltersAndWhatAUnitAdds)
{
  if (!HasDevice())
  {
    GTEST_SKIP() << "no Vulkan device";
  }
  const std::string options = this->Inputs +
    " --thickness 20 --columns 30 --rows 11 --pixel-spacing 2 --overwrite -o " + this->Image;
  ASSERT_EQ(this->Run(options + " --tube Mo --kvp 28 --filter Mo:0.03"), 0) << this->Errors;
  // Without air; TestTube has the published ones.
  EXPECT_THAT(this->Output,
    testing::HasSubstr("Mo 28 kVp, 0.03 mm Mo, mean 16.7 keV, half-value layer 0.29 mm Al"));
  const std::vector<float> plain = MhaValues(this->Image);
  ASSERT_EQ(this->Run(options +
              " --tube Mo --kvp 28 --filter Mo:0.03 --set source.inverse-square=true"
              " --set source.heel.angle=22 --set source.heel.depth-um=0.5"
              " --set detector.half-modulation=0.2"),
    0)
    << this->Errors;
  const std::vector<float> unit = MhaValues(this->Image);
  // Row 5 runs from the focus' foot to the nipple: there the beam is weaker by distance and heel.
  EXPECT_NEAR(unit[5 * 30] / plain[5 * 30], 1, 0.01);
  EXPECT_LT(unit[5 * 30 + 25], plain[5 * 30 + 25] * 0.99);
  this->ExpectRefused(options + " --tube Mo --filter Mo", "MATERIAL[@DENSITY]:MM");
  this->ExpectRefused(options + " --tube Mo --kev 20",
    "beam: expected one of kev, energies, spectrum, and tube");
  this->ExpectRefused(options + " --set detector.electronic-noise=3", "photons per pixel");
  this->ExpectRefused(options + " --set source.heel.angle=95",
    "source.heel.angle: expected a number from 0.1");
  EXPECT_EQ(this->Run(options + " --tube Cu"), 2);
  EXPECT_EQ(this->Run(options + " --tube W --kvp 451"), 2);
  this->ExpectRefused(options + " --tube Mo --kvp 50", "expected 18 to 42 kVp of an anode of Mo");
  this->ExpectRefused(options + " --tube Mo --set beam.target-angle=12", "tungsten anode only");
  this->ExpectRefused(options + " --kev 20 --set beam.target-angle=12",
    "expected a tube beside it");
  // The tissues' tables end at 60 keV.
  ASSERT_EQ(this->Run(options + " --tube W --kvp 58 --filter Al:2 --filter Cu:0.1"), 0)
    << this->Errors;
  EXPECT_THAT(this->Output, testing::HasSubstr("W 58 kVp, 2 mm Al, 0.1 mm Cu, mean "));
}

TEST_F(ProjectCommand, ScatterByKernelsAndByPhotonsThatAreFollowed)
{
  this->ExpectRefused(this->Inputs + " --set scatter.grid.ratio=5 -o " + this->Image,
    "expected scatter");
  this->ExpectRefused(this->Inputs + " --scatter kernels --source 0 0 600 -o " + this->Image,
    "scatter.air-gap: expected");
  this->ExpectRefused(this->Inputs +
      " --scatter kernels --set refraction.law=geometric --set attenuations.fat=H2O@1 -o " +
      this->Image,
    "or scatter");
  this->ExpectRefused(this->Inputs + " --scatter kernels --set scatter.grid.ratio=0.1 -o " +
      this->Image,
    "scatter.grid.ratio: expected a number from 1 to 30");
  if (!HasDevice())
  {
    GTEST_SKIP() << "no Vulkan device";
  }
  // The middle of the brick, which has 20 mm of fat all around.
  const std::string options = this->Inputs +
    " --kev 20 --thickness 20 --support-height 15 --columns 30 --rows 20 --pixel-spacing 2 "
    "--overwrite -o " +
    this->Image;
  const auto middle = [&](const std::string& more)
  {
    EXPECT_EQ(this->Run(options + more), 0) << this->Errors;
    const std::vector<float> values = MhaValues(this->Image);
    double sum = 0;
    for (int place = 0; place < 64; ++place)
    {
      sum += values[static_cast<std::size_t>((6 + place / 8) * 30 + 11 + place % 8)];
    }
    return sum / 64;
  };
  const double primary = middle("");
  const double kernels = middle(" --scatter kernels") - primary;
  const double followed = middle(" --scatter monte-carlo --set scatter.photons=1e6") - primary;
  EXPECT_GT(kernels, 0.03 * primary);
  // Fat where the kernels have 25 % of gland, and a brick as small as what scatter travels: 15 %.
  EXPECT_NEAR(kernels, followed, 0.15 * followed);
  EXPECT_LT(middle(" --scatter kernels --set scatter.grid.ratio=5") - primary, 0.4 * kernels);
  EXPECT_LT(middle(" --scatter kernels --set scatter.air-gap=100") - primary, 0.7 * kernels);
  // Of its own materials; from a file the same but for three digits. The brick is as small.
  const std::string quick = " --scatter kernels --set scatter.photons=1e5 --make-kernels ";
  const std::string file = this->Folder.File("kernels.csv");
  const double made = middle(quick + file) - primary;
  EXPECT_NEAR(made, followed, 0.15 * followed);
  EXPECT_NEAR(middle(" --scatter kernels --set scatter.kernels=" + file) - primary, made,
    0.005 * made);
  EXPECT_NEAR(middle(" --scatter kernels --set scatter.photons=1e5 --set scatter.kernels=scene") -
      primary,
    made, 1e-6 * primary);
  this->ExpectRefused(this->Inputs +
      " --scatter kernels --set scatter.kernels=none.csv --overwrite -o " + this->Image,
    "none.csv");
}

TEST_F(ProjectCommand, DoseAndTheUnitThatIsLikeARealOne)
{
  const std::string picture = this->Folder.File("picture.png");
  const std::string options =
    this->Inputs + " --thickness 20 --columns 80 --rows 40 --pixel-spacing 1 --overwrite -o ";
  this->ExpectRefused(options + picture + " --display --turn 3", "--display: expected one picture");
  if (!HasDevice())
  {
    GTEST_SKIP() << "no Vulkan device";
  }
  ASSERT_EQ(
    this->Run(options + picture + " --realistic --display --dose --set scatter.photons=1e5"), 0)
    << this->Errors;
  EXPECT_THAT(this->Output, testing::HasSubstr("W 29 kVp, 0.05 mm Rh"));
  EXPECT_THAT(this->Output, testing::HasSubstr("22.0 mm above the detector; "));
  EXPECT_THAT(this->Output, testing::ContainsRegex("fat +44.2 g +0\\.[2-6]"));
  // Dark air, a bright brick.
  const std::string shown = this->Folder.File("shown.mha");
  ASSERT_EQ(this->Run(options + shown + " --display"), 0) << this->Errors;
  const std::vector<float> values = MhaValues(shown);
  EXPECT_LT(values[20 * 80 + 75], 0.2F);
  EXPECT_GT(values[20 * 80 + 30], 0.3F);
  const std::string dicom = this->Folder.File("shown.dcm");
  ASSERT_EQ(this->Run(options + dicom + " --display --side left"), 0) << this->Errors;
  test::ExpectValidDicom(dicom);
  const Mammogram mammogram = ReadMammogram(dicom);
  EXPECT_EQ(mammogram.PresentationIntent, Mammogram::Intent::ForPresentation);
}

TEST_F(ProjectCommand, NoiseAndFocalSpot)
{
  if (!HasDevice())
  {
    GTEST_SKIP() << "no Vulkan device";
  }
  // All of the 60 x 25 pixels of 0.5 mm see the brick, 20 mm of fat.
  const std::string options = this->Inputs +
    " --kev 20 --thickness 20 --columns 60 --rows 25 --pixel-spacing 0.5 --set "
    "detector.response=counting"
    " --set 'source.focal-spot=[0.3, 0.3]' --set source.focal-spot-samples=2 --photons 2000"
    " --set detector.seed=5 --overwrite -o " +
    this->Image;
  ASSERT_EQ(this->Run(options), 0) << this->Errors;
  const std::vector<float> values = MhaValues(this->Image);
  ASSERT_EQ(values.size(), 1500u);
  const double expected = std::exp(-0.0512551 * 20);
  double mean = 0;
  double variance = 0;
  for (const float value : values)
  {
    mean += value / 1500.0;
  }
  for (const float value : values)
  {
    variance += (value - mean) * (value - mean) / 1499;
  }
  // Four standard deviations of each; oblique rays are up to 0.2 % longer, which is 0.2 % of the
  // mean.
  EXPECT_NEAR(mean, expected, 4 * std::sqrt(expected / 2000 / 1500) + 0.002 * expected);
  EXPECT_NEAR(variance, expected / 2000, 4 * expected / 2000 * std::sqrt(2.0 / 1500));
  const std::string before = ReadFile(this->Image);
  ASSERT_EQ(this->Run(options), 0);
  EXPECT_EQ(ReadFile(this->Image), before);

  this->ExpectRefused(options + " --beam-direction 0 0 -1", "point source");
  EXPECT_EQ(this->Run(options + " --photons -1"), 2);
}

TEST_F(ProjectCommand, RefusesInOneLine)
{
  const std::string output = " -o " + this->Image;
  this->ExpectRefused("project --mesh /nowhere.vtu --materials " + this->Folder.File("table.json") +
      output,
    "no such file");
  this->ExpectRefused(this->Inputs + " -o " + this->Folder.File("image.jpg"), ".png");
  this->ExpectRefused(this->Inputs + " -o " + this->Image + " --set attenuations.fat=adipose@920",
    "density from 5e-05 to 23 g/cm3, found 920 (in kg/m3?)");
  // Nobody stated the density.
  this->ExpectRefused(this->Inputs + " -o " + this->Image + " --set attenuations.fat=H2O",
    "attenuation 'H2O': expected a density");
  this->ExpectRefused(this->Inputs + output + " --spectrum W99", "W28kVp");
  this->ExpectRefused(this->Inputs + output + " --orientation XYZ", "orientation");
  this->ExpectRefused(this->Inputs + output + " --kev 3", "keV");
  this->Folder.Write("table.json", R"({"materials": [{"name": "air", "labels": [0]},
      {"name": "fat", "labels": [1], "attenuation": "butter"}]})");
  this->ExpectRefused(this->Inputs + output, "unknown attenuation 'butter'");
  EXPECT_EQ(this->Run(this->Inputs + output + " --rows 0"), 2);
  EXPECT_FALSE(std::filesystem::exists(this->Image));
}

TEST_F(ProjectCommand, WhatAFileSaysIsShownAsLetters)
{
  this->Folder.Write("table.json", R"({"materials": [{"name": "air", "labels": [0]},
      {"name": "fat", "labels": [1], "attenuation": "\u001b[2J\nmammoray: done"}]})");
  this->ExpectRefused(this->Inputs + " -o " + this->Image, "'\\x1b[2J\\x0amammoray: done'");
  // A line feed in a configuration makes no line of ours.
  const std::string config = this->Folder.Write("config.json", R"({"a\nmammoray: forged": 1})");
  EXPECT_EQ(this->Run("project --config " + config), 2);
  EXPECT_THAT(this->Errors, testing::HasSubstr("unknown option 'a\\x0amammoray: forged'"));
}

// Where the limit on files is smaller than what drivers map of them, access ends in SIGBUS: at once
// as in the middle of the work.
TEST_F(ProjectCommand, ALimitOnFilesIsTold)
{
  if (!HasDevice())
  {
    GTEST_SKIP() << "no Vulkan device";
  }
  const std::string small = test::MammorayExecutable() + " devices";
  const std::string large =
    test::MammorayExecutable() + " example veins -o " + this->Folder.File("veins");
  for (const auto& [kibibytes, command] : { std::pair(8, small), std::pair(20000, large) })
  {
    const std::string line = "bash -c 'ulimit -f " + std::to_string(kibibytes) + "; exec " +
      command + "' >/dev/null 2>" + this->Folder.File("err");
    EXPECT_EQ(WEXITSTATUS(std::system(line.c_str())), 1);
    EXPECT_THAT(ReadFile(this->Folder.File("err")),
      testing::ContainsRegex("mammoray: Vulkan: expected at least [0-9]* KiB of file size .ulimit "
                             "-f., where drivers keep memory, found " +
        std::to_string(kibibytes) + "\n$"));
  }
}

// Where a container's user has none Mesa would say twice that it cannot keep its shaders.
TEST_F(ProjectCommand, AUserWithoutAHomeReadsNothingOfLibraries)
{
  if (!HasDevice())
  {
    GTEST_SKIP() << "no Vulkan device";
  }
  const std::string line = "unset XDG_CACHE_HOME MESA_SHADER_CACHE_DIR; HOME=/dev/null exec " +
    test::MammorayExecutable() + " " + this->Inputs + " -o " + this->Image + " >/dev/null 2>" +
    this->Folder.File("err");
  EXPECT_EQ(WEXITSTATUS(std::system(line.c_str())), 0);
  EXPECT_THAT(ReadFile(this->Folder.File("err")), testing::Not(testing::HasSubstr("cache")));
}

TEST_F(ProjectCommand, AFullDiskIsToldAndLeavesNothing)
{
  const auto run = [this](const std::string& arguments)
  {
    return std::system(
      (test::MammorayExecutable() + " " + arguments + " 2>" + this->Folder.File("err")).c_str());
  };
  EXPECT_EQ(WEXITSTATUS(run(this->Inputs + " -o x.mha --print-config >/dev/full")), 1);
  EXPECT_EQ(ReadFile(this->Folder.File("err")),
    "mammoray: standard output: cannot be written (No space left on device)\n");
  const std::string disk = this->Folder.File("disk");
  std::filesystem::create_directory(disk);
  if (!HasDevice() || mount("tmpfs", disk.c_str(), "tmpfs", 0, "size=64k") != 0)
  {
    GTEST_SKIP() << "no Vulkan device, or mounting is not allowed";
  }
  const std::string options =
    this->Inputs + " --kev 20 --columns 200 --rows 300 --photons 1000 --side left -o ";
  for (const std::string name : { "x.vti", "x.mha", "x.nrrd", "x.png", "x.dcm" })
  {
    this->ExpectRefused(options + disk + "/" + name,
      name + ": cannot be written (No space left on device)");
  }
  this->ExpectRefused(options + this->Image + " --path-lengths " + disk + "/x.mha",
    "x.mha: cannot be written (No space left on device)");
  EXPECT_TRUE(std::filesystem::is_empty(disk));
  EXPECT_EQ(umount(disk.c_str()), 0);
  // A closed stream is not taken for a file that is opened later.
  EXPECT_EQ(run(options + this->Image + " --overwrite >&-"), 0);
  EXPECT_THAT(ReadFile(this->Image), testing::StartsWith("ObjectType = Image"));
}

TEST_F(ProjectCommand, WrongUsageSaysWhatWasExpected)
{
  const auto expectUsage = [this](const std::string& arguments, const std::string& text)
  {
    EXPECT_EQ(this->Run(arguments), 2) << arguments;
    EXPECT_THAT(this->Errors, testing::StartsWith(text));
  };
  expectUsage("projet", "unknown command 'projet'; did you mean project?");
  const std::string project = this->Inputs + " -o " + this->Image;
  for (const char* number : { "nan", "inf", "-1", "0", "one" })
  {
    expectUsage(project + " --pixel-spacing " + number,
      std::string("--pixel-spacing: expected a number from 1e-06 to 1000, found ") + number + "\n");
  }
  expectUsage(project + " --photons nan",
    "--photons: expected a number from 0 to 1e+12, found nan\n");
  expectUsage(project + " --support-height -1",
    "--support-height: expected a number not less than 0, found -1\n");
}

TEST_F(ProjectCommand, DevicesWithoutVulkanAreOneLine)
{
  setenv("VK_DRIVER_FILES", "/nonexistent", 1);
  setenv("VK_ICD_FILENAMES", "/nonexistent", 1);
  this->ExpectRefused("devices", "no Vulkan");
  unsetenv("VK_DRIVER_FILES");
  unsetenv("VK_ICD_FILENAMES");
  if (HasDevice())
  {
    EXPECT_EQ(this->Run("devices --projector rasterisation"), 0);
    EXPECT_THAT(this->Output, testing::HasSubstr("chosen: "));
    EXPECT_THAT(this->Output, testing::HasSubstr(", rasterisation"));
    EXPECT_EQ(this->Run("devices --projector rays"), 2);
  }
}
