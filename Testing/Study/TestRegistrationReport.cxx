// SPDX-License-Identifier: Apache-2.0
#include "Files.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/Sha256.h"
#include "mammoray/Study/RegistrationReport.h"

#include "vtkImageData.h"
#include "vtkNew.h"
#include "vtkPNGReader.h"
#include "vtkSmartPointer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <limits>
#include <numbers>

using namespace mammoray;
using ::testing::HasSubstr;
using ::testing::Not;

namespace
{
/// A half ball of radius 40 mm with a gland in it and its twin, 2 mm lower and 1 mm smaller.
struct MadeUp
{
  RegisteredView Registered;
  ResultFile File;
  Mammogram& Picture = Registered.Mammogram;
  RegistrationTarget& Target = Registered.View.Target;
  ViewResult& Result = Registered.Registration;
  RegistrationReport Report;

  static double Attenuation(double x, double y, double radius)
  {
    const double r = std::hypot(x, y);
    if (r >= radius)
    {
      return 0;
    }
    const double gland = std::exp(-(std::pow(x - 6, 2) + std::pow(y - 18, 2)) / 60);
    return 2.5 * std::sqrt(1 - r * r / (radius * radius)) + 0.8 * gland;
  }

  explicit MadeUp(char laterality = 'L')
  {
    this->Picture.View = "CC";
    this->Picture.Laterality = laterality;
    this->Picture.Columns = 200;
    this->Picture.Rows = 360;
    this->Picture.ColumnSpacingMm = 0.3;
    this->Picture.RowSpacingMm = 0.3;
    this->Picture.BodyPartThicknessMm = 52;
    this->Target.Grid.Columns = 200;
    this->Target.Grid.Rows = 360;
    this->Target.Grid.ColumnStep = { 0, 0.3 };
    this->Target.Grid.RowStep = { -0.3, 0 };
    this->Target.Grid.Origin = { 0.3 * 179.5, 0.15 };
    this->Registered.Warnings = { "The header does not say <this> & that." };
    for (int i = 0; i <= 90; ++i)
    {
      const double angle = std::numbers::pi * (i / 90.0 - 0.5);
      this->Result.Synthetic.Outline.push_back({ -2 + 39 * std::sin(angle), 39 * std::cos(angle) });
    }
    for (int row = 0; row < 360; ++row)
    {
      for (int column = 0; column < 200; ++column)
      {
        const double x = 0.3 * (179.5 - row);
        const double y = 0.3 * (column + 0.5);
        this->Target.LogAttenuation.push_back(static_cast<float>(Attenuation(x, y, 40)));
        this->Target.SignedDistanceMm.push_back(static_cast<float>(std::hypot(x, y) - 40));
        this->Target.BreastMask.push_back(std::hypot(x, y) < 40 ? 1 : 0);
        this->Result.Synthetic.LogAttenuation.push_back(
          static_cast<float>(Attenuation(x + 2, y, 39)));
      }
    }
    this->Result.Parameters = { { "thickness", "mm", 52, 40, 64, 2, false },
      { "roll", "deg", 0, -15, 15, 3, false }, { "lateral", "mm", 0, -15, 15, 2, false },
      { "anterior", "mm", 0, -15, 15, 2, true } };
    this->Result.Values = { 50.4, -1.25, 2.0, 0 };
    this->Result.StandardDeviations = { 0.11, 0.3, 0.05, std::numeric_limits<double>::quiet_NaN() };
    this->Result.Pose.ThicknessMm = 50.4;
    for (int i = 0; i <= 8; ++i)
    {
      const double outlineCost = 800 * std::exp(-0.7 * i) + 20;
      const double intensityCost = 300 * std::exp(-0.4 * i) + 120;
      this->Result.Iterations.push_back(
        { i, this->Result.Values, 1.5, i < 5 ? "global" : "gradient", outlineCost + intensityCost,
          outlineCost, intensityCost, 0, 1.5 * i });
    }
    this->Result.State.PaddleForceN = 87;
    this->Result.State.SupportForceN = 92;
    this->Result.State.VolumeRatio = 0.9987;
    this->Result.After.Correlation = 0.93;
    this->Result.After.MeanOutlineDistanceMm = 0.62;
    this->Result.After.LargestOutlineDistanceMm = 2.1;
    this->Result.After.TissueCorrelation = 0.86;
    this->Result.Expected = ExpectedError{ 1.4, 3.75 };
    this->Result.Converged = true;
    this->Result.StopReason = "the cost changes by less than 1e-4 of itself";
    this->Result.Evaluations = 43;
    this->Result.Seconds = 61.2;
    this->Report.Registered = &this->Registered;
    this->Report.File = &this->File;
    this->File.Notes = { "*.nii: its <sform> & qform" };
    this->File.Versions = { { "Vulkan device", "none, made up" } };
  }
};

/// Red, green, blue of a picture's pixel; row 0 at the top.
std::array<int, 3> Pixel(vtkImageData* image, double right, double down)
{
  const int* size = image->GetDimensions();
  const int x = static_cast<int>(right * size[0]);
  const int y = size[1] - 1 - static_cast<int>(down * size[1]);
  std::array<int, 3> color{};
  for (int c = 0; c < 3; ++c)
  {
    color[c] = static_cast<int>(image->GetScalarComponentAsDouble(x, y, 0, c));
  }
  return color;
}

vtkSmartPointer<vtkImageData> ReadPng(const std::string& path)
{
  vtkNew<vtkPNGReader> reader;
  reader->SetFileName(path.c_str());
  reader->Update();
  return reader->GetOutput();
}
}

