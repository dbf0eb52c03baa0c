// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_RequireDisplay_h
#define mammoray_RequireDisplay_h

#include "mammorayAppModule.h"

namespace mammoray
{
/// Throws InputError, one line, unless there is an X display with OpenGL: VTK ends the program
/// where it finds none.
MAMMORAYAPP_EXPORT void RequireDisplay();
}

#endif
