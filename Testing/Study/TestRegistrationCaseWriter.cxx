// SPDX-License-Identifier: Apache-2.0
#include "FileSizeLimit.h"
#include "Files.h"
#include "TestMeshes.h"
#include "mammoray/Dicom/DicomReader.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/PoseParameters.h"
#include "mammoray/IO/MaterialTableIO.h"
#include "mammoray/IO/Sha256.h"
#include "mammoray/Study/RegisteredBreast.h"
#include "mammoray/Study/RegistrationCase.h"
#include "mammoray/Study/ResultFile.h"
#include "mammoray/Study/StudyCase.h"

#include "vtkDataArray.h"
#include "vtkPointData.h"
#include "vtkUnstructuredGrid.h"

#include <sys/mount.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

using namespace mammoray;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
namespace fs = std::filesystem;

namespace
{
/// A box that moved by 1 mm along y and what a search would say of it, with input files that exist.
class WrittenCase : public ::testing::Test
{
protected:
  void SetUp() override
  {
    this->Input.Labels.Path = this->Folder.Write("labels.nrrd", "labels");
    this->Input.Materials = test::DataFolder() + "/materials/victre.json";
    this->Result.Materials = ReadMaterialTable(this->Input.Materials);
    this->Result.Axes = AnatomicalAxes::FromCode("ALS");
    this->Result.Anchor = { 1, 2, 3 };
    this->Result.Anatomy = test::MakeBoxMesh({ 0, 0, 0 }, { 20, 20, 20 }, { 2, 2, 2 });
    this->Result.Device = "none";
    this->AddMammogram("CC");
  }

  void AddMammogram(const std::string& name)
  {
    RegisteredView& registered = this->Result.Views.emplace_back();
    registered.Path = this->Folder.Write("mammogram.dcm", "mammogram");
    registered.Mammogram.View = name;
    registered.Mammogram.Laterality = 'L';
    RegistrationTarget& target = registered.View.Target;
    target.Grid.Columns = 20;
    target.Grid.Rows = 30;
    target.Grid.ColumnStep = { 0, 1 };
    target.Grid.RowStep = { -1, 0 };
    target.Grid.Origin = { 14.5, 0.5 };
    const std::size_t count = 600;
    ViewResult& found = registered.Registration;
    target.LogAttenuation.assign(count, 1);
    target.BreastMask.assign(count, 1);
    target.SignedDistanceMm.assign(count, -1);
    target.Excluded.assign(count, 0);
    std::fill_n(target.Excluded.begin(), 150, 1);
    found.Synthetic.LogAttenuation.assign(count, 1);
    found.Points = this->Result.Anatomy.Points;
    for (std::size_t index = 1; index < found.Points.size(); index += 3)
    {
      found.Points[index] += 1;
    }
    found.Pose.ThicknessMm = 51;
    found.Pose.AnteriorMm = 5; // not at its bound, the chest wall
    found.Pose.Stiffness = 1.5;
    found.Parameters = DefaultParameters(BreastPose());
    found.Values = ValuesOf(found.Pose);
    found.StandardDeviations.assign(ParameterCount, 0.25);
    found.After = { 0.9, 0.5, 1.5, 0.9 };
    found.Converged = true;
    found.State.PaddleForceN = 11;
    found.State.SupportForceN = 12;
    found.State.LargestWallGlideMm = 4;
    found.Sensitivities = { std::vector<double>(this->Result.Anatomy.Points.size(), 0.5), {} };
    registered.Warnings = { "Something had to be assumed." };
  }

  std::vector<std::string> Written() const
  {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(this->Folder.File("")))
    {
      names.push_back(entry.path().filename().string());
    }
    std::sort(names.begin(), names.end());
    return names;
  }

  test::TemporaryFolder Folder;
  RegistrationCase Input;
  RegistrationCaseResult Result;
};
}

