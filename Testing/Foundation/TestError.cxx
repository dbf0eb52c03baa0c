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

TEST(Error, WhatCameFromAFileCannotForgeALine)
{
  EXPECT_STREQ(InputError("view: found 'CC\nmammoray: done\r\x1b[2J\x7f'").what(),
    "view: found 'CC\\x0amammoray: done\\x0d\\x1b[2J\\x7f'");
}

TEST(Error, PrintableKeepsLettersOfAllWriting)
{
  const std::string written = "Größe 50 µm, 乳房, \U0001F600 ~";
  EXPECT_EQ(EscapeControls(written), written);
  EXPECT_EQ(EscapeControls(std::string("a\0b", 3)), "a\\x00b");
  // C1 controls (CSI), a mark from right to left, a line separator.
  EXPECT_EQ(EscapeControls("\xc2\x9b"), "\\xc2\\x9b");
  EXPECT_EQ(EscapeControls("\xe2\x80\xae"), "\\xe2\\x80\\xae");
  EXPECT_EQ(EscapeControls("\xe2\x80\xa8"), "\\xe2\\x80\\xa8");
  // Latin-1, a letter cut short, one written too long, a surrogate, beyond Unicode.
  EXPECT_EQ(EscapeControls("Gr\xf6\xdf"), "Gr\\xf6\\xdf");
  EXPECT_EQ(EscapeControls("\xe4\xb9"), "\\xe4\\xb9");
  EXPECT_EQ(EscapeControls("\xc0\xaf"), "\\xc0\\xaf");
  EXPECT_EQ(EscapeControls("\xed\xa0\x80"), "\\xed\\xa0\\x80");
  EXPECT_EQ(EscapeControls("\xf5\x80\x80\x80"), "\\xf5\\x80\\x80\\x80");
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
