// SPDX-License-Identifier: Apache-2.0
// Every refusal in one line, with nothing written; and going on from where a run was killed.
#include "CommandTest.h"
#include "DicomTesting.h"
#include "Files.h"
#include "ShippedPhantom.h"
#include "mammoray/IO/LabelVolumeIO.h"
#include "mammoray/XRay/PathLengthProjector.h"

#include <nlohmann/json.hpp>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <thread>

using namespace mammoray;
using test::Labels;
using test::MammogramFile;
using test::Materials;
using test::ReadFile;
namespace fs = std::filesystem;

namespace
{
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
  this->Folder.Write("picture.tif", "no picture");
  this->ExpectRefused(this->Register(Labels, Materials, this->Folder.File("picture.tif")),
    "expected a DICOM mammogram, or a picture of one (.jpg, .jpeg or .png), found neither");
  this->Folder.Write("camera.JPG", "no picture");
  this->ExpectRefused(this->Register(Labels, Materials, this->Folder.File("camera.JPG")),
    "expected its pixel spacing, view, laterality to be given");
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
  EXPECT_EQ(this->Run(this->Register(Labels, Materials, MammogramFile, "--series 2")), 2);
  EXPECT_THAT(this->Errors, testing::HasSubstr("--series: expected a --study"));
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