TEST(RegistrationReport, WritesEverythingItIsGiven)
{
  const test::TemporaryFolder folder;
  const std::string report = folder.File("report");
  MadeUp made;
  made.File.Inputs = { { "Mammogram", "input <1>.txt", "ba7816bf" } };
  WriteRegistrationReport(made.Report, report);

  const std::string html = test::ReadFile(report + "/report.html");
  EXPECT_THAT(html, HasSubstr("The two mammograms match"));
  EXPECT_THAT(html, HasSubstr("The header does not say &lt;this&gt; &amp; that."));
  EXPECT_THAT(html, HasSubstr("*.nii: its &lt;sform&gt; &amp; qform"));
  EXPECT_THAT(html, HasSubstr("input &lt;1&gt;.txt<br><code>SHA-256 ba7816bf"));
  EXPECT_THAT(html, HasSubstr("none, made up"));
  EXPECT_THAT(html,
    HasSubstr("Compared in pixels of 1.5 mm (global) from iteration 0; 1.5 mm (gradient) from "
              "iteration 5."));
  // What the script of the comparison looks for.
  EXPECT_THAT(html, HasSubstr("<img alt=\"Target mammogram\" width=\""));
  EXPECT_THAT(html, HasSubstr("<img alt=\"Synthetic mammogram\" width=\""));
  EXPECT_THAT(html, Not(HasSubstr(folder.File("")))); // self-contained, and no path of this machine
  EXPECT_THAT(html, Not(HasSubstr("http://127")));
  EXPECT_THAT(test::ReadFile(report + "/convergence.svg"), HasSubstr("Iteration"));
  for (const auto& entry : std::filesystem::directory_iterator(report))
  {
    EXPECT_NE(entry.path().extension(), ".part");
  }
}

TEST(RegistrationReport, BeginsWithTheAnswerWhereOneWasAskedFor)
{
  const test::TemporaryFolder folder;
  MadeUp made;
  LayeredPicture slices{ "no picture", 30, 20, "<path d=\"M1 2L3 4\"/>" };
  made.Report.Asked = { { "Lesion 3", "3", { 12, 34, -5 }, 523, slices },
    { "Lesion 4", "4", { 1, 2, 3 }, 10, {} } };
  PlaceInMammogram place;
  place.Imaged.Material = "gland";
  place.Imaged.ReceptorMm = { 6, 18 };
  place.Imaged.Column = 60;
  place.Imaged.Row = 160;
  place.Imaged.InImage = true;
  place.Imaged.Uncertainty = UncertaintyEllipse{ 4.14 / Deviations95, 2.86 / Deviations95, 0 };
  PlaceInMammogram lost;
  lost.Problem = "It <lies> beside the breast.";
  made.Report.Places = { place, lost };
  made.Report.Examination = { { "mammogram of", "2024-03-01" } };
  WriteRegistrationReport(made.Report, folder.File("report"));
  const std::string html = test::ReadFile(folder.File("report/report.html"));
  const std::size_t answer =
    html.find("Lesion 3 <small>523 mm³ around (12.0, 34.0, −5.0) mm, in gland");
  ASSERT_NE(answer, std::string::npos);
  EXPECT_LT(answer, html.find("The two mammograms match"));
  // The outline's foremost point is at x = -2, y = 39.
  EXPECT_THAT(html,
    HasSubstr(
      "21 mm behind the breast’s foremost point, 8 mm to L of it; pixel column 60, row 160; "
      "<b>within 4.1 × 2.9 mm</b>"));
  EXPECT_THAT(html, HasSubstr("not found: It &lt;lies&gt; beside the breast."));
  EXPECT_THAT(html, HasSubstr("mammogram of 2024-03-01"));
  EXPECT_THAT(html, HasSubstr("M1 2L3 4"));
  EXPECT_THAT(html, HasSubstr(">3</text>"));
  // Doubt is told beside the place.
  EXPECT_THAT(html, Not(HasSubstr("class=\"warning\"")));
  made.Result.After.TissueCorrelation = 0.5;
  made.Result.Trust = Assess(made.Result);
  WriteRegistrationReport(made.Report, folder.File("doubtful"));
  EXPECT_THAT(test::ReadFile(folder.File("doubtful/report.html")),
    HasSubstr("<b class=\"warning\">The match should be checked by eye.</b>"));
}

