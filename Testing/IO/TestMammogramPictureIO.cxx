// SPDX-License-Identifier: Apache-2.0
#include "Files.h"
#include "Refusals.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/MammogramPictureIO.h"

#include "vtkImageData.h"
#include "vtkNew.h"
#include "vtkPNGWriter.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

using mammoray::test::RefusalOf;
using namespace mammoray;
using test::TemporaryFolder;
using testing::HasSubstr;

namespace
{
/// A black picture whose pixel (5, 0), the first row at the top, has this value in each colour.
std::string WritePicture(const std::string& path, std::initializer_list<int> colours)
{
  vtkNew<vtkImageData> image;
  image->SetDimensions(40, 30, 1);
  image->AllocateScalars(VTK_UNSIGNED_CHAR, static_cast<int>(colours.size()));
  auto* pixels = static_cast<unsigned char*>(image->GetScalarPointer());
  std::fill_n(pixels, 40 * 30 * colours.size(), static_cast<unsigned char>(0));
  std::copy(colours.begin(), colours.end(),
    static_cast<unsigned char*>(image->GetScalarPointer(5, 29, 0))); // VTK's last row is the top
  vtkNew<vtkPNGWriter> writer;
  writer->SetInputData(image);
  writer->SetFileName(path.c_str());
  writer->Write();
  return path;
}

}

TEST(MammogramPictureIO, PicturesNeedWhatTheyDoNotSay)
{
  const TemporaryFolder folder;
  const std::string path = WritePicture(folder.File("a.png"), { 200 });
  EXPECT_THAT(RefusalOf([&] { ReadMammogramPicture(path, { .View = "MLO" }); }),
    HasSubstr("pixel spacing, laterality to be given, and its thickness if it is known; set "
              "PixelSpacingMm and Laterality "
              "and ThicknessMm"));
  const Mammogram read =
    ReadMammogramPicture(path, { .PixelSpacingMm = 0.1, .View = "MLO", .Laterality = 'L' });
  EXPECT_EQ(read.Columns, 40);
  EXPECT_EQ(read.Rows, 30);
  EXPECT_EQ(read.Pixels[5], 200);
  EXPECT_EQ(read.Pixels[6], 0);
  EXPECT_EQ(read.ColumnSpacingMm, 0.1);
  EXPECT_EQ(read.View, "MLO");
}

TEST(MammogramPictureIO, ColoursMustBeGrey)
{
  const TemporaryFolder folder;
  const PictureDescription given{ .PixelSpacingMm = 0.1, .View = "CC", .Laterality = 'R' };
  const std::string grey = WritePicture(folder.File("grey.png"), { 200, 202, 199 });
  EXPECT_EQ(ReadMammogramPicture(grey, given).Pixels[5], 200);
  const std::string opaque = WritePicture(folder.File("opaque.png"), { 200, 255 });
  EXPECT_EQ(ReadMammogramPicture(opaque, given).Pixels[5], 200);
  const std::string red = WritePicture(folder.File("red.png"), { 200, 0, 0 });
  EXPECT_THAT(RefusalOf([&] { ReadMammogramPicture(red, given); }), HasSubstr("a coloured one"));
}

TEST(MammogramPictureIO, MasksHaveTheirFirstRowAtTheTop)
{
  const TemporaryFolder folder;
  const std::string path = WritePicture(folder.File("mask.png"), { 7 });
  const std::vector<unsigned char> mask = ReadMask(path, 40, 30);
  EXPECT_EQ(std::count(mask.begin(), mask.end(), 1), 1);
  EXPECT_EQ(mask[5], 1);
  EXPECT_THAT(RefusalOf([&] { ReadMask(path, 30, 40); }),
    HasSubstr("expected a mask of the mammogram's 30 x 40 pixels, found 40 x 30"));
  EXPECT_THAT(RefusalOf([&] { ReadMask(folder.File("none.png"), 8, 8); }), HasSubstr("no such"));
  EXPECT_THAT(RefusalOf([&] { ReadMask(folder.Write("mask.txt", "1"), 8, 8); }),
    HasSubstr(".png, .mha or .mhd"));
  EXPECT_THAT(RefusalOf([&] { ReadMask(folder.Write("mask.jpg", "1"), 8, 8); }),
    HasSubstr("expected a mask (.png, .mha or .mhd), found a JPEG"));
}

TEST(MammogramPictureIO, PathsTellPictures)
{
  EXPECT_TRUE(IsPicturePath("a.jpg") && IsPicturePath("a.jpeg") && IsPicturePath("a.png"));
  EXPECT_FALSE(IsPicturePath("a.dcm") || IsPicturePath("png"));
}

TEST(MammogramPictureIO, DamagedPicturesAreRefusedInOneLine)
{
  const TemporaryFolder folder;
  const PictureDescription description{ .PixelSpacingMm = 0.1, .View = "MLO", .Laterality = 'L' };
  const std::string whole = test::ReadFile(WritePicture(folder.File("a.png"), { 200 }));
  // Signature, chunk's kind, width, data, checksum; each of which libpng answers in its own way.
  for (const std::size_t at :
    { std::size_t{ 1 }, std::size_t{ 12 }, std::size_t{ 18 }, whole.size() / 2, whole.size() - 14 })
  {
    std::string damaged = whole;
    damaged[at] = static_cast<char>(damaged[at] ^ 0x55);
    const std::string path = folder.Write("damaged.png", damaged);
    const auto read = [&] { ReadMammogramPicture(path, description); };
    EXPECT_THAT(RefusalOf(read), testing::StartsWith(path + ": expected ")) << at;
    EXPECT_THAT(RefusalOf([&] { ReadMask(path, 40, 30); }),
      testing::StartsWith(path + ": expected "))
      << at;
  }
  const std::string cut = folder.Write("cut.png", whole.substr(0, whole.size() / 2));
  EXPECT_THAT(RefusalOf([&] { ReadMammogramPicture(cut, description); }),
    testing::StartsWith(cut + ": expected a picture"));
}

TEST(MammogramPictureIO, FloatsComeBackInTheirOrder)
{
  const TemporaryFolder folder;
  const std::string header = "ObjectType = Image\nNDims = 2\nBinaryData = True\nDimSize = 2 3\n"
                             "ElementType = MET_FLOAT\nElementDataFile = LOCAL\n";
  const std::vector<float> pixels{ 1.5F, -2, 3, 4, 5, 6 };
  const std::string bytes(reinterpret_cast<const char*>(pixels.data()), 6 * sizeof(float));
  const std::string path = folder.Write("a.mha", header + bytes);
  EXPECT_EQ(ReadFloatPicture(path, 2, 3), pixels);
  EXPECT_THAT(RefusalOf([&] { ReadFloatPicture(path, 3, 2); }),
    HasSubstr("a.mha: expected the mammogram's 3 x 2 pixels, found 2 x 3"));
  const std::string cut = folder.Write("cut.mha", header + bytes.substr(0, 10));
  EXPECT_THAT(RefusalOf([&] { ReadFloatPicture(cut, 2, 3); }), testing::StartsWith(cut + ": "));
}
