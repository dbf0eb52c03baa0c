// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Desktop_h
#define mammoray_Desktop_h

namespace mammoray
{
/// Runs the desktop application until its window is closed; arguments as of main(). Returns the
/// exit code: 0, 1 after a line on standard error, 2 on wrong usage.
int RunDesktop(int argc, char* argv[]);
}

#endif
