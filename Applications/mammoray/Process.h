// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Process_h
#define mammoray_Process_h

namespace mammoray
{
/**
 * What main begins with: streams, signals, memory and the environment of libraries as the work
 * wants them; may begin the program anew, with the same arguments. Where this is linked, limits on
 * the process that leave too little for the libraries' own set-up are told in one line before it,
 * and end the process with exit status 1.
 */
void SetUpProcess(char* argv[]);
}

#endif
