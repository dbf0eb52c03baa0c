// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Benchmarks_TextFile_h
#define mammoray_Benchmarks_TextFile_h

#include "mammoray/Foundation/Error.h"

#include <fstream>
#include <string>

namespace mammoray::benchmarks
{
/// Writes a text over whatever the file held. Throws Error where it cannot be written to its end.
inline void WriteText(const std::string& text, const std::string& path)
{
  if (!(std::ofstream(path) << text << std::flush))
  {
    throw Error(path + ": cannot be written");
  }
}
}

#endif
