// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_FailedRequest_h
#define mammoray_FailedRequest_h

#include "mammoray/Foundation/Error.h"

#include "vtkDataObject.h"
#include "vtkObject.h"

#include <exception>

namespace mammoray
{
/**
 * What a filter's RequestData answers to the exception being handled: its output is emptied, an
 * interrupt is no failure, and an error is told. To be called in a catch block.
 */
inline int FailedRequest(vtkObject* filter, vtkDataObject* output)
{
  output->Initialize();
  try
  {
    throw;
  }
  catch (const Interrupted&)
  {
    return 1;
  }
  catch (const std::exception& error) // bad_alloc must not cross the pipeline either
  {
    vtkErrorWithObjectMacro(filter, << error.what());
    return 0;
  }
}
}

#endif
