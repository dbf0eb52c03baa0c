// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Study/ResultFile.h"

#include "Private/ResultFields.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/Numbers.h"
#include "mammoray/Foundation/PoseParameters.h"
#include "mammoray/Foundation/ValidRange.h"
#include "mammoray/IO/AtomicFile.h"

#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>

namespace mammoray
{
namespace
{
constexpr const char* SingleFormat = "mammoray-registration-result";
constexpr const char* JointFormat = "mammoray-joint-registration-result";

/// A value of a file, short enough for a line; "none" if there is none.
std::string Shown(const Json* json)
{
  if (!json)
  {
    return "none";
  }
  constexpr std::size_t Longest = 60;
  const std::string text = json->dump(-1, ' ', true, Json::error_handler_t::replace);
  return text.size() > Longest ? text.substr(0, Longest) + "..." : text;
}

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
  WriteAtomicFile(PathIn(folder), json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
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
    json = Json::parse(file, JsonNestingLimit{ path });
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
  for (std::size_t place = 0; place < covariance.size(); place += unknowns + 1)
  {
    if (!(covariance[place] >= 0))
    {
      reader.Refuse(name, "variances of at least 0", NumberText(covariance[place]));
    }
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

/// Whether these are directions of a frame, as exact as they are written.
bool AreAxes(const std::array<Vector3, 3>& axes)
{
  constexpr double rounding = 1e-6;
  for (int a = 0; a < 3; ++a)
  {
    for (int b = a; b < 3; ++b)
    {
      if (!(std::abs(Dot(axes[a], axes[b]) - (a == b ? 1 : 0)) <= rounding))
      {
        return false;
      }
    }
  }
  return true;
}

/// Refuses numbers that no registration writes, with which places would be found all the same.
void CheckGeometry(const FieldReader& reader, const ResultFile& result)
{
  constexpr int mostPixels = 65535; // of a DICOM picture
  constexpr double farthestMm = 1e5;
  const auto number = [&](const char* field, double value, double least, double most)
  {
    if (!(value >= least && value <= most))
    {
      reader.Refuse(field, NumberText(least) + " to " + NumberText(most), NumberText(value));
    }
  };
  number("grid.columns", result.Grid.Columns, 1, mostPixels);
  number("grid.rows", result.Grid.Rows, 1, mostPixels);
  const auto& [cx, cy] = result.Grid.ColumnStep;
  const auto& [rx, ry] = result.Grid.RowStep;
  const double column = std::hypot(cx, cy);
  const double row = std::hypot(rx, ry);
  constexpr double shortestMm = 1e-3;
  number("grid.columnStepMm", column, shortestMm, farthestMm);
  number("grid.rowStepMm", row, shortestMm, farthestMm);
  if (!(std::abs(cx * rx + cy * ry) <= 1e-6 * column * row))
  {
    reader.Refuse("grid.rowStepMm", "a step at a right angle to columnStepMm",
      NumberText(rx) + ", " + NumberText(ry));
  }
  const VolumeFromGantry& placed = result.Placed;
  if (!AreAxes({ placed.X, placed.Y, placed.Z }))
  {
    reader.Refuse("placement", "unit vectors at right angles to each other", "others");
  }
  if (!AreAxes({ result.Axes.Left, result.Axes.Anterior, result.Axes.Superior }))
  {
    reader.Refuse("axes", "unit vectors at right angles to each other", "others");
  }
  number("placement.originMm", Norm(placed.Origin), 0, farthestMm);
  number("anchorMm", Norm(result.Anchor), 0, farthestMm);
  number("unit.sourceToDetectorMm", result.Unit.SourceToDetectorMm, 1, farthestMm);
  for (const ResultParameter& parameter : result.Parameters)
  {
    number("parameters[].value", parameter.Value, -farthestMm, farthestMm);
  }
  number("parameters[].value of the thickness", result.Pose.ThicknessMm, shortestMm, farthestMm);
}

ResultFile SingleOf(const Json& json, const std::string& path, const std::string& folder)
{
  const FieldReader reader(json, path);
  ResultFile result;
  result.Folder = folder;
  ListFields(reader, result);
  result.Pose = PoseIn(reader, result.Parameters);
  CheckGeometry(reader, result);
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

void FieldReader::Refuse(const std::string& field, const std::string& expected,
  const std::string& found) const
{
  const auto at = this->Object.find(field);
  throw InputError(this->File + ": field '" + this->Prefix + field + "': expected " + expected +
    ", found " + (!found.empty() ? found : Shown(at == this->Object.end() ? nullptr : &*at)));
}

void FieldReader::CheckVersion() const
{
  int version = 0;
  (*this)("formatVersion", version);
  if (version != ResultFormatVersion)
  {
    this->Refuse("formatVersion", std::to_string(ResultFormatVersion));
  }
}

void FieldReader::Check(bool fits, const Json* json, const std::string& field,
  const std::string& expected) const
{
  if (!fits)
  {
    throw InputError(
      this->File + ": field '" + field + "': expected " + expected + ", found " + Shown(json));
  }
}

void FieldReader::Read(const Json* json, const std::string& field, std::string& value) const
{
  this->Check(json && json->is_string(), json, field, "a text");
  value = EscapeControls(json->get_ref<const std::string&>());
}

void FieldReader::Read(const Json* json, const std::string& field, Trust& value) const
{
  std::string name;
  this->Read(json, field, name);
  for (const Trust level : { Trust::Good, Trust::Doubtful, Trust::None })
  {
    if (name == NameOf(level))
    {
      value = level;
      return;
    }
  }
  this->Check(false, json, field, "good, doubtful or none");
}

void FieldReader::Read(const Json* json, const std::string& field, NamedTexts& texts) const
{
  this->Check(json && json->is_object(), json, field, "an object");
  texts.clear();
  for (const auto& [name, text] : json->items())
  {
    this->Read(&text, field + "." + name, texts.emplace_back(name, "").second);
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
