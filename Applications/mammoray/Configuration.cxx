// SPDX-License-Identifier: Apache-2.0
#include "Configuration.h"

#include "Help.h"
#include "mammoray/Foundation/SpellingSuggestions.h"
#include "mammoray/Foundation/ValidRange.h"

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace mammoray
{
namespace
{
std::string JsonScalar(const nlohmann::json& value, const std::string& key)
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

/// CLI11 reads and prints configuration through this; see AddConfigurationOptions for the format.
class JsonConfiguration : public CLI::Config
{
public:
  std::string to_config(const CLI::App* command, bool withDefaults, bool /*descriptions*/,
    std::string) const override
  {
    nlohmann::ordered_json values = nlohmann::ordered_json::object();
    for (const CLI::Option* option : command->get_options({}))
    {
      if (option->get_lnames().empty() || !option->get_configurable())
      {
        continue;
      }
      const std::string name = option->get_lnames().front();
      if (option->get_type_size() == 0)
      {
        values[name] = option->count() > 0;
      }
      else if (option->count() == 1)
      {
        values[name] = AsJson(option->results().front());
      }
      else if (option->count() > 1)
      {
        for (const std::string& result : option->results())
        {
          values[name].push_back(AsJson(result));
        }
      }
      else if (withDefaults && !option->get_default_str().empty())
      {
        values[name] = DefaultAsJson(*option);
      }
    }
    return values.dump(2) + "\n";
  }

  std::vector<CLI::ConfigItem> from_config(std::istream& input) const override
  {
    nlohmann::json values;
    try
    {
      values = nlohmann::json::parse(input, mammoray::JsonNestingLimit{ "configuration" });
    }
    catch (const nlohmann::json::exception& error)
    {
      throw CLI::ConversionError(std::string("configuration: not JSON: ") + error.what());
    }
    if (!values.is_object())
    {
      throw CLI::ConversionError("configuration: expected a JSON object of options");
    }
    std::vector<CLI::ConfigItem> entries;
    for (const auto& [key, value] : values.items())
    {
      CLI::ConfigItem item;
      item.name = key;
      if (value.is_array())
      {
        for (const auto& element : value)
        {
          item.inputs.push_back(JsonScalar(element, key));
        }
      }
      else
      {
        item.inputs.push_back(JsonScalar(value, key));
      }
      entries.push_back(item);
    }
    return entries;
  }

private:
  /// CLI11 writes the default of a list as [a,b].
  static nlohmann::ordered_json DefaultAsJson(const CLI::Option& option)
  {
    const std::string& text = option.get_default_str();
    if (option.get_expected_max() == 1 || text.front() != '[' || text.back() != ']')
    {
      return AsJson(text);
    }
    nlohmann::ordered_json values = nlohmann::ordered_json::array();
    for (const std::string& value : CLI::detail::split(text.substr(1, text.size() - 2), ','))
    {
      values.push_back(AsJson(value));
    }
    return values;
  }

  static nlohmann::ordered_json AsJson(const std::string& text)
  {
    if (nlohmann::ordered_json::accept(text))
    {
      auto value = nlohmann::ordered_json::parse(text);
      if (value.is_number() || value.is_boolean())
      {
        return value;
      }
    }
    return text;
  }
};

/// The path beside the configuration file where there is something, else as it was given.
std::string BesideOrAsGiven(const std::string& path, const std::filesystem::path& folder)
{
  std::error_code ignored;
  const std::filesystem::path beside = folder / path; // an absolute path stays what it is
  return !path.empty() && std::filesystem::exists(beside, ignored) ? beside.string() : path;
}

/// Gives the options that the command line left out their values from the file.
void ReadConfiguration(CLI::App& command, const std::string& path)
{
  const std::filesystem::path folder = std::filesystem::path(path).parent_path();
  for (CLI::ConfigItem& item : JsonConfiguration().from_file(path))
  {
    CLI::Option* option = command.get_option_no_throw("--" + item.name);
    if (!option)
    {
      throw CLI::ConversionError(path + ": unknown option '" + item.name + "'; " +
        SpellingHint("--" + item.name, LongOptions(command)));
    }
    if (!option->get_configurable())
    {
      throw CLI::ConfigError::NotConfigurable(item.name);
    }
    if (option->count() > 0)
    {
      continue;
    }
    if (option->get_type_size() > 0)
    {
      if (option->get_type_name() == InputTypeName)
      {
        for (std::string& input : item.inputs)
        {
          input = BesideOrAsGiven(input, folder);
        }
      }
      option->add_result(item.inputs);
      option->run_callback();
    }
    else if (item.inputs != std::vector<std::string>{ "false" })
    {
      option->add_result(option->get_flag_value(item.name, JsonConfiguration().to_flag(item)));
      option->run_callback();
    }
  }
}
}

void AddConfigurationOptions(CLI::App& command)
{
  command.config_formatter(std::make_shared<JsonConfiguration>());
  // Not set_config: CLI11 reads configuration for the application only, never for a sub-command.
  command
    .add_option_function<std::string>(
      "--config", [&command](const std::string& path) { ReadConfiguration(command, path); },
      "read options from a JSON file")
    ->check(CLI::ExistingFile)
    ->configurable(false);
  command
    .add_flag_callback(
      "--print-config",
      [&command]()
      {
        std::fputs(command.config_to_str(true, false).c_str(), stdout);
        throw CLI::Success();
      },
      "print the options as JSON for --config, and stop")
    ->configurable(false)
    ->trigger_on_parse(false);
}
}
