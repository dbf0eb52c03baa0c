// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Evidence/Benchmark.h"

#include "mammoray/Dicom/DicomReader.h"
#include "mammoray/Evidence/LandmarkEvaluation.h"
#include "mammoray/Evidence/OutlineBaseline.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/AtomicFile.h"
#include "mammoray/IO/LabelVolumeIO.h"
#include "mammoray/IO/Sha256.h"
#include "mammoray/IO/ShippedData.h"
#include "mammoray/Registration/Silhouette.h"
#include "mammoray/Registration/TargetPreparation.h"
#include "mammoray/Study/RegistrationCase.h"
#include "mammoray/Study/StudyCase.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <utility>

namespace mammoray
{
namespace
{
namespace fs = std::filesystem;

constexpr const char* Protocol =
  R"(# Where is this point of the breast MRI in the mammogram?

An open benchmark of registering breast MRI with mammograms: virtual studies, made by MammoRay )" MAMMORAY_VERSION
  R"(, whose truth is known. Cite the software (CITATION.cff) with its version, and the checksums' checksum
(`sha256sum SHA256SUMS`).

Given, of each study in `studies.csv`:

| file | what |
|---|---|
| `STUDY/export` | a clinic's export: DICOM, the MRI of a prone patient among decoys, CC and MLO of one breast |
| `STUDY/mri-plain.nii.gz`, `mri-fat-suppressed.nii.gz` | the T1-weighted MRI before contrast in it, without and with fat suppression, NIfTI |
| `STUDY/cc.dcm`, `mlo.dcm` | the mammograms in it, For Presentation |
| `STUDY/labels.nii.gz` | the breast as `mammoray segment` finds it: 1 fat, 2 gland, 3 skin, 4 chest wall. Not the truth |
| `STUDY/points.csv` | `point,x,y,z`: places in the breast, DICOM LPS, mm |

Asked: for each study a CSV file with the header `view,point,column,row`: where each mammogram (CC, MLO) has each point,
in columns and rows of its picture, the middle of the first pixel being (0, 0). A method that tells depth, too, writes
`view,point,column,row,x,y,z`: mm in the frame of the receptor, whose origin is the middle of its chest-wall edge, x along
that edge to the patient's left (turned with the unit in MLO), y to the nipple, z to the source.

Measured: distance on the receptor and, with x, y, z, in space, mm, of the points that the mammogram shows; the median and
the value that 95 % stay below, over all studies. A point that is not answered counts as missing and is said so. Points
behind the receptor's edge are told apart. `mammoray evaluate --answers ANSWERS.csv --truth truth/STUDY.json` prints it.

Rules: `truth/` is for scoring alone. Nothing is tuned on these studies: make others for that (another `--seed`).

What is true: a finite element model of the phantom or of a patient's segmented MRI, with stiffness of fat, gland and skin
half to twice the usual, hung under gravity along a gliding chest wall for the MRI and compressed standing between plates
that are tilted by 2 degrees, by other elements on another mesh (`truth/STUDY.json` has the numbers). It is a model: what
no such model knows (Cooper's ligaments, muscle that contracts, breathing) is not in it.

Baselines (`baselines/`, their errors in `scores.csv`): `rigid`, the breast of the MRI put into the unit where the header
says and moved until its shadow's tip and middle meet the mammogram's; `affine`, scaled to its width and depth, and to the
thickness in the header, too.

Licences: studies of phantoms as the phantoms (Data/README.md of the project); those of patients' MRI as their data sets:
uta11 CC BY-SA 4.0, duke CC BY-NC 4.0.
)";

struct Baseline
{
  const char* Name;
  OutlineMotion Motion;
};
constexpr Baseline Baselines[]{ { "rigid", OutlineMotion::Rigid },
  { "affine", OutlineMotion::Affine } };

std::string NameOf(const EvidenceStudy& study)
{
  char name[80];
  std::snprintf(name, sizeof name, "%03u-%s", static_cast<unsigned>(study.Options.Seed),
    study.Phantom.c_str());
  return name;
}

/// The answers that have no error.
std::vector<StudyAnswer> TrueAnswers(const VirtualStudyTruth& truth)
{
  std::vector<StudyAnswer> answers;
  for (const VirtualView& view : truth.Views)
  {
    for (std::size_t point = 0; point < view.Pixels.size(); ++point)
    {
      answers.push_back({ view.View, point, view.Pixels[point], view.Gantry[point] });
    }
  }
  return answers;
}

/// A study as everyone gets it: what a method reads, and what ours makes of it first.
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

