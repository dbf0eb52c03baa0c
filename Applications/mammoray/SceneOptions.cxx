// SPDX-License-Identifier: Apache-2.0
#include "SceneOptions.h"

#include "mammoray/Foundation/Error.h"

#include <cstdio>
#include <optional>
#include <tuple>
#include <utility>

namespace mammoray
{
namespace
{
using QuantityKind = SceneQuantity::Kind;

/// What help shows in place of a type.
std::string TypeName(const SceneQuantity& quantity)
{
  const bool isPath =
    quantity.Type == QuantityKind::FileOrName || quantity.Type == QuantityKind::Table;
  return quantity.Type == QuantityKind::File     ? FileTypeName
    : isPath                                     ? InputTypeName
    : !quantity.Unit.empty()                     ? quantity.Unit
    : quantity.Type == QuantityKind::WholeNumber ? "INT"
    : quantity.Type == QuantityKind::Number      ? "FLOAT"
                                                 : "TEXT";
}

std::vector<SurfaceSample> ToSamples(const std::vector<std::string>& surfaces,
  const std::string& unit)
{
  std::vector<SurfaceSample> samples;
  for (const std::string& text : surfaces)
  {
    // Mass fractions have no '=', and a path may have one.
    SurfaceSample sample;
    std::tie(sample.Material, sample.File) = SplitAssignment(text, "--surface", "MATERIAL=FILE");
    sample.Name = "--surface " + text;
    sample.UnitMm = unit.empty() ? std::optional<double>() : LengthUnitMm(unit);
    samples.push_back(std::move(sample));
  }
  return samples;
}
}

std::string OptionOf(const SceneQuantity& quantity)
{
  if (quantity.Usage == SceneQuantity::Use::Rare)
  {
    return {};
  }
  const std::string& key = quantity.Key;
  return key == "source.position" ? "--source"
    : key == "detector.origin"    ? "--detector-origin"
    : key == "scatter.method"     ? "--scatter"
                                  : "--" + key.substr(key.rfind('.') + 1);
}

void AddQuantityOption(const OptionList& add, const SceneQuantity& quantity,
  SceneArguments& arguments)
{
  const auto take = [name = OptionOf(quantity), key = quantity.Key, &settings = arguments.Settings](
                      const std::vector<std::string>& values)
  {
    std::erase_if(settings, [&](const SceneSetting& setting) { return setting.Key == key; });
    settings.push_back({ name, key, values });
  };
  const Shown shown =
    quantity.Usage == SceneQuantity::Use::Daily ? Shown::InHelp : Shown::InHelpAll;
  Command& command = add.App();
  if (quantity.Type == QuantityKind::Flag)
  {
    add.Keep({ command.add_flag_callback(
                 OptionOf(quantity), [take]() { take({ "true" }); }, quantity.Help),
      shown, "boolean" });
    return;
  }
  CLI::Option* option =
    command.add_option_function<std::vector<std::string>>(OptionOf(quantity), take, quantity.Help)
      ->type_name(TypeName(quantity))
      ->default_str(quantity.Default);
  if (quantity.Count == 0)
  {
    option->allow_extra_args(false);
  }
  else
  {
    option->expected(static_cast<int>(quantity.Count));
  }
  if (quantity.Type == QuantityKind::Word)
  {
    option->check(OneOfWords(quantity.Words));
  }
  else if (quantity.Type == QuantityKind::File || quantity.Type == QuantityKind::FileOrName ||
    quantity.Type == QuantityKind::Table)
  {
    option->check(FileOrFolder(quantity.Type == QuantityKind::File));
  }
  const Quantity numbers = quantity.IsNumeric() && quantity.Count == 1
    ? Between(quantity.Least, quantity.Most, quantity.Unit.c_str())
    : Quantity("");
  const bool isWhole = quantity.Type == QuantityKind::WholeNumber;
  const bool isNumber = quantity.Type == QuantityKind::Component || quantity.IsNumeric();
  if (isNumber)
  {
    option->check(isWhole ? NumberIn<int>(numbers) : NumberIn<double>(numbers));
  }
  const char* const kind = isWhole ? "integer" : isNumber ? "number" : "string";
  add.Keep({ option, shown, kind, numbers, quantity.Words, false });
}

SceneSetting ToSetting(const std::string& text, const std::string& option,
  const std::string& prefix)
{
  const auto [key, value] = SplitAssignment(text, option, "KEY=VALUE");
  return { option + " " + key, prefix + key, { value } };
}

SceneDescription ReadSceneArguments(const SceneArguments& arguments)
{
  SceneDescription scene = arguments.File.empty() ? SceneDescription() : ReadScene(arguments.File);
  for (const SceneSetting& setting : arguments.Settings)
  {
    SetQuantity(setting, scene);
  }
  for (const std::string& text : arguments.Sets)
  {
    SetQuantity(ToSetting(text, "--set"), scene);
  }
  if (!arguments.Surfaces.empty())
  {
    if (!scene.Samples.empty())
    {
      throw InputError("--surface: expected no samples in " + arguments.File + ", found some");
    }
    scene.Samples = ToSamples(arguments.Surfaces, arguments.Unit);
  }
  if (!scene.Mesh.empty())
  {
    if (!arguments.Unit.empty())
    {
      SetQuantity({ "--unit", "mesh-unit", { arguments.Unit } }, scene);
    }
    CheckInputFile(scene.Mesh);
  }
  for (const SurfaceSample& sample : scene.Samples)
  {
    CheckInputFile(sample.File);
  }
  return scene;
}

void WarnOfOverlap(const std::string& overlap)
{
  if (!overlap.empty())
  {
    std::fprintf(stderr,
      "mammoray: warning: %s; overlap-priority counts parts once, 'mammoray mesh --repair' turns "
      "the faces of cavities\n",
      overlap.c_str());
  }
}
}
