// SPDX-License-Identifier: Apache-2.0
#include "Refusals.h"
#include "mammoray/Study/Private/HeaderRules.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace
{
using namespace mammoray;
using test::NotRefused;
using test::RefusalOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

DicomHeader ImageOf(const std::string& id, const std::string& name, const std::string& born,
  const std::string& sex = "F")
{
  DicomHeader header;
  header.Path = "/export/" + id + "/1.dcm";
  header.Identity.PatientId = id;
  header.Identity.PatientName = name;
  header.Identity.PatientBirthDate = born;
  header.Identity.PatientSex = sex;
  return header;
}

std::string PatientRefusal(const std::vector<DicomHeader>& images)
{
  return RefusalOf([&] { CheckOnePatient(images, "/export"); });
}

TEST(StudyPatients, NamesAreTheSameHoweverTheyAreWritten)
{
  // A name's empty components may be written or left out (PS3.5, 6.2.1), with any case.
  const DicomHeader written = ImageOf("17", "DOE^JANE", "");
  for (const char* name : { "Doe^Jane", "DOE^JANE^^^", "DOE^JANE^", "doe jane", "DOE, JANE " })
  {
    EXPECT_EQ(PatientRefusal({ written, ImageOf("17", name, "") }), NotRefused) << name;
    EXPECT_THAT(CheckOnePatient({ written, ImageOf("17", name, "") }, "/export"), IsEmpty())
      << name;
  }
  // What is not said contradicts nothing.
  EXPECT_THAT(CheckOnePatient({ written, ImageOf("", "", "", "O") }, "/export"), IsEmpty());
}

TEST(StudyPatients, TwoOfThreeAreTakenForOneWithAWarning)
{
  const DicomHeader one = ImageOf("17", "DOE^JANE", "19700101");
  EXPECT_THAT(CheckOnePatient({ one, ImageOf("B-9", "DOE^JANE", "19700101") }, "/export"),
    ElementsAre(HasSubstr("two identifiers or two names")));
  EXPECT_THAT(CheckOnePatient({ one, ImageOf("17", "ROE^JANE", "19700101") }, "/export"),
    ElementsAre(HasSubstr("two identifiers or two names")));
}

TEST(StudyPatients, ContradictionsAreRefusedWithoutIdentity)
{
  const DicomHeader one = ImageOf("17", "DOE^JANE", "19700101");
  const DicomHeader others[] = {
    ImageOf("17", "DOE^JANE", "19700102"),      // born on another day
    ImageOf("17", "DOE^JANE", "19700101", "M"), // of another sex
    ImageOf("18", "ROE^ANN", "19700101"),       // one of three
    ImageOf("18", "DOE^JANE", ""),              // a namesake, no date to confirm
  };
  for (const DicomHeader& other : others)
  {
    const std::string message = PatientRefusal({ one, one, other });
    EXPECT_THAT(message, HasSubstr("2 images of patient #"));
    EXPECT_THAT(message, HasSubstr("1 images of patient #"));
    EXPECT_THAT(message, HasSubstr("(first in 17)"));
    EXPECT_THAT(message, Not(HasSubstr("DOE")));
    EXPECT_THAT(message, Not(HasSubstr("doe")));
    EXPECT_THAT(message, Not(HasSubstr("1970")));
  }
}
}
