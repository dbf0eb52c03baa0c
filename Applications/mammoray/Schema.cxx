// SPDX-License-Identifier: Apache-2.0
#include "Schema.h"

#include "SceneOptions.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace mammoray
{
namespace
{
using Json = nlohmann::ordered_json;

/// Whole where it is.
Json Bound(double bound)
{
  return std::floor(bound) == bound && std::abs(bound) < 1e15
    ? Json(static_cast<std::int64_t>(bound))
    : Json(bound);
}

Json ValueSchema(const Declaration& declaration)
{
  Json schema{ { "type", declaration.Kind } };
  const Quantity& numbers = declaration.Numbers;
  if (std::isfinite(numbers.Least))
  {
    schema[numbers.LeastExcluded ? "exclusiveMinimum" : "minimum"] = Bound(numbers.Least);
  }
  if (std::isfinite(numbers.Most))
  {
    schema["maximum"] = Bound(numbers.Most);
  }
  if (!declaration.Words.empty())
  {
    schema["enum"] = declaration.Words;
  }
  if (!declaration.IsList())
  {
    return schema;
  }
  const int least = declaration.Option->get_expected_min();
  Json list{ { "type", "array" }, { "items", schema }, { "minItems", least } };
  if (declaration.Option->get_expected_max() == least)
  {
    list["maxItems"] = least;
  }
  return least > 1 ? list : Json{ { "anyOf", { schema, list } } };
}

Json SettingSchema(const Declaration& declaration)
{
  const CLI::Option& option = *declaration.Option;
  const char* const shown[] = { "--help", "--help-all", "case file" };
  Json schema = ValueSchema(declaration);
  const std::string unit =
    declaration.Kind == std::string("string") ? "" : declaration.Numbers.Unit;
  schema["description"] = declaration.Help() + (unit.empty() ? "" : " [" + unit + "]");
  if (const Json standard = declaration.Default(); !standard.is_null())
  {
    schema["default"] = standard;
  }
  if (!declaration.IsFlag())
  {
    schema["value"] = option.get_type_name();
  }
  if (!option.get_snames().empty())
  {
    schema["short"] = option.get_snames().front();
  }
  if (option.get_required())
  {
    schema["mandatory"] = true;
  }
  if (option.get_positional())
  {
    schema["positional"] = true;
  }
  if (option.get_group() != "Options")
  {
    schema["group"] = option.get_group();
  }
  schema["shown"] = shown[static_cast<std::size_t>(declaration.Where)];
  return schema;
}

/// What a quantity of a scene may be.
Json QuantitySchema(const SceneQuantity& quantity)
{
  using Kind = SceneQuantity::Kind;
  Json one{ { "type", "string" } };
  switch (quantity.Type)
  {
    case Kind::Number:
    case Kind::Length:
    case Kind::Component:
    case Kind::WholeNumber:
      one = { { "type", quantity.Type == Kind::WholeNumber ? "integer" : "number" },
        { "minimum", Bound(quantity.Least) }, { "maximum", Bound(quantity.Most) } };
      break;
    case Kind::Flag:
    case Kind::Sample:
      one["type"] = quantity.Type == Kind::Flag ? "boolean" : "object";
      break;
    case Kind::Word:
      one["enum"] = quantity.Words;
      break;
    case Kind::Table:
      one["type"] = { "string", "object" };
      break;
    default:
      break;
  }
  if (quantity.IsByMaterial)
  {
    return { { "type", "object" }, { "additionalProperties", one } };
  }
  if (quantity.Count == 1)
  {
    return one;
  }
  Json list{ { "type", "array" }, { "items", one },
    { "minItems", std::max<std::size_t>(quantity.Count, 1) } };
  if (quantity.Count > 1)
  {
    list["maxItems"] = quantity.Count;
  }
  return list;
}

/// Scene files; limits of lengths are mm.
Json SceneSchema()
{
  Json scene{ { "type", "object" }, { "additionalProperties", false } };
  for (const SceneQuantity& quantity : SceneQuantities())
  {
    Json* object = &scene;
    std::size_t begin = 0;
    for (std::size_t dot = 0; (dot = quantity.Key.find('.', begin)) != std::string::npos;
         begin = dot + 1)
    {
      object = &(*object)["properties"][quantity.Key.substr(begin, dot - begin)];
      (*object)["type"] = "object";
      (*object)["additionalProperties"] = false;
    }
    Json schema = QuantitySchema(quantity);
    std::string help = quantity.Help;
    std::replace(help.begin(), help.end(), '\n', ' ');
    schema["description"] = help;
    for (const auto& [key, text] : { std::pair("default", quantity.Default),
           { "value", quantity.Unit }, { "option", OptionOf(quantity) } })
    {
      if (!text.empty())
      {
        schema[key] = text;
      }
    }
    (*object)["properties"][quantity.Key.substr(begin)] = schema;
  }
  return scene;
}

Json CommandSchema(const Command& command, Json& program)
{
  Json properties{ { "$schema", { { "type", "string" } } } };
  for (const Declaration& declaration : command.Declarations)
  {
    const std::string name = declaration.Name();
    if (!declaration.IsOfProgram())
    {
      properties[name] = SettingSchema(declaration);
      continue;
    }
    program[name] = SettingSchema(declaration);
    if (declaration.IsSetting())
    {
      properties[name] = { { "$ref", "#/$defs/program/properties/" + name } };
    }
  }
  return { { "type", "object" }, { "description", command.get_description() },
    { "example", command.get_footer() }, { "additionalProperties", false },
    { "properties", properties } };
}
}

std::string CaseFileSchema(const CLI::App& application)
{
  Json any = Json::array();
  Json definitions{ { "program", { { "description", application.get_description() } } } };
  Json program = Json::object();
  for (const CLI::App* each : application.get_subcommands({}))
  {
    if (const auto* command = dynamic_cast<const Command*>(each))
    {
      any.push_back({ { "$ref", "#/$defs/" + command->get_name() } });
      definitions[command->get_name()] = CommandSchema(*command, program);
    }
  }
  definitions["program"]["properties"] = program;
  definitions["scene"] = SceneSchema();
  const Json schema{ { "$schema", "https://json-schema.org/draft/2020-12/schema" },
    { "title", "Case files of mammoray (--config)" },
    { "description",
      "Made by mammoray --print-schema from the declared options. A case file names its command "
      "by \"$schema\": \"case.schema.json#/$defs/register\"." },
    { "anyOf", any }, { "$defs", definitions } };
  return schema.dump(1) + "\n";
}
}
