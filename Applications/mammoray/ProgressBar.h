// SPDX-License-Identifier: Apache-2.0
// Progress of long work on stderr, and how it is stopped.
#ifndef mammoray_ProgressBar_h
#define mammoray_ProgressBar_h

#include "mammoray/Foundation/Progress.h"

namespace mammoray
{
/**
 * A callback that writes a line to stderr for each part (PartOf) of the work that took a second or
 * more, with its time. Within a part it draws a bar with the remaining time if stderr is a
 * terminal, else it writes a line every ten seconds. It requests a stop when InterruptRequested
 * does.
 */
ProgressCallback MakeProgressBar();

/// Returns true once Ctrl-C, SIGTERM or the end of the terminal has asked the program to stop;
/// installs the handlers at the first call. A second signal ends the program at once.
bool InterruptRequested();
}

#endif
