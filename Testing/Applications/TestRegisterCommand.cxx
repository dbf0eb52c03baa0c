// SPDX-License-Identifier: Apache-2.0
// The whole way on the shipped phantom, coarse enough for a minute; and every refusal in one line,
// with nothing written.
#include "CommandTest.h"
#include "DicomTesting.h"
#include "Files.h"
#include "mammoray/Dicom/DicomReader.h"
#include "mammoray/IO/LabelVolumeIO.h"
#include "mammoray/IO/MeshConversion.h"
#include "mammoray/IO/MeshIO.h"
#include "mammoray/Study/LandmarkEvaluation.h"
#include "mammoray/Study/LesionShadow.h"
#include "mammoray/Study/RegisteredBreast.h"
#include "mammoray/Study/RegisteredMammogram.h"
#include "mammoray/XRay/PathLengthProjector.h"

#include "vtkUnstructuredGrid.h"

#include <nlohmann/json.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <unistd.h>

#include <algorithm>
#include <bit>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <numeric>
#include <sstream>
#include <thread>

using namespace mammoray;
using test::ReadFile;
namespace fs = std::filesystem;

namespace
{
const std::string Data = test::DataFolder();
const std::string Labels = Data + "/victre-phantom-1/labels.nrrd";
const std::string Materials = Data + "/materials/victre.json";
const std::string MammogramFile = Data + "/victre-phantom-1/victre1_lcc_processing.dcm";

/// Label 3 in voxels of 0.4 mm.
LabelVolume Ball(const Vector3& centre, double radius)
{
  LabelVolume volume;
  const int count = static_cast<int>(2 * radius / 0.4) + 5;
  volume.Size = { count, count, count };
  volume.Spacing = { 0.4, 0.4, 0.4 };
  const double half = 0.2 * (count - 1);
  volume.Origin = centre - Vector3{ half, half, half };
  volume.Voxels.assign(static_cast<std::size_t>(count) * count * count, 0);
  for (int k = 0; k < count; ++k)
  {
    for (int j = 0; j < count; ++j)
    {
      for (int i = 0; i < count; ++i)
      {
        volume.Voxels[volume.Index(i, j, k)] =
          Norm(volume.PointAt(i, j, k) - centre) < radius ? 3 : 0;
      }
    }
  }
  return volume;
}

class RegisterCommand : public test::CommandTest
{
protected:
  std::string Register(const std::string& labels, const std::string& materials,
    const std::string& mammogram, const std::string& rest = "") const
  {
    return "register --labels " + labels + " --materials " + materials + " --mammogram " +
      mammogram + " --orientation ALS --output " + this->Folder.File("result") + " " + rest;
  }

