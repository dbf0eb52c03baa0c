// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_FilterRequest_h
#define mammoray_FilterRequest_h

#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/Progress.h"

#include "vtkAlgorithm.h"
#include "vtkDataObject.h"

#include <exception>
#include <new>
#include <string>
#include <utility>

namespace mammoray
{
/// Moves a filter's progress from `from` to `to` of 1, and stops where the filter is aborted.
inline ProgressCallback ProgressOf(vtkAlgorithm* filter, double from = 0, double to = 1)
{
  return [=](double fraction, const char*)
  {
    filter->UpdateProgress(from + (to - from) * fraction);
    return filter->GetAbortExecute() == 0;
  };
}

/// Sets a property of a filter, which is to be made anew only where the value is another.
template <typename Value>
void SetProperty(vtkAlgorithm* filter, Value& property, Value value)
{
  if (!(property == value))
  {
    property = std::move(value);
    filter->Modified();
  }
}

/// A file that was named goes before what was chosen by name.
inline const std::string& FileOrName(const std::string& file, const std::string& name)
{
  return file.empty() ? name : file;
}

/// What a failure is told as. All are caught: a bad_alloc must not cross the pipeline either.
inline std::string TextOf(const std::exception& error)
{
  return dynamic_cast<const std::bad_alloc*>(&error)
    ? "expected memory for the work, found less free than it takes"
    : error.what();
}

/**
 * What RequestData answers that fills `output` by `work`. Where that throws, the output is emptied;
 * an interrupt is no failure, and an error is told by the filter's ErrorEvent.
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
