// SPDX-License-Identifier: Apache-2.0
#include "mammoray/IO/SceneIO.h"

#include "Private/JsonFile.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/Numbers.h"
#include "mammoray/IO/MeshConversion.h"
#include "mammoray/IO/MeshIO.h"
#include "mammoray/IO/ScatterData.h"
#include "mammoray/IO/ShippedData.h"
#include "mammoray/XRay/Tube.h"

#include "vtkPolyData.h"
#include "vtkUnstructuredGrid.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <limits>
#include <memory>
#include <numbers>
#include <utility>

namespace mammoray
{
namespace
{
/// A unit of length: what it is in mm, above and below a fraction's line so that rounding is right.
struct LengthUnit
{
  const char* Name;
  double Mm;
  double PerMm;

  double ToMm(double value) const { return value * this->Mm / this->PerMm; }
};
constexpr LengthUnit LengthUnits[] = { { "um", 1, 1000 }, { "mm", 1, 1 }, { "cm", 10, 1 },
  { "m", 1000, 1 } };
constexpr LengthUnit Millimetre = LengthUnits[1];

/// Splits "ATTENUATION[@DENSITY]" and takes the density, where there is none, from the
/// attenuation's table. Throws InputError.
void SetAttenuation(const std::string& text, const std::string& where, Material& material)
{
  const std::size_t at = std::min(text.rfind('@'), text.size());
  material.Attenuation = text.substr(0, at);
  AttenuationTable attenuation;
  try
  {
    attenuation = FindAttenuationTable(material.Attenuation);
  }
  catch (const InputError& error)
  {
    throw InputError(where + ": " + error.what());
  }
  material.DensityGPerCm3 = attenuation.NominalDensityGPerCm3;
  if (at < text.size() &&
    !(ToNumber(text.substr(at + 1), material.DensityGPerCm3) && material.DensityGPerCm3 > 0 &&
      std::isfinite(material.DensityGPerCm3)))
  {
    throw InputError(
      where + ": expected MATERIAL[@DENSITY] with a density in g/cm3, found '" + text + "'");
  }
}

/// A material of the table, by its name, or a new one of that composition.
int MaterialFor(const SurfaceSample& sample, MaterialTable& table)
{
  const auto known = std::find_if(table.Materials.begin(), table.Materials.end(),
    [&](const Material& material) { return material.Name == sample.Material; });
  if (known != table.Materials.end())
  {
    if (known == table.Materials.begin())
    {
      throw InputError(sample.Name + ": expected a material, found air");
    }
    return static_cast<int>(known - table.Materials.begin());
  }
  Material material;
  material.Name = sample.Material;
  SetAttenuation(sample.Material, sample.Name, material);
  table.Materials.push_back(material);
  return static_cast<int>(table.Materials.size()) - 1;
}

/// From the file's unit to mm. Throws InputError where the surface then reaches too far.
void Scale(const SurfaceSample& sample, SurfaceMesh& part)
{
  const double scale = sample.UnitMm ? *sample.UnitMm / NativeUnitMm(sample.File) : 1;
  for (double& coordinate : part.Points)
  {
    coordinate *= scale;
    if (!(std::abs(coordinate) <= SceneLimits::LengthMm))
    {
      throw InputError(sample.Name + ": expected a surface within " +
        NumberText(SceneLimits::LengthMm) + " mm of the origin, found a coordinate of " +
        NumberText(coordinate) + " mm; is the file's unit right?");
    }
  }
}

/// Adds the sample, and its material where the table has none of it.
void AddSample(const SurfaceSample& sample, Scene& scene)
{
  SceneSample placed;
  placed.Material = MaterialFor(sample, scene.Materials);
  auto part = std::make_shared<SurfaceMesh>(ReadSurface(sample.File));
  const auto several = [](const std::vector<std::uint16_t>& sides)
  { return std::any_of(sides.begin(), sides.end(), [](std::uint16_t side) { return side > 1; }); };
  if (several(part->BackMaterials) || several(part->FrontMaterials))
  {
    throw InputError(sample.Name +
        ": expected a surface of one material, found several, as of a mesh with a table",
      { "File", sample.File, { "Mesh" } });
  }
  Scale(sample, *part);
  placed.Surface = std::move(part);
  placed.Rotation =
    (sample.RotationDeg * std::numbers::pi / 180 / Norm(sample.RotationAxis)) * sample.RotationAxis;
  placed.TranslationMm = sample.TranslationMm;
  scene.Samples.push_back(std::move(placed));
}

/// The interfaces of a mesh's file, whose materials are those of the scene's table.
void AddMesh(const std::string& path, Scene& scene)
{
  std::vector<std::string> names;
  auto surface = std::make_shared<SurfaceMesh>(std::filesystem::path(path).extension() == ".vtu"
      ? ExtractInterfaces(FromGrid(ReadMesh(path), &names))
      : ReadSurface(path, &names));
  scene.Materials.CheckMesh(*surface, names, path);
  scene.Samples.push_back({ std::move(surface) });
}

MaterialTable MaterialsOf(const SceneDescription& description)
{
  MaterialTable table =
    description.Materials.empty() ? MaterialTable() : FindMaterialTable(description.Materials);
  const auto named = [&table](const std::string& name) -> Material&
  { return table.Materials[static_cast<std::size_t>(table.IndexOf(name))]; };
  for (const auto& [name, text] : description.Attenuations)
  {
    Material& material = named(name);
    const double density = material.DensityGPerCm3;
    SetAttenuation(text, "attenuation of " + name, material);
    if (text.find('@') == std::string::npos)
    {
      material.DensityGPerCm3 = density;
    }
  }
  for (const auto& [name, iodine] : description.IodineMgPerMl)
  {
    named(name).IodineMgPerMl = iodine;
  }
  if (table.Materials.empty())
  {
    table.Name = "surfaces";
    table.Materials.push_back({ .Name = "air" });
  }
  return table;
}

/// Reads a scene's file over a description.
class SceneReader
{
public:
  SceneReader(const std::string& path, SceneDescription& description)
    : Path(path)
    , Into(description)
    , File(ParseJsonFile(path, "a scene"))
    , Root(JsonObject::Root(this->File, path,
        { "description", "unit", "mesh", "source", "detector", "beam", "materials", "attenuations",
          "iodine", "samples", "overlap-priority", "scatter", "refraction", "dose" }))
  {
    if (this->Root.Find("description"))
    {
      this->Root.Text("description");
    }
    this->Unit = this->UnitOf(this->Root, "unit").value_or(Millimetre);
  }

