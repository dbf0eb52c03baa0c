// SPDX-License-Identifier: Apache-2.0
#include "Help.h"

#include "mammoray/Foundation/SpellingSuggestions.h"

#include <CLI/CLI.hpp>

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <memory>
#include <sstream>
#include <utility>

namespace mammoray
{
namespace
{
constexpr std::size_t UsualWidth = 100;
constexpr std::size_t LeastWidth = 50;

/// One for each command, on files of one's own or, where it needs none, as it stands.
constexpr std::pair<const char*, const char*> Examples[] = {
  { "compress",
    "compress --mesh breast.vtu --materials victre --orientation ALS --thickness 50 -o "
    "compressed.vtu" },
  { "demo", "demo" },
  { "devices", "devices" },
  { "dicom", "dicom --result result --mammogram mg.dcm -o synthetic.dcm" },
  { "displacement", "displacement --result result -o displacement.nrrd" },
  { "evaluate", "evaluate --result result --landmarks landmarks.csv" },
  { "example", "example breast -o example" },
  { "fetch", "fetch --pacs pacs.example.org:104 --accession A123 -o export" },
  { "fuse",
    "fuse --result result --image t1-series/ -o compressed.nrrd --maximum-picture maximum.png" },
  { "intake", "intake export/ --side left" },
  { "locate", "locate --result result --point 30 12 -10" },
  { "mesh", "mesh --labels labels.nrrd --materials victre --label-spacing 0.5 -o breast.vtu" },
  { "project", "project --mesh breast.vtu --materials victre --orientation ALS -o breast.mha" },
  { "register", "register --study export/ --side left -o result" },
  { "segment", "segment --image t1-series/ -o labels.nii.gz --picture labels.png" },
  { "send", "send --result result --pacs pacs.example.org:104" },
  { "view", "view --result result" },
};

std::size_t TerminalWidth()
{
  winsize size{};
  std::size_t width = UsualWidth;
  if (ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0)
  {
    width = size.ws_col;
  }
  else if (const char* columns = std::getenv("COLUMNS"))
  {
    width = std::strtoul(columns, nullptr, 10);
  }
  return std::max(width, LeastWidth);
}

class HelpFormatter : public CLI::Formatter
{
public:
  std::string make_help(const CLI::App* command, std::string name,
    CLI::AppFormatMode mode) const override
  {
    return Wrapped(CLI::Formatter::make_help(command, std::move(name), mode), TerminalWidth());
  }

  /// Below an option whose name leaves no two spaces before the second column.
  std::string make_option(const CLI::Option* option, bool positional) const override
  {
    const std::string name =
      "  " + this->make_option_name(option, positional) + this->make_option_opts(option);
    if (name.size() + 2 <= this->get_column_width())
    {
      return CLI::Formatter::make_option(option, positional);
    }
    return name + "\n" + std::string(this->get_column_width(), ' ') +
      this->make_option_desc(option) + "\n";
  }

  /// A group of which one option is required: its description and the options, as of any heading.
  std::string make_expanded(const CLI::App* group) const override
  {
    if (!group->get_name().empty())
    {
      return CLI::Formatter::make_expanded(group);
    }
    std::string text = "\n" + group->get_description() + ":\n";
    text[1] = static_cast<char>(std::toupper(static_cast<unsigned char>(text[1])));
    for (const CLI::Option* option : group->get_options({}))
    {
      text += option == group->get_help_ptr() ? "" : this->make_option(option, false);
    }
    return text;
  }

