// SPDX-License-Identifier: Apache-2.0
#include "PatientRuns.h"

#include "DrawnSlices.h"
#include "mammoray/Dicom/DicomReader.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/MammographyGeometry.h"
#include "mammoray/Foundation/MaterialTable.h"
#include "mammoray/Foundation/Numbers.h"
#include "mammoray/IO/AtomicFile.h"
#include "mammoray/IO/LabelVolumeIO.h"
#include "mammoray/IO/ShippedData.h"
#include "mammoray/Segmentation/BreastSegmentation.h"
#include "mammoray/Study/Intake.h"
#include "mammoray/Study/StudyPictures.h"

#include "vtkImageAppend.h"
#include "vtkImageData.h"
#include "vtkImageTranslateExtent.h"
#include "vtkNew.h"
#include "vtkPNGReader.h"
#include "vtkPNGWriter.h"
#include "vtkUnsignedCharArray.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <numeric>
#include <optional>

namespace mammoray
{
namespace
{
/// Pictures beside each other in the sheet.
constexpr int SheetColumns = 3;

/// Fat, gland and skin of a breast.
struct SegmentedBreast
{
  double Cm3 = 0;
  double GlandCm3 = 0;

  double GlandPercent() const { return 100 * this->GlandCm3 / this->Cm3; }
};

struct PatientRow
{
  std::string Name;
  /// Why there are no labels; empty if there are.
  std::string Refusal;
  std::vector<std::string> Warnings;
  std::vector<BreastQuality> Quality;
  LabelVolume Labels;
  /// From the patient's right to the left; one if the labels hold one.
  std::vector<SegmentedBreast> Breasts;
  DrawnAgreement Agreement;
  double Seconds = 0;
  std::string Picture;
};

std::vector<SegmentedBreast> BreastsOf(const LabelVolume& labels, const MaterialTable& table,
  const AnatomicalAxes& axes)
{
  const std::optional<double> middle =
    MidlineBetweenBreasts(table.ToMaterials(labels, "labels"), table.Fixed(), axes);
  std::vector<SegmentedBreast> breasts(middle ? 2 : 1);
  labels.ForEachVoxel(
    [&](int i, int j, int k, std::size_t voxel)
    {
      const auto label = static_cast<TissueLabel>(labels.Voxels[voxel]);
      if (label == TissueLabel::Air || label == TissueLabel::ChestWall)
      {
        return;
      }
      const bool isLeft = middle && Dot(labels.PointAt(i, j, k), axes.Left) > *middle;
      SegmentedBreast& breast = breasts[isLeft ? 1 : 0];
      breast.Cm3 += labels.VoxelVolume() / 1000;
      breast.GlandCm3 += label == TissueLabel::Gland ? labels.VoxelVolume() / 1000 : 0;
    });
  return breasts;
}

PatientRow Segment(const Patient& patient, const std::vector<DrawnSlice>& drawn,
  const ProgressCallback& progress)
{
  SegmentationOptions options;
  const MaterialTable table = FindMaterialTable("segment");
  PatientRow row;
  row.Name = patient.Name;
  IntensityVolume image;
  const auto start = std::chrono::steady_clock::now();
  try
  {
    image = ReadIntensityVolume(patient.Mri);
    if (FatOfMri(patient.Mri) == FatSuppression::Present)
    {
      options.Contrast = FatContrast::FatDark;
    }
    const SegmentationResult result = SegmentBreast(image, options, progress);
    row.Warnings = result.Warnings;
    row.Quality = result.Quality;
    row.Labels = result.Labels;
    row.Breasts = BreastsOf(result.Labels, table, options.Axes);
    row.Picture =
      DrawLabelSlices(result.Corrected, result.Labels, options.Axes, table.Names(), row.Name).Png;
  }
  catch (const Interrupted&)
  {
    throw;
  }
  catch (const Error& error)
  {
    row.Refusal = error.what();
  }
  row.Seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  if (!row.Refusal.empty() && !image.Voxels.empty())
  {
    // The MRI alone, in a frame.
    LabelVolume whole;
    static_cast<VolumeGrid&>(whole) = image;
    whole.Voxels.assign(image.Voxels.size(), 1);
    row.Picture = DrawLabelSlices(image, whole, options.Axes, { "", "refused" }, row.Name).Png;
  }
  if (row.Refusal.empty())
  {
    row.Agreement = CompareWithDrawn(row.Labels, drawn);
  }
  return row;
}

std::string Verdict(const PatientRow& row)
{
  if (!row.Refusal.empty())
  {
    return "refused: " + row.Refusal;
  }
  const bool doubted = std::any_of(row.Quality.begin(), row.Quality.end(),
    [](const BreastQuality& quality) { return !quality.Doubt.empty(); });
  return std::accumulate(row.Warnings.begin(), row.Warnings.end(),
    std::string(doubted ? "doubted" : "good"),
    [](const std::string& all, const std::string& warning)
    { return all + (all.find(':') == std::string::npos ? ": " : "; ") + warning; });
}

/// Empty for NaN, which stands for what was not drawn.
std::string Cell(double value, int digits)
{
  return std::isnan(value) ? "" : std::isinf(value) ? "inf" : NumberText(value, digits);
}

/// A value of each breast, from right to left: "612.4/598.0".
template <typename Breast, typename Value>
std::string BreastCell(const std::vector<Breast>& breasts, const Value& value, int digits)
{
  std::string text;
  for (const Breast& breast : breasts)
  {
    text += text.empty() ? "" : "/";
    text += Cell(std::invoke(value, breast), digits);
  }
  return text;
}

constexpr const char* Header = "patient,seconds,breast_cm3,gland_percent,"
                               "wall_seen,wall_agreement,skin_seen,breast_dice,gland_dice,"
                               "outline_mm,outline_95_mm,chest_wall_mm,chest_wall_95_mm,verdict\n";

std::string CsvRow(const PatientRow& row)
{
  const DrawnAgreement& agreement = row.Agreement;
  std::string verdict = Verdict(row);
  std::replace(verdict.begin(), verdict.end(), '"', '\'');
  return row.Name + ',' + Cell(row.Seconds, 1) + ',' +
    BreastCell(row.Breasts, &SegmentedBreast::Cm3, 1) + ',' +
    BreastCell(row.Breasts, &SegmentedBreast::GlandPercent, 1) + ',' +
    BreastCell(row.Quality, &BreastQuality::WallSeen, 2) + ',' +
    BreastCell(row.Quality, &BreastQuality::WallAgreement, 2) + ',' +
    BreastCell(row.Quality, &BreastQuality::SkinSeen, 2) + ',' + Cell(agreement.BreastDice, 3) +
    ',' + Cell(agreement.GlandDice, 3) + ',' + Cell(agreement.Outline.MeanMm, 2) + ',' +
    Cell(agreement.Outline.Quantile95Mm, 2) + ',' + Cell(agreement.ChestWall.MeanMm, 2) + ',' +
    Cell(agreement.ChestWall.Quantile95Mm, 2) + ",\"" + verdict + "\"\n";
}

/// Pictures in rows from above, as one (.png).
std::string SheetOf(const std::vector<PatientRow>& rows)
{
  vtkNew<vtkImageAppend> sheet;
  sheet->PreserveExtentsOn();
  int left = 0;
  int low = 0;
  int height = 0;
  int column = 0;
  for (const PatientRow& row : rows)
  {
    if (row.Picture.empty())
    {
      continue;
    }
    vtkNew<vtkPNGReader> reader;
    reader->SetMemoryBuffer(row.Picture.data());
    reader->SetMemoryBufferLength(static_cast<vtkIdType>(row.Picture.size()));
    reader->Update();
    const int* size = reader->GetOutput()->GetDimensions();
    if (column == SheetColumns)
    {
      low -= height;
      left = column = height = 0;
    }
    vtkNew<vtkImageTranslateExtent> placed;
    placed->SetInputConnection(reader->GetOutputPort());
    placed->SetTranslation(left, low - size[1], 0);
    sheet->AddInputConnection(placed->GetOutputPort());
    left += size[0];
    height = std::max(height, size[1]);
    ++column;
  }
  vtkNew<vtkPNGWriter> writer;
  writer->SetInputConnection(sheet->GetOutputPort());
  writer->WriteToMemoryOn();
  writer->Write();
  vtkUnsignedCharArray* bytes = writer->GetResult();
  return { reinterpret_cast<const char*>(bytes->GetPointer(0)),
    static_cast<std::size_t>(bytes->GetNumberOfValues()) };
}
}

void RunPatients(const std::vector<Patient>& patients, const std::string& folder,
  const ProgressCallback& progress)
{
  std::vector<std::vector<DrawnSlice>> drawn;
  for (const Patient& patient : patients)
  {
    drawn.push_back(std::filesystem::exists(patient.Drawn) ? ReadDrawnSlices(patient.Drawn)
                                                           : std::vector<DrawnSlice>());
  }
  ReserveEmptyFolder(folder);
  std::vector<PatientRow> rows;
  std::string csv = Header;
  std::printf("%s", Header);
  for (const Patient& patient : patients)
  {
    const double done = static_cast<double>(rows.size()) / static_cast<double>(patients.size());
    const double next = static_cast<double>(rows.size() + 1) / static_cast<double>(patients.size());
    rows.push_back(
      Segment(patient, drawn[rows.size()], PartOf(progress, done, next, patient.Name)));
    csv += CsvRow(rows.back());
    std::printf("%s", CsvRow(rows.back()).c_str());
    std::fflush(stdout);
  }
  WriteAtomicFolder(folder,
    [&](const std::string& staged)
    {
      WriteAtomicFile(staged + "/patients.csv", csv);
      WriteAtomicFile(staged + "/patients.png", SheetOf(rows));
      for (const PatientRow& row : rows)
      {
        if (row.Refusal.empty())
        {
          WriteLabelVolume(row.Labels, staged + "/" + row.Name + ".nrrd");
        }
      }
    });
}
}