  void Read() const
  {
    AddKeys(this->File, "");
    const std::pair<const char*, void (SceneReader::*)(const nlohmann::json&) const> parts[] = {
      { "source", &SceneReader::ReadSource }, { "detector", &SceneReader::ReadDetector },
      { "beam", &SceneReader::ReadBeam }, { "samples", &SceneReader::ReadSamples },
      { "scatter", &SceneReader::ReadScatter }, { "refraction", &SceneReader::ReadRefraction },
      { "attenuations", &SceneReader::ReadAttenuations }, { "iodine", &SceneReader::ReadIodine }
    };
    for (const auto& [key, read] : parts)
    {
      if (const nlohmann::json* value = this->Root.Find(key))
      {
        (this->*read)(*value);
      }
    }
    if (this->Root.Find("mesh"))
    {
      this->Into.Mesh = this->Beside(this->Root.Text("mesh"));
    }
    if (this->Root.Find("materials"))
    {
      this->Into.Materials = this->BesideOrAsGiven(this->Root.Text("materials"));
    }
    if (this->Root.Find("overlap-priority"))
    {
      this->Into.OverlapPriority = this->Root.Texts("overlap-priority");
    }
    Flag(this->Root, "dose", this->Into.Fixed.Dose);
  }

private:
  /// "detector" and "detector.photons", but not the entries of lists and of objects within.
  void AddKeys(const nlohmann::json& object, const std::string& prefix) const
  {
    for (const auto& [key, value] : object.items())
    {
      this->Into.Keys.push_back(prefix + key);
      if (prefix.empty() && value.is_object())
      {
        this->AddKeys(value, key + ".");
      }
    }
  }

  static void Flag(const JsonObject& entry, const char* key, bool& value)
  {
    if (const nlohmann::json* found = entry.Find(key))
    {
      if (!found->is_boolean())
      {
        entry.Refuse(key, "true or false");
      }
      value = found->get<bool>();
    }
  }

  static void Between(const JsonObject& entry, const char* key, double least, double most,
    double& value)
  {
    entry.Number(
      key, "a number from " + NumberText(least) + " to " + NumberText(most),
      [=](double number) { return number >= least && number <= most; }, value);
  }

