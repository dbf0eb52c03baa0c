// SPDX-License-Identifier: Apache-2.0
#include "mammoray/IO/SceneIO.h"

#include "Private/JsonFile.h"
#include "Private/SceneTable.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/Numbers.h"
#include "mammoray/Foundation/SpellingSuggestions.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <sstream>
#include <utility>

namespace mammoray
{
namespace
{
using Json = nlohmann::json;
using Kind = SceneQuantity::Kind;

/// A unit of length, Mm / PerMm millimetres. Both are whole, so that 0.001 is not rounded twice.
struct LengthUnit
{
  const char* Name;
  double Mm;
  double PerMm;

  double ToMm(double value) const { return value * this->Mm / this->PerMm; }
  std::string Text(double mm) const { return NumberText(mm / this->ToMm(1)) + " " + this->Name; }
};
constexpr LengthUnit LengthUnits[] = { { "um", 1, 1000 }, { "mm", 1, 1 }, { "cm", 10, 1 },
  { "m", 1000, 1 }, { "in", 254, 10 } };
constexpr LengthUnit Millimetre = LengthUnits[1];
constexpr double MostAngleDeg = 3600;

/// What the meaning of a value depends on, and the place that messages name.
struct SceneValueContext
{
  std::string Place;
  LengthUnit Unit = Millimetre;
  /// Paths are relative to this folder; empty: to the working folder.
  std::filesystem::path Folder = {};

