// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Configuration_h
#define mammoray_Configuration_h

namespace CLI
{
class App;
}

namespace mammoray
{
/// What --help says in the place of a type of the options that name something to read.
constexpr const char* InputTypeName = "PATH";

/**
 * Adds --config FILE.json and --print-config to a sub-command. Keys of the file are the long option
 * names without dashes; an option on the command line wins over the file. What is to be read
 * (options of InputTypeName) is looked for beside the file first, so that a folder with its
 * configuration can be moved, then in the working folder. Call it after the options are added.
 */
void AddConfigurationOptions(CLI::App& command);
}

#endif
