// SPDX-License-Identifier: Apache-2.0
#include "ProgramOptions.h"

#include "OptionList.h"
#include "mammoray/Foundation/SpellingSuggestions.h"
#include "mammoray/Foundation/ValidRange.h"

#include <cstdio>
#include <filesystem>
#include <fstream>

namespace mammoray
{
namespace
{
using Json = nlohmann::ordered_json;

/// The value of an option that was given, else its default; null if it has none.
Json ValueOf(const Declaration& declaration)
{
  const CLI::Option& option = *declaration.Option;
  if (declaration.IsFlag())
  {
    return option.count() > 0;
  }
  if (option.count() == 0)
  {
    return declaration.PrintsDefault ? declaration.Default() : Json();
  }
  Json values = Json::array();
  for (const std::string& result : option.results())
  {
    values.push_back(declaration.ToJson(result));
  }
  return values.size() == 1 ? values.front() : values;
}

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

/// The path beside the case file where there is something, else as it was given.
std::string BesideOrAsGiven(const std::string& path, const std::filesystem::path& folder)
{
  std::error_code ignored;
  const std::filesystem::path beside = folder / path; // an absolute path stays what it is
  return !path.empty() && std::filesystem::exists(beside, ignored) ? beside.string() : path;
}

/// The words that would be given on the command line.
std::vector<std::string> WordsOf(const Json& value, const std::string& where)
{
  std::vector<std::string> words;
  for (const Json& element : value.is_array() ? value : Json::array({ value }))
  {
    if (element.is_structured() || element.is_null())
    {
      throw CLI::ConversionError(where + ": expected a value or a list of values");
    }
    words.push_back(element.is_string() ? element.get<std::string>() : element.dump());
  }
  return words;
}

/// Gives an option that the command line left out its value from the file.
void SetFromFile(const Declaration& declaration, const Json& value, const std::string& path)
{
  const std::string where = path + ": " + declaration.Name();
  std::vector<std::string> words = WordsOf(value, where);
  CLI::Option& option = *declaration.Option;
  if (declaration.IsFlag())
  {
    if (!value.is_boolean())
    {
      throw CLI::ConversionError(where + ": expected true or false, found " + value.dump());
    }
    if (!value.get<bool>())
    {
      return;
    }
  }
  else if (declaration.IsInput())
  {
    for (std::string& word : words)
    {
      word = BesideOrAsGiven(word, std::filesystem::path(path).parent_path());
    }
  }
  option.add_result(words);
  option.run_callback();
}

void ReadCaseFile(const Command& command, const std::string& path)
{
  std::vector<std::string> settings;
  for (const Declaration& declaration : command.Declarations)
  {
    if (declaration.IsSetting())
    {
      settings.push_back(declaration.Name());
    }
  }
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
        path + ": unknown option '" + key + "'; " + SpellingHint(key, settings));
    }
    if (declaration->Option->count() == 0)
    {
      SetFromFile(*declaration, value, path);
    }
  }
}
}

void ProgramOptions::ApplyTo(LabelSource& labels) const
{
  labels.AxesAsGiven = this->AxesAsGiven;
  labels.AcceptUnusual = this->AcceptUnusual;
}

ProgramOptions& Program()
{
  static ProgramOptions options;
  return options;
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

void AddProgramOptions(Command& command)
{
  const OptionList add = OptionList(command).Group(ProgramHeading);
  const OptionList expert = add.Expert();
  ProgramOptions& program = Program();
  add.Flag("--overwrite", program.Overwrite, "replace outputs that are there already");
  expert("--device", program.Projector.Device,
    "part of the Vulkan device's name (see mammoray devices)\n(default: MAMMORAY_DEVICE, else the "
    "most capable one)");
  using Method = ProjectorOptions::Method;
  expert.Choice<Method>("--projector", program.Projector.Projection,
    { { "auto", Method::Auto }, { "ray-tracing", Method::RayTracing },
      { "rasterisation", Method::Rasterisation } },
    "how path lengths are found; auto: by rays where hardware traces them");
  expert.Flag("--axes-as-given", program.AxesAsGiven,
    "take the axes of volumes' headers as they are, with no conversion to LPS");
  expert.Flag("--accept-unusual", program.AcceptUnusual,
    "accept values that no patient has, such as voxels of 100 mm\n(a refusal says where it is "
    "needed)");
  // The last two read and print what the options above them were given.
  add.Keep({ command
               .add_option_function<std::string>(
                 "--config", [&command](const std::string& path) { ReadCaseFile(command, path); },
                 "read options from a case file (.json)")
               ->check(CLI::Validator(CLI::ExistingFile).description(""))
               ->type_name(FileTypeName)
               ->configurable(false),
    Shown::InHelp });
  const auto print = [&command]
  {
    std::fputs(PrintedConfiguration(command).c_str(), stdout);
    throw CLI::Success();
  };
  expert.Keep(
    { command
        .add_flag_callback("--print-config", print, "print the options as a case file, and stop")
        ->configurable(false)
        ->trigger_on_parse(false),
      Shown::InHelpAll, "boolean" });
}
}
