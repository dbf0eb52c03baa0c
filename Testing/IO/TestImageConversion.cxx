// SPDX-License-Identifier: Apache-2.0
#include "Refusals.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/ImageConversion.h"

#include "vtkDoubleArray.h"
#include "vtkImageData.h"
#include "vtkNew.h"
#include "vtkPointData.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

using mammoray::test::RefusalOf;
using namespace mammoray;

TEST(ImageConversion, LabelsKeepAnObliqueGridAndItsExtent)
{
  vtkNew<vtkImageData> image;
  image->SetExtent(2, 3, 0, 1, 5, 5);
  image->SetSpacing(0.5, 2, 3);
  image->SetOrigin(1, 2, 3);
  image->SetDirectionMatrix(0, -1, 0, 1, 0, 0, 0, 0, 1); // i along +y, j along -x
  vtkNew<vtkDoubleArray> values;
  for (const double value : { 0.0, 7.0, 65535.0, 1.0 })
  {
    values->InsertNextValue(value);
  }
  image->GetPointData()->SetScalars(values);
  const LabelVolume volume = ToLabelVolume(image);
  EXPECT_EQ(volume.Size, (std::array<int, 3>{ 2, 2, 1 }));
  EXPECT_THAT(volume.Voxels, testing::ElementsAre(0, 7, 65535, 1));
  EXPECT_LT(Norm(volume.PointAt(0, 0, 0) - Vector3{ 1, 2 + 2 * 0.5, 3 + 5 * 3 }), 1e-12);
  EXPECT_LT(Norm(volume.PointAt(1, 1, 0) - Vector3{ 1 - 2, 2 + 3 * 0.5, 3 + 5 * 3 }), 1e-12);
  values->SetValue(3, 0.5);
  EXPECT_THAT(RefusalOf([&] { ToLabelVolume(image); }),
    testing::HasSubstr("labels: voxel (1, 1, 0) holds 0.5"));
}

TEST(ImageConversion, MammogramsComeBack)
{
  Mammogram mammogram;
  mammogram.Columns = 3;
  mammogram.Rows = 2;
  mammogram.ColumnSpacingMm = 0.1;
  mammogram.RowSpacingMm = 0.2;
  mammogram.Pixels = { 1, 2, 3, 4, 5, 6 };
  mammogram.View = "MLO";
  mammogram.Laterality = 'R';
  mammogram.RowDirection = "P";
  mammogram.ColumnDirection = "FL";
  mammogram.PresentationIntent = Mammogram::Intent::ForProcessing;
  mammogram.InvertedForDisplay = true;
  mammogram.IntensityRelationship = Mammogram::Relationship::Logarithmic;
  mammogram.IntensitySign = -1;
  mammogram.BitsStored = 12;
  mammogram.BodyPartThicknessMm = 53.5;
  const auto image = ToImage(mammogram);
  EXPECT_EQ(image->GetScalarComponentAsDouble(0, 1, 0, 0), 1) << "the first row is on top";
  const Mammogram back = ToMammogram(image);
  EXPECT_EQ(back.Pixels, mammogram.Pixels);
  EXPECT_EQ(back.ColumnSpacingMm, 0.1);
  EXPECT_EQ(back.RowSpacingMm, 0.2);
  EXPECT_EQ(back.View, "MLO");
  EXPECT_EQ(back.Laterality, 'R');
  EXPECT_EQ(back.RowDirection, "P");
  EXPECT_EQ(back.ColumnDirection, "FL");
  EXPECT_EQ(back.PresentationIntent, mammogram.PresentationIntent);
  EXPECT_TRUE(back.InvertedForDisplay);
  EXPECT_EQ(back.IntensityRelationship, mammogram.IntensityRelationship);
  EXPECT_EQ(back.IntensitySign, -1);
  EXPECT_EQ(back.BitsStored, 12);
  EXPECT_EQ(back.BodyPartThicknessMm, 53.5);
  EXPECT_FALSE(back.SourceToDetectorMm);
  image->SetSpacing(0, 1, 1);
  EXPECT_THROW(ToMammogram(image), InputError);
}
