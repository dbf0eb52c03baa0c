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

/// True once the program was asked to stop, by Ctrl-C, SIGTERM, the end of its terminal or a limit
/// on its processor time that may be passed (ulimit -St); installs the handlers at the first call.
/// The second time, but of that limit, ends it at once.
bool InterruptRequested();
}

#endif
