// SPDX-License-Identifier: Apache-2.0
// How a registration compares pictures, for the commands that run one.
#ifndef mammoray_ComparisonOptions_h
#define mammoray_ComparisonOptions_h

#include "mammoray/Registration/RegistrationResiduals.h"

#include <CLI/CLI.hpp>

namespace mammoray
{
/// Adds --residual and --window.
void AddComparisonOptions(CLI::App& command, RegistrationOptions& options);
}

#endif
