// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_OptionNames_h
#define mammoray_OptionNames_h

#include "mammoray/Foundation/Error.h"

#include <string>

namespace mammoray
{
/// The option that sets a field: "--pixel-spacing" of "PixelSpacingMm".
std::string OptionOfField(const std::string& field);

/// The error's message, with options in place of the fields that it names.
std::string InOptions(const InputError& error);
}

#endif
