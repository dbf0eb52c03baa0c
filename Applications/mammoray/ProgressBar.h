// SPDX-License-Identifier: Apache-2.0
// How long work tells of itself, and how it is stopped.
#ifndef mammoray_ProgressBar_h
#define mammoray_ProgressBar_h

#include "mammoray/Foundation/Progress.h"

namespace mammoray
{
/**
 * A callback that draws a progress bar on stderr when that is a terminal, and asks to stop once
 * Ctrl-C was pressed.
 */
ProgressCallback MakeProgressBar();

/// True once Ctrl-C was pressed; installs the handler at the first call.
bool InterruptRequested();
}

#endif
