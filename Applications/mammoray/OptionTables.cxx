// SPDX-License-Identifier: Apache-2.0
#include "OptionTables.h"

#include "Configuration.h"
#include "Help.h"
#include "OptionList.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <vector>

namespace mammoray
{
namespace
{
using Json = nlohmann::ordered_json;

std::vector<const Command*> CommandsOf(const CLI::App& application)
{
  std::vector<const Command*> commands;
  for (const CLI::App* each : application.get_subcommands({}))
  {
    if (const auto* command = dynamic_cast<const Command*>(each))
    {
      commands.push_back(command);
    }
  }
  return commands;
}

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
  return schema;
}

Json SettingSchema(const Declaration& declaration)
{
  const CLI::Option& option = *declaration.Option;
  Json schema = ValueSchema(declaration);
  if (declaration.IsList())
  {
    const int least = option.get_expected_min();
    Json list{ { "type", "array" }, { "items", schema }, { "minItems", least } };
    if (option.get_expected_max() == least)
    {
      list["maxItems"] = least;
    }
    schema = least > 1 ? list : Json{ { "anyOf", { schema, list } } };
  }
  const std::string& unit = declaration.Numbers.Unit;
  schema["description"] = WholeHelp(option) + (unit.empty() ? "" : " [" + unit + "]");
  if (const Json standard = DefaultAsJson(declaration); !standard.is_null())
  {
    schema["default"] = standard;
  }
  return schema;
}

/// What makes two commands' options one.
std::string Identity(const Declaration& declaration)
{
  return declaration.Name() + '\n' + declaration.Option->get_description();
}

/// As Markdown shows it in a table, and Doxygen, to which @ begins a command.
std::string Cell(std::string text)
{
  for (std::size_t place = 0; (place = text.find_first_of("|@", place)) != std::string::npos;
       place += 2)
  {
    text.insert(place, 1, '\\');
  }
  return text;
}

/// A command that takes an option, and how it declares it.
struct Use
{
  const Command* By;
  const Declaration* Declared;
};

/// Of an option of several commands the default stands where it is the same in all.
std::string Row(const std::vector<Use>& uses)
{
  const Declaration& declaration = *uses.front().Declared;
  const auto isAlike = [&declaration](const Use& use)
  { return use.Declared->Option->get_default_str() == declaration.Option->get_default_str(); };
  const bool isDefaultShared = std::all_of(uses.begin(), uses.end(), isAlike);
  const CLI::Option& option = *declaration.Option;
  const char* const where[] = { "`--help`", "`--help-all`", "case file" };
  const bool isWord = declaration.Where == Shown::InCaseFile || option.get_positional();
  const std::string& range = declaration.Numbers.Range();
  std::string values =
    declaration.Words.empty() ? option.get_type_name() : CLI::detail::join(declaration.Words, ", ");
  values = declaration.IsFlag() ? "" : values + (range.empty() ? "" : ", ") + range;
  std::string row = "| `" +
    std::string(isWord ? declaration.Name() : option.get_name(false, true)) + "` | " +
    Cell(values) + " | " + (isDefaultShared ? Cell(option.get_default_str()) : "by command") +
    " | " + Cell(WholeHelp(option)) +
    (option.get_required() && uses.size() == 1 ? " (required)" : "") + " | " +
    where[static_cast<std::size_t>(declaration.Where)] + " |";
  if (uses.size() == 1)
  {
    return row + "\n";
  }
  std::string commands;
  for (const Use& use : uses)
  {
    commands += (commands.empty() ? "" : ", ") + use.By->get_name();
  }
  return row + " " + commands + " |\n";
}

constexpr const char* TableHead = "\n| option | value | default | meaning | shown in |";
constexpr const char* TableRule = "\n|---|---|---|---|---|";
}

std::string CaseFileSchema(const CLI::App& application)
{
  Json schema{ { "$schema", "https://json-schema.org/draft/2020-12/schema" },
    { "title", "Case files of mammoray (--config)" },
    { "description",
      "Made by mammoray --print-schema from the declared options. A case file names "
      "its command by \"$schema\": \"case.schema.json#/$defs/register\"." } };
  Json any = Json::array();
  Json definitions = Json::object();
  for (const Command* command : CommandsOf(application))
  {
    Json properties{ { "$schema", { { "type", "string" } } } };
    for (const Declaration& declaration : command->Declarations)
    {
      if (declaration.IsSetting())
      {
        properties[declaration.Name()] = SettingSchema(declaration);
      }
    }
    any.push_back({ { "$ref", "#/$defs/" + command->get_name() } });
    definitions[command->get_name()] = { { "type", "object" }, { "additionalProperties", false },
      { "properties", properties } };
  }
  schema["anyOf"] = any;
  schema["$defs"] = definitions;
  return schema.dump(1) + "\n";
}

std::string OptionTables(const CLI::App& application)
{
  const std::vector<const Command*> commands = CommandsOf(application);
  std::map<std::string, std::vector<Use>> uses;
  std::size_t offered = 0;
  for (const Command* command : commands)
  {
    offered += command->Declarations.size();
    for (const Declaration& declaration : command->Declarations)
    {
      uses[Identity(declaration)].push_back({ command, &declaration });
    }
  }
  std::string shared;
  std::string others;
  for (const Command* command : commands)
  {
    std::string own;
    for (const Declaration& declaration : command->Declarations)
    {
      const std::vector<Use>& of = uses[Identity(declaration)];
      if (of.size() == 1)
      {
        own += Row(of);
      }
      else if (of.front().By == command)
      {
        shared += Row(of);
      }
    }
    others += "\n## " + command->get_name() + "\n" +
      (own.empty() ? std::string("\nShared options only.\n")
                   : TableHead + std::string(TableRule) + "\n" + own);
  }
  return "# Options\n\nMade by `mammoray --print-options` from the declared options. " +
    std::to_string(uses.size()) + " options; counted for each command that takes them, " +
    std::to_string(offered) +
    ".\nThe case file (`--config FILE.json`) takes all of them by name without dashes; those shown "
    "in \"case file\" are set there only.\n\n## Shared by several commands\n" +
    TableHead + " commands |" + TableRule + "---|\n" + shared + others;
}
}
