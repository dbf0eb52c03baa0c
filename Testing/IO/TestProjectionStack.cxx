// SPDX-License-Identifier: Apache-2.0
#include "Files.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/LabelVolumeIO.h"
#include "mammoray/IO/ProjectionImage.h"

#include "vtkImageData.h"
#include "vtkNew.h"
#include "vtkTIFFReader.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numeric>

using namespace mammoray;
using test::TemporaryFolder;

namespace
{
/// Three columns, two rows, four projections: 0 to 23, and a half.
ProjectionStack Stack()
{
  ProjectionStack stack{ .Columns = 3, .Rows = 2, .Number = 4 };
  stack.ColumnSpacingMm = 0.5;
  stack.RowSpacingMm = 0.25;
  stack.Values.resize(24);
  std::iota(stack.Values.begin(), stack.Values.end(), 0.5F);
  return stack;
}
}

TEST(ProjectionStack, TiffHasAPageOfFloatsForEachProjection)
{
  const TemporaryFolder folder;
  for (const char* name : { "stack.tif", "stack.TIFF" })
  {
    WriteProjectionStack(Stack(), folder.File(name));
    vtkNew<vtkTIFFReader> reader;
    reader->SetFileName(folder.File(name).c_str());
    reader->Update();
    vtkImageData* image = reader->GetOutput();
    int size[3];
    image->GetDimensions(size);
    ASSERT_EQ((std::array<int, 3>{ size[0], size[1], size[2] }), (std::array<int, 3>{ 3, 2, 4 }));
    EXPECT_EQ(image->GetScalarType(), VTK_FLOAT);
    for (int index = 0; index < 24; ++index)
    {
      // VTK's reader has the first row of the file as its last.
      EXPECT_EQ(image->GetScalarComponentAsDouble(index % 3, 1 - index / 3 % 2, index / 6, 0),
        index + 0.5)
        << index;
    }
  }
}

TEST(ProjectionStack, VolumesHaveTheProjectionsBehindEachOther)
{
  const TemporaryFolder folder;
  for (const char* name : { "stack.mha", "stack.nrrd" })
  {
    WriteProjectionStack(Stack(), folder.File(name));
    const IntensityVolume read = ReadIntensityFile(folder.File(name));
    EXPECT_EQ(read.Size, (std::array<int, 3>{ 3, 2, 4 })) << name;
    EXPECT_EQ(read.Spacing, (Vector3{ 0.5, 0.25, 1 })) << name;
    EXPECT_EQ(read.Voxels.back(), 23.5F) << name;
  }
}

TEST(ProjectionStack, RefusesInOneLine)
{
  const TemporaryFolder folder;
  EXPECT_THROW(WriteProjectionStack(Stack(), folder.File("stack.png")), InputError);
  ProjectionStack stack = Stack();
  stack.Values.pop_back();
  EXPECT_THROW(WriteProjectionStack(stack, folder.File("stack.tif")), InputError);
  EXPECT_THROW(WriteProjectionStack(Stack(), "/nowhere/stack.tif"), InputError);
  EXPECT_FALSE(std::filesystem::exists(folder.File("stack.tif")));
}
