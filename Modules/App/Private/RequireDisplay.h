// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_RequireDisplay_h
#define mammoray_RequireDisplay_h

#include "mammorayAppModule.h"

#include <string>

namespace mammoray
{
/// Throws InputError, one line, unless there is an X display with OpenGL: VTK ends the program
/// where it finds none. `command`: begins the line.
MAMMORAYAPP_EXPORT void RequireDisplay(const std::string& command);
}

#endif
