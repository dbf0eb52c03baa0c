// SPDX-License-Identifier: Apache-2.0
#include "CommandTest.h"
#include "mammoray/IO/MeshConversion.h"
#include "mammoray/IO/MeshIO.h"
#include "mammoray/XRay/PathLengthProjector.h"

#include "vtkPolyData.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cstdlib>
#include <future>

using namespace mammoray;
using test::ReadFile;

namespace
{
class ExampleCommand : public test::CommandTest
{
protected:
  std::string Target = this->Folder.File("result");
};
}

TEST_F(ExampleCommand, WritesMeshImageAndPicture)
{
  if (ListDevices().empty())
  {
    GTEST_SKIP() << "no Vulkan device";
  }
  ASSERT_EQ(this->Run("example boxes -o " + this->Target), 0) << this->Errors;
  EXPECT_EQ(this->Errors, "");
  EXPECT_THAT(this->Output, testing::HasSubstr("47580 triangles"));
  const SurfaceMesh surface = ReadSurface(this->Target + "/boxes.vtp");
  EXPECT_EQ(surface.NumberOfTriangles(), 47580u);
  const std::string image = ReadFile(this->Target + "/boxes.mha");
  EXPECT_THAT(image, testing::HasSubstr("DimSize = 250 200 1"));
  EXPECT_GT(image.size(), 250u * 200 * sizeof(float));
  EXPECT_THAT(ReadFile(this->Target + "/boxes.png"), testing::StartsWith("\x89PNG"));

  // Nothing is replaced without being told, and nothing else is left there.
  EXPECT_EQ(this->Run("example boxes -o " + this->Target), 1);
  EXPECT_THAT(this->Errors, testing::HasSubstr("--overwrite"));
  EXPECT_EQ(this->Run("example boxes --overwrite -o " + this->Target), 0) << this->Errors;
  EXPECT_EQ(ReadFile(this->Target + "/boxes.mha"), image);
  std::size_t count = 0;
  for (const auto& entry : std::filesystem::directory_iterator(this->Target))
  {
    count += entry.is_regular_file() ? 1 : 0;
  }
  EXPECT_EQ(count, 3u);
}

// A folder that was not there appears with all that belongs into it: whoever looks before, or ends
// the program then, finds none.
TEST_F(ExampleCommand, MakesItsFolderWithAllFilesAtOnce)
{
  if (ListDevices().empty())
  {
    GTEST_SKIP() << "no Vulkan device";
  }
  const auto running =
    std::async(std::launch::async, [&] { return this->Run("example test -o " + this->Target); });
  while (!std::filesystem::exists(this->Target) &&
    running.wait_for(std::chrono::milliseconds(1)) == std::future_status::timeout)
  {
  }
  for (const char* file : { "/test.vtp", "/test.mha", "/test.png" })
  {
    EXPECT_TRUE(std::filesystem::exists(this->Target + file)) << file;
  }
  running.wait();
  EXPECT_EQ(this->Errors, "");
}

TEST_F(ExampleCommand, RefusesInOneLine)
{
  const auto refused = [&](const std::string& arguments, const std::string& text)
  {
    EXPECT_EQ(this->Run("example " + arguments), 1) << arguments;
    EXPECT_THAT(this->Errors, testing::StartsWith("mammoray: "));
    EXPECT_THAT(this->Errors, testing::HasSubstr(text));
    EXPECT_EQ(std::count(this->Errors.begin(), this->Errors.end(), '\n'), 1) << this->Errors;
  };
  refused("brest -o " + this->Target, "did you mean breast?");
  refused("xylophone -o " + this->Target, "known are test, boxes, veins, breast");
  refused("test -o /nowhere/at/all", "/nowhere/at/all");
  refused("test -o /dev/null", "expected a folder");
  refused("test --spectrum W99 -o " + this->Target, "W28kVp");
  EXPECT_FALSE(std::filesystem::exists(this->Target));
  EXPECT_EQ(this->Run("example -o " + this->Target), 2);
  EXPECT_EQ(this->Run("example test"), 2);
}
