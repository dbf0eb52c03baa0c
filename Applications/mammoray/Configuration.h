// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Configuration_h
#define mammoray_Configuration_h

namespace CLI
{
class App;
}

namespace mammoray
{
/**
 * Adds --config FILE.json and --print-config to a sub-command. Keys of the file are the long option
 * names without dashes; an option on the command line wins over the file. Call it after the options
 * are added.
 */
void AddConfigurationOptions(CLI::App& command);
}

#endif
