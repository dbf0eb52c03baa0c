// SPDX-License-Identifier: Apache-2.0
#include "ValidationCases.h"

#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/ValidRange.h"
#include "mammoray/IO/ShippedData.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <utility>

namespace mammoray
{
namespace
{
/// Orientation of the axes of all phantoms here, and the table of their labels.
constexpr const char* PhantomOrientation = "ALS";
constexpr const char* PhantomMaterials = "victre";

RegistrationCase CaseOf(const std::string& labels, const std::string& mammogram)
{
  RegistrationCase input;
  input.Labels.Path = labels;
  input.Materials = PhantomMaterials;
  input.Orientation = PhantomOrientation;
  input.Mammograms = { mammogram };
  return input;
}

/// The unit of the truth, from a configuration of "mammoray evaluate".
LandmarkTruth ReadTruth(const std::string& path)
{
  std::ifstream file(path);
  if (!file)
  {
    throw InputError(path + ": no such file");
  }
  try
  {
    const nlohmann::json json = nlohmann::json::parse(file, JsonNestingLimit{ path });
    const AnatomicalAxes axes =
      AnatomicalAxes::FromCode(json.at("truth-orientation").get<std::string>());
    return { { json.at("truth-origin").get<Vector3>(), axes.Left, axes.Anterior, axes.Superior },
      json.at("truth-source-to-detector").get<double>() };
  }
  catch (const nlohmann::json::exception& error)
  {
    throw InputError(path + ": expected options of 'mammoray evaluate': " + error.what());
  }
}
}

std::vector<Phantom> ValidationPhantoms(const std::string& publicData, double spacingMm)
{
  std::vector<Phantom> phantoms(3);
  phantoms[0].Name = "victre-1";
  phantoms[0].Labels.Path = DataDirectory() + "/victre-phantom-1/labels.nrrd";
  phantoms[1].Name = "scattered-1001";
  phantoms[1].Labels.Path = publicData + "/breastphantom-scattered-1001/labels.nrrd";
  phantoms[2].Name = "hetero-2002";
  phantoms[2].Labels.Path = publicData + "/breastphantom-hetero-2002/labels.nrrd";
  for (Phantom& phantom : phantoms)
  {
    phantom.Labels.SpacingMm = spacingMm;
  }
  return phantoms;
}

std::vector<LandmarkCase> ValidationLandmarks(const std::string& publicData)
{
  const auto caseIn = [](const std::string& name, const std::string& folder, const char* mammogram)
  {
    const std::string path = DataDirectory() + "/" + folder + "/";
    LandmarkCase landmarks;
    landmarks.Name = name;
    landmarks.Case = CaseOf(path + "labels.nrrd", path + mammogram);
    landmarks.Landmarks = path + "landmarks.csv";
    landmarks.Truth = ReadTruth(path + "evaluate.json");
    return landmarks;
  };
  std::vector<LandmarkCase> cases{ caseIn("victre-1, CC, FEBio", "victre-phantom-1",
    "victre1_lcc_processing.dcm") };
  const std::string compressed = publicData + "/victre-pipeline-phantom-1/pc_1_crop.nhdr";
  if (std::filesystem::exists(compressed))
  {
    cases.back().CompressedLabels.Path = compressed;
    cases.back().CompressedLabels.AxesAsGiven = true;
    // Its header repeats the origin of the volume it was cut from.
    cases.back().CompressedOrigin = Vector3{ 8.4, -46.4534, -26.3184 };
  }
  const std::string oblique = "scattered-1001, MLO, CalculiX, ";
  cases.push_back(caseIn(oblique + "true stiffness", "scattered-1001-mlo", "mammogram.dcm"));
  cases.back().Case.Start[StiffnessParameter] = { 2 };
  cases.push_back(caseIn(oblique + "gland half as stiff", "scattered-1001-mlo", "mammogram.dcm"));
  return cases;
}

std::vector<PlannedStudy> ValidationStudies(const std::vector<Phantom>& phantoms,
  const std::string& publicData, int count)
{
  std::vector<PlannedStudy> anatomies;
  for (const Phantom& phantom : phantoms)
  {
    PlannedStudy& study = anatomies.emplace_back();
    study.Phantom = phantom.Name;
    study.Labels = phantom.Labels;
    study.Materials = PhantomMaterials;
    study.Orientation = PhantomOrientation;
  }
  for (const Patient& patient : ValidationPatients(publicData, ""))
  {
    PlannedStudy& study = anatomies.emplace_back();
    study.Phantom = patient.Name;
    study.Mri = patient.Mri;
    study.Options.ChestAroundMm = 35;
    study.Options.LeastForceN = 49;
  }
  std::vector<PlannedStudy> studies;
  for (int number = 0; number < count && !anatomies.empty(); ++number)
  {
    PlannedStudy& study = studies.emplace_back(anatomies[number % anatomies.size()]);
    study.Options.Seed = static_cast<std::uint32_t>(number + 1);
    study.Options.Laterality = number % 2 == 0 ? 'L' : 'R';
  }
  return studies;
}

std::vector<Patient> ValidationPatients(const std::string& publicData, const std::string& drawn)
{
  namespace fs = std::filesystem;
  std::vector<Patient> patients;
  const auto add = [&](const std::string& name, const fs::path& series)
  {
    if (fs::is_directory(series))
    {
      patients.push_back({ name, series.string(), drawn + "/" + name + ".json" });
    }
  };
  std::error_code none;
  for (const fs::directory_entry& folder :
    fs::directory_iterator(publicData + "/uta11-breast-mri-CC-BY-SA-4.0", none))
  {
    add("uta11-" + folder.path().filename().string(), folder.path() / "t1-fat-suppressed");
  }
  std::sort(patients.begin(), patients.end(),
    [](const Patient& a, const Patient& b) { return a.Name < b.Name; });
  add("duke-153", fs::path(publicData) / "duke-breast-mri-153-CC-BY-NC-4.0" / "t1_tse");
  return patients;
}

std::vector<MammogramCase> ValidationMammograms(const std::vector<Phantom>& phantoms,
  const std::string& publicData)
{
  std::vector<MammogramCase> mammograms;
  const auto add = [&](const std::string& name, RegistrationCase input)
  {
    for (const Phantom& phantom : phantoms)
    {
      input.Labels = phantom.Labels;
      input.Labels.AcceptUnusual = true; // pixels of 1 mm
      mammograms.push_back({ name + ", " + phantom.Name, input });
    }
  };
  for (const char* name : { "mg_processing_mono1_explicitLE", "mg_presentation_mono2_explicitLE" })
  {
    add(name, CaseOf("", publicData + "/digibreast/dicom/" + name + ".dcm"));
  }
  // Views and sides by the markers in the pictures. Pixels are assumed: 0.07 mm as of the detector
  // whose matrix the larger pictures have, and the same field in the pictures of tomosynthesis.
  struct Picture
  {
    const char* Name;
    const char* Side;
    const char* View;
    double SpacingMm;
  };
  constexpr double Field = 3328 * 0.07;
  for (const Picture& picture : { Picture{ "sample_A1", "R", "CC", Field / 1996 },
         { "sample_A2", "L", "CC", Field / 1996 }, { "sample_A4", "L", "CC", 0.07 },
         { "sample_B1", "R", "MLO", 0.07 }, { "sample_C4", "L", "MLO", 0.07 } })
  {
    RegistrationCase input = CaseOf("", publicData + "/monai-mammograms/" + picture.Name + ".jpg");
    input.Laterality = picture.Side;
    input.MammogramViews = { picture.View };
    input.PixelSpacingMm = picture.SpacingMm;
    add(picture.Name, input);
  }
  return mammograms;
}
}
