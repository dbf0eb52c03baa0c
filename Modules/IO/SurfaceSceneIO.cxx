// SPDX-License-Identifier: Apache-2.0
#include "mammoray/IO/SurfaceSceneIO.h"

#include "Private/JsonFile.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/Numbers.h"
#include "mammoray/IO/MeshConversion.h"
#include "mammoray/IO/MeshIO.h"
#include "mammoray/IO/ShippedData.h"

#include "vtkPolyData.h"
#include "vtkUnstructuredGrid.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
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

/// A material of the table, by its name, or a new one of that composition.
int MaterialFor(const SurfaceSample& sample, MaterialTable& table)
{
  const std::string& text = sample.Material;
  const auto known = std::find_if(table.Materials.begin(), table.Materials.end(),
    [&](const Material& material) { return material.Name == text; });
  if (known != table.Materials.end())
  {
    if (known == table.Materials.begin())
    {
      throw InputError(sample.Name + ": expected a material, found air");
    }
    return static_cast<int>(known - table.Materials.begin());
  }
  Material material;
  material.Name = text;
  const std::size_t at = std::min(text.rfind('@'), text.size());
  material.Attenuation = text.substr(0, at);
  AttenuationTable attenuation;
  try
  {
    attenuation = FindAttenuationTable(material.Attenuation);
  }
  catch (const InputError& error)
  {
    throw InputError(sample.Name + ": " + error.what());
  }
  material.DensityGPerCm3 = attenuation.NominalDensityGPerCm3;
  if (at < text.size() &&
    !(ToNumber(text.substr(at + 1), material.DensityGPerCm3) && material.DensityGPerCm3 > 0 &&
      std::isfinite(material.DensityGPerCm3)))
  {
    throw InputError(
      sample.Name + ": expected MATERIAL[@DENSITY] with a density in g/cm3, found '" + text + "'");
  }
  table.Materials.push_back(material);
  return static_cast<int>(table.Materials.size()) - 1;
}

/// From the file's frame and unit into the scene's.
void Place(const SurfaceSample& sample, SurfaceMesh& part)
{
  const double scale = sample.UnitMm ? *sample.UnitMm / NativeUnitMm(sample.File) : 1;
  const Vector3 rotation =
    (sample.RotationDeg * std::numbers::pi / 180 / Norm(sample.RotationAxis)) * sample.RotationAxis;
  for (std::size_t index = 0; index < part.Points.size(); index += 3)
  {
    const Vector3 own{ part.Points[index], part.Points[index + 1], part.Points[index + 2] };
    const Vector3 placed = Rotated(scale * own, rotation) + sample.TranslationMm;
    for (std::size_t axis = 0; axis < 3; ++axis)
    {
      if (!(std::abs(placed[axis]) <= SceneLimits::LengthMm))
      {
        throw InputError(sample.Name + ": expected a surface within " +
          NumberText(SceneLimits::LengthMm) + " mm of the origin, found a coordinate of " +
          NumberText(placed[axis]) + " mm; is the file's unit right?");
      }
      part.Points[index + axis] = placed[axis];
    }
  }
}

/// The reader of one scene's file.
class SceneReader
{
public:
  explicit SceneReader(const std::string& path)
    : Path(path)
    , File(ParseJsonFile(path, "a scene"))
    , Root(JsonObject::Root(this->File, path,
        { "description", "unit", "source", "detector", "beam", "materials", "samples",
          "overlap-priority" }))
  {
    if (this->Root.Find("description"))
    {
      this->Root.Text("description");
    }
    this->Unit = this->UnitOf(this->Root, "unit").value_or(Millimetre);
  }

  SceneDescription Read() const
  {
    SceneDescription scene;
    if (const auto* source = this->Root.Find("source"))
    {
      scene.Source = this->Source(*source);
    }
    if (const auto* detector = this->Root.Find("detector"))
    {
      scene.Detector = this->Detector(*detector);
    }
    if (const auto* beam = this->Root.Find("beam"))
    {
      scene.Beam = this->Beam(*beam);
    }
    if (this->Root.Find("materials"))
    {
      scene.Materials = this->BesideOrAsGiven(this->Root.Text("materials"));
    }
    if (const auto* samples = this->Root.Find("samples"))
    {
      if (!samples->is_array() || samples->empty())
      {
        this->Root.Refuse("samples", "a list of at least one sample");
      }
      for (std::size_t index = 0; index < samples->size(); ++index)
      {
        scene.Samples.push_back(this->Sample((*samples)[index],
          this->Root.PlaceOf("samples") + "[" + std::to_string(index) + "]"));
      }
    }
    if (this->Root.Find("overlap-priority"))
    {
      scene.OverlapPriority = this->Root.Texts("overlap-priority");
    }
    return scene;
  }

private:
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