  /// One of the words; the first where the key is absent.
  static std::string Word(const JsonObject& entry, const char* key,
    std::initializer_list<const char*> words)
  {
    if (!entry.Find(key))
    {
      return *words.begin();
    }
    std::string found = entry.Text(key);
    if (std::find(words.begin(), words.end(), found) == words.end())
    {
      std::string expected;
      for (const char* word : words)
      {
        expected += (expected.empty() ? "one of \"" : ", \"") + std::string(word) + "\"";
      }
      entry.Refuse(key, expected);
    }
    return found;
  }

  static std::optional<LengthUnit> UnitOf(const JsonObject& entry, const char* key)
  {
    if (!entry.Find(key))
    {
      return {};
    }
    const nlohmann::json& named = *entry.Find(key);
    const auto found = std::find_if(std::begin(LengthUnits), std::end(LengthUnits),
      [&](const LengthUnit& unit) { return named == unit.Name; });
    if (found == std::end(LengthUnits))
    {
      entry.Refuse(key, "one of \"um\", \"mm\", \"cm\", \"m\"");
    }
    return *found;
  }

  /// `Count` numbers, each taken by `accept`.
  template <std::size_t Count, typename Accept>
  static std::array<double, Count> Numbers(const JsonObject& entry, const char* key,
    const std::string& expected, const Accept& accept)
  {
    const nlohmann::json& found = entry.Require(key, expected);
    std::array<double, Count> numbers{};
    bool usable = found.is_array() && found.size() == Count;
    for (std::size_t index = 0; usable && index < Count; ++index)
    {
      usable = found[index].is_number() && accept(found[index].template get<double>());
      numbers[index] = usable ? found[index].template get<double>() : 0;
    }
    if (!usable)
    {
      entry.Refuse(key, expected);
    }
    return numbers;
  }

  std::string InUnit(double mm) const
  {
    return NumberText(mm / this->Unit.ToMm(1)) + " " + this->Unit.Name;
  }

  Vector3 Position(const JsonObject& entry, const char* key) const
  {
    Vector3 place = Numbers<3>(entry, key,
      "three numbers within " + this->InUnit(SceneLimits::LengthMm) + " of 0",
      [this](double value) { return std::abs(this->Unit.ToMm(value)) <= SceneLimits::LengthMm; });
    for (double& coordinate : place)
    {
      coordinate = this->Unit.ToMm(coordinate);
    }
    return place;
  }

  static Vector3 Direction(const JsonObject& entry, const char* key)
  {
    const char* const expected = "three numbers from -1e6 to 1e6 that are not all 0";
    const Vector3 direction =
      Numbers<3>(entry, key, expected, [](double value) { return std::abs(value) <= 1e6; });
    if (!(Norm(direction) > 1e-12))
    {
      entry.Refuse(key, expected);
    }
    return direction;
  }

  void ReadSource(const nlohmann::json& value) const
  {
    const JsonObject entry(value, this->Root.PlaceOf("source"),
      { "position", "beam-direction", "focal-spot", "focal-spot-samples", "heel",
        "inverse-square" });
    XRaySource& source = this->Into.Fixed.Source;
    ExposureOptions& detection = this->Into.Fixed.Detection;
    if (!entry.Find("position") == !entry.Find("beam-direction"))
    {
      throw InputError(this->Root.PlaceOf("source") +
        ": expected either position or beam-direction, found " +
        (entry.Find("position") ? "both" : "neither"));
    }
    if (entry.Find("position"))
    {
      source.Type = XRaySource::Kind::Point;
      source.Position = this->Position(entry, "position");
    }
    else
    {
      source.Type = XRaySource::Kind::Parallel;
      source.Direction = Direction(entry, "beam-direction");
    }
    if (entry.Find("focal-spot"))
    {
      const auto edges =
        Numbers<2>(entry, "focal-spot", "two numbers from 0 to " + this->InUnit(100),
          [this](double edge) { return edge >= 0 && this->Unit.ToMm(edge) <= 100; });
      detection.FocalSpotColumnMm = this->Unit.ToMm(edges[0]);
      detection.FocalSpotRowMm = this->Unit.ToMm(edges[1]);
    }
    if (entry.Find("focal-spot-samples"))
    {
      detection.FocalSpotSamples = entry.WholeNumber("focal-spot-samples", 1, 32);
    }
    Flag(entry, "inverse-square", this->Into.Fixed.Field.InverseSquare);
    if (const nlohmann::json* heel = entry.Find("heel"))
    {
      const JsonObject of(*heel, entry.PlaceOf("heel"), { "angle", "depth-um" });
      HeelEffect& effect = this->Into.Fixed.Field.Heel;
      of.Require("angle", "a number of degrees");
      Between(of, "angle", 0.1, 89.9, effect.TargetAngleDeg);
      double micrometres = 0.5;
      Between(of, "depth-um", 0, 1000, micrometres);
      effect.DepthMm = 1e-3 * micrometres;
    }
  }

