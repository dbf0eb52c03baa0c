// SPDX-License-Identifier: Apache-2.0
#include "Configuration.h"

#include "OptionList.h"
#include "mammoray/Foundation/SpellingSuggestions.h"
#include "mammoray/Foundation/ValidRange.h"

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace mammoray
{
namespace
{
using Json = nlohmann::ordered_json;

std::vector<std::string> SettingsOf(const Command& command)
{
  std::vector<std::string> names;
  for (const Declaration& declaration : command.Declarations)
  {
    if (declaration.IsSetting())
    {
      names.push_back(declaration.Name());
    }
  }
  return names;
}

std::string JsonScalar(const Json& value, const std::string& key)
{
  if (value.is_string())
  {
    return value.get<std::string>();
  }
  if (value.is_boolean())
  {
    return value.get<bool>() ? "true" : "false";
  }
  if (value.is_number())
  {
    return value.dump();
  }
  throw CLI::ConversionError(
    "configuration: '" + key + "' is neither a value nor a list of values");
}

/// A number, a truth value or a text.
Json AsJson(const std::string& text)
{
  if (Json::accept(text))
  {
    Json value = Json::parse(text);
    if (value.is_number() || value.is_boolean())
    {
      return value;
    }
  }
  return text;
}
}

Json DefaultAsJson(const Declaration& declaration)
{
  const std::string& text = declaration.Option->get_default_str();
  if (!declaration.IsList() || text.size() < 2 || text.front() != '[')
  {
    return text.empty() ? Json() : AsJson(text);
  }
  // CLI11 writes the default of a list as [a,b].
  Json values = Json::array();
  for (const std::string& value : CLI::detail::split(text.substr(1, text.size() - 2), ','))
  {
    values.push_back(AsJson(value));
  }
  return values;
}

namespace
{
Json ValueOf(const Declaration& declaration)
{
  const CLI::Option& option = *declaration.Option;
  if (declaration.IsFlag())
  {
    return option.count() > 0;
  }
  if (option.count() == 1)
  {
    return AsJson(option.results().front());
  }
  Json values = Json::array();
  for (const std::string& result : option.results())
  {
    values.push_back(AsJson(result));
  }
  return values.empty() ? DefaultAsJson(declaration) : values;
}

}

std::string PrintedConfiguration(const Command& command)
{
  Json values = Json::object();
  for (const Declaration& declaration : command.Declarations)
  {
    if (const Json value = declaration.IsSetting() ? ValueOf(declaration) : Json();
        !value.is_null())
    {
      values[declaration.Name()] = value;
    }
  }
  return values.dump(2) + "\n";
}

namespace
{
Json ReadObject(const std::string& path)
{
  try
  {
    std::ifstream file(path);
    Json values = Json::parse(file, mammoray::JsonNestingLimit{ path });
    if (values.is_object())
    {
      return values;
    }
  }
  catch (const nlohmann::json::exception& error)
  {
    throw CLI::ConversionError(path + ": not JSON: " + error.what());
  }
  throw CLI::ConversionError(path + ": expected a JSON object of options");
}

/// The path beside the configuration file where there is something, else as it was given.
std::string BesideOrAsGiven(const std::string& path, const std::filesystem::path& folder)
{
  std::error_code ignored;
  const std::filesystem::path beside = folder / path; // an absolute path stays what it is
  return !path.empty() && std::filesystem::exists(beside, ignored) ? beside.string() : path;
}

/// Gives the options that the command line left out their values from the file.
void ReadConfiguration(const Command& command, const std::string& path)
{
  const std::filesystem::path folder = std::filesystem::path(path).parent_path();
  const Json values = ReadObject(path);
  for (const auto& [key, value] : values.items())
  {
    if (key == "$schema")
    {
      continue;
    }
    const Declaration* declaration = command.Find(key);
    if (!declaration || !declaration->IsSetting())
    {
      throw CLI::ConversionError(
        path + ": unknown option '" + key + "'; " + SpellingHint(key, SettingsOf(command)));
    }
    CLI::Option& option = *declaration->Option;
    if (declaration->Where == Shown::InCaseFile)
    {
      option.clear(); // CLI11 does it for those of the command line
    }
    if (option.count() > 0)
    {
      continue;
    }
    std::vector<std::string> texts;
    for (const Json& element : value.is_array() ? value : Json::array({ value }))
    {
      const std::string text = JsonScalar(element, key);
      texts.push_back(
        option.get_type_name() == InputTypeName ? BesideOrAsGiven(text, folder) : text);
    }
    if (!declaration->IsFlag())
    {
      option.add_result(texts);
      option.run_callback();
    }
    else if (value == true)
    {
      option.add_result("true");
      option.run_callback();
    }
    else if (value != false)
    {
      throw CLI::ConversionError(
        path + ": " + key + ": expected true or false, found " + value.dump());
    }
  }
}
}

void AddConfigurationOptions(Command& command)
{
  const OptionList add(command);
  add.Keep(
    { command
        .add_option_function<std::string>(
          "--config", [&command](const std::string& path) { ReadConfiguration(command, path); },
          "read options from a case file (.json); docs/options.md lists its keys")
        ->check(CLI::Validator(CLI::ExistingFile).description(""))
        ->type_name("FILE")
        ->configurable(false),
      Shown::InHelp, "string", "", {} });
  // Not at once: what follows it on the line counts, too.
  add.Keep({ command
               .add_flag_callback(
                 "--print-config",
                 [&command]()
                 {
                   std::fputs(PrintedConfiguration(command).c_str(), stdout);
                   throw CLI::Success();
                 },
                 "print the options as JSON for --config, and stop")
               ->configurable(false)
               ->trigger_on_parse(false),
    Shown::InHelpAll, "boolean", "", {} });
}
}
