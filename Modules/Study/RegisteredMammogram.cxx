// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Study/RegisteredMammogram.h"

#include "mammoray/Dicom/DicomReader.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/MammogramPictureIO.h"
#include "mammoray/IO/MammogramSynthesis.h"
#include "mammoray/IO/Sha256.h"
#include "mammoray/IO/ShippedData.h"
#include "mammoray/Registration/PosedBreast.h"

#include <optional>

namespace mammoray
{
namespace
{
/// The header of the registered pose.
Mammogram DescribeRegistration(const ResultFile& result, char laterality)
{
  const MammographyUnit& unit = result.Unit;
  Mammogram mammogram = DescribeProjection(SourceOf(result.Placed, unit),
    DetectorOf(result.Placed, result.Grid, 1), result.Axes, laterality);
  mammogram.BodyPartThicknessMm = result.Pose.ThicknessMm;
  mammogram.SourceToPatientMm = unit.SourceToDetectorMm - unit.SupportHeightMm;
  return mammogram;
}

/// Nothing where a result is of this mammogram, by its checksum; else the name of the one it is of.
std::optional<std::string> NameOfOther(const ResultFile& result, const std::string& mammogramPath)
{
  const std::string checksum = Sha256OfFile(mammogramPath);
  std::string name;
  for (const ResultInput& input : result.Inputs)
  {
    if (input.Role == MammogramRole)
    {
      if (input.Sha256 == checksum)
      {
        return {};
      }
      name = input.File;
    }
  }
  return name;
}
}

Mammogram ReadSyntheticMammogram(const ResultFile& result, const Mammogram& real,
  Mammogram::Intent intent)
{
  Mammogram synthetic = DescribeRegistration(result, real.Laterality);
  const auto prefer = [](std::string& found, const std::string& told)
  { found = told.empty() ? found : told; };
  prefer(synthetic.View, real.View);
  prefer(synthetic.RowDirection, real.RowDirection);
  prefer(synthetic.ColumnDirection, real.ColumnDirection);
  try
  {
    synthetic.PeakKilovoltage = FindSpectrum(result.Spectrum).PeakEnergyKeV();
  }
  catch (const InputError&)
  {
    // A table of the user's that is no longer there: the voltage is left out.
  }
  SetPixels(synthetic, ReadFloatPicture(result.Folder + "/synthetic.mha", real.Columns, real.Rows),
    intent);
  return synthetic;
}

bool IsRegisteredMammogram(const ResultFile& result, const std::string& mammogramPath)
{
  return !NameOfOther(result, mammogramPath);
}

Mammogram ReadRegisteredMammogram(const ResultFile& result, const std::string& mammogramPath)
{
  if (const std::optional<std::string> other = NameOfOther(result, mammogramPath))
  {
    throw InputError(
      mammogramPath + ": expected the mammogram of the result, " + *other + ", found another file");
  }
  const Mammogram& searched = result.Mammogram;
  const PictureDescription known{ searched.ColumnSpacingMm, searched.View, searched.Laterality };
  Mammogram mammogram = IsPicturePath(mammogramPath) ? ReadMammogramPicture(mammogramPath, known)
                                                     : ReadMammogram(mammogramPath, known);
  mammogram.ColumnSpacingMm = searched.ColumnSpacingMm;
  mammogram.RowSpacingMm = searched.RowSpacingMm;
  mammogram.View = searched.View;
  mammogram.Laterality = searched.Laterality;
  return mammogram;
}

DicomHeader ReadRegisteredReference(const std::string& mammogramPath, const XRayDetector& detector)
{
  DicomHeader image = ReadMammogramHeader(mammogramPath);
  if (image.Columns != detector.Columns || image.Rows != detector.Rows)
  {
    throw InputError(mammogramPath + ": expected the registered mammogram of " +
      std::to_string(detector.Columns) + " x " + std::to_string(detector.Rows) + " pixels, found " +
      std::to_string(image.Columns) + " x " + std::to_string(image.Rows));
  }
  return image;
}
}
