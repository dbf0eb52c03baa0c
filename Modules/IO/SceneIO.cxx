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
#include <utility>

namespace mammoray
{
namespace
{
using Json = nlohmann::json;
using Kind = SceneQuantity::Kind;

/// A unit of length: what it is in mm, above and below a fraction's line so that rounding is right.
struct LengthUnit
{
  const char* Name;
  double Mm;
  double PerMm;

  double ToMm(double value) const { return value * this->Mm / this->PerMm; }
  std::string Text(double mm) const { return NumberText(mm / this->ToMm(1)) + " " + this->Name; }
};
constexpr LengthUnit LengthUnits[] = { { "um", 1, 1000 }, { "mm", 1, 1 }, { "cm", 10, 1 },
  { "m", 1000, 1 } };
constexpr LengthUnit Millimetre = LengthUnits[1];
constexpr double MostAngleDeg = 3600;

/// Where a value was given, which says what it means.
struct SceneValueContext
{
  std::string Place;
  LengthUnit Unit = Millimetre;
  /// Paths are relative to it; empty: to the working folder.
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
  const auto range = [](const std::string& least, const std::string& most)
  { return " from " + least + " to " + most; };
  const std::string numbers = range(NumberText(quantity.Least), NumberText(quantity.Most));
  const std::string lengths = range(unit.Text(quantity.Least), unit.Text(quantity.Most));
  std::string words;
  for (const std::string& word : quantity.Words)
  {
    words += (words.empty() ? "\"" : ", \"") + word + "\"";
  }
  switch (quantity.Type)
  {
    case Kind::Number:
      return "a number" + numbers;
    case Kind::Length:
      return "a number" + lengths;
    case Kind::WholeNumber:
      return "a whole number" +
        range(std::to_string(std::llround(quantity.Least)),
          std::to_string(std::llround(quantity.Most)));
    case Kind::Flag:
      return "true or false";
    case Kind::Word:
      return "one of " + words;
    case Kind::ListOfTexts:
      return "a list of texts that are not empty, at least one";
    case Kind::Point:
      return "three numbers within " + unit.Text(quantity.Most) + " of 0";
    case Kind::Direction:
      return "three numbers from -1e6 to 1e6 that are not all 0";
    case Kind::Edges:
      return "two numbers" + lengths;
    case Kind::TextsByMaterial:
    case Kind::NumbersByMaterial:
      return "an object by names of materials";
    case Kind::ListOfSamples:
      return "a list of at least one sample";
    default:
      return "a text that is not empty";
  }
}

bool IsNumberBetween(const Json& value, double least, double most)
{
  return value.is_number() && value.get<double>() >= least && value.get<double>() <= most;
}

bool IsFilledText(const Json& value)
{
  return value.is_string() && !value.get_ref<const std::string&>().empty();
}

template <typename Accept>
bool IsListOf(const Json& value, std::size_t least, std::size_t most, const Accept& accept)
{
  return value.is_array() && value.size() >= least && value.size() <= most &&
    std::all_of(value.begin(), value.end(), accept);
}

bool IsUsable(const SceneQuantity& quantity, const Json& value, const LengthUnit& unit)
{
  const auto isLength = [&](const Json& length)
  {
    return length.is_number() && unit.ToMm(length.get<double>()) >= quantity.Least &&
      unit.ToMm(length.get<double>()) <= quantity.Most;
  };
  switch (quantity.Type)
  {
    case Kind::Number:
      return IsNumberBetween(value, quantity.Least, quantity.Most);
    case Kind::WholeNumber:
      return value.is_number_integer() && IsNumberBetween(value, quantity.Least, quantity.Most);
    case Kind::Length:
      return isLength(value);
    case Kind::Flag:
      return value.is_boolean();
    case Kind::Word:
      return std::find(quantity.Words.begin(), quantity.Words.end(), value) != quantity.Words.end();
    case Kind::ListOfTexts:
      return IsListOf(value, 1, value.size(), IsFilledText);
    case Kind::Point:
      return IsListOf(value, 3, 3, isLength);
    case Kind::Direction:
      return IsListOf(value, 3, 3,
               [](const Json& number) { return IsNumberBetween(number, -1e6, 1e6); }) &&
        Norm(value.get<Vector3>()) > 1e-12;
    case Kind::Edges:
      return IsListOf(value, 2, 2, isLength);
    case Kind::TextsByMaterial:
    case Kind::NumbersByMaterial:
      return value.is_object();
    case Kind::ListOfSamples:
      return IsListOf(value, 1, value.size(), [](const Json&) { return true; });
    default:
      return IsFilledText(value);
  }
}

/// What is declared of the value of a single material.
SceneQuantity OfOneMaterial(SceneQuantity quantity)
{
  quantity.Type = quantity.Type == Kind::TextsByMaterial ? Kind::Text : Kind::Number;
  return quantity;
}

/// Checks a value; lengths become mm, paths those from the working folder.
Json ToPlainValue(const SceneQuantity& quantity, Json value, const SceneValueContext& context)
{
  if (!IsUsable(quantity, value, context.Unit))
  {
    RefuseJson(context.Place, ExpectedValue(quantity, context.Unit), &value);
  }
  switch (quantity.Type)
  {
    case Kind::Length:
      return context.Unit.ToMm(value.get<double>());
    case Kind::Point:
    case Kind::Edges:
      for (Json& length : value)
      {
        length = context.Unit.ToMm(length.get<double>());
      }
      return value;
    case Kind::Text:
      return EscapeControls(value.get<std::string>());
    case Kind::File:
      return context.Beside(EscapeControls(value.get<std::string>()));
    case Kind::FileOrName:
      return context.BesideOrAsGiven(EscapeControls(value.get<std::string>()));
    case Kind::ListOfTexts:
      for (Json& text : value)
      {
        text = EscapeControls(text.get<std::string>());
      }
      return value;
    case Kind::TextsByMaterial:
    case Kind::NumbersByMaterial:
      for (const auto& [name, entry] : value.items())
      {
        SceneValueContext inner = context;
        inner.Place += "." + name;
        entry = ToPlainValue(OfOneMaterial(quantity), entry, inner);
      }
      return value;
    default:
      return value;
  }
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
    entry.Refuse("unit", R"(one of "um", "mm", "cm", "m")");
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
  sample.Material = entry.Text("material");
  if (const auto unit = UnitOf(entry))
  {
    sample.UnitMm = unit->ToMm(1);
  }
  const auto numbers = [&](const SceneQuantity& quantity, const JsonObject& of)
  {
    SceneValueContext inner = context;
    inner.Place = of.PlaceOf(quantity.Key);
    return ToPlainValue(quantity, of.Require(quantity.Key, ExpectedValue(quantity, inner.Unit)),
      inner)
      .get<Vector3>();
  };
  if (const Json* rotation = entry.Find("rotation"))
  {
    const JsonObject turn(*rotation, entry.PlaceOf("rotation"), { "axis", "angle" });
    sample.RotationAxis = numbers({ .Key = "axis", .Type = Kind::Direction }, turn);
    const char* const expected = "a number of degrees from -3600 to 3600";
    turn.Require("angle", expected);
    turn.Number(
      "angle", expected, [](double degrees) { return std::abs(degrees) <= MostAngleDeg; },
      sample.RotationDeg);
  }
  if (entry.Find("translation"))
  {
    sample.TranslationMm = numbers({ .Key = "translation",
                                     .Type = Kind::Point,
                                     .Least = -MostCoordinateMm,
                                     .Most = MostCoordinateMm },
      entry);
  }
  return sample;
}

Json SamplesAsJson(const std::vector<SurfaceSample>& samples)
{
  Json list = Json::array();
  for (const SurfaceSample& sample : samples)
  {
    Json entry{ { "file", std::filesystem::absolute(sample.File).string() },
      { "material", sample.Material } };
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
  const Json plain = ToPlainValue(row.Quantity, value, context);
  description.Keys.push_back(row.Quantity.Key);
  if (row.Quantity.Type != Kind::ListOfSamples)
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
  const bool isList = quantity.Type == Kind::ListOfTexts || quantity.Type == Kind::Point ||
    quantity.Type == Kind::Direction || quantity.Type == Kind::Edges;
  const auto asJson = [&](const std::string& text)
  { return quantity.Type == Kind::ListOfTexts ? Json(text) : ParseSetting(text); };
  if (!isList)
  {
    const bool isText = quantity.Type == Kind::Text || quantity.Type == Kind::Word ||
      quantity.Type == Kind::File || quantity.Type == Kind::FileOrName;
    return isText ? Json(values.front()) : ParseSetting(values.front());
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
  const int beams =
    has("beam.kev") + has("beam.spectrum") + (hasTube || this->Has("beam.kvp") ? 1 : 0);
  if (beams > 1 || (beams == 1 && this->Has("beam.kvp") && !hasTube))
  {
    throw InputError(std::string("beam: expected one of kev, spectrum, and tube with kvp, found ") +
      (beams > 1 ? "several" : "another"));
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
}

void SetQuantity(const SceneSetting& setting, SceneDescription& description)
{
  const SceneRow* row = FindRow(setting.Key);
  const std::size_t dot = std::min(setting.Key.find('.'), setting.Key.size());
  const SceneRow* byMaterial = row ? nullptr : FindRow(setting.Key.substr(0, dot));
  if (byMaterial && dot + 1 < setting.Key.size())
  {
    const SceneQuantity quantity = OfOneMaterial(byMaterial->Quantity);
    byMaterial->Set(description,
      { { setting.Key.substr(dot + 1),
        ToPlainValue(quantity, SettingAsJson(quantity, setting.Values), { setting.Name }) } });
    description.Keys.push_back(setting.Key);
    return;
  }
  if (!row || row->Quantity.Type == Kind::ListOfSamples || row->Quantity.Key == "unit")
  {
    std::vector<std::string> known;
    for (const SceneRow& other : SceneRows())
    {
      known.push_back(other.Quantity.Key);
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
    Json value = quantity.Type == Kind::ListOfSamples ? SamplesAsJson(description.Samples)
                                                      : row.Get(description);
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
