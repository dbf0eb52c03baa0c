// SPDX-License-Identifier: Apache-2.0
#include "Files.h"
#include "Refusals.h"
#include "TestResults.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/Sha256.h"
#include "mammoray/Study/RegisteredMammogram.h"

#include "vtkImageData.h"
#include "vtkNew.h"
#include "vtkPNGWriter.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

using mammoray::test::RefusalOf;
using namespace mammoray;
using ::testing::HasSubstr;

namespace
{
void WriteGrey(const std::string& path, int columns, int rows)
{
  vtkNew<vtkImageData> image;
  image->SetDimensions(columns, rows, 1);
  image->AllocateScalars(VTK_UNSIGNED_CHAR, 1);
  std::fill_n(static_cast<unsigned char*>(image->GetScalarPointer()), columns * rows, 100);
  vtkNew<vtkPNGWriter> writer;
  writer->SetInputData(image);
  writer->SetFileName(path.c_str());
  writer->Write();
}
}

TEST(RegisteredMammogram, APictureIsReadAsItWasRegistered)
{
  const test::TemporaryFolder folder;
  const std::string picture = folder.File("a.png");
  const std::string other = folder.File("b.png");
  WriteGrey(picture, 40, 30);
  WriteGrey(other, 30, 40);
  ResultFile result = test::MakeResultFile();
  result.Inputs = { { MammogramRole, "a.png", Sha256OfFile(picture) } };
  result.Mammogram.View = "MLO";
  result.Mammogram.Laterality = 'L';
  result.Mammogram.Columns = 40;
  result.Mammogram.Rows = 30;
  result.Mammogram.ColumnSpacingMm = 0.07;
  result.Mammogram.RowSpacingMm = 0.08;
  const Mammogram read = ReadRegisteredMammogram(result, picture);
  EXPECT_EQ(read.Columns, 40);
  EXPECT_EQ(read.ColumnSpacingMm, 0.07);
  EXPECT_EQ(read.RowSpacingMm, 0.08);
  EXPECT_EQ(read.View, "MLO");
  EXPECT_EQ(read.Laterality, 'L');
  EXPECT_TRUE(IsRegisteredMammogram(result, picture));
  EXPECT_FALSE(IsRegisteredMammogram(result, other));
  EXPECT_THAT(RefusalOf([&] { ReadRegisteredMammogram(result, other); }),
    HasSubstr("b.png: expected the mammogram of the result, a.png"));
}

TEST(RegisteredMammogram, ASyntheticOneNeedsItsPicture)
{
  const test::TemporaryFolder folder;
  ResultFile result = test::MakeResultFile();
  result.Folder = folder.File("");
  Mammogram real;
  real.Laterality = 'L';
  EXPECT_THAT(
    RefusalOf([&] { ReadSyntheticMammogram(result, real, Mammogram::Intent::ForPresentation); }),
    HasSubstr("synthetic.mha: no such file"));
}
