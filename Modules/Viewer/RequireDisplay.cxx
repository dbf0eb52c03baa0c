// SPDX-License-Identifier: Apache-2.0
#include "RequireDisplay.h"

#include "Error.h"

// Last: its macros replace common words.
#include <X11/Xlib.h>

#include <cstdlib>
#include <string>

namespace mammoray
{
void RequireDisplay()
{
  Display* display = XOpenDisplay(nullptr);
  if (!display)
  {
    const char* name = std::getenv("DISPLAY");
    throw InputError(name && *name ? "view: cannot open the display " + std::string(name)
                                   : "view: expected a display, found none (DISPLAY is not set)");
  }
  int opcode = 0;
  int event = 0;
  int code = 0;
  const bool openGl = XQueryExtension(display, "GLX", &opcode, &event, &code) != 0;
  XCloseDisplay(display);
  if (!openGl)
  {
    throw InputError("view: the display has no OpenGL (GLX)");
  }
}
}
