// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Foundation/MemoryLimit.h"

#include "AddressLimit.h"
#include "Files.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

namespace mammoray
{
namespace
{
namespace fs = std::filesystem;

/// Files under another root.
class MemoryLimit : public testing::Test
{
protected:
  void Write(const std::string& name, const std::string& text) const
  {
    fs::create_directories(fs::path(this->Folder.File(name)).parent_path());
    this->Folder.Write(name, text);
  }
  double Limit() const { return MemoryLimitBytes(this->Folder.File("")); }

  test::TemporaryFolder Folder;
};

TEST_F(MemoryLimit, IsTheMachinesWithoutGroups)
{
  const auto machine = static_cast<double>(sysconf(_SC_PHYS_PAGES)) * sysconf(_SC_PAGESIZE);
  EXPECT_LE(this->Limit(), machine);
  const double limit = this->Limit();
  this->Write("proc/self/cgroup", "0::/\n");
  EXPECT_EQ(this->Limit(), limit);
  this->Write("sys/fs/cgroup/memory.max", "max\n");
  EXPECT_EQ(this->Limit(), limit);
}

TEST_F(MemoryLimit, IsTheLeastOfTheGroupsAround)
{
  this->Write("proc/self/cgroup", "0::/a user.slice/job\n");
  this->Write("sys/fs/cgroup/a user.slice/job/memory.max", "max\n");
  this->Write("sys/fs/cgroup/a user.slice/memory.max", "300000000\n");
  EXPECT_EQ(this->Limit(), 3e8);
  this->Write("sys/fs/cgroup/a user.slice/job/memory.max", "200000000\n");
  EXPECT_EQ(this->Limit(), 2e8);
}

TEST_F(MemoryLimit, OfVersionOneIsThatOfItsController)
{
  this->Write("proc/self/cgroup",
    "9:name=systemd:/\n4:cpu,memory:/docker/0f\n3:memory_other:/none\n0::/\n");
  this->Write("sys/fs/cgroup/none/memory.limit_in_bytes", "1\n");
  this->Write("sys/fs/cgroup/memory/docker/0f/memory.limit_in_bytes", "9223372036854771712\n");
  const double machine = this->Limit();
  EXPECT_GT(machine, 1e6);
  // The container's own view of its group.
  this->Write("sys/fs/cgroup/memory/memory.limit_in_bytes", "100000000\n");
  EXPECT_EQ(this->Limit(), 1e8);
}

TEST(MemoryLimitDeathTest, IsNotMoreThanTheAddresses)
{
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "sanitizers have more addresses than any machine has memory";
#endif
  EXPECT_EXIT(
    {
      test::LimitAddresses(rlim_t{ 64 } << 20);
      rlimit limits{};
      getrlimit(RLIMIT_AS, &limits);
      std::_Exit(MemoryLimitBytes("/none") == static_cast<double>(limits.rlim_cur) ? 0 : 1);
    },
    testing::ExitedWithCode(0), "");
}
}
}
