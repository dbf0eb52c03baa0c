// SPDX-License-Identifier: Apache-2.0
#include "Benchmark.h"

#include "OutlineBaseline.h"
#include "mammoray/Dicom/DicomReader.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/Mammogram.h"
#include "mammoray/IO/AtomicFile.h"
#include "mammoray/IO/LabelVolumeIO.h"
#include "mammoray/IO/Sha256.h"
#include "mammoray/IO/ShippedData.h"
#include "mammoray/Registration/PosedBreast.h"
#include "mammoray/Registration/RegistrationTarget.h"
#include "mammoray/Study/LandmarkEvaluation.h"
#include "mammoray/Study/RegistrationCase.h"
#include "mammoray/Study/StudyCase.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <utility>

namespace mammoray
{
namespace
{
namespace fs = std::filesystem;

std::string Protocol()
{
  std::ifstream file(MAMMORAY_PROTOCOL);
  std::string text(std::istreambuf_iterator<char>(file), {});
  const std::string version = "@VERSION@";
  return text.replace(text.find(version), version.size(), MAMMORAY_VERSION);
}

struct Baseline
{
  const char* Name;
  OutlineMotion Motion;
};
constexpr Baseline Baselines[]{ { "rigid", OutlineMotion::Rigid },
  { "affine", OutlineMotion::Affine } };

std::string NameOf(const PlannedStudy& study)
{
  char name[80];
  std::snprintf(name, sizeof name, "%03u-%s", static_cast<unsigned>(study.Options.Seed),
    study.Phantom.c_str());
  return name;
}

/// The answers without error.
std::vector<StudyAnswer> TrueAnswers(const StudyTruth& truth)
{
  std::vector<StudyAnswer> answers;
  for (const TrueView& view : truth.Views)
  {
    for (std::size_t point = 0; point < view.Pixels.size(); ++point)
    {
      answers.push_back({ view.View, point, view.Pixels[point], view.Gantry[point] });
    }
  }
  return answers;
}

/// Writes a file that ReadStudyAnswers reads. All answers have positions in the gantry frame.
void WriteAnswers(const std::vector<StudyAnswer>& answers, const std::string& path)
{
  std::string text = "view,point,column,row,x,y,z\n";
  for (const StudyAnswer& answer : answers)
  {
    const Vector3& at = answer.Gantry.value();
    char line[200];
    std::snprintf(line, sizeof line, "%s,%zu,%.3f,%.3f,%.3f,%.3f,%.3f\n", answer.View.c_str(),
      answer.Point, answer.Pixel[0], answer.Pixel[1], at[0], at[1], at[2]);
    text += line;
  }
  WriteAtomicFile(path, text);
}

/// A study in the form that a method reads, and its segmentation.
class GivenStudy
{
public:
  /// `folder`: the study's, with its export.
  GivenStudy(std::string folder, const ProgressCallback& progress)
    : Folder(std::move(folder))
    , Table(FindMaterialTable(StudyMaterials))
    , Choice(ChooseForRegistration(ReadStudy(this->Folder + "/export")))
    , Tissue(SegmentStudy(this->Choice, this->Table, progress))
  {
  }

  void Write(const StudyTruth& truth) const
  {
    for (const auto& [name, series] : { std::pair{ "mri-plain", &this->Choice.Plain },
           { "mri-fat-suppressed", &this->Choice.FatSuppressed } })
    {
      if (*series)
      {
        WriteIntensityVolume(ReadIntensitySeries((*series)->Files),
          this->Folder + '/' + name + ".nii.gz");
      }
    }
    WriteLabelVolume(this->Tissue.Labels, this->Folder + "/labels.nii.gz");
    for (const auto& [name, view] :
      { std::pair{ "cc", &this->Choice.Cc }, { "mlo", &this->Choice.Mlo } })
    {
      if (*view)
      {
        fs::copy_file((*view)->Header.Path, this->Folder + '/' + name + ".dcm");
      }
    }
    std::string points = "point,x,y,z\n";
    for (std::size_t point = 0; point < truth.MriPoints.size(); ++point)
    {
      const Vector3& at = truth.MriPoints[point];
      char line[120];
      std::snprintf(line, sizeof line, "%zu,%.4f,%.4f,%.4f\n", point, at[0], at[1], at[2]);
      points += line;
    }
    WriteAtomicFile(this->Folder + "/points.csv", points);
  }

