// SPDX-License-Identifier: Apache-2.0
#include "Files.h"
#include "mammoray/Dicom/DicomReader.h"
#include "mammoray/Filters/vtkMammogramReader.h"

#include "vtkCommand.h"
#include "vtkDataArray.h"
#include "vtkExecutive.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkNew.h"
#include "vtkPointData.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

using namespace mammoray;
using testing::HasSubstr;

TEST(MammogramReader, ShowsThePictureUprightWithItsGeometry)
{
  const std::string path = test::DataFolder() + "/victre-phantom-1/victre1_lcc_processing.dcm";
  const Mammogram mammogram = ReadMammogram(path);
  vtkNew<vtkMammogramReader> reader;
  reader->SetFileName(path.c_str());
  reader->Update();
  vtkImageData* image = reader->GetOutput();
  ASSERT_EQ(image->GetDimensions()[0], 720);
  ASSERT_EQ(image->GetDimensions()[1], 1080);
  EXPECT_EQ(image->GetSpacing()[0], 0.1);
  EXPECT_EQ(image->GetScalarComponentAsDouble(5, 1079, 0, 0), mammogram.Pixels[5]);
  EXPECT_EQ(image->GetScalarComponentAsDouble(7, 0, 0, 0), mammogram.Pixels[1079 * 720 + 7]);
  vtkFieldData* fields = image->GetFieldData();
  ASSERT_TRUE(fields->GetArray("BodyPartThicknessMm"));
  EXPECT_EQ(fields->GetArray("BodyPartThicknessMm")->GetTuple1(0), 50.0);
  EXPECT_FALSE(fields->HasArray("SourceToPatientMm"));
}

TEST(MammogramReader, ReportsABadFileOnceAndLeavesNoPicture)
{
  struct Observer : vtkCommand
  {
    void Execute(vtkObject*, unsigned long, void* text) override
    {
      ++this->Count;
      this->Message = static_cast<const char*>(text);
    }
    int Count = 0;
    std::string Message;
  };
  vtkNew<vtkMammogramReader> reader;
  Observer* observer = new Observer;
  reader->AddObserver(vtkCommand::ErrorEvent, observer);
  // The executive repeats that the algorithm failed; that is VTK's, not ours to count.
  Observer* executive = new Observer;
  reader->GetExecutive()->AddObserver(vtkCommand::ErrorEvent, executive);
  reader->SetFileName("/nonexistent/mammogram.dcm");
  reader->Update();
  EXPECT_EQ(observer->Count, 1);
  EXPECT_THAT(observer->Message, HasSubstr("no file that can be read"));
  EXPECT_EQ(reader->GetOutput()->GetNumberOfPoints(), 0);
  observer->Delete();
  executive->Delete();
}
