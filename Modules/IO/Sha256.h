// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Sha256_h
#define mammoray_Sha256_h

#include "mammorayIOModule.h"

#include <string>
#include <vector>

namespace mammoray
{
/// Returns the SHA-256 (FIPS 180-4) of a file as 64 lower-case hexadecimal digits. The SHA-256 of a
/// folder is that of its files one after the other, sorted by name (cat folder/* | sha256sum).
/// Throws InputError if a file cannot be read.
MAMMORAYIO_EXPORT std::string Sha256OfFile(const std::string& path);

/// Returns the SHA-256 of the files' bytes one after the other, in this order.
MAMMORAYIO_EXPORT std::string Sha256OfFiles(const std::vector<std::string>& paths);

/// Returns the SHA-256 of a text's bytes.
MAMMORAYIO_EXPORT std::string Sha256OfText(const std::string& text);
}

#endif
