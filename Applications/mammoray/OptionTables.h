// SPDX-License-Identifier: Apache-2.0
// What the repository keeps of the declared options.
#ifndef mammoray_OptionTables_h
#define mammoray_OptionTables_h

#include <string>

namespace CLI
{
class App;
}

namespace mammoray
{
/// JSON schema of the case files that --config reads, with one definition for each command:
/// Data/case.schema.json.
std::string CaseFileSchema(const CLI::App& application);

/// All options in Markdown, those of several commands once: docs/options.md.
std::string OptionTables(const CLI::App& application);
}

#endif