  std::string Beside(const std::string& path) const { return (this->Folder / path).string(); }
  std::string BesideOrAsGiven(const std::string& name) const
  {
    std::error_code none;
    return std::filesystem::exists(this->Beside(name), none) ? this->Beside(name) : name;
  }
};

std::string ExpectedValue(const SceneQuantity& quantity, const LengthUnit& unit)
{
  if (quantity.IsByMaterial)
  {
    return "an object by names of materials";
  }
  if (quantity.IsNumeric())
  {
    const auto text = [&](double limit)
    { return quantity.Type == Kind::Length ? unit.Text(limit) : NumberText(limit); };
    const char* const numbers[] = { "a list of numbers", "a number", "two numbers",
      "three numbers" };
    return (quantity.Type == Kind::WholeNumber ? "a whole number" : numbers[quantity.Count]) +
      (" from " + text(quantity.Least) + " to " + text(quantity.Most));
  }
  std::string words;
  for (const std::string& word : quantity.Words)
  {
    words += (words.empty() ? "one of \"" : ", \"") + word + "\"";
  }
  return quantity.Type == Kind::Component ? "three numbers from -1e6 to 1e6 that are not all 0"
    : quantity.Type == Kind::Flag         ? "true or false"
    : quantity.Type == Kind::Sample       ? "a list of at least one sample"
    : quantity.Type == Kind::Table        ? "the name of a table, or a table"
    : quantity.Count == 0                 ? "a list of texts that are not empty, at least one"
    : words.empty()                       ? "a text that is not empty"
                                          : words;
}

/// A single value with lengths in mm and paths from the working folder; null where it is unusable.
Json PlainValue(const SceneQuantity& quantity, const Json& value, const SceneValueContext& context)
{
  const double number = value.is_number() ? value.get<double>() : NAN;
  const double plain = quantity.Type == Kind::Length ? context.Unit.ToMm(number) : number;
  const bool isWithin = plain >= quantity.Least && plain <= quantity.Most;
  const std::string text = value.is_string() ? EscapeControls(value.get<std::string>()) : "";
  switch (quantity.Type)
  {
    case Kind::Number:
    case Kind::Component:
      return isWithin ? value : Json();
    case Kind::Length:
      return isWithin ? Json(plain) : Json();
    case Kind::WholeNumber:
      return isWithin && value.is_number_integer() ? value : Json();
    case Kind::Flag:
      return value.is_boolean() ? value : Json();
    case Kind::Word:
      // nlohmann/json 3.11.3 compares no JSON with a string in C++20.
      return value.is_string() &&
          std::find(quantity.Words.begin(), quantity.Words.end(), value.get<std::string>()) !=
            quantity.Words.end()
        ? value
        : Json();
    case Kind::Sample:
      return value;
    case Kind::Table:
      return value.is_object() ? value
        : text.empty()         ? Json()
                               : Json(context.BesideOrAsGiven(text));
    default:
      return text.empty()                   ? Json()
        : quantity.Type == Kind::File       ? Json(context.Beside(text))
        : quantity.Type == Kind::FileOrName ? Json(context.BesideOrAsGiven(text))
                                            : Json(text);
  }
}

/// A list of such values; null if one of them is unusable or their number is wrong.
Json PlainList(const SceneQuantity& quantity, const Json& value, const SceneValueContext& context)
{
  const bool isLong = quantity.Count == 0 ? !value.empty() : value.size() == quantity.Count;
  if (!value.is_array() || !isLong)
  {
    return {};
  }
  Json list = Json::array();
  for (const Json& element : value)
  {
    list.push_back(PlainValue(quantity, element, context));
    if (list.back().is_null() && quantity.Type != Kind::Sample)
    {
      return {};
    }
  }
  const bool isVector = quantity.Type != Kind::Component || Norm(list.get<Vector3>()) > 1e-12;
  return isVector ? list : Json();
}

/// Checks what was given for a quantity. Throws InputError.
Json ToPlain(SceneQuantity quantity, const Json& value, const SceneValueContext& context)
{
  if (quantity.IsByMaterial && value.is_object())
  {
    quantity.IsByMaterial = false;
    Json plain = Json::object();
    for (const auto& [name, entry] : value.items())
    {
      SceneValueContext inner = context;
      inner.Place += "." + name;
      plain[name] = ToPlain(quantity, entry, inner);
    }
    return plain;
  }
  Json plain = quantity.IsByMaterial ? Json()
    : quantity.Count == 1            ? PlainValue(quantity, value, context)
                                     : PlainList(quantity, value, context);
  if (plain.is_null())
  {
    RefuseJson(context.Place, ExpectedValue(quantity, context.Unit), &value);
  }
  return plain;
}

std::optional<LengthUnit> UnitOf(const JsonObject& entry)
{
  const Json* named = entry.Find("unit");
  if (!named)
  {
    return {};
  }
  const auto found = std::find_if(std::begin(LengthUnits), std::end(LengthUnits),
    [&](const LengthUnit& unit) { return *named == unit.Name; });
  if (found == std::end(LengthUnits))
  {
    entry.Refuse("unit", R"(one of "um", "mm", "cm", "m", "in")");
  }
  return *found;
}

SurfaceSample SampleOf(const Json& value, const SceneValueContext& context)
{
  const JsonObject entry(value, context.Place,
    { "file", "material", "unit", "rotation", "translation" });
  SurfaceSample sample;
  sample.Name = context.Place;
  sample.File = context.Beside(entry.Text("file"));
  sample.Material = entry.Find("material") ? entry.Text("material") : std::string();
  if (const auto unit = UnitOf(entry))
  {
    sample.UnitMm = unit->ToMm(1);
  }
  const auto numbers = [&](const SceneQuantity& quantity, const JsonObject& of)
  {
    SceneValueContext inner = context;
    inner.Place = of.PlaceOf(quantity.Key);
    return ToPlain(quantity, of.Require(quantity.Key, ExpectedValue(quantity, inner.Unit)), inner)
      .get<Vector3>();
  };
  if (const Json* rotation = entry.Find("rotation"))
  {
    const JsonObject turn(*rotation, entry.PlaceOf("rotation"), { "axis", "angle" });
    sample.RotationAxis = numbers(
      { .Key = "axis", .Type = Kind::Component, .Least = -1e6, .Most = 1e6, .Count = 3 }, turn);
    const char* const expected = "a number of degrees from -3600 to 3600";
    turn.Require("angle", expected);
    turn.Number(
      "angle", expected, [](double degrees) { return std::abs(degrees) <= MostAngleDeg; },
      sample.RotationDeg);
  }
  if (entry.Find("translation"))
  {
    sample.TranslationMm = numbers({ .Key = "translation",
                                     .Type = Kind::Length,
                                     .Least = -MostCoordinateMm,
                                     .Most = MostCoordinateMm,
                                     .Count = 3 },
      entry);
  }
  return sample;
}

Json SamplesAsJson(const std::vector<SurfaceSample>& samples)
{
  Json list = Json::array();
  for (const SurfaceSample& sample : samples)
  {
    Json entry{ { "file", std::filesystem::absolute(sample.File).string() } };
    if (!sample.Material.empty())
    {
      entry["material"] = sample.Material;
    }
    for (const LengthUnit& unit : LengthUnits)
    {
      if (sample.UnitMm == unit.ToMm(1))
      {
        entry["unit"] = unit.Name;
      }
    }
    if (sample.RotationDeg != 0)
    {
      entry["rotation"] = { { "axis", sample.RotationAxis }, { "angle", sample.RotationDeg } };
    }
    if (sample.TranslationMm != Vector3{ 0, 0, 0 })
    {
      entry["translation"] = sample.TranslationMm;
    }
    list.push_back(std::move(entry));
  }
  return list;
}

const SceneRow* FindRow(const std::string& key)
{
  const std::vector<SceneRow>& rows = SceneRows();
  const auto found = std::find_if(rows.begin(), rows.end(),
    [&](const SceneRow& row) { return row.Quantity.Key == key; });
  return found == rows.end() ? nullptr : &*found;
}

/// The keys of an object of scene files: "detector." has "origin", "columns" and so on.
std::vector<std::string> KeysWithin(const std::string& prefix)
{
  std::vector<std::string> keys;
  for (const SceneRow& row : SceneRows())
  {
    if (row.Quantity.Key.starts_with(prefix))
    {
      const std::string rest = row.Quantity.Key.substr(prefix.size());
      std::string key = rest.substr(0, rest.find('.'));
      if (std::find(keys.begin(), keys.end(), key) == keys.end())
      {
        keys.push_back(std::move(key));
      }
    }
  }
  return keys;
}

void Apply(const SceneRow& row, const Json& value, const SceneValueContext& context,
  SceneDescription& description)
{
  const Json plain = ToPlain(row.Quantity, value, context);
  description.Keys.push_back(row.Quantity.Key);
  if (row.Quantity.Type != Kind::Sample)
  {
    row.Set(description, plain);
    return;
  }
  description.Samples.clear();
  for (std::size_t index = 0; index < plain.size(); ++index)
  {
    SceneValueContext inner = context;
    inner.Place += "[" + std::to_string(index) + "]";
    description.Samples.push_back(SampleOf(plain[index], inner));
  }
}

/// Applies the keys of an object, and of those within it.
void ApplyObject(const JsonObject& object, const Json& value, const std::string& prefix,
  const SceneValueContext& context, SceneDescription& description)
{
  for (const auto& [key, entry] : value.items())
  {
    SceneValueContext inner = context;
    inner.Place = object.PlaceOf(key);
    if (const SceneRow* row = FindRow(prefix + key))
    {
      Apply(*row, entry, inner, description);
    }
    else
    {
      const std::string within = prefix + key + ".";
      description.Keys.push_back(prefix + key);
      ApplyObject(JsonObject(entry, inner.Place, KeysWithin(within)), entry, within, context,
        description);
    }
  }
}

/// JSON where a text is that, at most lists of numbers or texts; else the text itself.
Json ParseSetting(const std::string& text)
{
  const auto isFlat = [](int depth, Json::parse_event_t, const Json&) { return depth < 3; };
  Json value = Json::parse(text, isFlat, false);
  return value.is_discarded() || value.is_null() ? Json(text) : value;
}

/// The value of a setting: a text stays one even where it looks like a number.
Json SettingAsJson(const SceneQuantity& quantity, const std::vector<std::string>& values)
{
  const bool isText =
    !quantity.IsNumeric() && quantity.Type != Kind::Component && quantity.Type != Kind::Flag;
  const auto asJson = [&](const std::string& text)
  {
    if (quantity.Type == Kind::Table && text.starts_with('{'))
    {
      std::istringstream table(text);
      return ParseJson(table, quantity.Key, "a table");
    }
    return isText ? Json(text) : ParseSetting(text);
  };
  if (quantity.Count == 1)
  {
    return asJson(values.front());
  }
  if (values.size() == 1 && values.front().starts_with('['))
  {
    return ParseSetting(values.front());
  }
  Json list = Json::array();
  for (const std::string& text : values)
  {
    list.push_back(asJson(text));
  }
  return list;
}
}

bool SceneDescription::Has(const std::string& key) const
{
  return std::any_of(this->Keys.begin(), this->Keys.end(),
    [&](const std::string& given) { return given == key || given.starts_with(key + "."); });
}

bool SceneDescription::HasSource() const
{
  return this->Has("source.position") || this->Has("source.beam-direction");
}

bool SceneDescription::HasDetector() const
{
  return this->Has("detector.origin");
}

void SceneDescription::Validate() const
{
  const auto has = [this](const char* key) { return this->Has(key) ? 1 : 0; };
  const bool hasTube = this->Has("beam.tube");
  const int beams = has("beam.kev") + has("beam.energies") + has("beam.spectrum") +
    (hasTube || this->Has("beam.kvp") ? 1 : 0);
  if (beams > 1)
  {
    throw InputError(
      "beam: expected one of kev, energies, spectrum, and tube with kvp, found several");
  }
  if (this->Has("beam.kvp") && !hasTube)
  {
    throw InputError("beam.tube: expected beside kvp, found none");
  }
  if (has("beam.target-angle") && !hasTube)
  {
    throw InputError("beam.target-angle: expected a tube beside it, found none");
  }
  if (has("beam.energies") != has("beam.photons") ||
    this->EnergiesKeV.size() != this->Photons.size())
  {
    throw InputError("beam.photons: expected a number for each of " +
      std::to_string(this->EnergiesKeV.size()) + " energies, found " +
      std::to_string(this->Photons.size()));
  }
  if (has("source.position") && has("source.beam-direction"))
  {
    throw InputError("source: expected either position or beam-direction, found both");
  }
  if (has("source.heel") && !has("source.heel.angle"))
  {
    throw InputError("source.heel.angle: expected a number of degrees, found nothing");
  }
  if (has("refraction") && !this->Fixed.Refraction)
  {
    throw InputError(R"(refraction.law: expected "geometric" or "near-field", found nothing)");
  }
  if (has("scatter.grid") && !this->Fixed.Scatter.Grid)
  {
    throw InputError("scatter.grid: expected its ratio, found nothing");
  }
  const int places =
    has("detector.origin") + has("detector.column-direction") + has("detector.row-direction");
  if (places == 1 || places == 2)
  {
    throw InputError("detector: expected origin, column-direction and row-direction together, "
                     "found some of them");
  }
  if (!this->ResponseTable.empty() && !this->Scintillator.empty())
  {
    throw InputError("response: expected a table or a scintillator, found both");
  }
  if (!this->LineSpread.empty() && this->Fixed.Detection.HalfModulationPerMm > 0)
  {
    throw InputError("detector: expected half-modulation or line-spread, found both");
  }
}

double LengthUnitMm(const std::string& name)
{
  for (const LengthUnit& unit : LengthUnits)
  {
    if (name == unit.Name)
    {
      return unit.ToMm(1);
    }
  }
  throw InputError("unit: expected um, mm, cm, m or in, found '" + name + "'");
}

void SetQuantity(const SceneSetting& setting, SceneDescription& description)
{
  const SceneRow* row = FindRow(setting.Key);
  const std::size_t dot = std::min(setting.Key.find('.'), setting.Key.size());
  const SceneRow* byMaterial = row ? nullptr : FindRow(setting.Key.substr(0, dot));
  if (byMaterial && byMaterial->Quantity.IsByMaterial && dot + 1 < setting.Key.size())
  {
    SceneQuantity quantity = byMaterial->Quantity;
    quantity.IsByMaterial = false;
    const Json value = SettingAsJson(quantity, setting.Values);
    byMaterial->Set(description,
      { { setting.Key.substr(dot + 1), ToPlain(quantity, value, { setting.Name }) } });
    description.Keys.push_back(setting.Key);
    return;
  }
  const auto isSettable = [](const SceneRow& each)
  { return each.Quantity.Type != Kind::Sample && each.Quantity.Key != "unit"; };
  if (!row || !isSettable(*row))
  {
    std::vector<std::string> known;
    for (const SceneRow& each : SceneRows())
    {
      if (isSettable(each))
      {
        known.push_back(each.Quantity.Key);
      }
    }
    throw InputError(
      setting.Name + ": no quantity '" + setting.Key + "'; " + SpellingHint(setting.Key, known));
  }
  Apply(*row, SettingAsJson(row->Quantity, setting.Values), { setting.Name }, description);
}

const std::vector<SceneQuantity>& SceneQuantities()
{
  static const std::vector<SceneQuantity> quantities = []()
  {
    std::vector<SceneQuantity> all;
    for (const SceneRow& row : SceneRows())
    {
      all.push_back(row.Quantity);
    }
    return all;
  }();
  return quantities;
}

SceneDescription ReadScene(const std::string& path)
{
  SceneDescription description;
  const Json file = ParseJsonFile(path, "a scene");
  const JsonObject root = JsonObject::Root(file, path, KeysWithin(""));
  SceneValueContext context;
  context.Unit = UnitOf(root).value_or(Millimetre);
  context.Folder = std::filesystem::path(path).parent_path();
  ApplyObject(root, file, "", context, description);
  if (description.HasDetector())
  {
    for (const char* key : { "detector.columns", "detector.rows", "detector.pixel-spacing" })
    {
      if (!description.Has(key))
      {
        RefuseJson(path + ": " + key, ExpectedValue(FindRow(key)->Quantity, context.Unit), nullptr);
      }
    }
  }
  try
  {
    description.Validate();
  }
  catch (const InputError& error)
  {
    throw InputError(path + ": " + error.what());
  }
  return description;
}

std::string WriteScene(const SceneDescription& description)
{
  nlohmann::ordered_json scene = nlohmann::ordered_json::object();
  const SceneDescription defaults;
  for (const SceneRow& row : SceneRows())
  {
    const SceneQuantity& quantity = row.Quantity;
    Json value =
      quantity.Type == Kind::Sample ? SamplesAsJson(description.Samples) : row.Get(description);
    const bool isEmpty = value.is_null() ||
      (!value.is_number() && !value.is_boolean() && value.empty()) || value == "";
    if (isEmpty || (!description.Has(quantity.Key) && value == row.Get(defaults)))
    {
      continue;
    }
    std::error_code none;
    if (quantity.Type == Kind::File ||
      (quantity.Type == Kind::FileOrName &&
        std::filesystem::exists(value.get<std::string>(), none)))
    {
      value = std::filesystem::absolute(value.get<std::string>()).string();
    }
    nlohmann::ordered_json* place = &scene;
    std::size_t begin = 0;
    for (std::size_t dot; (dot = quantity.Key.find('.', begin)) != std::string::npos;
         begin = dot + 1)
    {
      place = &(*place)[quantity.Key.substr(begin, dot - begin)];
    }
    (*place)[quantity.Key.substr(begin)] = value;
  }
  return scene.dump(2) + "\n";
}
}
