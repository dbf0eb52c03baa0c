// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_WholeFile_h
#define mammoray_WholeFile_h

#include "mammorayReportModule.h"

#include <string>

namespace mammoray
{
/// Writes a file of these bytes aside and renames it, so that a file of this name is always a whole
/// one. Throws InputError where it cannot be written; then an earlier one stays.
MAMMORAYREPORT_EXPORT void WriteWholeFile(const std::string& content, const std::string& path);
}

#endif