TEST_F(WrittenCase, HasEverythingOfOneMammogram)
{
  const std::string folder = this->Folder.File("result");
  WriteRegistrationCase(this->Input, this->Result, folder);
  for (const char* name : { "uncompressed.vtu", "compressed.vtu", "synthetic.mha", "result.json",
         "report.html", "real.png", "convergence.svg" })
  {
    EXPECT_TRUE(fs::exists(folder + "/" + name)) << name;
  }
  const ResultFile result = ReadResultFile(folder);
  EXPECT_EQ(result.Axes.Anterior, this->Result.Axes.Anterior);
  EXPECT_EQ(result.Anchor, this->Result.Anchor);
  EXPECT_EQ(result.Trust.Level, Trust::Good);
  EXPECT_EQ(result.Pose.Stiffness, 1.5);
  EXPECT_EQ(result.ShareExcluded, 0.25);
  EXPECT_EQ(result.Compression.PaddleForceN, 11);
  EXPECT_EQ(result.Compression.SupportForceN, 12);
  EXPECT_EQ(result.Compression.LargestWallGlideMm, 4);
  EXPECT_TRUE(std::isnan(result.OtherEquilibriumMm)) << "none was looked for";
  EXPECT_EQ(result.Spectrum, this->Input.Spectrum);
  EXPECT_EQ(result.Scatter.Method, "none");
  const auto mammogram = std::find_if(result.Inputs.begin(), result.Inputs.end(),
    [](const ResultInput& input) { return input.Role == MammogramRole; });
  ASSERT_NE(mammogram, result.Inputs.end());
  EXPECT_EQ(mammogram->File, "*.dcm");             // its name may be a patient's
  EXPECT_EQ(result.Inputs[1].File, "victre.json"); // a shipped one
  EXPECT_EQ(mammogram->Sha256, Sha256OfFile(this->Folder.File("mammogram.dcm")));
  const BreastInUnit breast = ReadBreastInUnit(result);
  EXPECT_EQ(breast.Uncompressed->GetPointData()->GetArray("Displacement")->GetComponent(7, 1), 1);
  EXPECT_EQ(
    breast.Uncompressed->GetPointData()->GetArray("Sensitivity_thickness")->GetComponent(0, 0),
    0.5);
  EXPECT_EQ(breast.Uncompressed->GetPointData()->GetArray("Sensitivity_stiffness"), nullptr);
}

TEST_F(WrittenCase, TellsOfEachProjection)
{
  RegisteredView& view = this->Result.Views[0];
  view.View.Unit = WithFocalSpot(view.View.Unit, { 2, 0, 650 });
  // 610 tan 10 degrees to each side.
  view.View.Projections = { { { -105.56, 0, 600.7 }, {} }, { { 109.56, 0, 600.7 }, {} } };
  view.Registration.ProjectionsAfter = { { 0.91, 0.4, 1, 0.8 }, { 0.87, 0.6, 1, 0.8 } };
  const std::string folder = this->Folder.File("result");
  WriteRegistrationCase(this->Input, this->Result, folder);
  const ResultFile result = ReadResultFile(folder);
  EXPECT_EQ(result.Unit.FocalSpot(), (Vector3{ 2, 0, 650 }));
  ASSERT_EQ(result.Projections.size(), 2u);
  EXPECT_EQ(result.Projections[1].FocalSpotMm, (Vector3{ 109.56, 0, 600.7 }));
  EXPECT_EQ(result.Projections[1].After.Correlation, 0.87);
  EXPECT_EQ(result.Projections[0].After.MeanOutlineDistanceMm, 0.4);
  const std::string report = test::ReadFile(folder + "/report.html");
  const std::size_t first = report.find("Source at -10.0°");
  const std::size_t middle = report.find("Source at 0.2°");
  const std::size_t last = report.find("Source at 10.3°");
  ASSERT_NE(last, std::string::npos);
  EXPECT_LT(first, middle);
  EXPECT_LT(middle, last);
  EXPECT_LT(report.find("correlation 0.910, outlines 0.40 mm apart"), middle);
}

TEST_F(WrittenCase, SaysWhatScattered)
{
  this->Input.Scatter = RegisteredScatter{ {}, std::array{ 5.0, 31.0, 65.0 }, "air" };
  this->Result.Views[0].View.Unit.SupportHeightMm = 21;
  const std::string folder = this->Folder.File("result");
  WriteRegistrationCase(this->Input, this->Result, folder);
  const ResultScatter scatter = ReadResultFile(folder).Scatter;
  EXPECT_EQ(scatter.Method, "kernels");
  EXPECT_EQ(scatter.AirGapMm, 21);
  EXPECT_EQ(scatter.Grid[1], 31);
  EXPECT_EQ(scatter.Interspace, "air");
}

TEST_F(WrittenCase, NamesItsInputsWhereAsked)
{
  this->Input.NameInputs = true;
  const std::string folder = this->Folder.File("result");
  WriteRegistrationCase(this->Input, this->Result, folder);
  EXPECT_THAT(test::ReadFile(folder + "/result.json"), HasSubstr("\"mammogram.dcm\""));
  EXPECT_THAT(test::ReadFile(folder + "/report.html"), HasSubstr("mammogram.dcm"));
}

