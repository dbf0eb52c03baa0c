// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Schema_h
#define mammoray_Schema_h

#include <string>

namespace CLI
{
class App;
}

namespace mammoray
{
/**
 * The declared options as JSON: Data/case.schema.json. It is the JSON schema of the case files that
 * --config reads, with a definition for each command and one for the options of every command
 * ("program"), and it has what writeReference.py needs beside that: "group", "short", "value"
 * (what help shows in place of a type), "shown" ("--help", "--help-all" or "case file"),
 * "mandatory", "positional", and of commands "example".
 */
std::string CaseFileSchema(const CLI::App& application);
}

#endif