  /// In the list of commands the first line of what it does is enough.
  std::string make_subcommand(const CLI::App* command) const override
  {
    const std::string& description = command->get_description();
    std::ostringstream entry;
    CLI::detail::format_help(entry, command->get_name(),
      description.substr(0, description.find('\n')), this->get_column_width());
    return entry.str();
  }
};

/// Where a line is broken: at the last space, or behind the last comma of a list without spaces,
/// that leaves `width` or less; at the first one beyond where there is none. Its size: nowhere.
std::size_t BreakOf(const std::string& line, std::size_t indent, std::size_t width)
{
  const auto canBreak = [&](std::size_t place)
  { return line[place] == ' ' || (line[place - 1] == ',' && line[place] != ' '); };
  for (std::size_t place = width; place > indent; --place)
  {
    if (canBreak(place) && line.find_first_not_of(' ') < place)
    {
      return place;
    }
  }
  for (std::size_t place = std::max(width, indent) + 1; place < line.size(); ++place)
  {
    if (canBreak(place))
    {
      return place;
    }
  }
  return line.size();
}

/// Where a line goes on: below its second column, which two spaces part from the first.
std::size_t HangingIndent(const std::string& line)
{
  const std::size_t begin = std::min(line.find_first_not_of(' '), line.size());
  const std::size_t gap = line.find("  ", begin);
  const std::size_t second =
    gap == std::string::npos ? std::string::npos : line.find_first_not_of(' ', gap);
  return second == std::string::npos ? begin : second;
}
}

std::string Wrapped(const std::string& text, std::size_t width)
{
  std::istringstream lines(text);
  std::string wrapped;
  for (std::string line; std::getline(lines, line);)
  {
    const std::string indent(HangingIndent(line), ' ');
    while (line.size() > width)
    {
      const std::size_t place = BreakOf(line, indent.size(), width);
      if (place == line.size())
      {
        break; // one long word
      }
      wrapped += line.substr(0, place) + "\n";
      line = indent + line.substr(place + (line[place] == ' ' ? 1 : 0));
    }
    wrapped += line + "\n";
  }
  return wrapped;
}

std::vector<const CLI::Option*> OptionsOf(const CLI::App& command)
{
  std::vector<const CLI::Option*> options = command.get_options();
  for (const CLI::App* group :
    command.get_subcommands([](const CLI::App* inner) { return inner->get_name().empty(); }))
  {
    const std::vector<const CLI::Option*> inner = OptionsOf(*group);
    options.insert(options.end(), inner.begin(), inner.end());
  }
  return options;
}

std::vector<std::string> LongOptions(const CLI::App& command)
{
  std::vector<std::string> names;
  for (const CLI::Option* option : OptionsOf(command))
  {
    for (const std::string& name : option->get_lnames())
    {
      names.push_back("--" + name);
    }
  }
  return names;
}

void CheckWords(const CLI::App& application, const std::vector<std::string>& words)
{
  if (words.empty() || words.front().starts_with('-'))
  {
    return;
  }
  std::vector<std::string> known;
  const CLI::App* command = nullptr;
  for (const CLI::App* candidate : application.get_subcommands({}))
  {
    known.push_back(candidate->get_name());
    command = candidate->get_name() == words.front() ? candidate : command;
  }
  if (!command)
  {
    throw CLI::ValidationError(
      "unknown command '" + words.front() + "'; " + SpellingHint(words.front(), known));
  }
  const std::vector<std::string> options = LongOptions(*command);
  for (std::size_t word = 1; word < words.size(); ++word)
  {
    const std::string name = words[word].substr(0, words[word].find('='));
    if (name.starts_with("--") && name.size() > 2 &&
      std::find(options.begin(), options.end(), name) == options.end())
    {
      throw CLI::ValidationError("unknown option '" + name + "'; " + SpellingHint(name, options));
    }
  }
}

void SetUpHelp(CLI::App& application)
{
  const auto formatter = std::make_shared<HelpFormatter>();
  application.formatter(formatter);
  for (CLI::App* command : application.get_subcommands({}))
  {
    command->formatter(formatter);
    for (const auto& [name, example] : Examples)
    {
      if (command->get_name() == name)
      {
        command->footer(std::string("Example: mammoray ") + example);
      }
    }
  }
}
}