  void ReadDetector(const nlohmann::json& value) const
  {
    const JsonObject entry(value, this->Root.PlaceOf("detector"),
      { "origin", "column-direction", "row-direction", "columns", "rows", "pixel-spacing",
        "samples", "response", "scintillator", "response-table", "photons", "electronic-noise",
        "half-modulation", "seed" });
    XRayDetector& detector = this->Into.Fixed.Detector;
    detector.Origin = this->Position(entry, "origin");
    const Vector3 column = Direction(entry, "column-direction");
    const Vector3 row = Direction(entry, "row-direction");
    detector.Columns = entry.WholeNumber("columns", 1, 65535);
    detector.Rows = entry.WholeNumber("rows", 1, 65535);
    const std::string expected = "a number from " + this->InUnit(SceneLimits::LeastPixelMm) +
      " to " + this->InUnit(SceneLimits::MostPixelMm);
    entry.Require("pixel-spacing", expected);
    double pixel = 0;
    entry.Number(
      "pixel-spacing", expected,
      [this](double spacing)
      {
        return this->Unit.ToMm(spacing) >= SceneLimits::LeastPixelMm &&
          this->Unit.ToMm(spacing) <= SceneLimits::MostPixelMm;
      },
      pixel);
    pixel = this->Unit.ToMm(pixel);
    detector.ColumnStep = pixel * ((1 / Norm(column)) * column);
    detector.RowStep = pixel * ((1 / Norm(row)) * row);
    if (entry.Find("samples"))
    {
      detector.Samples = entry.WholeNumber("samples", 1, 16);
    }
    this->ReadDetection(entry);
  }

  /// Response, noise and blur.
  void ReadDetection(const JsonObject& entry) const
  {
    SceneResponse& response = this->Into.Response;
    if (entry.Find("response"))
    {
      response.ByEnergy = Word(entry, "response", { "energy", "counting" }) == "energy";
    }
    if (entry.Find("scintillator"))
    {
      response.Scintillator = entry.Text("scintillator");
    }
    if (entry.Find("response-table"))
    {
      response.Table = this->Beside(entry.Text("response-table"));
    }
    ExposureOptions& detection = this->Into.Fixed.Detection;
    Between(entry, "photons", 0, 1e12, detection.PhotonsPerPixel);
    Between(entry, "electronic-noise", 0, 1e6, detection.ElectronicNoisePhotons);
    Between(entry, "half-modulation", 0, 1000, detection.HalfModulationPerMm);
    if (entry.Find("seed"))
    {
      detection.Seed =
        static_cast<std::uint64_t>(entry.WholeNumber("seed", 0, std::numeric_limits<int>::max()));
    }
  }

  void ReadBeam(const nlohmann::json& value) const
  {
    const JsonObject entry(value, this->Root.PlaceOf("beam"),
      { "kev", "spectrum", "tube", "kvp", "filter" });
    const int ways =
      (entry.Find("kev") ? 1 : 0) + (entry.Find("spectrum") ? 1 : 0) + (entry.Find("tube") ? 1 : 0);
    if (ways != 1 || !entry.Find("tube") != !entry.Find("kvp"))
    {
      throw InputError(this->Root.PlaceOf("beam") +
        ": expected one of kev, spectrum, and tube with kvp, found " +
        (ways > 1 ? "several" : "another"));
    }
    SceneBeam& beam = this->Into.Beam;
    beam.EnergyKeV.reset();
    beam.Anode.clear();
    if (entry.Find("kev"))
    {
      double energy = 0;
      entry.Number(
        "kev", "a number from 1 to 500",
        [](double kev)
        { return kev >= SceneLimits::LeastEnergyKeV && kev <= SceneLimits::MostEnergyKeV; },
        energy);
      beam.EnergyKeV = energy;
    }
    else if (entry.Find("spectrum"))
    {
      beam.Spectrum = this->BesideOrAsGiven(entry.Text("spectrum"));
    }
    else
    {
      beam.Anode = entry.Text("tube");
      if (beam.Anode != "W" && beam.Anode != "Mo" && beam.Anode != "Rh")
      {
        entry.Refuse("tube", "one of \"W\", \"Mo\", \"Rh\"");
      }
      double voltage = 0;
      entry.Number(
        "kvp", "a number from 18 to 42", [](double kv) { return kv >= 18 && kv <= 42; }, voltage);
      beam.KilovoltagePeak = voltage;
    }
    if (entry.Find("filter"))
    {
      beam.Filters = entry.Texts("filter");
    }
  }

