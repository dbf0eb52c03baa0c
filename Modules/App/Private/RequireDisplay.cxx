// SPDX-License-Identifier: Apache-2.0
#include "Private/RequireDisplay.h"

#include "mammoray/Foundation/Error.h"

// Last: its macros replace common words.
#include <X11/Xlib.h>

#include <cstdlib>
#include <memory>
#include <string>
#include <utility>

namespace mammoray
{
void RequireDisplay(const std::string& command)
{
  // Kept, since an X server without -noreset (xvfb-run's) starts again when its last client leaves,
  // and refuses the next one meanwhile.
  static std::unique_ptr<Display, int (*)(Display*)> kept(nullptr, XCloseDisplay);
  std::unique_ptr<Display, int (*)(Display*)> display(XOpenDisplay(nullptr), XCloseDisplay);
  if (!display)
  {
    const char* name = std::getenv("DISPLAY");
    throw InputError(command +
      (name && *name ? ": cannot open the display " + std::string(name)
                     : ": expected a display, found none (DISPLAY is not set)"));
  }
  int opcode = 0;
  int event = 0;
  int code = 0;
  const bool openGl = XQueryExtension(display.get(), "GLX", &opcode, &event, &code) != 0;
  kept = std::move(display);
  if (!openGl)
  {
    throw InputError(command + ": the display has no OpenGL (GLX)");
  }
}
}
