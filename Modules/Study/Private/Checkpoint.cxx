// SPDX-License-Identifier: Apache-2.0
#include "Private/Checkpoint.h"

#include "Private/ResultFields.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/ValidRange.h"
#include "mammoray/IO/AtomicFile.h"
#include "mammoray/IO/Sha256.h"
#include "mammoray/IO/ShippedData.h"
#include "mammoray/Study/Intake.h"
#include "mammoray/Study/RegistrationCase.h"

#include <filesystem>
#include <fstream>
#include <utility>

namespace mammoray
{
namespace
{
constexpr const char* CheckpointFormat = "mammoray-registration-checkpoint";
}

template <typename Fields>
void ListFields(Fields& fields, SearchPoint& point)
{
  fields("inputs", point.Inputs);
  fields("parameters", point.Parameters);
}

namespace
{
std::vector<SearchPoint> ReadCheckpoint(const std::string& path)
{
  std::ifstream file(path);
  const Json json = Json::parse(file, JsonNestingLimit{ path }, false);
  if (!json.is_object())
  {
    throw InputError(path + ": expected a checkpoint of 'mammoray register', found no JSON object");
  }
  const FieldReader reader(json, path);
  std::string format;
  reader("format", format);
  if (format != CheckpointFormat)
  {
    reader.Refuse("format", std::string("'") + CheckpointFormat + "'");
  }
  reader.CheckVersion();
  std::vector<SearchPoint> points;
  reader("mammograms", points);
  return points;
}
}

std::vector<ResultParameter> ParametersOf(const ViewResult& found)
{
  std::vector<ResultParameter> parameters;
  for (std::size_t index = 0; index < found.Parameters.size(); ++index)
  {
    const RegistrationParameter& parameter = found.Parameters[index];
    const double value = found.Values[index];
    parameters.push_back(
      { parameter.Name, parameter.Unit, value, found.StandardDeviations[index], parameter.Start,
        parameter.Lower, parameter.Upper, parameter.Fixed, AtBound(parameter, value) });
  }
  return parameters;
}

std::vector<ResultInput> InputsOf(const RegistrationCase& input, const std::string& mammogram)
{
  std::vector<ResultInput> inputs;
  const auto add = [&](const char* role, const std::string& path)
  {
    if (!path.empty())
    {
      inputs.push_back({ role, ShownName(path, input.NameInputs), Sha256OfFile(path) });
    }
  };
  if (input.Study)
  {
    const StudyChoice& study = *input.Study;
    for (const auto& [role, series] : { std::pair{ "MRI without fat suppression", &study.Plain },
           { "MRI with fat suppression", &study.FatSuppressed }, { "MRI", &study.Undetermined } })
    {
      if (*series)
      {
        const std::vector<std::string>& files = (*series)->Files;
        inputs.push_back({ role, (*series)->Description,
          files.size() == 1 ? Sha256OfFile(files.front()) : Sha256OfFiles(files) });
      }
    }
  }
  add(LabelRole, input.Labels.Path);
  if (const std::string names = LabelDescriptionOf(input.Labels.Path); IsLabelDescription(names))
  {
    add("Names of labels", names);
  }
  add(MaterialTableRole, FindMaterialTablePath(input.Materials));
  add(MammogramRole, mammogram);
  add("MRI", input.Image);
  add("Lesions", input.Lesions);
  add("Anatomy mesh", input.AnatomyMesh);
  add("Simulation mesh", input.SimulationMesh);
  return inputs;
}

void WriteCheckpoint(const std::vector<SearchPoint>& points, const std::string& path)
{
  Json json;
  json["format"] = CheckpointFormat;
  json["formatVersion"] = ResultFormatVersion;
  FieldWriter writer(json);
  std::vector<SearchPoint> copy = points; // see WriteResultFile
  writer("mammograms", copy);
  WriteAtomicFile(path, json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
}

std::vector<SearchPoint> ReadSearchPoints(const std::string& path)
{
  const std::string beside = CheckpointPath(path);
  if (std::filesystem::is_regular_file(path) || std::filesystem::exists(beside))
  {
    return ReadCheckpoint(std::filesystem::is_regular_file(path) ? path : beside);
  }
  std::vector<SearchPoint> points;
  for (ResultFile& result : ReadResultFiles(path))
  {
    points.push_back({ std::move(result.Inputs), std::move(result.Parameters) });
  }
  return points;
}
}
