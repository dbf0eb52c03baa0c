// SPDX-License-Identifier: Apache-2.0
#include "Manual.h"

#include "Help.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/SpellingSuggestions.h"

#include <CLI/CLI.hpp>

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <string>
#include <vector>

namespace mammoray
{
namespace
{
/// Text as roff takes it: no hyphen that breaks an option, no line that is a request.
std::string Roff(const std::string& text)
{
  std::string roff;
  for (const char letter : text)
  {
    if ((letter == '.' || letter == '\'') && (roff.empty() || roff.back() == '\n'))
    {
      roff += "\\&";
    }
    roff += letter == '-' ? "\\-" : letter == '\\' ? "\\e" : std::string(1, letter);
  }
  return roff;
}

std::string UpperCase(std::string text)
{
  std::transform(text.begin(), text.end(), text.begin(),
    [](unsigned char letter) { return static_cast<char>(std::toupper(letter)); });
  return text;
}

std::vector<const CLI::App*> Commands(const CLI::App& application)
{
  const auto commands = application.get_subcommands(
    [](const CLI::App* command) { return !command->get_name().empty(); });
  return { commands.begin(), commands.end() };
}

/// Hidden options have no group.
std::vector<const CLI::Option*> ShownOptionsOf(const CLI::App& command)
{
  std::vector<const CLI::Option*> options = OptionsOf(command);
  std::erase_if(options, [](const CLI::Option* option) { return option->get_group().empty(); });
  return options;
}

/// "-o", "--output".
std::vector<std::string> NamesOf(const CLI::Option& option)
{
  std::vector<std::string> names;
  for (const std::string& name : option.get_snames())
  {
    names.push_back("-" + name);
  }
  for (const std::string& name : option.get_lnames())
  {
    names.push_back("--" + name);
  }
  return names;
}

std::string Entry(const CLI::Option& option)
{
  std::string names;
  for (const std::string& name : NamesOf(option))
  {
    names += (names.empty() ? "" : ", ") + ("\\fB" + Roff(name) + "\\fR");
  }
  std::string entry = ".TP\n" + names;
  if (!option.get_type_name().empty())
  {
    entry += " \\fI" + Roff(option.get_type_name()) + "\\fR";
  }
  if (!option.get_default_str().empty())
  {
    entry += " (default: " + Roff(option.get_default_str()) + ")";
  }
  return entry + (option.get_required() ? " (required)" : "") + "\n" +
    Roff(option.get_description()) + "\n";
}

std::string OptionSections(const CLI::App& command)
{
  std::vector<std::string> headings;
  const std::vector<const CLI::Option*> options = ShownOptionsOf(command);
  for (const CLI::Option* option : options)
  {
    if (std::find(headings.begin(), headings.end(), option->get_group()) == headings.end())
    {
      headings.push_back(option->get_group());
    }
  }
  std::string text;
  for (const std::string& heading : headings)
  {
    text += ".SH " + Roff(UpperCase(heading)) + "\n";
    for (const CLI::Option* option : options)
    {
      text += option->get_group() == heading ? Entry(*option) : "";
    }
  }
  return text;
}

std::string FirstLine(const std::string& text)
{
  std::string line = text.substr(0, text.find('\n'));
  line.erase(line.find_last_not_of(".:") + 1);
  return line;
}

std::string Header(const std::string& name, const std::string& purpose)
{
  return ".TH " + UpperCase(Roff(name)) +
    " 1 \"\" \"MammoRay " MAMMORAY_VERSION "\" \"User Commands\"\n.SH NAME\n" + Roff(name) +
    " \\- " + Roff(purpose) + "\n";
}

const CLI::App& FindCommand(const CLI::App& application, const std::string& name)
{
  std::vector<std::string> known;
  for (const CLI::App* command : Commands(application))
  {
    if (command->get_name() == name)
    {
      return *command;
    }
    known.push_back(command->get_name());
  }
  throw InputError("--print-manual: unknown command '" + name + "'; " + SpellingHint(name, known));
}

/// The words of "TEXT:{left,right}"; none where it takes anything else.
std::string WordsOf(const CLI::Option& option)
{
  const std::string type = option.get_type_name();
  const std::size_t begin = type.find('{');
  const std::size_t end = type.find('}', begin);
  if (begin == std::string::npos || end == std::string::npos)
  {
    return "";
  }
  std::string words = type.substr(begin + 1, end - begin - 1);
  std::replace(words.begin(), words.end(), ',', ' ');
  return words;
}
}

std::string ManualPage(const CLI::App& application, const std::string& command)
{
  if (!command.empty())
  {
    const CLI::App& found = FindCommand(application, command);
    return Header("mammoray-" + command, FirstLine(found.get_description())) +
      ".SH SYNOPSIS\n\\fBmammoray " + Roff(command) + "\\fR [\\fIOPTIONS\\fR]\n.SH DESCRIPTION\n" +
      Roff(found.get_description()) + "\n" + OptionSections(found) +
      ".SH SEE ALSO\n\\fBmammoray\\fR(1)\n";
  }
  std::string page =
    Header("mammoray", "synthetic X-rays of meshes, registration of breast MRI with mammograms") +
    ".SH SYNOPSIS\n\\fBmammoray\\fR \\fICOMMAND\\fR [\\fIOPTIONS\\fR]\n.SH DESCRIPTION\n" +
    Roff(application.get_description()) + "\n.SH COMMANDS\n";
  std::string others;
  for (const CLI::App* known : Commands(application))
  {
    page += ".TP\n\\fB" + Roff(known->get_name()) + "\\fR\n" +
      Roff(FirstLine(known->get_description())) + "\n";
    others += (others.empty() ? "" : ", ") + ("\\fBmammoray\\-" + known->get_name() + "\\fR(1)");
  }
  return page +
    ".SH EXIT STATUS\n0: done; 1: refused or failed, with one line that says why; 2: wrong usage.\n"
    ".SH ENVIRONMENT\n.TP\n\\fBMAMMORAY_DEVICE\\fR\npart of the name of the Vulkan device to use\n"
    ".TP\n\\fBMAMMORAY_DATA\\fR\nfolder of attenuation tables, spectra and material tables in "
    "place "
    "of the shipped one\n.SH SEE ALSO\n" +
    others + "\n";
}

std::string CompletionScript(const CLI::App& application)
{
  std::string commands;
  std::string values;
  std::string options;
  for (const CLI::App* command : Commands(application))
  {
    const std::string& name = command->get_name();
    commands += (commands.empty() ? "" : " ") + name;
    std::string names;
    for (const CLI::Option* option : ShownOptionsOf(*command))
    {
      for (const std::string& spelling : NamesOf(*option))
      {
        names += (names.empty() ? "" : " ") + spelling;
        if (const std::string words = WordsOf(*option); !words.empty())
        {
          values += "    '" + name + " " + spelling + "') words='" + words + "' ;;\n";
        }
      }
    }
    options += "    " + name + ") options='" + names + "' ;;\n";
  }
  return "# bash completion for mammoray\n"
         "_mammoray() {\n"
         "  local current=${COMP_WORDS[COMP_CWORD]} words='' options=''\n"
         "  if [ \"$COMP_CWORD\" -eq 1 ]; then\n"
         "    mapfile -t COMPREPLY < <(compgen -W '" +
    commands +
    " --help --version' -- \"$current\")\n"
    "    return\n"
    "  fi\n"
    "  case \"${COMP_WORDS[1]} ${COMP_WORDS[COMP_CWORD-1]}\" in\n" +
    values +
    "  esac\n"
    "  case \"${COMP_WORDS[1]}\" in\n" +
    options +
    "  esac\n"
    "  if [ -n \"$words\" ]; then\n"
    "    mapfile -t COMPREPLY < <(compgen -W \"$words\" -- \"$current\")\n"
    "  elif [[ $current == -* ]]; then\n"
    "    mapfile -t COMPREPLY < <(compgen -W \"$options\" -- \"$current\")\n"
    "  fi\n"
    "} && complete -o default -F _mammoray mammoray\n";
}

void AddManualOptions(CLI::App& application)
{
  application
    .add_option_function<std::string>(
      "--print-manual",
      [&application](const std::string& command)
      {
        std::fputs(ManualPage(application, command == "mammoray" ? "" : command).c_str(), stdout);
        throw CLI::Success();
      },
      "--print-manual=COMMAND: print its manual page, or that of 'mammoray', and stop")
    ->type_name("COMMAND")
    ->trigger_on_parse();
  application.add_flag_callback(
    "--print-completion",
    [&application]()
    {
      std::fputs(CompletionScript(application).c_str(), stdout);
      throw CLI::Success();
    },
    "print the completion script for bash, and stop");
  application.get_option("--print-completion")->trigger_on_parse();
}
}
