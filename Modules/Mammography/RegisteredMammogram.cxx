// SPDX-License-Identifier: Apache-2.0
#include "RegisteredMammogram.h"

#include "Error.h"
#include "MammogramSynthesis.h"
#include "RegisteredBreast.h"
#include "ResultFile.h"
#include "Sha256.h"

#include "vtkFloatArray.h"
#include "vtkImageData.h"
#include "vtkMetaImageReader.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkUnstructuredGrid.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <filesystem>

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
    [&](const nlohmann::json& result)
    {
      const nlohmann::json& inputs = result.at("inputs");
      const std::string checksum = Sha256OfFile(mammogramPath);
      found = std::any_of(inputs.begin(), inputs.end(),
        [&](const nlohmann::json& input)
        { return input.at("role") == "Mammogram" && input.at("sha256") == checksum; });
    });
  return found;
}
}
