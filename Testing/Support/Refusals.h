// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Testing_Refusals_h
#define mammoray_Testing_Refusals_h

#include "mammoray/Foundation/Error.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

namespace mammoray::test
{
/// What RefusalOf returns if nothing is refused.
inline constexpr const char* NotRefused = "not refused";

/// The message of the Error that an action throws, or NotRefused. The message must be one line, and
/// nothing may be printed.
template <typename Action>
std::string RefusalOf(const Action& action)
{
  std::string message = NotRefused;
  NoteKeeper notes; // which are no refusals
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

/// Matches a message that contains each of these texts: the field at fault, and the value found.
template <typename... Text>
auto Mentions(const Text&... texts)
{
  return testing::AllOf(testing::HasSubstr(texts)...);
}
}

#endif