TEST_F(WrittenCase, KeepsWhatReadersNoted)
{
  this->Result.Notes = { "*.nii: its qform is taken" };
  const std::string folder = this->Folder.File("result");
  WriteRegistrationCase(this->Input, this->Result, folder);
  EXPECT_THAT(ReadResultFile(folder).Notes, ElementsAre("*.nii: its qform is taken"));
  EXPECT_THAT(test::ReadFile(folder + "/report.html"), HasSubstr("its qform is taken"));
}

TEST_F(WrittenCase, OfSeveralMammogramsHasAFolderForEach)
{
  this->AddMammogram("MLO");
  this->AddMammogram("CC");
  this->Result.FreeParameters = { { ThicknessParameter, { 1 } }, { StiffnessParameter, { 0, 1 } } };
  this->Result.Covariance = { 0.04, 0.01, 0.01, 0.09 };
  EXPECT_THAT(MammogramFolders(this->Result), ElementsAre("cc", "mlo", "cc-2"));
  const std::string folder = this->Folder.File("result");
  WriteRegistrationCase(this->Input, this->Result, folder);
  const JointResultFile joint = ReadJointResultFile(folder);
  ASSERT_EQ(joint.Mammograms.size(), 3u);
  EXPECT_EQ(joint.Mammograms[2].Folder, "cc-2");
  ASSERT_EQ(joint.Unknowns.size(), 2u);
  EXPECT_EQ(joint.Unknowns[0].Folder, "mlo");
  EXPECT_DOUBLE_EQ(joint.Unknowns[0].StandardDeviation, 0.2);
  EXPECT_FALSE(joint.Unknowns[1].Folder.has_value());
  EXPECT_DOUBLE_EQ(joint.Unknowns[1].StandardDeviation, 0.3);
  EXPECT_EQ(ReadResultFiles(folder).size(), 3u);
  EXPECT_THAT(test::ReadFile(folder + "/report.html"), HasSubstr("<b>1.50</b> ± 0.30"));
}

TEST_F(WrittenCase, OfAStudyHoldsItsTissueAndTellsOfIt)
{
  auto tissue = std::make_shared<StudyTissue>();
  tissue->Labels.Size = { 4, 4, 4 };
  tissue->Labels.Voxels.assign(64, 1);
  tissue->Mri.Size = tissue->Labels.Size;
  tissue->Mri.Voxels.assign(64, 0.5F);
  tissue->Warnings = { "The wall is ragged." };
  this->Result.Tissue = tissue;
  StudyChoice study;
  study.Plain.emplace();
  study.Plain->Description = "t1 <tse>";
  study.Plain->Files = { this->Input.Labels.Path };
  study.Plain->Reason = "taken: T1";
  study.Found.Series = { *study.Plain };
  this->Input.Study = std::make_shared<StudyChoice>(study);
  const std::string folder = this->Folder.File("result");
  WriteRegistrationCase(this->Input, this->Result, folder);
  EXPECT_EQ(ReadLabelVolume(folder + "/labels.seg.nrrd").Voxels, tissue->Labels.Voxels);
  EXPECT_EQ(ReadIntensityVolume(folder + "/mri.nrrd").Voxels, tissue->Mri.Voxels);
  const ResultFile result = ReadResultFile(folder);
  EXPECT_EQ(result.Inputs.front().Role, "MRI without fat suppression");
  // Labels beside the study are its tissue.
  EXPECT_EQ(result.Inputs[1].Role, "Label volume");
  EXPECT_EQ(result.Inputs[1].File, "*.nrrd");
  EXPECT_EQ(result.Inputs.front().File, "t1 <tse>");
  EXPECT_EQ(result.Inputs.front().Sha256, Sha256OfFile(this->Input.Labels.Path));
  EXPECT_THAT(result.Warnings, ElementsAre("Something had to be assumed.", "The wall is ragged."));
  const std::string report = test::ReadFile(folder + "/report.html");
  EXPECT_THAT(report, HasSubstr("MRI: t1 &lt;tse&gt;"));
  EXPECT_THAT(report, HasSubstr("labels that were given: *.nrrd"));
  // Once.
  EXPECT_EQ(report.find("The wall is ragged."), report.rfind("The wall is ragged."));
  EXPECT_NE(report.find("The wall is ragged."), std::string::npos);
}