  SceneSource Source(const nlohmann::json& value) const
  {
    const JsonObject entry(value, this->Root.PlaceOf("source"),
      { "position", "beam-direction", "focal-spot" });
    SceneSource source;
    if (!entry.Find("position") == !entry.Find("beam-direction"))
    {
      throw InputError(this->Root.PlaceOf("source") +
        ": expected either position or beam-direction, found " +
        (entry.Find("position") ? "both" : "neither"));
    }
    if (entry.Find("position"))
    {
      source.PositionMm = this->Position(entry, "position");
    }
    else
    {
      source.Direction = Direction(entry, "beam-direction");
    }
    if (entry.Find("focal-spot"))
    {
      source.FocalSpotMm =
        Numbers<2>(entry, "focal-spot", "two numbers from 0 to " + this->InUnit(100),
          [this](double edge) { return edge >= 0 && this->Unit.ToMm(edge) <= 100; });
      for (double& edge : *source.FocalSpotMm)
      {
        edge = this->Unit.ToMm(edge);
      }
    }
    return source;
  }

  SceneDetector Detector(const nlohmann::json& value) const
  {
    const JsonObject entry(value, this->Root.PlaceOf("detector"),
      { "origin", "column-direction", "row-direction", "columns", "rows", "pixel-spacing" });
    SceneDetector detector;
    detector.OriginMm = this->Position(entry, "origin");
    detector.ColumnDirection = Direction(entry, "column-direction");
    detector.RowDirection = Direction(entry, "row-direction");
    detector.Columns = entry.WholeNumber("columns", 1, 65535);
    detector.Rows = entry.WholeNumber("rows", 1, 65535);
    const std::string expected = "a number from " + this->InUnit(SceneLimits::LeastPixelMm) +
      " to " + this->InUnit(SceneLimits::MostPixelMm);
    entry.Require("pixel-spacing", expected);
    entry.Number(
      "pixel-spacing", expected,
      [this](double spacing)
      {
        return this->Unit.ToMm(spacing) >= SceneLimits::LeastPixelMm &&
          this->Unit.ToMm(spacing) <= SceneLimits::MostPixelMm;
      },
      detector.PixelSpacingMm);
    detector.PixelSpacingMm = this->Unit.ToMm(detector.PixelSpacingMm);
    return detector;
  }

  SceneBeam Beam(const nlohmann::json& value) const
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
    SceneBeam beam;
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
    return beam;
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
  nlohmann::json File;
  JsonObject Root;
  LengthUnit Unit = Millimetre;
};
}

SurfaceScene ReadMeshScene(const std::string& path, const MaterialTable& table)
{
  SurfaceScene scene;
  scene.Materials = table;
  std::vector<std::string> names;
  scene.Surface = std::filesystem::path(path).extension() == ".vtu"
    ? ExtractInterfaces(FromGrid(ReadMesh(path), &names))
    : FromPolyData(ReadSurface(path), &names);
  table.CheckMesh(scene.Surface, names, path);
  return scene;
}

SurfaceScene ReadSurfaces(const std::vector<SurfaceSample>& samples, MaterialTable table)
{
  SurfaceScene scene;
  if (table.Materials.empty())
  {
    table.Name = "surfaces";
    table.Materials.push_back({ .Name = "air" });
  }
  for (const SurfaceSample& sample : samples)
  {
    const int material = MaterialFor(sample, table);
    SurfaceMesh part = FromPolyData(ReadSurface(sample.File));
    const auto several = [](const std::vector<std::uint16_t>& sides) {
      return std::any_of(sides.begin(), sides.end(), [](std::uint16_t side) { return side > 1; });
    };
    if (several(part.BackMaterials) || several(part.FrontMaterials))
    {
      throw InputError(sample.Name +
          ": expected a surface of one material, found several, as of a mesh with a table",
        { "File", sample.File, { "Mesh" } });
    }
    Place(sample, part);
    AppendBoundary(part, material, scene.Surface);
  }
  scene.Materials = std::move(table);
  return scene;
}

SceneDescription ReadScene(const std::string& path)
{
  return SceneReader(path).Read();
}
}
