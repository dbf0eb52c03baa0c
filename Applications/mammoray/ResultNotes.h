// SPDX-License-Identifier: Apache-2.0
// Warnings about a registration's result on stderr.
#ifndef mammoray_ResultNotes_h
#define mammoray_ResultNotes_h

#include "mammoray/Study/ResultFile.h"

#include <string>

namespace mammoray
{
/// Whether the mammograms match, and all that speaks against it.
std::string Verdict(const Assessment& trust);

/// Warns where the match in a registration's folder is doubtful or not to be trusted.
void WarnOfDistrust(const std::string& folder, const Assessment& trust);

/// Notes if the mammogram is not the file that was registered. Throws InputError if it is of
/// another view.
void NoteOtherMammogram(const ResultFile& result, const std::string& mammogram);
}

#endif