  /// Sends the program a signal once the file is there. The exit status, -1 when killed.
  int RunAndKill(const std::string& arguments, const std::string& file, int signal) const
  {
    const pid_t child = fork();
    if (child == 0)
    {
      const std::string command = "exec " + test::MammorayExecutable() + " " + arguments + " >" +
        this->Folder.File("out") + " 2>" + this->Folder.File("err");
      execl("/bin/sh", "sh", "-c", command.c_str(), nullptr);
      _exit(127);
    }
    int status = 0;
    while (waitpid(child, &status, WNOHANG) == 0)
    {
      if (fs::exists(file))
      {
        kill(child, signal);
        waitpid(child, &status, 0);
        break;
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  }

  /// The report begins with where lesion 3 is, as 'locate' says it; a lesion elsewhere is refused.
  void ExpectAnswered(const std::string& result, const std::string& lesion)
  {
    ASSERT_EQ(this->Run("locate --result " + result + " --lesion " + lesion), 0) << this->Errors;
    const std::size_t pixel = this->Output.find("pixel ");
    ASSERT_NE(pixel, std::string::npos);
    double column = 0;
    double row = 0;
    ASSERT_EQ(std::sscanf(this->Output.c_str() + pixel, "pixel %lf %lf", &column, &row), 2);
    char answer[80];
    std::snprintf(answer, sizeof answer, "; pixel column %.0f, row %.0f; <b>within ", column, row);
    const std::string report = ReadFile(result + "/report.html");
    const std::size_t answered = report.find(answer);
    EXPECT_NE(answered, std::string::npos) << answer;
    EXPECT_LT(report.find("Lesion 3 <small>"), answered);
    EXPECT_LT(answered, report.find("Outline and picture of the synthetic mammogram agree"));
    WriteLabelVolume(Ball({ 30, 12, 190 }, 4), this->Folder.File("elsewhere.nrrd"));
    this->CommandTest::ExpectRefused("register --labels " + Labels + " --materials " + Materials +
        " --mammogram " + MammogramFile + " --orientation ALS --output " +
        this->Folder.File("other") + " --lesion " + this->Folder.File("elsewhere.nrrd"),
      "expected lesion 3 in the tissue that is registered, found 0 % of it there");
  }

  void ExpectRefused(const std::string& arguments, const std::string& text,
    const std::string& environment = "")
  {
    this->CommandTest::ExpectRefused(arguments, text, environment);
    for (const auto& entry : fs::directory_iterator(this->Folder.File("")))
    {
      EXPECT_THAT(entry.path().filename().string(), testing::Not(testing::HasSubstr("result")));
    }
  }
};
}

TEST_F(RegisterCommand, FuseRefusesAnOutputBeforeItReadsAResult)
{
  for (const auto& [output, expected] : { std::pair{ "--mean-picture mean.jpg", ".png" },
         std::pair{ "--maximum-picture maximum", ".png" }, std::pair{ "-o fused.png", ".nrrd" },
         std::pair{ "--projection rays.jpg", ".vti" } })
  {
    this->ExpectRefused(std::string("fuse --result none --image none.nrrd ") + output, expected);
  }
}

TEST_F(RegisterCommand, RefusesUnusableInputInOneLine)
{
  this->ExpectRefused(this->Register("missing.nrrd", Materials, MammogramFile),
    "missing.nrrd: no such file");
  this->ExpectRefused(this->Register(Labels, Materials, "missing.dcm"),
    "missing.dcm: no such file");
  this->ExpectRefused(this->Register(Labels, Materials, Materials), "victre.json");
  this->ExpectRefused(this->Register(Labels, Labels, MammogramFile), "labels.nrrd");
  this->ExpectRefused(this->Register(Labels, "victer", MammogramFile), "did you mean victre?");
  fs::create_directory(this->Folder.File("empty"));
  this->ExpectRefused(this->Register(this->Folder.File("empty"), Materials, MammogramFile),
    "expected a folder of DICOM slices, found none");
  this->ExpectRefused(this->Register(Labels, Materials, MammogramFile, "--grid 5 31 65"),
    "expected --scatter beside them");
  this->ExpectRefused(
    this->Register(Labels, Materials, MammogramFile, "--scatter kernels --grid 99 31 65"), "99");
  this->ExpectRefused(this->Register(Labels, Materials, MammogramFile, "--crop 0:500 : :"),
    "within the volume's voxels 0:186 0:223 0:224");
  const std::string mr =
    test::SharedDataFolder() + "/duke-breast-mri-153-CC-BY-NC-4.0/t1_tse/1-01.dcm";
  if (fs::exists(mr))
  {
    this->ExpectRefused(this->Register(Labels, Materials, mr), "MG");
  }

  LabelVolume volume;
  volume.Size = { 3, 3, 3 };
  volume.Voxels.assign(27, 0);
  WriteLabelVolume(volume, this->Folder.File("air.nrrd"));
  volume.Voxels.assign(27, 77);
  WriteLabelVolume(volume, this->Folder.File("unknown.nrrd"));
  if (!ListDevices().empty())
  {
    this->ExpectRefused(this->Register(this->Folder.File("air.nrrd"), Materials, MammogramFile),
      "only air");
    this->ExpectRefused(this->Register(this->Folder.File("unknown.nrrd"), Materials, MammogramFile),
      "label 77 (27 voxels)");
  }
  this->ExpectRefused(
    this->Register(Labels, Materials, MammogramFile, "--free thickness,everything"), "everything");
  this->Folder.Write("picture.jpg", "no picture");
  this->ExpectRefused(this->Register(Labels, Materials, this->Folder.File("picture.jpg")),
    "expected its pixel spacing, view, laterality to be given");
  this->ExpectRefused(this->Register(Labels, Materials, this->Folder.File("picture.jpg"),
                        "--pixel-spacing 0.1 --view MLO --side left"),
    "expected a picture that can be read");
  this->ExpectRefused(
    this->Register(Labels, Materials, MammogramFile, "--mask " + this->Folder.File("none.png")),
    "none.png: no such file");
  this->ExpectRefused(this->Register(Labels, Materials, MammogramFile), "Vulkan",
    "VK_DRIVER_FILES=/nonexistent VK_ICD_FILENAMES=/nonexistent");
}

TEST_F(RegisterCommand, RefusesWhatNoPatientHas)
{
  if (ListDevices().empty())
  {
    GTEST_SKIP() << "no Vulkan device";
  }
  const auto refused = [this](const std::string& rest, const std::string& text)
  { this->ExpectRefused(this->Register(Labels, Materials, MammogramFile, rest), text); };
  refused("--thickness 500",
    "expected a compressed thickness from 5 to 150 mm, found 500; set --thickness or "
    "--accept-unusual");
  refused("--pixel-spacing 1", "expected a pixel spacing from 0.02 to 0.3 mm, found 1");
  refused("--source-to-detector 65", "distance from 300 to 1500 mm, found 65");
  refused("--side right", "expected a mammogram of the right breast, found L");
  refused("--view MLO", "expected a mammogram of the view MLO, found CC");
  refused("--mammogram " + MammogramFile, "expected another picture than");
  this->CommandTest::ExpectRefused("register --labels " + Labels + " --materials " + Materials +
      " --mammogram " + MammogramFile + " --orientation ALI --output " +
      this->Folder.File("result"),
    "orientation ALI: expected axes that are right-handed");
  const std::string magnified = this->Folder.File("magnified.dcm");
  test::ChangeDicom(MammogramFile, magnified,
    [](gdcm::DataSet& data)
    {
      gdcm::DataElement factor(gdcm::Tag(0x0018, 0x1114));
      factor.SetVR(gdcm::VR::DS);
      factor.SetByteValue("1.8 ", 4);
      data.Replace(factor);
    });
  this->ExpectRefused(this->Register(Labels, Materials, magnified),
    "expected a mammogram of a whole breast on the receptor, found 'magnification view' in its "
    "header; set --accept-unusual");
  // What is to be taken comes further: to the volume.
  LabelVolume volume;
  volume.Size = { 3, 3, 3 };
  volume.Voxels.assign(27, 0);
  WriteLabelVolume(volume, this->Folder.File("air.nrrd"));
  this->ExpectRefused(
    this->Register(this->Folder.File("air.nrrd"), Materials, magnified,
      "--side right --view MLO --thickness 500 --pixel-spacing 0.31 --accept-unusual"),
    "only air");
}

TEST_F(RegisterCommand, NeverReplacesWhatIsNotAnEarlierResult)
{
  fs::create_directory(this->Folder.File("result"));
  this->Folder.Write("result/thesis.txt", "mine");
  EXPECT_EQ(this->Run(this->Register(Labels, Materials, MammogramFile)), 1);
  EXPECT_THAT(this->Errors, testing::HasSubstr("exists already"));
  EXPECT_EQ(this->Run(this->Register(Labels, Materials, MammogramFile, "--overwrite")), 1);
  EXPECT_THAT(this->Errors, testing::HasSubstr("earlier result"));
  EXPECT_EQ(ReadFile(this->Folder.File("result/thesis.txt")), "mine");
}

TEST_F(RegisterCommand, WrongUsageExitsWithTwo)
{
  EXPECT_EQ(this->Run("register --labels x"), 2);
  EXPECT_EQ(this->Run(this->Register(Labels, Materials, MammogramFile, "--iterations zero")), 2);
}

TEST_F(RegisterCommand, ConfigurationRoundTrips)
{
  ASSERT_EQ(this->Run(this->Register(Labels, Materials, MammogramFile, "--print-config")), 0)
    << this->Errors;
  const std::string printed = this->Output;
  EXPECT_EQ(nlohmann::json::parse(printed).at("pixel-sizes"), (std::vector<double>{ 3, 1.5 }));
  const std::string config = this->Folder.Write("config.json", printed);
  ASSERT_EQ(this->Run("register --config " + config + " --print-config"), 0) << this->Errors;
  EXPECT_EQ(this->Output, printed);
}

TEST_F(RegisterCommand, GoesOnFromWhereItWasKilled)
{
  if (ListDevices().empty())
  {
    GTEST_SKIP() << "no Vulkan device";
  }
  const std::string coarse = "--label-spacing 1 --anatomy-cell-size 6 --simulation-cell-size 16 "
                             "--pixel-sizes 3 --iterations 3 ";
  const std::string checkpoint = this->Folder.File("result.checkpoint.json");
  const std::string folder = this->Folder.File("result");
  // Killed as soon as there is a step to go on from.
  ASSERT_EQ(
    this->RunAndKill(this->Register(Labels, Materials, MammogramFile, coarse), checkpoint, SIGKILL),
    -1);
  EXPECT_FALSE(fs::exists(folder));
  EXPECT_TRUE(fs::exists(folder + ".partial")); // it lay in wait there
  const nlohmann::json kept = nlohmann::json::parse(ReadFile(checkpoint)).at("mammograms").at(0);
  const std::string again =
    this->Register(Labels, Materials, MammogramFile, coarse + " --resume " + folder);
  ASSERT_EQ(this->Run(again), 0) << this->Errors;
  const nlohmann::json resumed = nlohmann::json::parse(ReadFile(folder + "/result.json"));
  for (std::size_t index = 0; index < kept.at("parameters").size(); ++index)
  {
    EXPECT_EQ(resumed.at("iterations").at(0).at("parameters").at(index),
      kept.at("parameters").at(index).at("value"));
  }
  EXPECT_FALSE(fs::exists(checkpoint));
  EXPECT_FALSE(fs::exists(folder + ".partial"));

  // Asked to stop, it writes the best pose so far.
  fs::copy_file(folder + "/uncompressed.vtu", this->Folder.File("anatomy.vtu"));
  const std::string meshed = this->Register(Labels, Materials, MammogramFile,
    coarse + " --overwrite --anatomy-mesh " + this->Folder.File("anatomy.vtu"));
  ASSERT_EQ(this->RunAndKill(meshed, checkpoint, SIGTERM), 0) << ReadFile(this->Folder.File("err"));
  EXPECT_THAT(nlohmann::json::parse(ReadFile(folder + "/result.json")).at("stopReason"),
    testing::HasSubstr("best pose so far"));
  EXPECT_FALSE(fs::exists(checkpoint));

  // A start that is too thin for this breast is opened; its result is gone on from, too.
  const std::string thin = meshed + " --thickness 20";
  ASSERT_EQ(this->Run(thin), 0) << this->Errors;
  EXPECT_THAT(this->Errors, testing::HasSubstr("is not compressed to the 20.0 mm"));
  ASSERT_EQ(this->Run(thin + " --resume " + folder), 0) << this->Errors;
}

TEST_F(RegisterCommand, RegistersTheShippedPhantom)
{
  const auto devices = ListDevices();
  if (devices.empty())
  {
    GTEST_SKIP() << "no Vulkan device";
  }
  ASSERT_EQ(this->Run(this->Register(Labels, Materials, MammogramFile,
              "--label-spacing 1 --anatomy-cell-size 6 --simulation-cell-size 13 "
              "--pixel-sizes 3 --iterations 6")),
    0)
    << this->Errors;
  EXPECT_THAT(this->Output, testing::EndsWith("\nThe two mammograms match\n"));
  const std::string folder = this->Folder.File("result");
  for (const char* name :
    { "uncompressed.vtu", "compressed.vtu", "synthetic.mha", "synthetic.png", "real.png",
      "overlay.png", "difference.png", "convergence.svg", "result.json", "report.html" })
  {
    EXPECT_GT(fs::file_size(folder + "/" + name), 0u) << name;
  }
  const nlohmann::json result = nlohmann::json::parse(ReadFile(folder + "/result.json"));
  // The acceptance limits of the full-size demo; the coarse one meets them too.
  EXPECT_LT(result.at("meanOutlineDistanceMm").get<double>(), 1.5);
  EXPECT_GT(result.at("correlation").get<double>(), 0.9);

  for (const char* name : { "/uncompressed.vtu", "/compressed.vtu" })
  {
    const auto placed = FindPlacement(ReadMesh(folder + name).Get());
    ASSERT_TRUE(placed) << name;
    EXPECT_EQ(placed->Origin, result.at("placement").at("originMm").get<Vector3>());
    EXPECT_EQ(placed->Y, result.at("placement").at("y").get<Vector3>());
  }

  // Gone on from, it has little left to do; another volume's result is refused. What is asked for
  // is answered at the head of the report.
  const std::string asked = this->Folder.File("asked.nrrd");
  WriteLabelVolume(Ball({ 30, 12, -10 }, 4), asked);
  const std::string anatomy = this->Folder.File("anatomy.vtu");
  fs::copy_file(folder + "/uncompressed.vtu", anatomy);
  const std::string again = Register(Labels, Materials, MammogramFile,
    "--label-spacing 1 --anatomy-mesh " + anatomy +
      " --simulation-cell-size 13 --pixel-sizes 3 --iterations 6 --overwrite --lesion " + asked +
      " --resume " + folder);
  ASSERT_EQ(this->Run(again), 0) << this->Errors;
  this->ExpectAnswered(folder, asked);
  const nlohmann::json resumed = nlohmann::json::parse(ReadFile(folder + "/result.json"));
  EXPECT_EQ(resumed.at("iterations").at(0).at("parameters"),
    result.at("iterations").back().at("parameters"));
  EXPECT_LE(resumed.at("iterations").back().at("cost").get<double>(),
    1.001 * result.at("iterations").back().at("cost").get<double>());
  fs::copy_file(Materials, this->Folder.File("table.json"));
  std::ofstream(this->Folder.File("table.json"), std::ios::app) << "\n";
  this->CommandTest::ExpectRefused("register --labels " + Labels + " --materials " +
      this->Folder.File("table.json") + " --mammogram " + MammogramFile +
      " --orientation ALS --output " + this->Folder.File("other") + " --resume " + folder,
    "found one of another file");

  ASSERT_EQ(this->Run("evaluate --result " + folder + " --landmarks " + Data +
              "/victre-phantom-1/landmarks.csv --truth-orientation ALS --truth-origin 8.4 7.4466 "
              "-27.3184 --second-reader " +
              Data + "/victre-phantom-1/landmarks.csv"),
    0)
    << this->Errors;
  EXPECT_THAT(this->Output, testing::ContainsRegex("two readers, compressed +all +[0-9]+ +0.00"));
  const std::size_t line = this->Output.find("registered");
  ASSERT_NE(line, std::string::npos);
  std::istringstream row(this->Output.substr(line));
  std::string method;
  std::string group;
  int count = 0;
  double median = 0;
  row >> method >> group >> count >> median;
  EXPECT_EQ(group, "imaged");
  EXPECT_EQ(count, 12);
  // Identity 9.2 mm, best rigid motion 2.7 mm.
  EXPECT_LT(median, 3.0);
  EXPECT_GT(median, 0.0);

  // A landmark's pixel, and back: the curve behind that pixel passes through the landmark.
  const std::vector<Landmark> landmarks = ReadLandmarks(Data + "/victre-phantom-1/landmarks.csv");
  const RegisteredBreast breast(folder);
  int imagedCount = 0;
  for (const Landmark& landmark : landmarks)
  {
    const ImagedPoint imaged = breast.ToMammogram(landmark.Uncompressed);
    if (!landmark.Imaged || !imaged.InImage)
    {
      continue;
    }
    ++imagedCount;
    ASSERT_TRUE(imaged.Uncertainty.has_value());
    EXPECT_GT(imaged.Uncertainty->MinorMm, 0);
    EXPECT_LT(imaged.Uncertainty->MajorMm, 10);
    double nearest = 1e9;
    double length = 0;
    for (const RaySegment& stretch : breast.ToVolume(imaged.Column, imaged.Row))
    {
      length += stretch.LengthMm;
      EXPECT_GE(stretch.EntryHeightMm, stretch.ExitHeightMm);
      for (const Vector3& point : stretch.Uncompressed)
      {
        nearest = std::min(nearest, Norm(point - landmark.Uncompressed));
      }
    }
    // Half a step of 0.25 mm, stretched back by up to the compression's 2.
    EXPECT_LT(nearest, 0.3);
    // Landmarks near the skin have less tissue along their ray than the breast is thick.
    EXPECT_GT(length, 10);
    EXPECT_LT(length, 60);
  }
  EXPECT_GE(imagedCount, 10);

  ASSERT_EQ(this->Run("locate --result " + folder + " --pixel 200 500 -o " +
              this->Folder.File("curve.csv")),
    0)
    << this->Errors;
  EXPECT_THAT(this->Output, testing::HasSubstr("gland"));
  EXPECT_THAT(ReadFile(this->Folder.File("curve.csv")), testing::StartsWith("x_mm,y_mm,z_mm"));
  ASSERT_EQ(this->Run("locate --result " + folder + " --pixel 719 5"), 0);
  EXPECT_THAT(this->Output, testing::HasSubstr("misses the breast"));
  EXPECT_EQ(this->Run("locate --result " + folder + " --point 1000 0 0"), 1);
  EXPECT_THAT(this->Errors, testing::HasSubstr("expected a place in the breast"));
  EXPECT_EQ(this->Run("locate --result " + folder + " --pixel 720 5"), 1);
  EXPECT_THAT(this->Errors, testing::HasSubstr("columns 0 to 719"));
  EXPECT_EQ(this->Run("locate --result " + folder), 2);
  EXPECT_THAT(this->Errors, testing::Not(testing::HasSubstr("trusted")));
  // Of a match that the report does not trust, it says so.
  const std::string said = ReadFile(folder + "/result.json");
  nlohmann::json distrusted = nlohmann::json::parse(said);
  distrusted["trust"] = { { "level", "none" }, { "reasons", { "The outlines lie apart." } } };
  this->Folder.Write("result/result.json", distrusted.dump());
  ASSERT_EQ(this->Run("locate --result " + folder + " --point 30 10 -5"), 0) << this->Errors;
  EXPECT_THAT(this->Errors,
    testing::EndsWith("The match is not to be trusted: The outlines lie apart.\n"));
  this->Folder.Write("result/result.json", said);

  // A ball of 5 mm and its shadow. The compressed volume is the ball's, 524 mm3, as thick as the
  // rays say: sum of thickness times pixel, without the magnification (650 / 625)^2.
  const Vector3 centre{ 30, 10, -5 };
  const std::string lesionFile = this->Folder.File("lesion.nrrd");
  WriteLabelVolume(Ball(centre, 5), lesionFile);
  const LabelVolume lesionVolume = ReadLabelFile(lesionFile);
  const auto projector = MakeProjector();
  const LesionShadow lesion = ProjectLesion(breast, lesionVolume, 3, *projector);
  EXPECT_NEAR(lesion.VolumeMm3, 524, 10); // the voxels' stairs
  EXPECT_LT(Norm(lesion.Centre - centre), 0.1);
  EXPECT_EQ(lesion.ShareOutside, 0);
  ASSERT_EQ(lesion.Outlines.size(), 1u);
  const auto& outline = lesion.Outlines.front();
  EXPECT_EQ(outline.front(), outline.back());
  double middle[2] = { 0, 0 };
  for (std::size_t index = 1; index < outline.size(); ++index)
  {
    middle[0] += outline[index][0] / (outline.size() - 1);
    middle[1] += outline[index][1] / (outline.size() - 1);
  }
  // The shadow's middle is the centre's pixel up to how unevenly a ball of that size is squeezed.
  EXPECT_NEAR(middle[0], lesion.ImagedCentre.Column, 10);
  EXPECT_NEAR(middle[1], lesion.ImagedCentre.Row, 10);
  // A ball squeezed along the beam: wider than its section, 78.5 mm2, and flatter than 10 mm; an
  // ellipsoid of its volume has 2/3 of the box around it.
  EXPECT_GT(lesion.AreaMm2, 80);
  EXPECT_LT(lesion.AreaMm2, 140);
  EXPECT_NEAR(2.0 / 3.0 * lesion.AreaMm2 * lesion.LargestThicknessMm / (1.04 * 1.04), 524, 40);
  const std::string outlines = this->Folder.File("outlines.csv");
  ASSERT_EQ(this->Run("locate --result " + folder + " --lesion " + lesionFile + " -o " + outlines),
    0)
    << this->Errors;
  EXPECT_THAT(this->Output, testing::HasSubstr("lesion 3"));
  EXPECT_THAT(ReadFile(outlines), testing::StartsWith("label,polygon,column,row\n3,0,"));
  // The shadow as a segmentation of the mammogram, as many pixels as the area has.
  const std::string shadow = this->Folder.File("lesion.dcm");
  const std::string segmentation =
    "locate --result " + folder + " --lesion " + lesionFile + " -o " + shadow;
  this->CommandTest::ExpectRefused(segmentation, "found no --mammogram");
  ASSERT_EQ(this->Run(segmentation + " --mammogram " + MammogramFile), 0) << this->Errors;
  EXPECT_EQ(this->Errors, "");
  test::ExpectValidDicom(shadow);
  EXPECT_EQ(test::DicomTextOf(shadow, 0x0020, 0x000d),
    test::DicomTextOf(MammogramFile, 0x0020, 0x000d));
  EXPECT_EQ(test::DicomTextOf(shadow, 0x0010, 0x0020), "");
  const std::string bits = test::DicomTextOf(shadow, 0x7fe0, 0x0010);
  const auto setBits = std::accumulate(bits.begin(), bits.end(), 0,
    [](int sum, char byte) { return sum + std::popcount(static_cast<unsigned char>(byte)); });
  EXPECT_NEAR(setBits * 0.01, lesion.AreaMm2, 0.005); // 0.1 mm pixels

  // The synthetic mammogram as DICOM.
  const std::string synthetic = this->Folder.File("synthetic.dcm");
  const std::string dicom = "dicom --result " + folder + " --mammogram " + MammogramFile;
  this->CommandTest::ExpectRefused(dicom + " -o " + this->Folder.File("synthetic.png"),
    "expected the extension .dcm");
  ASSERT_EQ(this->Run(dicom + " --same-patient -o " + synthetic), 0) << this->Errors;
  test::ExpectValidDicom(synthetic);
  EXPECT_EQ(test::DicomTextOf(synthetic, 0x0010, 0x0020), "VICTRE-1");
  const Mammogram written = ReadMammogram(synthetic);
  const Mammogram real = ReadMammogram(MammogramFile);
  EXPECT_EQ(written.View, real.View);
  EXPECT_EQ(written.Laterality, real.Laterality);
  EXPECT_EQ(written.ColumnDirection, real.ColumnDirection);
  // Without a header's help the registration says the same.
  Mammogram bare = real;
  bare.View.clear();
  bare.RowDirection.clear();
  bare.ColumnDirection.clear();
  const Mammogram described =
    ReadSyntheticMammogram(ReadResultFile(folder), bare, Mammogram::Intent::ForPresentation);
  EXPECT_EQ(described.View, real.View);
  EXPECT_EQ(described.RowDirection, real.RowDirection);
  EXPECT_EQ(described.ColumnDirection, real.ColumnDirection);
  EXPECT_EQ(described.Pixels, written.Pixels);
  EXPECT_EQ(written.ColumnSpacingMm, real.ColumnSpacingMm);
  EXPECT_NEAR(*written.BodyPartThicknessMm,
    resumed.at("parameters").at(0).at("value").get<double>(),
    1e-7); // ten digits

  // Both together, as if they were two exposures: each has its folder, one report tells of both.
  const std::string both = "register --labels " + Labels + " --materials " + Materials +
    " --mammogram " + MammogramFile + " --mammogram " + synthetic +
    " --orientation ALS --label-spacing 1 --anatomy-cell-size 6 --simulation-cell-size 13 "
    "--pixel-sizes 3 --iterations 3 --output " +
    this->Folder.File("both");
  this->CommandTest::ExpectRefused(both + " --thickness 50",
    "expected a thickness for each of 2 mammogram(s), found 1");
  this->CommandTest::ExpectRefused(both + " --resume " + folder,
    "expected a result of 2 mammogram(s), found one of 1");
  ASSERT_EQ(this->Run(both), 0) << this->Errors;
  const std::string joint = this->Folder.File("both");
  const nlohmann::json shared = nlohmann::json::parse(ReadFile(joint + "/result.json"));
  EXPECT_EQ(shared.at("mammograms").at(0).at("folder"), "cc");
  EXPECT_EQ(shared.at("mammograms").at(1).at("folder"), "cc-2");
  ASSERT_EQ(shared.at("unknowns").size(), 15u); // seven of each, and the stiffness
  EXPECT_EQ(shared.at("covariance").size(), 225u);
  EXPECT_THAT(ReadFile(joint + "/report.html"), testing::HasSubstr("What the mammograms share"));
  for (const char* view : { "/cc", "/cc-2" })
  {
    const nlohmann::json own = nlohmann::json::parse(ReadFile(joint + view + "/result.json"));
    EXPECT_GT(own.at("correlation").get<double>(), 0.9);
    EXPECT_EQ(own.at("parameters").at(8).at("value"), shared.at("unknowns").at(7).at("value"));
    EXPECT_GT(fs::file_size(joint + view + "/compressed.vtu"), 0u);
  }
  ASSERT_EQ(this->Run(both + " --overwrite --resume " + joint), 0) << this->Errors;
  ASSERT_EQ(this->Run("locate --result " + joint + " --point 30 10 -5"), 0) << this->Errors;
  EXPECT_THAT(this->Output, testing::HasSubstr("in cc\n"));
  EXPECT_THAT(this->Output, testing::HasSubstr("in cc-2\n"));
  this->CommandTest::ExpectRefused("locate --result " + joint + " --pixel 300 500",
    "expected --view with the result of several mammograms, one of cc, cc-2");
  this->CommandTest::ExpectRefused("locate --result " + joint + " --view mlo --pixel 300 500",
    "view 'mlo': expected cc, cc-2");
  ASSERT_EQ(this->Run("locate --result " + joint + " --view cc --pixel 300 500 -o " +
              this->Folder.File("line.csv")),
    0)
    << this->Errors;
  EXPECT_THAT(this->Output, testing::HasSubstr("in cc-2: on the line from pixel"));
  const std::string seen = "locate --result " + joint + " --view cc --pixel 300 500 --also ";
  ASSERT_EQ(this->Run(seen + "cc-2=300,500"), 0) << this->Errors;
  EXPECT_THAT(this->Output, testing::HasSubstr("behind both: "));
  this->CommandTest::ExpectRefused(seen + "mlo=300,500",
    "expected one of the result's other views, cc-2, found 'mlo'");
  this->CommandTest::ExpectRefused(seen + "cc-2=300", "expected VIEW=COLUMN,ROW");
  this->CommandTest::ExpectRefused(seen + "cc-2=300,nan", "expected VIEW=COLUMN,ROW");
  this->CommandTest::ExpectRefused("locate --result " + joint + " --point 30 10 -5 --also cc-2=1,2",
    "expected --pixel beside it");
  EXPECT_THAT(ReadFile(this->Folder.File("line.csv")),
    testing::StartsWith("x_mm,y_mm,z_mm,material,cc-2_column,cc-2_row,cc-2_sigma_mm\n"));
  this->CommandTest::ExpectRefused("fuse --result " + joint + " --image " + Labels + " -o " +
      this->Folder.File("fused.nrrd"),
    "expected the result of one mammogram, found one of 2");

  WriteLabelVolume(Ball({ 300, 10, -5 }, 5), this->Folder.File("elsewhere.nrrd"));
  this->CommandTest::ExpectRefused("locate --result " + folder + " --lesion " +
      this->Folder.File("elsewhere.nrrd"),
    "expected label 3 in the breast");
}
