// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Filters/Private/FilterRequest.h"
#include "mammoray/Filters/vtkXRayProjector.h"

#include "vtkCallbackCommand.h"
#include "vtkImageData.h"
#include "vtkNew.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <new>
#include <string>

namespace
{
using namespace mammoray;
using testing::HasSubstr;
using testing::IsEmpty;

class FilterRequest : public testing::Test
{
protected:
  FilterRequest()
  {
    this->Listener->SetClientData(&this->Told);
    this->Listener->SetCallback([](vtkObject*, unsigned long, void* told, void* text)
      { *static_cast<std::string*>(told) += static_cast<const char*>(text); });
    this->Filter->AddObserver(vtkCommand::ErrorEvent, this->Listener);
    this->Output->SetDimensions(2, 2, 1);
  }
  int Answer(const std::function<void()>& work)
  {
    return AnswerRequest(this->Filter, this->Output, work);
  }
  vtkNew<vtkXRayProjector> Filter;
  vtkNew<vtkImageData> Output;
  vtkNew<vtkCallbackCommand> Listener;
  std::string Told;
};

TEST_F(FilterRequest, TellsFailuresAndEmptiesTheOutput)
{
  EXPECT_EQ(this->Answer([] { throw InputError("expected this, found that"); }), 0);
  EXPECT_THAT(this->Told, HasSubstr("expected this, found that"));
  EXPECT_EQ(this->Output->GetNumberOfPoints(), 0);
  this->Told.clear();
  EXPECT_EQ(this->Answer([] { throw std::bad_alloc(); }), 0);
  EXPECT_THAT(this->Told, HasSubstr("expected memory for the work, found less free"));
}

TEST_F(FilterRequest, AnInterruptIsNoFailure)
{
  EXPECT_EQ(this->Answer([] { throw Interrupted(); }), 1);
  EXPECT_EQ(this->Output->GetNumberOfPoints(), 0);
  EXPECT_EQ(this->Answer([this] { this->Output->SetDimensions(3, 2, 1); }), 1);
  EXPECT_EQ(this->Output->GetNumberOfPoints(), 6);
  EXPECT_THAT(this->Told, IsEmpty());
}
}