  void ReadScatter(const nlohmann::json& value) const
  {
    const JsonObject entry(value, this->Root.PlaceOf("scatter"),
      { "method", "air-gap", "grid", "photons", "voxel" });
    SceneScatter& scatter = this->Into.Fixed.Scatter;
    if (entry.Find("method"))
    {
      scatter.Method = Word(entry, "method", { "kernels", "monte-carlo" }) == "kernels"
        ? SceneScatter::Model::Kernels
        : SceneScatter::Model::MonteCarlo;
    }
    this->Length(entry, "air-gap", 0, 200, scatter.AirGapMm);
    this->Length(entry, "voxel", 0.05, 10, this->Into.VoxelMm);
    Between(entry, "photons", 1, 1e12, scatter.Photons);
    if (const nlohmann::json* grid = entry.Find("grid"))
    {
      const JsonObject of(*grid, entry.PlaceOf("grid"),
        { "ratio", "lines-per-cm", "septum-um", "interspace" });
      std::array<double, 3> numbers{ 5, 31, 65 };
      Between(of, "ratio", 1, 30, numbers[0]);
      Between(of, "lines-per-cm", 5, 200, numbers[1]);
      Between(of, "septum-um", 0.1, 2000, numbers[2]);
      scatter.Grid = AntiscatterGridOptions::OfLead(numbers,
        Word(of, "interspace", { "fibre", "air", "aluminium" }));
    }
  }

  void ReadRefraction(const nlohmann::json& value) const
  {
    const JsonObject entry(value, this->Root.PlaceOf("refraction"), { "law", "distance" });
    RefractionOptions& refraction = this->Into.Fixed.Refraction.emplace();
    refraction.Method = Word(entry, "law", { "geometric", "near-field" }) == "geometric"
      ? RefractionOptions::Law::Geometric
      : RefractionOptions::Law::NearField;
    if (entry.Find("distance"))
    {
      double distance = 0;
      this->Length(entry, "distance", 0, SceneLimits::LengthMm, distance);
      this->Into.BendDistanceMm = distance;
    }
  }

  void ReadAttenuations(const nlohmann::json& value) const
  {
    this->RequireObject(value, "attenuations");
    for (const auto& [name, text] : value.items())
    {
      if (!text.is_string() || text.get<std::string>().empty())
      {
        throw InputError(this->Root.PlaceOf("attenuations") + "." + name +
          ": expected a text that is not empty, found " + text.dump());
      }
      this->Into.Attenuations[name] = text.get<std::string>();
    }
  }

  void ReadIodine(const nlohmann::json& value) const
  {
    this->RequireObject(value, "iodine");
    for (const auto& [name, number] : value.items())
    {
      if (!number.is_number() || !(number.get<double>() >= 0 && number.get<double>() <= 500))
      {
        throw InputError(this->Root.PlaceOf("iodine") + "." + name +
          ": expected a number from 0 to 500, found " + number.dump());
      }
      this->Into.IodineMgPerMl[name] = number.get<double>();
    }
  }

  void RequireObject(const nlohmann::json& value, const char* key) const
  {
    if (!value.is_object())
    {
      this->Root.Refuse(key, "an object by names of materials");
    }
  }

  void ReadSamples(const nlohmann::json& value) const
  {
    if (!value.is_array() || value.empty())
    {
      this->Root.Refuse("samples", "a list of at least one sample");
    }
    this->Into.Samples.clear();
    for (std::size_t index = 0; index < value.size(); ++index)
    {
      this->Into.Samples.push_back(this->Sample(value[index],
        this->Root.PlaceOf("samples") + "[" + std::to_string(index) + "]"));
    }
  }

  /// A length between limits in mm.
  void Length(const JsonObject& entry, const char* key, double least, double most, double& mm) const
  {
    double own = 0;
    if (entry.Find(key))
    {
      entry.Number(
        key, "a number from " + this->InUnit(least) + " to " + this->InUnit(most),
        [&](double length)
        { return this->Unit.ToMm(length) >= least && this->Unit.ToMm(length) <= most; },
        own);
      mm = this->Unit.ToMm(own);
    }
  }

