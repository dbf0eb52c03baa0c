// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_FilterRequest_h
#define mammoray_FilterRequest_h

#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/Progress.h"

#include "vtkAlgorithm.h"
#include "vtkDataObject.h"
#include "vtkInformation.h"
#include "vtkStreamingDemandDrivenPipeline.h"

#include <exception>
#include <new>
#include <string>
#include <utility>

namespace mammoray
{
/// Moves a filter's progress from `from` to `to`, both in [0, 1]; stops the work if the filter is
/// aborted.
inline ProgressCallback ProgressOf(vtkAlgorithm* filter, double from = 0, double to = 1)
{
  return [=](double fraction, const char*)
  {
    filter->UpdateProgress(from + (to - from) * fraction);
    return filter->GetAbortExecute() == 0;
  };
}

/// Sets a property, and marks the filter as modified if the value differs.
template <typename Value>
void SetProperty(vtkAlgorithm* filter, Value& property, Value value)
{
  if (!(property == value))
  {
    property = std::move(value);
    filter->Modified();
  }
}

/// Defines the setter of a text property: a null pointer empties it, an equal text changes nothing.
#define mammorayCxxSetTextMacro(filter, name)                                                      \
  void filter::Set##name(const char* text)                                                         \
  {                                                                                                \
    mammoray::SetProperty(this, this->name, std::string(text ? text : ""));                        \
  }

/// Requests the whole image of an input, even where the output is divided into pieces.
inline void RequestWholeExtent(vtkInformation* input)
{
  using Pipeline = vtkStreamingDemandDrivenPipeline;
  if (input->Has(Pipeline::WHOLE_EXTENT()))
  {
    int whole[6];
    input->Get(Pipeline::WHOLE_EXTENT(), whole);
    input->Set(Pipeline::UPDATE_EXTENT(), whole, 6);
  }
}

/// Returns `file` unless it is empty, else `name`.
inline const std::string& FileOrName(const std::string& file, const std::string& name)
{
  return file.empty() ? name : file;
}

/// Message of a failure, also of a bad_alloc: no exception may cross the pipeline.
inline std::string TextOf(const std::exception& error)
{
  return dynamic_cast<const std::bad_alloc*>(&error)
    ? "expected memory for the work, found less free than it takes"
    : error.what();
}

/**
 * Runs `work`, which fills `output`, and returns the result of RequestData. If it throws, the
 * output is emptied. An interrupt is no failure; any other exception raises the filter's
 * ErrorEvent.
 */
template <typename Work>
int AnswerRequest(vtkAlgorithm* filter, vtkDataObject* output, const Work& work)
{
  try
  {
    work();
    return 1;
  }
  catch (const Interrupted&)
  {
    output->Initialize();
    return 1;
  }
  catch (const std::exception& error)
  {
    output->Initialize();
    vtkErrorWithObjectMacro(filter, << TextOf(error));
    return 0;
  }
}
}

#endif
