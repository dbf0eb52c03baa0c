// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Study/StudyAnswers.h"

#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/PoseParameters.h"
#include "mammoray/Foundation/ValidRange.h"
#include "mammoray/IO/AtomicFile.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <fstream>

namespace mammoray
{
namespace
{
using Json = nlohmann::ordered_json;

constexpr int TruthVersion = 1;

/// Tells `field` the path and value of each field of a view, for the reader and the writer.
template <typename Field, typename View>
void ListTruthOfView(const Field& field, View& view)
{
  field("/view", view.View);
  field("/file", view.File);
  for (const PoseParameter& parameter : PoseParameters)
  {
    if (parameter.Index != StiffnessParameter) // the factors of the materials are in the study
    {
      field(std::string("/pose/") + parameter.Name + '_' + parameter.Unit,
        view.Pose.*parameter.Value);
    }
  }
  field("/source_to_detector_mm", view.Unit.SourceToDetectorMm);
  field("/support_height_mm", view.Unit.SupportHeightMm);
  field("/header_thickness_mm", view.HeaderThicknessMm);
  field("/paddle_force_n", view.PaddleForceN);
  field("/points_gantry_mm", view.Gantry);
  field("/points_receptor_mm", view.Receptor);
  field("/points_pixel", view.Pixels);
}

template <typename Field, typename Truth>
void ListTruth(const Field& field, Truth& truth)
{
  field("/seed", truth.Seed);
  field("/scanner", truth.Scanner);
  field("/materials", truth.Materials);
  field("/stiffness_factors", truth.StiffnessFactors);
  field("/youngs_moduli_kpa", truth.YoungsModuliKPa);
  field("/mean_hang_mm", truth.MeanHangMm);
  field("/glide_stiffness_kpa_per_mm", truth.GlideStiffness);
  field("/points_mri_lps_mm", truth.MriPoints);
  field("/points_rest_lps_mm", truth.RestPoints);
}

auto Into(Json& json)
{
  return [&json](const std::string& path, const auto& value)
  { json[Json::json_pointer(path)] = value; };
}

auto From(const Json& json)
{
  return [&json](const std::string& path, auto& value)
  { json.at(Json::json_pointer(path)).get_to(value); };
}
}

const TrueView* StudyTruth::FindView(const std::string& view) const
{
  const auto found = std::find_if(this->Views.begin(), this->Views.end(),
    [&](const TrueView& known) { return known.View == view; });
  return found == this->Views.end() ? nullptr : &*found;
}

void WriteStudyTruth(const StudyTruth& truth, const std::string& path)
{
  Json json{ { "truth_version", TruthVersion }, { "laterality", std::string(1, truth.Laterality) },
    { "patient_position", "HFP" } };
  ListTruth(Into(json), truth);
  json["views"] = Json::array();
  for (const TrueView& view : truth.Views)
  {
    ListTruthOfView(Into(json["views"].emplace_back()), view);
  }
  WriteAtomicFile(path, json.dump(1) + '\n');
}

StudyTruth ReadStudyTruth(const std::string& path)
{
  std::ifstream file(path);
  if (!file)
  {
    throw InputError(path + ": expected the truth of a virtual study, found no file");
  }
  StudyTruth truth;
  try
  {
    const Json json = Json::parse(file, JsonNestingLimit{ path });
    if (json.at("truth_version") != TruthVersion)
    {
      throw InputError(path + ": expected version " + std::to_string(TruthVersion) +
        " of a virtual study's truth, found " + json.at("truth_version").dump());
    }
    truth.Laterality = json.at("laterality").get<std::string>() == "R" ? 'R' : 'L';
    ListTruth(From(json), truth);
    for (const Json& view : json.at("views"))
    {
      ListTruthOfView(From(view), truth.Views.emplace_back());
    }
  }
  catch (const Json::exception& error)
  {
    throw InputError(path + ": expected the truth of a virtual study: " + error.what());
  }
  for (const TrueView& view : truth.Views)
  {
    if (view.Gantry.size() != truth.MriPoints.size() ||
      view.Receptor.size() != truth.MriPoints.size() ||
      view.Pixels.size() != truth.MriPoints.size())
    {
      throw InputError(path + ": expected each of " + std::to_string(truth.MriPoints.size()) +
        " points in each view, found " + std::to_string(view.Gantry.size()) + " in " + view.View);
    }
  }
  return truth;
}
}
