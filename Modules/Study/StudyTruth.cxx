// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Study/StudyTruth.h"

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

Json ViewJson(const TrueView& view)
{
  return { { "view", view.View }, { "file", view.File },
    { "pose",
      { { "thickness_mm", view.Pose.ThicknessMm }, { "roll_deg", view.Pose.RollDeg },
        { "pitch_deg", view.Pose.PitchDeg }, { "yaw_deg", view.Pose.YawDeg },
        { "lateral_mm", view.Pose.LateralMm }, { "anterior_mm", view.Pose.AnteriorMm },
        { "vertical_mm", view.Pose.VerticalMm }, { "tilt_deg", view.Pose.TiltDeg } } },
    { "source_to_detector_mm", view.Unit.SourceToDetectorMm },
    { "support_height_mm", view.Unit.SupportHeightMm },
    { "header_thickness_mm", view.HeaderThicknessMm }, { "paddle_force_n", view.PaddleForceN },
    { "points_gantry_mm", view.Gantry }, { "points_receptor_mm", view.Receptor },
    { "points_pixel", view.Pixels } };
}

TrueView ViewOf(const Json& json)
{
  TrueView view;
  view.View = json.at("view");
  view.File = json.at("file");
  const Json& pose = json.at("pose");
  view.Pose.ThicknessMm = pose.at("thickness_mm");
  view.Pose.RollDeg = pose.at("roll_deg");
  view.Pose.PitchDeg = pose.at("pitch_deg");
  view.Pose.YawDeg = pose.at("yaw_deg");
  view.Pose.LateralMm = pose.at("lateral_mm");
  view.Pose.AnteriorMm = pose.at("anterior_mm");
  view.Pose.VerticalMm = pose.at("vertical_mm");
  view.Pose.TiltDeg = pose.at("tilt_deg");
  view.Unit.SourceToDetectorMm = json.at("source_to_detector_mm");
  view.Unit.SupportHeightMm = json.at("support_height_mm");
  view.HeaderThicknessMm = json.at("header_thickness_mm");
  view.PaddleForceN = json.at("paddle_force_n");
  view.Gantry = json.at("points_gantry_mm").get<std::vector<Vector3>>();
  view.Receptor = json.at("points_receptor_mm").get<std::vector<std::array<double, 2>>>();
  view.Pixels = json.at("points_pixel").get<std::vector<std::array<double, 2>>>();
  return view;
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
    { "seed", truth.Seed }, { "scanner", truth.Scanner }, { "patient_position", "HFP" },
    { "materials", truth.Materials }, { "stiffness_factors", truth.StiffnessFactors },
    { "youngs_moduli_kpa", truth.YoungsModuliKPa }, { "mean_hang_mm", truth.MeanHangMm },
    { "glide_stiffness_kpa_per_mm", truth.GlideStiffness },
    { "points_mri_lps_mm", truth.MriPoints }, { "points_rest_lps_mm", truth.RestPoints },
    { "views", Json::array() } };
  for (const TrueView& view : truth.Views)
  {
    json["views"].push_back(ViewJson(view));
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
    truth.Seed = json.at("seed");
    truth.Scanner = json.at("scanner");
    truth.Materials = json.at("materials").get<std::vector<std::string>>();
    truth.StiffnessFactors = json.at("stiffness_factors").get<std::vector<double>>();
    truth.YoungsModuliKPa = json.at("youngs_moduli_kpa").get<std::vector<double>>();
    truth.MeanHangMm = json.at("mean_hang_mm");
    truth.GlideStiffness = json.at("glide_stiffness_kpa_per_mm");
    truth.MriPoints = json.at("points_mri_lps_mm").get<std::vector<Vector3>>();
    truth.RestPoints = json.at("points_rest_lps_mm").get<std::vector<Vector3>>();
    for (const Json& view : json.at("views"))
    {
      truth.Views.push_back(ViewOf(view));
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