  void Write(const VirtualStudyTruth& truth) const
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
        fs::copy_file((*view)->File, this->Folder + '/' + name + ".dcm");
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

  /// Answers by the mammograms' outlines alone.
  std::vector<StudyAnswer> Answer(const std::vector<Vector3>& points, OutlineMotion motion) const
  {
    const AnatomicalAxes axes = AnatomicalAxes::FromCode("LPS");
    const std::vector<bool> held = this->Table.Fixed();
    TargetOptions options;
    options.ChestWallMarginMm = StudyChestWallMarginMm;
    std::vector<StudyAnswer> answers;
    for (const auto* view : { &this->Choice.Cc, &this->Choice.Mlo })
    {
      const Mammogram mammogram = ReadMammogram((*view)->File);
      const RegistrationTarget target = PrepareTarget(mammogram, options);
      UnitPlacement placement{ axes, FindPoseAnchor(this->Tissue.Breast, held, axes), {} };
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
          { (*view)->View, point, target.Grid.IndexOf(ShadowOf(at, placement.Unit)), at });
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

std::string StudyRow(const EvidenceStudy& study, const VirtualStudyTruth& truth)
{
  std::string views;
  for (const VirtualView& view : truth.Views)
  {
    views += (views.empty() ? "" : " ") + view.View;
  }
  const std::string sequences = std::string(study.Options.Plain ? "plain" : "") +
    (study.Options.Plain && study.Options.FatSuppressed ? " " : "") +
    (study.Options.FatSuppressed ? "fat-suppressed" : "");
  return NameOf(study) + ',' + study.Phantom + ',' + (truth.Laterality == 'L' ? "left" : "right") +
    ',' + sequences + ',' + views + '\n';
}

/// As `sha256sum -c` reads it, by name.
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

/// Into `folder`; the scores of the baselines go to the end of `scores`.
std::string ExportStudy(const EvidenceStudy& study, const std::string& folder,
  std::vector<BaselineScore>& scores, const ProgressCallback& progress)
{
  const std::string name = NameOf(study);
  const std::string own = folder + '/' + name;
  const VirtualStudyTruth truth = MakeEvidenceStudy(study, own, ShareOf(progress, 0, 0.7));
  fs::rename(own + "/truth.json", folder + "/truth/" + name + ".json");
  WriteStudyAnswers(TrueAnswers(truth), folder + "/truth/" + name + ".csv");
  const GivenStudy given(own, ShareOf(progress, 0.7, 1));
  given.Write(truth);
  for (const Baseline& baseline : Baselines)
  {
    const std::vector<StudyAnswer> answers = given.Answer(truth.MriPoints, baseline.Motion);
    WriteStudyAnswers(answers, folder + "/baselines/" + name + '-' + baseline.Name + ".csv");
    scores.push_back({ name, baseline.Name, ScoreAnswers(truth, answers) });
  }
  return StudyRow(study, truth);
}
}

std::vector<BaselineScore> ExportBenchmark(const std::vector<EvidenceStudy>& studies,
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
      WriteAtomicFile(written + "/PROTOCOL.md", Protocol);
      WriteAtomicFile(written + "/SHA256SUMS", Checksums(written));
    });
  return scores;
}
}
