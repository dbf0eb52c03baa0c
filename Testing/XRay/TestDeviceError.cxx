// SPDX-License-Identifier: Apache-2.0
#include "mammoray/XRay/PathLengthProjector.h"

#include <gtest/gtest.h>

namespace
{
using namespace mammoray;

TEST(DeviceError, IsAnErrorWithTheNameOfItsCause)
{
  const DeviceError lost("Vulkan: the device is lost", "VK_ERROR_DEVICE_LOST");
  EXPECT_EQ(lost.ResultName(), "VK_ERROR_DEVICE_LOST");
  try
  {
    throw DeviceError("no Vulkan");
  }
  catch (const InputError&)
  {
    FAIL() << "a missing device is not the input's fault";
  }
  catch (const Error& error)
  {
    EXPECT_STREQ(error.what(), "no Vulkan");
    EXPECT_EQ(dynamic_cast<const DeviceError&>(error).ResultName(), "");
  }
}
}
