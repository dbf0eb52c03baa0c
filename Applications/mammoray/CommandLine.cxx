// SPDX-License-Identifier: Apache-2.0
#include "CommandLine.h"

#include "mammoray/Case/RegisteredBreast.h"

#include <nlohmann/json.hpp>

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>
#include <sstream>

namespace mammoray
{
namespace
{
volatile std::sig_atomic_t interruptCount = 0;

void OnInterrupt(int)
{
  interruptCount = interruptCount + 1;
  if (interruptCount > 1)
  {
    // The second Ctrl-C does what the user is used to.
    std::signal(SIGINT, SIG_DFL);
    std::raise(SIGINT);
  }
}

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

/// CLI11's own ranges take NaN and tell the largest double in full.
template <typename Accepts>
CLI::Validator NumberThat(const Accepts& accepts, const std::string& expected,
  const std::string& forHelp)
{
  return CLI::Validator(
    [accepts, expected](const std::string& text)
    {
      double value = 0;
      const bool isNumber = CLI::detail::lexical_cast(text, value) && std::isfinite(value);
      return isNumber && accepts(value) ? std::string()
                                        : "expected " + expected + ", found " + text;
    },
    forHelp);
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
      values = nlohmann::json::parse(input);
    }
    catch (const nlohmann::json::parse_error& error)
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
}

namespace
{
/// Gives the options that the command line left out their values from the file.
void ReadConfiguration(CLI::App& command, const std::string& path)
{
  for (const CLI::ConfigItem& item : JsonConfiguration().from_file(path))
  {
    CLI::Option* option = command.get_option_no_throw("--" + item.name);
    if (!option)
    {
      throw CLI::ConfigError::Extras(item.name);
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

bool InterruptRequested()
{
  static const bool installed = []
  {
    std::signal(SIGINT, OnInterrupt);
    return true;
  }();
  return installed && interruptCount > 0;
}

ProgressCallback MakeProgressBar()
{
  InterruptRequested(); // from now on, not from the first report on
  const bool terminal = isatty(STDERR_FILENO) != 0;
  auto lastPercent = std::make_shared<int>(-1);
  auto lastStage = std::make_shared<std::string>();
  return [=](double fraction, const char* stage)
  {
    const int percent = std::clamp(static_cast<int>(100 * fraction), 0, 100);
    if (terminal && (percent != *lastPercent || *lastStage != stage))
    {
      const std::string bar(percent / 4, '#');
      std::fprintf(stderr, "\r\033[K%-32s [%-25s] %3d %%", stage, bar.c_str(), percent);
      if (percent == 100)
      {
        std::fputs("\r\033[K", stderr);
      }
      std::fflush(stderr);
      *lastPercent = percent;
      *lastStage = stage;
    }
    return !InterruptRequested();
  };
}

void CheckOutputFile(const std::string& path, bool overwrite)
{
  namespace fs = std::filesystem;
  if (path.empty())
  {
    throw InputError("output: expected a file name, found an empty one");
  }
  const fs::path folder = fs::absolute(fs::path(path)).parent_path();
  if (!fs::is_directory(folder))
  {
    throw InputError("output " + path + ": there is no folder " + folder.string());
  }
  if (access(folder.c_str(), W_OK) != 0)
  {
    throw InputError("output " + path + ": the folder " + folder.string() + " is not writable");
  }
  if (fs::is_directory(path))
  {
    throw InputError("output " + path + ": expected a file name, found a folder");
  }
  if (fs::exists(path) && !overwrite)
  {
    throw InputError("output " + path + ": exists already; --overwrite replaces it");
  }
}

void CheckPictureFile(const std::string& path, bool overwrite)
{
  if (path.empty())
  {
    return;
  }
  CheckOutputFile(path, overwrite);
  if (std::filesystem::path(path).extension() != ".png")
  {
    throw InputError(path + ": expected the extension .png for a picture");
  }
}

CLI::Option* AddLabelOptions(CLI::App& command, LabelSource& source)
{
  CLI::Option* labels = command.add_option("--labels", source.Path,
    "label volume: .nrrd .nhdr .mha .mhd .nii .nii.gz, a DICOM segmentation (.dcm; labels are its "
    "segment numbers) or a folder with a DICOM series");
  command
    .add_option("--crop", source.Crop,
      "voxels of --labels to keep along i, j and k: three times FIRST:LAST, counted from 0, both "
      "included, : for all; e.g. --crop 0:199 : 12:")
    ->expected(3)
    ->needs(labels);
  CLI::Option* skin = command.add_option("--skin", source.Skin,
    "THICKNESS[=MATERIAL]: a layer of that many mm below the air becomes skin (default: the "
    "table's thin material), not at held tissue nor at the volume's border");
  skin->needs(labels);
  command
    .add_option("--cut-side", source.CutSides,
      "i-, i+, j-, j+, k- or k+: end of an axis of --labels at which the tissue was cut flat, "
      "with air behind (before the chest wall, say), and gets no --skin; may be given for several")
    ->needs(skin);
  command
    .add_flag("--axes-as-given", source.AxesAsGiven,
      "take the axes of the header of --labels as they are, with no conversion to LPS")
    ->needs(labels);
  return labels;
}

CLI::Option* AddMaterialsOption(CLI::App& command, std::string& pathOrName)
{
  return command.add_option("--materials", pathOrName,
    "material table: a file (.json) or the name of a shipped one (victre, segment, ...)");
}

CLI::Option* AddProjectorOption(CLI::App& command, std::string& method)
{
  return command
    .add_option("--projector", method,
      "how path lengths are found; auto traces rays on hardware that can and rasterises elsewhere")
    ->check(CLI::IsMember({ "auto", "ray-tracing", "rasterisation" }))
    ->capture_default_str();
}

void WriteComplete(const std::string& path,
  const std::function<void(const std::string& temporary)>& write)
{
  namespace fs = std::filesystem;
  const fs::path target(path);
  // The writer goes by the extension, .nii.gz as one.
  std::string stem = target.stem().string();
  std::string extension = target.extension().string();
  if (extension == ".gz")
  {
    extension = fs::path(stem).extension().string() + extension;
    stem = fs::path(stem).stem().string();
  }
  const fs::path temporary = fs::absolute(target).parent_path() /
    (stem + ".partial-" + std::to_string(getpid()) + extension);
  try
  {
    write(temporary.string());
    fs::rename(temporary, target);
  }
  catch (...)
  {
    std::error_code ignored;
    fs::remove(temporary, ignored);
    throw;
  }
}

CLI::Validator NumberFrom(double least, double most)
{
  std::ostringstream range;
  range << least << " to " << most;
  return NumberThat([least, most](double value) { return value >= least && value <= most; },
    "a number from " + range.str(), range.str());
}

CLI::Validator PositiveNumber()
{
  return NumberThat([](double value) { return value > 0; }, "a number greater than 0", "POSITIVE");
}

CLI::Validator NonNegativeNumber()
{
  return NumberThat([](double value) { return value >= 0; }, "a number not less than 0",
    "NONNEGATIVE");
}

const std::string& CheckInputFile(const std::string& path)
{
  namespace fs = std::filesystem;
  if (!fs::exists(path))
  {
    throw InputError(path + ": no such file");
  }
  if (fs::is_directory(path))
  {
    throw InputError(path + ": expected a file, found a folder");
  }
  if (!std::ifstream(path))
  {
    throw InputError(path + ": cannot be opened for reading");
  }
  return path;
}

void WarnOfDistrust(const std::string& folder)
{
  if (const std::string reason = DistrustOf(folder); !reason.empty())
  {
    std::fprintf(stderr, "mammoray: warning: %s: the match is not to be trusted: %s\n",
      folder.c_str(), reason.c_str());
  }
}
}
