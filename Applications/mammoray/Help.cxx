// SPDX-License-Identifier: Apache-2.0
#include "Help.h"

#include "OptionList.h"
#include "mammoray/Foundation/SpellingSuggestions.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
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

/// Width of the column of names and types, characters.
constexpr std::size_t NameColumn = 30;

/// "--thickness mm", and words where they fit.
std::string NameAndType(const Declaration& declaration)
{
  const CLI::Option& option = *declaration.Option;
  std::string text = "  " + option.get_name(option.get_positional(), true);
  if (declaration.IsFlag())
  {
    return text;
  }
  const std::string words = CLI::detail::join(declaration.Words, "|");
  // A type with '=' says by itself that there may be several.
  const bool isSeries = declaration.IsList() && option.get_expected_min() == 1 &&
    option.get_type_name().find('=') == std::string::npos;
  const std::string more = isSeries ? " ..." : "";
  const bool fits = !words.empty() && text.size() + words.size() + more.size() + 3 <= NameColumn;
  return text + " " + (fits ? words : words.empty() ? option.get_type_name() : "WORD") + more;
}

/// " (greater than 0; default 50)", or nothing.
std::string ValueRemark(const Declaration& declaration, bool withRange)
{
  const std::string range = withRange ? declaration.Numbers.Range() : "";
  const std::string standard = declaration.Option->get_default_str();
  std::string text = range;
  text += standard.empty() ? "" : (text.empty() ? "" : "; ") + ("default " + standard);
  text +=
    declaration.Option->get_required() ? (text.empty() ? "" : "; ") + std::string("required") : "";
  return text.empty() ? "" : " (" + text + ")";
}

std::string Entry(const Declaration& declaration, bool all)
{
  const CLI::Option& option = *declaration.Option;
  const std::string name = NameAndType(declaration);
  std::string text = all ? declaration.Help()
                         : option.get_description().substr(0, option.get_description().find('\n'));
  if (!declaration.Words.empty() && name.find('|') == std::string::npos)
  {
    text += ": " + CLI::detail::join(declaration.Words, ", ");
  }
  text += ValueRemark(declaration, all);
  const std::string gap = name.size() + 2 <= NameColumn ? std::string(NameColumn - name.size(), ' ')
                                                        : "\n" + std::string(NameColumn, ' ');
  return name + gap + text + "\n";
}

class HelpFormatter : public CLI::Formatter
{
public:
  std::string make_help(const CLI::App* app, std::string name,
    CLI::AppFormatMode mode) const override
  {
    const auto* command = dynamic_cast<const Command*>(app);
    const std::string text = command
      ? this->CommandHelp(*command, name, mode == CLI::AppFormatMode::All)
      : CLI::Formatter::make_help(app, name, CLI::AppFormatMode::Normal);
    return Wrapped(text, TerminalWidth());
  }

  /// In the list of commands the first line of what it does is enough.
  std::string make_subcommand(const CLI::App* command) const override
  {
    const std::string& description = command->get_description();
    std::ostringstream entry;
    CLI::detail::format_help(entry, command->get_name(),
      description.substr(0, description.find('\n')), NameColumn);
    return entry.str();
  }

private:
  std::string CommandHelp(const Command& command, const std::string& name, bool all) const
  {
    std::vector<std::pair<std::string, std::string>> sections;
    std::size_t experts = 0;
    std::size_t settings = 0;
    for (const Declaration& declaration : command.Declarations)
    {
      experts += declaration.Where == Shown::InHelpAll && !all ? 1 : 0;
      settings += declaration.Where == Shown::InCaseFile ? 1 : 0;
      if (declaration.Where == Shown::InHelp || (declaration.Where == Shown::InHelpAll && all))
      {
        const std::string& heading = declaration.Option->get_group();
        auto section = std::find_if(sections.begin(), sections.end(),
          [&heading](const auto& known) { return known.first == heading; });
        section = section != sections.end() ? section : sections.insert(section, { heading, "" });
        section->second += Entry(declaration, all);
      }
    }
    std::string text = this->make_description(&command) + this->make_usage(&command, name);
    for (const auto& [heading, entries] : sections)
    {
      text += "\n" + heading + ":\n" + entries;
    }
    text += "\n";
    text += experts > 0 ? "--help-all lists " + std::to_string(experts) + " more options.\n" : "";
    text += settings > 0
      ? "The case file (--config) has " + std::to_string(settings) + " further settings.\n"
      : "";
    return text + this->make_footer(&command);
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

void CheckWords(const CLI::App& application, const std::vector<std::string>& words)
{
  if (words.empty() || words.front().starts_with('-'))
  {
    return;
  }
  std::vector<std::string> known;
  const CLI::App* found = nullptr;
  for (const CLI::App* candidate : application.get_subcommands({}))
  {
    known.push_back(candidate->get_name());
    found = candidate->get_name() == words.front() ? candidate : found;
  }
  if (!found)
  {
    throw CLI::ValidationError(
      "unknown command '" + words.front() + "'; " + SpellingHint(words.front(), known));
  }
  const auto* command = dynamic_cast<const Command*>(found);
  if (!command) // not in this build
  {
    return;
  }
  std::vector<std::string> options{ "--help", "--help-all" };
  for (const Declaration& declaration : command->Declarations)
  {
    if (declaration.Where != Shown::InCaseFile && !declaration.Option->get_positional())
    {
      options.push_back("--" + declaration.Name());
    }
  }
  for (std::size_t word = 1; word < words.size(); ++word)
  {
    const std::string name = words[word].substr(0, words[word].find('='));
    if (!name.starts_with("--") || name.size() == 2 ||
      std::find(options.begin(), options.end(), name) != options.end())
    {
      continue;
    }
    throw CLI::ValidationError(command->Find(name.substr(2))
        ? name + ": expected it in the case file (--config FILE.json), found it as an option"
        : "unknown option '" + name + "'; " + SpellingHint(name, options));
  }
}

void SetUpHelp(CLI::App& application)
{
  const auto formatter = std::make_shared<HelpFormatter>();
  application.formatter(formatter);
  for (CLI::App* command : application.get_subcommands({}))
  {
    command->formatter(formatter);
  }
}
}
