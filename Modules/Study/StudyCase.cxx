// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Study/StudyCase.h"

#include "Private/HeaderRules.h"
#include "Private/StudyTissues.h"
#include "mammoray/Dicom/DicomReader.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/MammographyGeometry.h"
#include "mammoray/Foundation/Numbers.h"
#include "mammoray/IO/ShippedData.h"
#include "mammoray/Study/LabelSource.h"
#include "mammoray/Study/StudyPictures.h"

#ifdef MAMMORAY_HAS_SEGMENTATION
#include "mammoray/Segmentation/BreastSegmentation.h"
#endif

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

namespace mammoray
{
namespace
{
/// The end of the grid's axis that leads backwards most; DICOM LPS.
std::string PosteriorSide(const VolumeGrid& grid)
{
  const std::size_t depth = grid.AxisAlong({ 0, 1, 0 });
  return GridSides()[2 * depth + (grid.Direction[depth][1] > 0 ? 1 : 0)];
}

/// Distance from the front of fixed tissue to that of the rest, mm: all but the hundredth part of
/// the columns along the patient's depth have less.
double DepthOf(const LabelVolume& breast, const std::vector<bool>& fixed)
{
  const std::size_t axis = breast.AxisAlong({ 0, 1, 0 });
  const double forwards =
    breast.Direction[axis][1] > 0 ? -breast.Spacing[axis] : breast.Spacing[axis];
  const std::size_t across = (axis + 1) % 3;
  const std::size_t along = (axis + 2) % 3;
  std::vector<std::array<Extent, 2>> columns(
    static_cast<std::size_t>(breast.Size[across]) * breast.Size[along]);
  breast.ForEachVoxel(
    [&](int i, int j, int k, std::size_t voxel)
    {
      if (const std::uint16_t material = breast.Voxels[voxel]; material != 0)
      {
        const std::array<int, 3> at{ i, j, k };
        const std::size_t row = static_cast<std::size_t>(at[along]) * breast.Size[across];
        columns[row + at[across]][fixed[material] ? 1 : 0].Add(forwards * at[axis]);
      }
    });
  std::vector<double> depths{ 0 };
  for (const auto& [rest, wall] : columns)
  {
    if (rest.Length() >= 0)
    {
      depths.push_back(std::max(0.0, rest.High - (wall.Length() >= 0 ? wall.High : rest.Low)));
    }
  }
  return QuantileElement(std::move(depths), 0.99);
}
}

StudyTissue MakeStudyTissue(LabelVolume&& materials, IntensityVolume&& mri,
  const MaterialTable& table)
{
  StudyTissue tissue;
  tissue.Labels = std::move(materials);
  tissue.Mri = std::move(mri);
  for (std::size_t index = 1; index < table.Materials.size(); ++index)
  {
    tissue.Labels.Names[static_cast<int>(index)] = table.Materials[index].Name;
  }
  const std::vector<bool> fixed = table.Fixed();
  tissue.Breast = KeepBreast(tissue.Labels, fixed, AnatomicalAxes());
  // Beside the breast, in front of the chest wall, the plates push what was cut before them.
  tissue.Cut = CutTissue(tissue.Labels, tissue.Labels, table, { PosteriorSide(tissue.Labels) });
  const std::vector<int> gland = table.Glandular();
  double glandCm3 = 0;
  for (const auto& [material, count] : tissue.Breast.CountLabels())
  {
    const double cm3 = static_cast<double>(count) * tissue.Breast.VoxelVolume() / 1000;
    tissue.BreastCm3 += material != 0 && !fixed[material] ? cm3 : 0;
    glandCm3 += std::find(gland.begin(), gland.end(), material) != gland.end() ? cm3 : 0;
  }
  tissue.GlandFraction = glandCm3 / std::max(tissue.BreastCm3, 1e-9);
  tissue.DepthMm = DepthOf(tissue.Breast, fixed);
  return tissue;
}

#ifdef MAMMORAY_HAS_SEGMENTATION
namespace
{
/// The side is asked for where both breasts are there: where they are not, the field holds one,
/// although it may not be told which.
BreastSide SideToSegment(const StudySeries& series, char laterality)
{
  if (series.Side != 'B')
  {
    return BreastSide::Both;
  }
  return laterality == 'L' ? BreastSide::Left : BreastSide::Right;
}

StudyTissue TissueOf(SegmentationResult&& found, const MaterialTable& table)
{
  StudyTissue tissue = MakeStudyTissue(table.ToMaterials(found.Labels, "the study's MRI"),
    std::move(found.Corrected), table);
  tissue.DepthMm = found.Measures.DepthMm;
  tissue.Warnings = std::move(found.Warnings);
  for (const BreastQuality& quality : found.Quality) // of the side that is registered
  {
    tissue.Doubt = quality.Doubt;
  }
  return tissue;
}
}

StudyTissue SegmentStudy(const StudyChoice& choice, const MaterialTable& table,
  const ProgressCallback& progress, bool acceptUnusual)
{
  choice.Require();
  SegmentationOptions options;
  options.AcceptUnusual = acceptUnusual;
  const StudySeries& first = *choice.Mri();
  options.Side = SideToSegment(first, choice.Laterality);
  options.Contrast = choice.Plain ? FatContrast::FatBright
    : choice.FatSuppressed        ? FatContrast::FatDark
                                  : FatContrast::Auto;
  const IntensityVolume image =
    ReadIntensitySlices(first.Slices, PartOf(progress, 0, 0.1, "read the MRI"));
  const std::optional<StudySeries>& other =
    choice.FatSuppressed && !choice.Plain ? choice.Undetermined : choice.FatSuppressed;
  if (!other)
  {
    return TissueOf(SegmentBreast(image, options, PartOf(progress, 0.1, 1, "segment the MRI")),
      table);
  }
  const IntensityVolume second =
    ReadIntensitySlices(other->Slices, PartOf(progress, 0.1, 0.2, "read the other MRI"));
  if (choice.Plain)
  {
    return TissueOf(
      SegmentBreast(image, second, options, PartOf(progress, 0.2, 1, "segment the MRI")), table);
  }
  // No header tells of what kind it is: if fat turns out to be bright, it is the plain one.
  SegmentationOptions open = options;
  open.Contrast = FatContrast::Auto;
  std::string why = "its fat is dark, too";
  try
  {
    if (SegmentBreast(second, open, PartOf(progress, 0.2, 0.5, "look at the other MRI")).Contrast ==
      FatContrast::FatBright)
    {
      return TissueOf(
        SegmentBreast(second, image, options, PartOf(progress, 0.5, 1, "segment the MRI")), table);
    }
  }
  catch (const InputError& error)
  {
    why = error.what();
  }
  StudyTissue tissue =
    TissueOf(SegmentBreast(image, options, PartOf(progress, 0.5, 1, "segment the MRI")), table);
  tissue.Warnings.push_back(
    "'" + other->Description + "' is not used beside '" + first.Description + "': " + why);
  return tissue;
}
#else
StudyTissue SegmentStudy(const StudyChoice&, const MaterialTable&, const ProgressCallback&, bool)
{
  throw InputError("study: this build has no Segmentation module (ITK 5 was not found, or "
                   "MAMMORAY_BUILD_SEGMENTATION was OFF); expected labels made elsewhere");
}
#endif

namespace
{
/// Numbers in place of what somebody wrote into headers and names of files, which may be anything
/// of the patient.
void HideNames(Study& study)
{
  if (!study.Damaged.empty())
  {
    study.Damaged = { "damaged files among the export: " + std::to_string(study.Damaged.size()) +
      "; intake names them" };
  }
  std::vector<StudySeries>& series = study.Series;
  for (std::size_t index = 0; index < series.size(); ++index)
  {
    const std::optional<double> number = series[index].Header.SeriesNumber;
    const std::string written = "'" + series[index].Description + "'";
    series[index].Description = number && std::abs(*number) < 1e9
      ? "series " + std::to_string(std::lround(*number))
      : "volume " + std::to_string(index + 1) + " of the MRI";
    for (StudySeries& other : series) // which it may be the evidence of
    {
      const std::size_t at = other.ContrastEvidence.find(written);
      if (at != std::string::npos)
      {
        other.ContrastEvidence.replace(at, written.size(), "'" + series[index].Description + "'");
      }
    }
  }
}

/// Gives views to the mammograms of the side whose headers name none, in their order.
void FillViews(const std::vector<std::string>& views, std::optional<char> laterality, Study& study)
{
  std::size_t used = 0;
  for (StudyMammogram& image : study.Mammograms)
  {
    if (used < views.size() && image.LeftOut == NamesNoView &&
      (!laterality || image.Header.Laterality == *laterality))
    {
      image.Header.View = views[used++];
      image.LeftOut.clear();
    }
  }
  if (used < views.size())
  {
    throw InputError("MammogramViews: expected views of the " + std::to_string(used) +
      " mammograms of the study whose headers name none, found " + std::to_string(views.size()));
  }
}
}

void TakeStudy(const std::string& folder, std::optional<char> laterality, RegistrationCase& input,
  const ProgressCallback& progress)
{
  TakeStudy(ReadStudy(folder, progress), laterality, input);
}

void TakeStudy(Study study, std::optional<char> laterality, RegistrationCase& input)
{
  if (!input.NameInputs)
  {
    HideNames(study);
  }
  if (input.PixelSpacingMm)
  {
    for (StudyMammogram& image : study.Mammograms)
    {
      image.Header.WhyNoPixelSize.clear();
    }
  }
  FillViews(input.MammogramViews, laterality, study);
  StudyChoice choice =
    ChooseForRegistration(std::move(study), laterality, input.Series, input.ImagePosition);
  choice.Require();
  const bool filled = !input.MammogramViews.empty();
  input.Mammograms.clear();
  input.MammogramViews.clear();
  for (const auto* view : { &choice.Cc, &choice.Mlo })
  {
    if (*view)
    {
      input.Mammograms.push_back((*view)->Header.Path);
      if (filled)
      {
        input.MammogramViews.push_back((*view)->Header.View);
      }
    }
  }
  input.Laterality = choice.Laterality;
  input.Materials = input.Materials.empty() ? StudyMaterials : input.Materials;
  input.Orientation = "LPS";
  input.ImagePosition = choice.Position;
  // The pectoral muscle lets the breast glide; fixed there, it could not follow the plates.
  input.ChestWall = ChestWallMode::Sliding;
  input.Targets.ChestWallMarginMm = StudyChestWallMarginMm;
  input.RollSigmaDeg = StudyRollSigmaDeg;
  // Three of these beside it a breast fits as well, toppled to its other side.
  input.Options.RollOffsetsDeg.clear();
  input.Study = std::make_shared<const StudyChoice>(std::move(choice));
}

ReportSection StudySection(const StudyChoice& choice, const StudyTissue& tissue,
  const std::string& labels)
{
  ReportSection section;
  section.Title = "The patient's files";
  for (const StudySeries& series : choice.Found.Series)
  {
    const std::string name = series.Description.empty() ? "no description" : series.Description;
    const std::string phase = series.Phases > 1
      ? ", " + std::to_string(series.Phase) + " of " + std::to_string(series.Phases)
      : "";
    section.Rows.emplace_back("MRI: " + name + phase, series.Reason);
  }
  for (const StudyMammogram& image : choice.Found.Mammograms)
  {
    const DicomHeader& header = image.Header;
    const std::string side = header.Laterality == 'L' ? "left "
      : header.Laterality == 'R'                      ? "right "
                                                      : "";
    const bool processing = header.PresentationIntent == Mammogram::Intent::ForProcessing;
    section.Rows.emplace_back("Mammogram: " + side + header.View +
        (processing ? ", For Processing" : ", For Presentation"),
      image.Reason);
  }
  section.Rows.emplace_back("Patient in the MRI",
    !choice.Position                               ? "not stated: taken as without weight"
      : *choice.Position == PatientPosition::Prone ? "prone"
                                                   : "supine");
  section.Rows.emplace_back("Tissue",
    labels.empty() ? "segmented in the MRI" : "labels that were given: " + labels);
  section.Rows.emplace_back("Breast in the MRI", NumberText(tissue.BreastCm3, 0) + " cm3");
  section.Rows.emplace_back("Gland in it", NumberText(100 * tissue.GlandFraction, 0) + " %");
  section.Rows.emplace_back("Stands out by", NumberText(tissue.DepthMm, 0) + " mm");
  std::vector<std::string> names;
  for (const auto& [material, name] : tissue.Labels.Names)
  {
    names.resize(static_cast<std::size_t>(material) + 1);
    names.back() = name;
  }
  section.Picture =
    DrawLabelSlices(tissue.Mri, tissue.Labels, AnatomicalAxes::FromCode("LPS"), names);
  section.Caption = labels.empty() ? "The breast as it was found in the MRI."
                                   : "The tissue of the labels, over the MRI.";
  section.Caption += " What is coloured wrong here is wrong everywhere: look at it first.";
  section.Notes = choice.Warnings;
  section.Notes.insert(section.Notes.end(), tissue.Warnings.begin(), tissue.Warnings.end());
  return section;
}
}
