// SPDX-License-Identifier: Apache-2.0
#include "CommandTest.h"
#include "mammoray/XRay/PathLengthProjector.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

using namespace mammoray;

namespace
{
using DevicesCommand = test::CommandTest;

TEST_F(DevicesCommand, ListsAllAndTheChosenOne)
{
  const std::vector<DeviceDescription> devices = ListDevices();
  if (devices.empty())
  {
    GTEST_SKIP() << "no Vulkan device";
  }
  ASSERT_EQ(this->Run("devices --projector rasterisation"), 0) << this->Errors;
  for (const DeviceDescription& device : devices)
  {
    EXPECT_THAT(this->Output,
      testing::HasSubstr(device.Name + "\n  driver       " + device.Driver));
  }
  EXPECT_THAT(this->Output, testing::HasSubstr("\nchosen: "));
  EXPECT_THAT(this->Output, testing::EndsWith(", rasterisation\n"));
}

TEST_F(DevicesCommand, RefusesInOneLine)
{
  this->ExpectRefused("devices", "Vulkan",
    "VK_DRIVER_FILES=/nonexistent VK_ICD_FILENAMES=/nonexistent");
  if (!ListDevices().empty())
  {
    this->ExpectRefusedAfterListing("devices --device 'abacus of bronze'", "abacus of bronze");
  }
  EXPECT_EQ(this->Run("devices --projector guessing"), 2);
}
}