TEST(RegistrationReport, HangsAnObliqueViewWithTheHeadUp)
{
  const test::TemporaryFolder folder;
  MadeUp made;
  made.Picture.View = "MLO";
  made.Report.Asked = { { "The point", "point", { 1, 2, 3 }, 0, {} } };
  made.Report.Places.resize(1);
  made.Report.Places[0].Imaged.ReceptorMm = { 6, 18 };
  WriteRegistrationReport(made.Report, folder.File("report"));
  EXPECT_THAT(test::ReadFile(folder.File("report/report.html")), HasSubstr("8 mm to HL of it"));
  EXPECT_THAT(test::ReadFile(folder.File("report/report.html")),
    HasSubstr("which lies beside the picture"));
  made.Report.Places[0].Imaged.ReceptorMm = { 6, -4 };
  WriteRegistrationReport(made.Report, folder.File("behind"));
  EXPECT_THAT(test::ReadFile(folder.File("behind/report.html")),
    HasSubstr("4 mm behind the receptor’s edge, where no mammogram shows it"));
}

TEST(RegistrationReport, SaysWhatTheHeaderSaysBesideWhatWasFound)
{
  const test::TemporaryFolder folder;
  MadeUp made;
  made.Picture.View = "MLO"; // 45 degrees where the header says none
  WriteRegistrationReport(made.Report, folder.File("report"));
  const std::string html = test::ReadFile(folder.File("report/report.html"));
  EXPECT_THAT(html, HasSubstr("compressed thickness; the header says 52.0 mm"));
  EXPECT_THAT(html, HasSubstr("angle of the unit; the header says −45°"));
}

TEST(RegistrationReport, LoadsNothingAndRunsNoScriptsButItsOwn)
{
  const test::TemporaryFolder folder;
  WriteRegistrationReport(MadeUp().Report, folder.File("report"));
  const std::string html = test::ReadFile(folder.File("report/report.html"));
  EXPECT_THAT(html, HasSubstr("content=\"default-src 'none'; img-src data:; style-src 'sha256-"));
  // What the policy forbids is not there to be missed: style attributes and handlers in the markup,
  // addresses.
  const std::string markup = html.substr(html.find("</style>"));
  const std::string body = markup.substr(0, markup.find("<script>"));
  EXPECT_THAT(body, Not(HasSubstr(" style=")));
  EXPECT_THAT(body, Not(testing::ContainsRegex(" on[a-z]*=")));
  EXPECT_THAT(html, Not(testing::ContainsRegex("(src|href)=\"[^d#]")));
  EXPECT_THAT(html, Not(HasSubstr("unsafe")));
  // The hash is that of the very text between the tags.
  const auto between = [&](const std::string& from, const std::string& to)
  {
    const std::size_t begin = html.find(from) + from.size();
    return html.substr(begin, html.find(to, begin) - begin);
  };
  const std::string hex = Sha256OfText(between("<script>", "</script>"));
  const std::string base64 = between("script-src 'sha256-", "'");
  std::string decoded;
  unsigned int bits = 0;
  int count = 0;
  for (const char letter : base64.substr(0, base64.find('=')))
  {
    const std::string alphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    bits = bits << 6 | static_cast<unsigned int>(alphabet.find(letter));
    for (count += 6; count >= 4; count -= 4)
    {
      decoded += "0123456789abcdef"[bits >> (count - 4) & 15];
    }
  }
  EXPECT_EQ(decoded.substr(0, 64), hex);
}

