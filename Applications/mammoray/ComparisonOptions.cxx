// SPDX-License-Identifier: Apache-2.0
#include "ComparisonOptions.h"

#include "CommandLine.h"

#include <string>

namespace mammoray
{
void AddComparisonOptions(CLI::App& command, RegistrationOptions& options)
{
  command
    .add_option_function<std::string>(
      "--residual",
      [&options](const std::string& name) { options.Comparison = ComparisonFromName(name); },
      "how pictures are compared: log attenuation normalised globally or locally (in windows), or "
      "its gradient")
    ->check(CLI::IsMember({ "global", "local", "gradient" }))
    ->default_str("global")
    ->group("Search");
  command.add_option("--window", options.WindowMm, "edge of the windows of --residual local, mm")
    ->check(PositiveNumber())
    ->capture_default_str()
    ->group("Search");
}
}
