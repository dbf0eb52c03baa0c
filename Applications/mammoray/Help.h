// SPDX-License-Identifier: Apache-2.0
// Help texts, and spelling suggestions for unknown words.
#ifndef mammoray_Help_h
#define mammoray_Help_h

#include <string>
#include <vector>

namespace CLI
{
class App;
}

namespace mammoray
{
/// Gives every command help that is as wide as the terminal (elsewhere as COLUMNS says, else 100).
/// Call it after the commands are added.
void SetUpHelp(CLI::App& application);

/// Lines that are longer than `width` are broken between words and go on below where they began, or
/// below their second column.
std::string Wrapped(const std::string& text, std::size_t width);

/// Throws CLI::ValidationError, with near names, for a first word that is no command and for words
/// that look like options which the command does not have: CLI11 would only say what it misses.
void CheckWords(const CLI::App& application, const std::vector<std::string>& words);
}

#endif
