// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Configuration_h
#define mammoray_Configuration_h

#include <nlohmann/json_fwd.hpp>

#include <string>

namespace mammoray
{
class Command;
struct Declaration;

/// What help shows in place of a type of the options that name something to read.
constexpr const char* InputTypeName = "PATH";

/**
 * Adds --config FILE.json, which reads a case file, and --print-config, which writes one. Keys of
 * the file are the option names without dashes, and "$schema"; an option on the command line wins
 * over the file. What is to be read (options of InputTypeName) is looked for beside the file first,
 * so that a folder with its case file can be moved, then in the working folder. Call it after the
 * options are added.
 */
void AddConfigurationOptions(Command& command);

/// What --print-config prints.
std::string PrintedConfiguration(const Command& command);

/// The default of an option, null where there is none.
nlohmann::ordered_json DefaultAsJson(const Declaration& declaration);
}

#endif
