// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_OptionNames_h
#define mammoray_OptionNames_h

#include <exception>
#include <string>

namespace mammoray
{
/// The option that sets a field: "--pixel-spacing" of "PixelSpacingMm".
std::string OptionOfField(const std::string& field);

/// What went wrong, in one line for people. Options stand in place of the fields that an InputError
/// names.
std::string Complaint(const std::exception& error);
}

#endif
