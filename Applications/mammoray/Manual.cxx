// SPDX-License-Identifier: Apache-2.0
#include "Manual.h"

#include "Help.h"
#include "OptionList.h"
#include "OptionTables.h"
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

std::string Entry(const Declaration& declaration)
{
  const CLI::Option& option = *declaration.Option;
  std::string entry = ".TP\n";
  if (declaration.Where == Shown::InCaseFile || option.get_positional())
  {
    entry += "\\fB" + Roff(declaration.Name()) + "\\fR";
  }
  else
  {
    std::string names;
    for (const std::string& name : NamesOf(option))
    {
      names += (names.empty() ? "" : ", ") + ("\\fB" + Roff(name) + "\\fR");
    }
    entry += names;
  }
  const std::string type =
    declaration.Words.empty() ? option.get_type_name() : CLI::detail::join(declaration.Words, "|");
  if (!declaration.IsFlag() && !type.empty())
  {
    entry += " \\fI" + Roff(type) + "\\fR";
  }
  return entry + Roff(ValueRemark(declaration, true)) + "\n" + Roff(WholeHelp(option)) + "\n";
}

std::string OptionSections(const Command& command)
{
  const auto headingOf = [](const Declaration& declaration)
  {
    return declaration.Where == Shown::InCaseFile ? "Settings of the case file (--config)"
                                                  : declaration.Option->get_group();
  };
  std::vector<std::string> headings;
  for (const Declaration& declaration : command.Declarations)
  {
    if (std::find(headings.begin(), headings.end(), headingOf(declaration)) == headings.end())
    {
      headings.push_back(headingOf(declaration));
    }
  }
  std::string text;
  for (const std::string& heading : headings)
  {
    text += ".SH " + Roff(UpperCase(heading)) + "\n";
    for (const Declaration& declaration : command.Declarations)
    {
      text += headingOf(declaration) == heading ? Entry(declaration) : "";
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
}

std::string ManualPage(const CLI::App& application, const std::string& command)
{
  if (!command.empty())
  {
    const CLI::App& found = FindCommand(application, command);
    const auto* declared = dynamic_cast<const Command*>(&found);
    return Header("mammoray-" + command, FirstLine(found.get_description())) +
      ".SH SYNOPSIS\n\\fBmammoray " + Roff(command) + "\\fR [\\fIOPTIONS\\fR]\n.SH DESCRIPTION\n" +
      Roff(found.get_description()) + "\n" +
      (declared ? OptionSections(*declared) : std::string()) +
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
  for (const CLI::App* known : Commands(application))
  {
    const auto* command = dynamic_cast<const Command*>(known);
    const std::string& name = known->get_name();
    commands += (commands.empty() ? "" : " ") + name;
    std::string names = "--help --help-all";
    for (const Declaration& declaration :
      command ? command->Declarations : std::vector<Declaration>())
    {
      if (declaration.Where == Shown::InCaseFile)
      {
        continue;
      }
      for (const std::string& spelling : NamesOf(*declaration.Option))
      {
        names += " " + spelling;
        if (!declaration.Words.empty())
        {
          values += "    '" + name + " " + spelling + "') words='" +
            CLI::detail::join(declaration.Words, " ") + "' ;;\n";
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
  const auto add =
    [&application](const char* name, std::string (*print)(const CLI::App&), const char* help)
  {
    application
      .add_flag_callback(
        name,
        [&application, print]()
        {
          std::fputs(print(application).c_str(), stdout);
          throw CLI::Success();
        },
        help)
      ->trigger_on_parse();
  };
  add("--print-completion", CompletionScript, "print the completion script for bash, and stop");
  add("--print-schema", CaseFileSchema, "print the JSON schema of case files, and stop");
  add("--print-options", OptionTables, "print tables of all options (Markdown), and stop");
}
}
