// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Testing_DicomTesting_h
#define mammoray_Testing_DicomTesting_h

#include "Files.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <gdcmReader.h>
#include <gdcmWriter.h>

#include <cstdlib>
#include <string>

namespace mammoray::test
{
/// Text of an element on the top level of a file, by GDCM; empty where it is absent.
inline std::string DicomTextOf(const std::string& path, std::uint16_t group, std::uint16_t element)
{
  gdcm::Reader reader;
  reader.SetFileName(path.c_str());
  EXPECT_TRUE(reader.Read()) << path;
  const gdcm::DataSet& data = reader.GetFile().GetDataSet();
  const gdcm::Tag tag(group, element);
  const gdcm::ByteValue* bytes =
    data.FindDataElement(tag) ? data.GetDataElement(tag).GetByteValue() : nullptr;
  std::string text = bytes ? std::string(bytes->GetPointer(), bytes->GetLength()) : std::string();
  while (!text.empty() && (text.back() == ' ' || text.back() == '\0'))
  {
    text.pop_back();
  }
  return text;
}

/// Writes a file once more, with what `change` makes of its data set.
template <typename Change>
void ChangeDicom(const std::string& path, const std::string& changed, const Change& change)
{
  gdcm::Reader reader;
  reader.SetFileName(path.c_str());
  EXPECT_TRUE(reader.Read()) << path;
  change(reader.GetFile().GetDataSet());
  gdcm::Writer writer;
  writer.SetFileName(changed.c_str());
  writer.CheckFileMetaInformationOff();
  writer.SetFile(reader.GetFile());
  EXPECT_TRUE(writer.Write()) << changed;
}

/// The standard's attributes are there and have allowed values, as far as dciodvfy (Debian package
/// dicom3tools) knows them; nothing is said where it is not installed.
inline void ExpectValidDicom(const std::string& path)
{
  if (std::system("command -v dciodvfy >/dev/null 2>&1") != 0)
  {
    return;
  }
  const std::string report = path + ".report";
  // Its exit status is not documented; errors begin their lines.
  static_cast<void>(!std::system(("dciodvfy " + path + " >" + report + " 2>&1").c_str()));
  EXPECT_THAT(ReadFile(report), testing::Not(testing::HasSubstr("Error"))) << path;
}
}

#endif
