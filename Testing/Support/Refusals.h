// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Testing_Refusals_h
#define mammoray_Testing_Refusals_h

#include "mammoray/Foundation/Error.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

namespace mammoray::testing_support
{
/// What RefusalOf answers where nothing is refused.
inline constexpr const char* NotRefused = "not refused";

/// The one line with which an action refuses its input, or NotRefused. Nothing else is printed.
template <typename Action>
std::string RefusalOf(const Action& action)
{
  std::string message = NotRefused;
  testing::internal::CaptureStderr();
  try
  {
    action();
  }
  catch (const Error& error)
  {
    message = error.what();
  }
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "") << "a library talks on its own";
  EXPECT_THAT(message, testing::Not(testing::HasSubstr("\n")));
  return message;
}
}

#endif