  SurfaceSample Sample(const nlohmann::json& value, const std::string& place) const
  {
    const JsonObject entry(value, place, { "file", "material", "unit", "rotation", "translation" });
    SurfaceSample sample;
    sample.Name = place;
    sample.File = this->Beside(entry.Text("file"));
    sample.Material = entry.Text("material");
    if (const auto unit = UnitOf(entry, "unit"))
    {
      sample.UnitMm = unit->ToMm(1);
    }
    if (const nlohmann::json* rotation = entry.Find("rotation"))
    {
      const JsonObject turn(*rotation, entry.PlaceOf("rotation"), { "axis", "angle" });
      const char* const expected = "a number of degrees from -3600 to 3600";
      sample.RotationAxis = Direction(turn, "axis");
      turn.Require("angle", expected);
      turn.Number(
        "angle", expected,
        [](double degrees) { return std::abs(degrees) <= SceneLimits::MostAngleDeg; },
        sample.RotationDeg);
    }
    if (entry.Find("translation"))
    {
      sample.TranslationMm = this->Position(entry, "translation");
    }
    return sample;
  }

  std::string Beside(const std::string& path) const
  {
    return (std::filesystem::path(this->Path).parent_path() / path).string();
  }
  /// What may also be the name of something shipped.
  std::string BesideOrAsGiven(const std::string& name) const
  {
    std::error_code none;
    return std::filesystem::exists(this->Beside(name), none) ? this->Beside(name) : name;
  }

  std::string Path;
  SceneDescription& Into;
  nlohmann::json File;
  JsonObject Root;
  LengthUnit Unit = Millimetre;
};
}

bool SceneDescription::Has(const std::string& key) const
{
  return std::find(this->Keys.begin(), this->Keys.end(), key) != this->Keys.end();
}

SceneDescription ReadScene(const std::string& path, SceneDescription description)
{
  SceneReader(path, description).Read();
  return description;
}

Spectrum FindSpectrum(const SceneBeam& beam)
{
  std::vector<XRayFilter> filters;
  for (const std::string& text : beam.Filters)
  {
    filters.push_back(XRayFilter::FromText(text));
  }
  if (!beam.Anode.empty() && !beam.EnergyKeV)
  {
    return TubeSpectrum(
      { .Anode = beam.Anode, .KilovoltagePeak = beam.KilovoltagePeak, .Filters = filters });
  }
  Spectrum spectrum =
    beam.EnergyKeV ? Spectrum::Monochromatic(*beam.EnergyKeV) : FindSpectrum(beam.Spectrum);
  for (const XRayFilter& filter : filters)
  {
    spectrum = FilterSpectrum(spectrum, filter);
  }
  return spectrum;
}

DetectorResponse FindResponse(const SceneResponse& description)
{
  if (!description.Table.empty())
  {
    if (!description.Scintillator.empty())
    {
      throw InputError("response: expected a table or a scintillator, found both");
    }
    return ReadDetectorResponse(description.Table);
  }
  DetectorResponse response;
  if (!description.Scintillator.empty())
  {
    response = AbsorbingDetector(XRayFilter::FromText(description.Scintillator));
  }
  response.ByEnergy = description.ByEnergy;
  return response;
}

Scene LoadScene(const SceneDescription& description)
{
  Scene scene = description.Fixed;
  scene.Materials = MaterialsOf(description);
  scene.XRays = FindSpectrum(description.Beam);
  scene.Response = FindResponse(description.Response);
  if (!description.Mesh.empty())
  {
    AddMesh(description.Mesh, scene);
  }
  for (const SurfaceSample& sample : description.Samples)
  {
    AddSample(sample, scene);
  }
  scene.Attenuations = FindAttenuations(scene.Materials);
  if (!description.Beam.Anode.empty())
  {
    scene.Field.Heel.Target = description.Beam.Anode;
  }
  for (const std::string& name : description.OverlapPriority)
  {
    scene.OverlapPriority.push_back(scene.Materials.IndexOf(name));
  }
  if (scene.Scatter.Method == SceneScatter::Model::Kernels)
  {
    scene.Scatter.Kernels = std::make_shared<const ScatterKernels>(FindScatterKernels());
  }
  if (scene.Refraction && description.BendDistanceMm)
  {
    scene.Refraction->DistanceMm = *description.BendDistanceMm;
  }
  return scene;
}
}
