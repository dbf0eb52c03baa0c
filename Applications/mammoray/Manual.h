// SPDX-License-Identifier: Apache-2.0
// Manual pages and shell completion, made of the same declarations as --help.
#ifndef mammoray_Manual_h
#define mammoray_Manual_h

#include <string>

namespace CLI
{
class App;
}

namespace mammoray
{
/// The manual page of the program (an empty name: its commands) or of a command, for man(1).
/// Throws InputError, with near names, for an unknown command.
std::string ManualPage(const CLI::App& application, const std::string& command);

/// A script for bash-completion: commands, their options, and the words of an option that takes one
/// of some.
std::string CompletionScript(const CLI::App& application);

/// Adds --print-manual and --print-completion, which packages are made with, and --print-schema and
/// --print-options (OptionTables.h). Call it after the commands are added.
void AddManualOptions(CLI::App& application);
}

#endif
