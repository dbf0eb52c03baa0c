// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Foundation/Error.h"

#include <gtest/gtest.h>

namespace
{
using namespace mammoray;

template <typename Thrown>
void ExpectCaughtAsError(const Thrown& thrown, const char* message)
{
  try
  {
    throw thrown;
  }
  catch (const Error& error)
  {
    EXPECT_STREQ(error.what(), message);
  }
}

TEST(Error, IsTheBaseOfAllAndKeepsTheMessage)
{
  ExpectCaughtAsError(InputError("mesh: expected cells, found none"),
    "mesh: expected cells, found none");
  ExpectCaughtAsError(ConvergenceError("load step 3: cell 7 is inverted"),
    "load step 3: cell 7 is inverted");
  ExpectCaughtAsError(Interrupted(), "interrupted");
}

TEST(Error, KindsAreToldApart)
{
  EXPECT_THROW(throw Interrupted(), Interrupted);
  try
  {
    throw InputError("");
  }
  catch (const ConvergenceError&)
  {
    FAIL() << "an input is no failure of a computation";
  }
  catch (const InputError&)
  {
  }
}
}
