// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Evidence/EvidenceCases.h"

#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/Plausible.h"
#include "mammoray/IO/ShippedData.h"

#include <nlohmann/json.hpp>

#include <filesystem>
#include <fstream>
#include <utility>

namespace mammoray
{
namespace
{
/// Directions of the axes of all phantoms here, and the table of their labels.
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

/// What a configuration of 'mammoray evaluate' says of the unit that the truth was taken in.
LandmarkTruth ReadTruth(const std::string& path)
{
  std::ifstream file(path);
  if (!file)
  {
    throw InputError(path + ": no such file");
  }
  try
  {
    const nlohmann::json json = nlohmann::json::parse(file, PlausibleNesting{ path });
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

std::vector<EvidencePhantom> PhantomsOfEvidence(const std::string& publicData, double spacingMm)
{
  std::vector<EvidencePhantom> phantoms(3);
  phantoms[0].Name = "victre-1";
  phantoms[0].Labels.Path = DataDirectory() + "/victre-phantom-1/labels.nrrd";
  phantoms[1].Name = "scattered-1001";
  phantoms[1].Labels.Path = publicData + "/breastphantom-scattered-1001/labels.nrrd";
  phantoms[2].Name = "hetero-2002";
  phantoms[2].Labels.Path = publicData + "/breastphantom-hetero-2002/labels.nrrd";
  for (EvidencePhantom& phantom : phantoms)
  {
    phantom.Labels.SpacingMm = spacingMm;
  }
  return phantoms;
}

EvidenceLandmarks LandmarksOfEvidence(const std::string& publicData)
{
  const std::string folder = DataDirectory() + "/victre-phantom-1/";
  EvidenceLandmarks landmarks;
  landmarks.Case = CaseOf(folder + "labels.nrrd", folder + "victre1_lcc_processing.dcm");
  landmarks.Landmarks = folder + "landmarks.csv";
  landmarks.Truth = ReadTruth(folder + "evaluate.json");
  const std::string compressed = publicData + "/victre-pipeline-phantom-1/pc_1_crop.nhdr";
  if (std::filesystem::exists(compressed))
  {
    landmarks.CompressedLabels.Path = compressed;
    landmarks.CompressedLabels.AxesAsGiven = true;
    // Its header repeats the origin of the volume it was cut from.
    landmarks.CompressedOrigin = Vector3{ 8.4, -46.4534, -26.3184 };
  }
  return landmarks;
}

std::vector<EvidenceStudy> StudiesOfEvidence(const std::vector<EvidencePhantom>& phantoms,
  const std::string& publicData, int count)
{
  std::vector<EvidenceStudy> anatomies;
  for (const EvidencePhantom& phantom : phantoms)
  {
    EvidenceStudy& study = anatomies.emplace_back();
    study.Phantom = phantom.Name;
    study.Labels = phantom.Labels;
    study.Materials = PhantomMaterials;
    study.Orientation = PhantomOrientation;
  }
  const std::string uta = publicData + "/uta11-breast-mri-CC-BY-SA-4.0";
  for (const auto& [name, folder] :
    { std::pair<std::string, std::string>{ "uta11-a", uta + "/a/t1-tse" },
      { "uta11-b", uta + "/b/t1-fat-suppressed" },
      { "duke-153", publicData + "/duke-breast-mri-153-CC-BY-NC-4.0/t1_tse" } })
  {
    if (std::filesystem::is_directory(folder))
    {
      EvidenceStudy& study = anatomies.emplace_back();
      study.Phantom = name;
      study.Mri = folder;
      study.Options.ChestAroundMm = 35;
      study.Options.LeastForceN = 49;
    }
  }
  std::vector<EvidenceStudy> studies;
  for (int number = 0; number < count && !anatomies.empty(); ++number)
  {
    EvidenceStudy& study = studies.emplace_back(anatomies[number % anatomies.size()]);
    study.Options.Seed = static_cast<std::uint32_t>(number + 1);
    study.Options.Laterality = number % 2 == 0 ? 'L' : 'R';
  }
  return studies;
}

std::vector<EvidenceMammogram> MammogramsOfEvidence(const std::string& publicData)
{
  std::vector<EvidenceMammogram> mammograms;
  for (const char* name : { "mg_processing_mono1_explicitLE", "mg_presentation_mono2_explicitLE" })
  {
    mammograms.push_back({ name,
      CaseOf(publicData + "/breastphantom-scattered-1001/labels.nrrd",
        publicData + "/digibreast/dicom/" + name + ".dcm") });
    mammograms.back().Case.Labels.AcceptUnusual = true; // pixels of 1 mm
  }
  return mammograms;
}
}
