// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Sha256_h
#define mammoray_Sha256_h

#include "mammorayIOModule.h"

#include <string>
#include <vector>

namespace mammoray
{
/// SHA-256 (FIPS 180-4) of a file's bytes, of a folder that of its files one after the other by
/// name (cat folder/* | sha256sum), 64 lower-case hexadecimal digits. Throws InputError when it
/// cannot be read.
MAMMORAYIO_EXPORT std::string Sha256OfFile(const std::string& path);

/// That of files one after the other, in this order.
MAMMORAYIO_EXPORT std::string Sha256OfFiles(const std::vector<std::string>& paths);

/// That of a text's bytes.
MAMMORAYIO_EXPORT std::string Sha256OfText(const std::string& text);
}

#endif