  /// Answers from the mammograms' outlines alone.
  std::vector<StudyAnswer> Answer(const std::vector<Vector3>& points, OutlineMotion motion) const
  {
    const AnatomicalAxes axes = AnatomicalAxes::FromCode("LPS");
    const std::vector<bool> held = this->Table.Fixed();
    TargetOptions options;
    options.ChestWallMarginMm = StudyChestWallMarginMm;
    std::vector<StudyAnswer> answers;
    for (const auto* view : { &this->Choice.Cc, &this->Choice.Mlo })
    {
      const Mammogram mammogram = ReadMammogram((*view)->Header.Path);
      const RegistrationTarget target = PrepareTarget(mammogram, options);
      UnitPlacement placement{ FindPoseFrame(this->Tissue.Breast, held, axes), {} };
      placement.Unit.SourceToDetectorMm =
        mammogram.SourceToDetectorMm.value_or(placement.Unit.SourceToDetectorMm);
      BreastPose pose;
      pose.ThicknessMm = mammogram.BodyPartThicknessMm.value_or(pose.ThicknessMm);
      pose.RollDeg = NominalRollDeg(mammogram).value_or(0);
      const std::vector<Vector3> moved =
        MoveByOutline(points, this->Tissue.Breast, held, placement, pose, target, motion);
      for (std::size_t point = 0; point < moved.size(); ++point)
      {
        const Vector3& at = moved[point];
        answers.push_back(
          { (*view)->Header.View, point, target.Grid.IndexOf(ShadowOf(at, placement.Unit)), at });
      }
    }
    return answers;
  }

private:
  std::string Folder;
  MaterialTable Table;
  StudyChoice Choice;
  StudyTissue Tissue;
};

std::string ScoreTable(const std::vector<BaselineScore>& scores)
{
  std::string table = "study,baseline,view,points,median_3d_mm,p95_3d_mm,median_receptor_mm,"
                      "p95_receptor_mm\n";
  for (const BaselineScore& score : scores)
  {
    for (const AnswerScore& view : score.Views)
    {
      const std::vector<double>& space = view.Imaged.InSpaceMm;
      const std::vector<double>& receptor = view.Imaged.OnReceptorMm;
      char line[200];
      std::snprintf(line, sizeof line, "%s,%s,%s,%zu,%.2f,%.2f,%.2f,%.2f\n", score.Study.c_str(),
        score.Baseline.c_str(), view.View.c_str(), receptor.size(), Quantile(space, 0.5),
        Quantile(space, 0.95), Quantile(receptor, 0.5), Quantile(receptor, 0.95));
      table += line;
    }
  }
  return table;
}

std::string StudyRow(const PlannedStudy& study, const StudyTruth& truth)
{
  std::string views;
  for (const TrueView& view : truth.Views)
  {
    views += (views.empty() ? "" : " ") + view.View;
  }
  const std::string sequences = std::string(study.Options.Plain ? "plain" : "") +
    (study.Options.Plain && study.Options.FatSuppressed ? " " : "") +
    (study.Options.FatSuppressed ? "fat-suppressed" : "");
  return NameOf(study) + ',' + study.Phantom + ',' + SideName(truth.Laterality) + ',' + sequences +
    ',' + views + '\n';
}

/// Checksums of all files, sorted by name, for `sha256sum -c`.
std::string Checksums(const fs::path& folder)
{
  std::vector<std::string> names;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder))
  {
    if (entry.is_regular_file())
    {
      names.push_back(entry.path().lexically_relative(folder).string());
    }
  }
  std::sort(names.begin(), names.end());
  std::string sums;
  for (const std::string& name : names)
  {
    sums += Sha256OfFile((folder / name).string()) + "  " + name + '\n';
  }
  return sums;
}

/// Writes a study into `folder` and appends the scores of the baselines to `scores`. Returns its
/// row.
std::string ExportStudy(const PlannedStudy& study, const std::string& folder,
  std::vector<BaselineScore>& scores, const ProgressCallback& progress)
{
  const std::string name = NameOf(study);
  const std::string own = folder + '/' + name;
  const StudyTruth truth = MakePlannedStudy(study, own, ShareOf(progress, 0, 0.7));
  fs::rename(own + "/truth.json", folder + "/truth/" + name + ".json");
  WriteAnswers(TrueAnswers(truth), folder + "/truth/" + name + ".csv");
  const GivenStudy given(own, ShareOf(progress, 0.7, 1));
  given.Write(truth);
  for (const Baseline& baseline : Baselines)
  {
    const std::vector<StudyAnswer> answers = given.Answer(truth.MriPoints, baseline.Motion);
    WriteAnswers(answers, folder + "/baselines/" + name + '-' + baseline.Name + ".csv");
    scores.push_back({ name, baseline.Name, ScoreAnswers(truth, answers) });
  }
  return StudyRow(study, truth);
}
}

std::vector<BaselineScore> ExportBenchmark(const std::vector<PlannedStudy>& studies,
  const std::string& folder, const ProgressCallback& progress)
{
  ReserveEmptyFolder(folder);
  std::vector<BaselineScore> scores;
  WriteAtomicFolder(folder,
    [&](const std::string& written)
    {
      fs::create_directory(written + "/truth");
      fs::create_directory(written + "/baselines");
      std::string rows = "study,anatomy,side,sequences,views\n";
      for (std::size_t number = 0; number < studies.size(); ++number)
      {
        const auto part = [&](std::size_t done)
        { return static_cast<double>(done) / static_cast<double>(studies.size()); };
        rows += ExportStudy(studies[number], written, scores,
          ShareOf(progress, part(number), part(number + 1)));
      }
      WriteAtomicFile(written + "/studies.csv", rows);
      WriteAtomicFile(written + "/scores.csv", ScoreTable(scores));
      WriteAtomicFile(written + "/PROTOCOL.md", Protocol());
      WriteAtomicFile(written + "/SHA256SUMS", Checksums(written));
    });
  return scores;
}
}