TEST(RegistrationReport, PicturesShowWhatDiffersWhereItDoes)
{
  for (const char laterality : { 'L', 'R' })
  {
    SCOPED_TRACE(laterality);
    const test::TemporaryFolder folder;
    const std::string report = folder.File("report");
    const MadeUp made(laterality);
    WriteRegistrationReport(made.Report, report);
    const auto difference = ReadPng(report + "/difference.png");
    EXPECT_EQ(difference->GetDimensions()[1], 900);
    // x from -41 to 40 mm and y from 0 to 40 mm with a margin of 8 mm: 97 x 48 mm on 0.3 mm pixels.
    EXPECT_NEAR(difference->GetDimensions()[0], 900 * 48 / 97.0, 900 * 0.6 / 97);
    // The left breast is hung with its chest wall at the left and patient left up, the right one
    // the other way round in both. 1.5 mm inside the real outline towards +x, beyond the synthetic
    // one:
    const double chestWall = laterality == 'L' ? 0.02 : 0.98;
    const double plusX = laterality == 'L' ? (48 - 38.5) / 97 : (38.5 + 49) / 97;
    const std::array<int, 3> realOnly = Pixel(difference, chestWall, plusX);
    EXPECT_GT(realOnly[0], 200);
    EXPECT_LT(realOnly[2], 60); // orange
    const std::array<int, 3> beside = Pixel(difference, 1 - chestWall, 0.3);
    EXPECT_GT(beside[0], 230); // paper
    EXPECT_GT(beside[2], 230);
    const auto real = ReadPng(report + "/real.png");
    EXPECT_GT(Pixel(real, laterality == 'L' ? 0.1 : 0.9, 0.5)[1], 150);
    EXPECT_LT(Pixel(real, 1 - chestWall, 0.3)[1], 10);
  }
}

TEST(RegistrationReport, SaysWhenTheMatchIsNotToBeTrusted)
{
  const test::TemporaryFolder folder;
  const std::string report = folder.File("report");
  MadeUp made;
  made.Result.After.TissueCorrelation = 0.2;
  made.Result.Converged = false;
  made.Result.StopReason = "stopped by the user";
  made.Result.Trust = Assess(made.Result);
  WriteRegistrationReport(made.Report, report);
  const std::string html = test::ReadFile(report + "/report.html");
  EXPECT_THAT(html, HasSubstr("The match is not to be trusted"));
  EXPECT_THAT(html, HasSubstr("stopped by the user"));
}

TEST(RegistrationReport, RefusesAFolderThatCannotBeMade)
{
  EXPECT_THROW(WriteRegistrationReport(MadeUp().Report, "/dev/null/folder"), InputError);
}

TEST(RegistrationReport, TellsOfSeveralMammogramsInOnePage)
{
  const test::TemporaryFolder folder;
  const MadeUp first;
  MadeUp second;
  second.Picture.View = "MLO";
  JointResultFile file;
  file.Mammograms = { { "cc", "CC", 'L', Trust::Good, 1, 0 },
    { "mlo", "MLO", 'L', Trust::Good, 1, 0 } };
  file.Unknowns = { { "stiffness", "", {}, 1.75, std::numeric_limits<double>::quiet_NaN() },
    { "thickness", "mm", "cc", 50, 1 } };
  JointReport joint{ { first.Report, second.Report }, &file, {} };
  joint.Mammograms[0].Title = "Both <views>";
  WriteJointReport(joint, folder.File("joint"));
  const std::string html = test::ReadFile(folder.File("joint/report.html"));
  EXPECT_THAT(html, HasSubstr("Both &lt;views&gt;"));
  EXPECT_THAT(html, HasSubstr("Left breast, CC view, MLO view"));
  EXPECT_THAT(html,
    HasSubstr("Stiffness of gland, times the table's</td><td class=\"value\"><b>1.75</b> ± –"));
  EXPECT_TRUE(std::filesystem::exists(folder.File("joint/cc/real.png")));
  EXPECT_TRUE(std::filesystem::exists(folder.File("joint/mlo/report.html")));
  EXPECT_THAT(html, Not(HasSubstr("<b>50.00</b> ±")));
}
