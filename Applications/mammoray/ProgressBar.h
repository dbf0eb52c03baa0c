// SPDX-License-Identifier: Apache-2.0
// How long work tells of itself, and how it is stopped.
#ifndef mammoray_ProgressBar_h
#define mammoray_ProgressBar_h

#include "mammoray/Foundation/Progress.h"

namespace mammoray
{
/**
 * A callback that tells on stderr, in indented lines, each part (PartOf) of the work that took a
 * second or more, with its time; within a part it draws a bar with the time that is left where
 * stderr is a terminal, else it tells a line every ten seconds. It asks to stop as
 * InterruptRequested says.
 */
ProgressCallback MakeProgressBar();

/// Returns true once Ctrl-C, SIGTERM or the end of the terminal has asked the program to stop;
/// installs the handlers at the first call. A second signal ends the program at once.
bool InterruptRequested();
}

#endif
