// SPDX-License-Identifier: Apache-2.0
#include "RegisteredMammogram.h"

#include "Error.h"
#include "MammogramSynthesis.h"
#include "Sha256.h"

#include "vtkFloatArray.h"
#include "vtkImageData.h"
#include "vtkMetaImageReader.h"
#include "vtkNew.h"
#include "vtkPointData.h"

#include <nlohmann/json.hpp>

#include <filesystem>
#include <fstream>
#include <functional>

namespace mammoray
{
namespace
{
/// Hands over result.json; what is missing in it becomes an InputError.
void WithResult(const std::string& folder, const std::function<void(const nlohmann::json&)>& use)
{
  const std::string path = folder + "/result.json";
  std::ifstream file(path);
  if (!file)
  {
    throw InputError(path + ": no such file");
  }
  try
  {
    use(nlohmann::json::parse(file));
  }
  catch (const nlohmann::json::exception& error)
  {
    throw InputError(path + ": expected the result of 'mammoray register': " + error.what());
  }
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
  Mammogram synthetic = real;
  synthetic.PeakKilovoltage.reset();
  synthetic.AnodeMaterial.clear();
  synthetic.FilterMaterial.clear();
  WithResult(folder,
    [&](const nlohmann::json& result)
    {
      const nlohmann::json& pose = result.at("pose");
      synthetic.BodyPartThicknessMm = pose.at("thicknessMm").get<double>();
      synthetic.PositionerPrimaryAngleDeg = pose.at("rollDeg").get<double>();
      const nlohmann::json& unit = result.at("unit");
      synthetic.SourceToDetectorMm = unit.at("sourceToDetectorMm").get<double>();
      synthetic.SourceToPatientMm =
        *synthetic.SourceToDetectorMm - unit.at("supportHeightMm").get<double>();
    });
  SetPixels(synthetic, ReadLogAttenuation(folder + "/synthetic.mha", real), intent);
  return synthetic;
}

bool IsRegisteredMammogram(const std::string& folder, const std::string& mammogramPath)
{
  bool same = false;
  WithResult(folder,
    [&](const nlohmann::json& result)
    {
      for (const nlohmann::json& input : result.at("inputs"))
      {
        same |=
          input.at("role") == "Mammogram" && input.at("sha256") == Sha256OfFile(mammogramPath);
      }
    });
  return same;
}
}
