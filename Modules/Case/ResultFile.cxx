// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Case/ResultFile.h"

#include "Private/ResultFields.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/Plausible.h"
#include "mammoray/Foundation/PoseParameters.h"
#include "mammoray/IO/WholeOutput.h"

#include <algorithm>
#include <filesystem>
#include <fstream>

namespace mammoray
{
namespace
{
constexpr const char* SingleFormat = "mammoray-registration-result";
constexpr const char* JointFormat = "mammoray-joint-registration-result";

std::string PathIn(const std::string& folder)
{
  return (std::filesystem::path(folder) / ResultFileName).string();
}

template <typename Result>
void Write(const char* format, const Result& result, const std::string& folder)
{
  Json json;
  json["format"] = format;
  json["formatVersion"] = ResultFormatVersion;
  FieldWriter writer(json);
  Result copy = result; // the lists of fields serve both ways and so take what can be changed
  ListFields(writer, copy);
  // A file name or DICOM text need not be UTF-8: replace what is not.
  WriteWholeFile(PathIn(folder), json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
}

/// The file as JSON of this version, in one of the two formats.
Json Parse(const std::string& path)
{
  std::ifstream file(path);
  if (!file)
  {
    throw InputError(path + ": no such file");
  }
  Json json;
  try
  {
    json = Json::parse(file, PlausibleNesting{ path });
  }
  catch (const Json::exception& error)
  {
    throw InputError(
      path + ": expected the result of 'mammoray register', found no JSON: " + error.what());
  }
  if (!json.is_object())
  {
    throw InputError(path + ": expected the result of 'mammoray register', found no JSON object");
  }
  const FieldReader reader(json, path);
  std::string format;
  reader("format", format);
  if (format != SingleFormat && format != JointFormat)
  {
    reader.Refuse("format", std::string("'") + SingleFormat + "' or '" + JointFormat + "'");
  }
  reader.CheckVersion();
  return json;
}

bool IsJoint(const Json& json)
{
  return json["format"] == JointFormat;
}

void CheckCount(const FieldReader& reader, const char* name, const std::vector<double>& covariance,
  std::size_t unknowns)
{
  if (!covariance.empty() && covariance.size() != unknowns * unknowns)
  {
    reader.Refuse(name, std::to_string(unknowns * unknowns) + " numbers",
      std::to_string(covariance.size()));
  }
}

/// Reads the pose off the parameters, which must be those of PoseParameters.
BreastPose PoseIn(const FieldReader& reader, const std::vector<ResultParameter>& parameters)
{
  std::vector<double> values;
  for (const ResultParameter& parameter : parameters)
  {
    const std::size_t index = values.size();
    if (index >= PoseParameters.size() || parameter.Name != PoseParameters[index].Name)
    {
      break;
    }
    values.push_back(parameter.Value);
  }
  if (values.size() != PoseParameters.size() || parameters.size() != values.size())
  {
    reader.Refuse("parameters", PoseParameterNames(),
      std::to_string(parameters.size()) + ", of which " + std::to_string(values.size()) +
        " are as expected");
  }
  return PoseOf(values);
}

ResultFile SingleOf(const Json& json, const std::string& path, const std::string& folder)
{
  const FieldReader reader(json, path);
  ResultFile result;
  result.Folder = folder;
  ListFields(reader, result);
  result.Pose = PoseIn(reader, result.Parameters);
  CheckCount(reader, "covariance", result.Covariance, result.Parameters.size());
  CheckCount(reader, "consideredCovariance", result.ConsideredCovariance, result.Parameters.size());
  return result;
}

JointResultFile JointOf(const Json& json, const std::string& path)
{
  const FieldReader reader(json, path);
  JointResultFile result;
  ListFields(reader, result);
  CheckCount(reader, "covariance", result.Covariance, result.Unknowns.size());
  return result;
}

std::string FolderWithin(const std::string& folder, const JointResultFile::Registered& mammogram)
{
  return (std::filesystem::path(folder) / mammogram.Folder).string();
}
}

void WriteResultFile(const ResultFile& result, const std::string& folder)
{
  Write(SingleFormat, result, folder);
}

void WriteResultFile(const JointResultFile& result, const std::string& folder)
{
  Write(JointFormat, result, folder);
}

ResultFile ReadResultFile(const std::string& folder)
{
  const std::string path = PathIn(folder);
  const Json json = Parse(path);
  if (IsJoint(json))
  {
    const JointResultFile joint = JointOf(json, path);
    throw InputError(folder + ": expected the result of one mammogram, found one of " +
      std::to_string(joint.Mammograms.size()) +
      (joint.Mammograms.empty() ? std::string()
                                : "; give one of its folders, such as " +
            FolderWithin(folder, joint.Mammograms.front())));
  }
  return SingleOf(json, path, folder);
}

JointResultFile ReadJointResultFile(const std::string& folder)
{
  const std::string path = PathIn(folder);
  const Json json = Parse(path);
  if (!IsJoint(json))
  {
    throw InputError(folder + ": expected the result of several mammograms, found that of one");
  }
  return JointOf(json, path);
}

std::vector<ResultFile> ReadResultFiles(const std::string& folder)
{
  const std::string path = PathIn(folder);
  const Json json = Parse(path);
  std::vector<ResultFile> results;
  if (!IsJoint(json))
  {
    results.push_back(SingleOf(json, path, folder));
    return results;
  }
  for (const JointResultFile::Registered& mammogram : JointOf(json, path).Mammograms)
  {
    results.push_back(ReadResultFile(FolderWithin(folder, mammogram)));
  }
  return results;
}
}