TEST_F(WrittenCase, IsCompleteOrNotThere)
{
  const std::vector<std::string> before = this->Written();
  fs::remove(this->Folder.File("labels.nrrd")); // its checksum cannot be taken
  EXPECT_THROW(WriteRegistrationCase(this->Input, this->Result, this->Folder.File("result")),
    InputError);
  this->Folder.Write("labels.nrrd", "labels");
  EXPECT_EQ(this->Written(), before);
}

TEST_F(WrittenCase, ReplacesAnEarlierResultOnly)
{
  const std::string folder = this->Folder.File("result");
  const auto refusal = [&](const std::string& path, bool overwrite)
  {
    try
    {
      WriteRegistrationCase(this->Input, this->Result, path, overwrite);
    }
    catch (const InputError& error)
    {
      return std::string(error.what());
    }
    return std::string("nothing was refused");
  };
  fs::create_directory(folder);
  this->Folder.Write("result/thesis.txt", "mine");
  EXPECT_THAT(refusal(folder, false), HasSubstr("exists already"));
  EXPECT_THAT(refusal(folder, true), HasSubstr("expected an earlier result"));
  EXPECT_THAT(refusal(this->Folder.File("absent/result"), true), HasSubstr("cannot be written"));
  EXPECT_EQ(test::ReadFile(folder + "/thesis.txt"), "mine");
  fs::remove_all(folder);
  WriteRegistrationCase(this->Input, this->Result, folder + "/");
  this->Result.Anchor = { 7, 8, 9 };
  WriteRegistrationCase(this->Input, this->Result, folder, true);
  EXPECT_EQ(ReadResultFile(folder).Anchor, this->Result.Anchor);
  // What is not of a result stays.
  this->Folder.Write("result/notes.txt", "mine");
  EXPECT_THAT(refusal(folder, true), HasSubstr("found notes.txt"));
  fs::remove(folder + "/notes.txt");
  fs::create_directories(folder + "/cc/result.json");
  EXPECT_THAT(refusal(folder, true), HasSubstr("found cc/result.json"));
  fs::remove_all(folder + "/cc");
  fs::create_directory(folder + "/more");
  EXPECT_THAT(refusal(folder, true), HasSubstr("found more"));
  fs::remove(folder + "/more");
  EXPECT_EQ(refusal(folder, true), "nothing was refused");
  EXPECT_THAT(this->Written(), testing::Not(testing::Contains(HasSubstr("partial"))));
}

TEST_F(WrittenCase, AFullDiskLosesNothing)
{
  const std::string folder = this->Folder.File("result");
  WriteRegistrationCase(this->Input, this->Result, folder);
  const std::string before = test::ReadFile(folder + "/report.html");
  const std::vector<std::string> written = this->Written();
  this->Result.Anchor = { 7, 8, 9 };
  // Each file of a result is larger than one of these, smaller than another.
  for (rlim_t most = 16; most < before.size(); most *= 2)
  {
    {
      const test::FileSizeLimit limit(most);
      EXPECT_THROW(WriteRegistrationCase(this->Input, this->Result, folder, true), InputError)
        << most;
    }
    EXPECT_EQ(this->Written(), written);
    EXPECT_EQ(test::ReadFile(folder + "/report.html"), before);
  }
}

TEST_F(WrittenCase, AMountPointIsFilledOrRefused)
{
  const std::string folder = this->Folder.File("result");
  fs::create_directory(folder);
  // In a container the folder of an output is one.
  if (mount("tmpfs", folder.c_str(), "tmpfs", 0, "size=4m") != 0)
  {
    GTEST_SKIP() << "mounting is not allowed";
  }
  try
  {
    CheckResultFolder(folder, false); // before the work
    WriteRegistrationCase(this->Input, this->Result, folder);
    EXPECT_EQ(ReadResultFile(folder).Anchor, this->Result.Anchor);
    EXPECT_FALSE(fs::exists(folder + "/.partial"));
    CheckResultFolder(folder, true);
    ADD_FAILURE() << "expected a refusal before the work";
  }
  catch (const InputError& error)
  {
    EXPECT_THAT(error.what(), HasSubstr("is a mount point"));
  }
  EXPECT_EQ(ReadResultFile(folder).Anchor, this->Result.Anchor);
  EXPECT_EQ(umount(folder.c_str()), 0);
}
