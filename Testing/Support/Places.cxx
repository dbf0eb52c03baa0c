// SPDX-License-Identifier: Apache-2.0
#include "Files.h"

namespace mammoray::testing_support
{
std::string DataFolder()
{
  return MAMMORAY_DATA_DIR;
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
