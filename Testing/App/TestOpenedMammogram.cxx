// SPDX-License-Identifier: Apache-2.0
#include "SmallBreast.h"
#include "mammoray/App/Private/OpenedResult.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <thread>

namespace
{
using namespace mammoray;

class OpenedMammogramTest : public testing::Test
{
protected:
  void SetUp() override
  {
    if (ListDevices().empty())
    {
      GTEST_SKIP() << "no Vulkan device";
    }
    this->Viewed = ReadViewedBreasts(test::WriteSmallBreast(this->Folder)).front();
  }
  template <typename Result>
  static auto Await(const Result& result)
  {
    const auto begin = std::chrono::steady_clock::now();
    auto value = result();
    while (!value && std::chrono::steady_clock::now() - begin < std::chrono::seconds(120))
    {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));
      value = result();
    }
    return value;
  }

  test::TemporaryFolder Folder;
  ViewedBreast Viewed;
};

TEST_F(OpenedMammogramTest, FollowsThePaddleByEquilibriaThatItKnows)
{
  OpenedMammogram opened(this->Viewed, {});
  // Plates that hardly touch the breast, of 76 mm.
  const double closed = 68;
  const std::vector<double> rest = opened.Live.Points();
  for (const double thickness : { closed, closed + 6 })
  {
    opened.Live.SetPose(thickness, 0);
    opened.Compress();
    const auto answer = Await([&] { return opened.TakeEquilibrium(); });
    ASSERT_TRUE(answer.has_value());
    ASSERT_EQ(answer->Error, "");
    EXPECT_EQ(answer->ReducedFrom, 0);
    EXPECT_EQ(opened.Live.Points(), answer->Points);
    EXPECT_NE(opened.Live.Points(), rest);
    Extent height;
    for (std::size_t index = 0; index < rest.size(); index += 3)
    {
      if (answer->Points[index + 1] > 20) // before the chest wall
      {
        height.Add(answer->Points[index + 2]);
      }
    }
    EXPECT_LT(height.Length(), thickness);
    // It is known a moment after the answer.
    const auto isKnown = [&]
    {
      const auto known = opened.Worker.Reduced(opened.Live.Pose());
      return known && known->Points == answer->Points;
    };
    ASSERT_TRUE(Await(isKnown));
  }
  opened.Live.SetPose(closed + 2.4, 0);
  const auto between = opened.Compress();
  ASSERT_TRUE(between.has_value());
  EXPECT_EQ(between->ReducedFrom, 2);
  EXPECT_EQ(opened.Live.Points(), between->Points);
  const auto exact = Await([&] { return opened.TakeEquilibrium(); });
  ASSERT_TRUE(exact.has_value());
  EXPECT_EQ(exact->ReducedFrom, 0);
  std::vector<double> distances;
  for (std::size_t index = 0; index < rest.size(); index += 3)
  {
    distances.push_back(std::hypot(exact->Points[index] - between->Points[index],
      exact->Points[index + 1] - between->Points[index + 1],
      exact->Points[index + 2] - between->Points[index + 2]));
  }
  std::sort(distances.begin(), distances.end());
  // The tissue moves by up to 2 mm from either end to there; to second order it is 0.2 at most.
  EXPECT_LT(distances[distances.size() * 95 / 100], 0.4);
  EXPECT_GT(distances[distances.size() / 2], 0);
}

TEST_F(OpenedMammogramTest, ShowsWhatIsKnownWhereThePlatesHaveMovedOn)
{
  OpenedMammogram opened(this->Viewed, {});
  opened.Live.SetPose(70, 0);
  opened.Compress();
  ASSERT_TRUE(Await([&] { return opened.TakeEquilibrium(); }).has_value());
  ASSERT_TRUE(Await([&] { return opened.Worker.Reduced(opened.Live.Pose()); }).has_value());
  opened.Live.SetPose(68, 0);
  opened.Compress();
  ASSERT_TRUE(Await([&] { return opened.Worker.Stage().empty(); }));
  opened.Live.SetPose(69, 0);
  const auto answer = opened.TakeEquilibrium();
  ASSERT_TRUE(answer.has_value());
  EXPECT_GT(answer->ReducedFrom, 0);
  EXPECT_EQ(answer->Pose.ThicknessMm, 69);
}
}
