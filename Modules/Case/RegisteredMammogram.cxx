// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Case/RegisteredMammogram.h"

#include "mammoray/Case/RegisteredBreast.h"
#include "mammoray/Case/ResultFile.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/MammogramIO.h"
#include "mammoray/IO/MammogramPictureIO.h"
#include "mammoray/IO/MammogramSynthesis.h"
#include "mammoray/IO/Sha256.h"

#include "vtkFloatArray.h"
#include "vtkImageData.h"
#include "vtkMetaImageReader.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkUnstructuredGrid.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <filesystem>
#include <optional>

namespace mammoray
{
namespace
{
/// What was found for a parameter; 0 for one that results of early versions lack.
double ValueOf(const BreastInUnit& breast, const std::string& parameter)
{
  const auto name = std::find(breast.Parameters.begin(), breast.Parameters.end(), parameter);
  return name == breast.Parameters.end() ? 0 : breast.Values[name - breast.Parameters.begin()];
}

/// The header of the registered pose. Directions of the patient do not depend on the volume's
/// frame, so any will do.
Mammogram DescribeRegistration(const BreastInUnit& breast, char laterality)
{
  const BreastPose pose{ .ThicknessMm = ValueOf(breast, "thickness"),
    .RollDeg = ValueOf(breast, "roll"),
    .PitchDeg = ValueOf(breast, "pitch"),
    .YawDeg = ValueOf(breast, "yaw") };
  const MammographyUnit& unit = breast.Unit;
  const RegistrationTarget& grid = breast.Grid;
  const AnatomicalAxes axes;
  const VolumeFromGantry gantry = PlaceUnit(axes, { 0, 0, 0 }, unit, pose);
  XRayDetector detector;
  detector.Columns = grid.Columns;
  detector.Rows = grid.Rows;
  detector.Origin = gantry.Point({ grid.Origin[0], grid.Origin[1], 0 });
  detector.ColumnStep = gantry.Direction({ grid.ColumnStep[0], grid.ColumnStep[1], 0 });
  detector.RowStep = gantry.Direction({ grid.RowStep[0], grid.RowStep[1], 0 });
  XRaySource source;
  source.Position = gantry.Point({ 0, 0, unit.SourceToDetectorMm });
  Mammogram mammogram = DescribeProjection(source, detector, axes, laterality);
  mammogram.BodyPartThicknessMm = pose.ThicknessMm;
  mammogram.SourceToPatientMm = unit.SourceToDetectorMm - unit.SupportHeightMm;
  return mammogram;
}

std::vector<float> ReadLogAttenuation(const std::string& path, const Mammogram& real)
{
  if (!std::filesystem::is_regular_file(path))
  {
    throw InputError(path + ": no such file");
  }
  vtkNew<vtkMetaImageReader> reader;
  reader->SetFileName(path.c_str());
  reader->Update();
  vtkImageData* image = reader->GetOutput();
  auto* values = vtkFloatArray::SafeDownCast(image->GetPointData()->GetScalars());
  const int* size = image->GetDimensions();
  if (!values || size[0] != real.Columns || size[1] != real.Rows || size[2] != 1)
  {
    throw InputError(path + ": expected the mammogram's " + std::to_string(real.Columns) + " x " +
      std::to_string(real.Rows) + " pixels, found " +
      (values ? std::to_string(size[0]) + " x " + std::to_string(size[1]) : "no floats") +
      "; is it the mammogram that was registered?");
  }
  const float* begin = values->GetPointer(0);
  return { begin, begin + values->GetNumberOfValues() };
}

/// Nothing where a result is of this mammogram, by its checksum; else the name of the one it is of.
std::optional<std::string> NameOfOther(const nlohmann::json& result,
  const std::string& mammogramPath)
{
  const std::string checksum = Sha256OfFile(mammogramPath);
  std::string name;
  for (const nlohmann::json& input : result.at("inputs"))
  {
    if (input.at("role") == "Mammogram")
    {
      if (input.at("sha256") == checksum)
      {
        return {};
      }
      input.at("file").get_to(name);
    }
  }
  return name;
}
}

Mammogram ReadSyntheticMammogram(const std::string& folder, const Mammogram& real,
  Mammogram::Intent intent)
{
  Mammogram synthetic = DescribeRegistration(ReadRegistration(folder), real.Laterality);
  const auto prefer = [](std::string& found, const std::string& told)
  { found = told.empty() ? found : told; };
  prefer(synthetic.View, real.View);
  prefer(synthetic.RowDirection, real.RowDirection);
  prefer(synthetic.ColumnDirection, real.ColumnDirection);
  SetPixels(synthetic, ReadLogAttenuation(folder + "/synthetic.mha", real), intent);
  return synthetic;
}

bool IsRegisteredMammogram(const std::string& folder, const std::string& mammogramPath)
{
  bool found = false;
  ReadResultFile(folder,
    [&](const nlohmann::json& result) { found = !NameOfOther(result, mammogramPath); });
  return found;
}

Mammogram ReadRegisteredMammogram(const std::string& folder, const std::string& mammogramPath)
{
  Mammogram mammogram;
  ReadResultFile(folder,
    [&](const nlohmann::json& result)
    {
      if (const std::optional<std::string> other = NameOfOther(result, mammogramPath))
      {
        throw InputError(mammogramPath + ": expected the mammogram of the result, " + *other +
          ", found another file");
      }
      const nlohmann::json& searched = result.at("mammogram");
      const std::string laterality = searched.at("laterality").get<std::string>();
      PictureDescription known{ searched.at("columnSpacingMm").get<double>(),
        searched.at("view").get<std::string>(), laterality.empty() ? '?' : laterality.front() };
      mammogram = IsPicturePath(mammogramPath) ? ReadMammogramPicture(mammogramPath, known)
                                               : ReadMammogram(mammogramPath);
      mammogram.ColumnSpacingMm = *known.PixelSpacingMm;
      searched.at("rowSpacingMm").get_to(mammogram.RowSpacingMm);
      mammogram.View = known.View;
      mammogram.Laterality = known.Laterality;
    });
  return mammogram;
}
}
