// SPDX-License-Identifier: Apache-2.0
#include "Files.h"

#include <cstdlib>

namespace mammoray::test
{
std::string DataFolder()
{
  const char* elsewhere = std::getenv("MAMMORAY_DATA"); // where the tests run without their sources
  return elsewhere ? elsewhere : MAMMORAY_DATA_DIR;
}

std::string SharedDataFolder()
{
  return MAMMORAY_SHARED_DATA_DIR;
}

std::string MammorayExecutable()
{
  return MAMMORAY_EXECUTABLE;
}

std::string XvfbPath()
{
  return MAMMORAY_XVFB;
}
}
