// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_ExampleData_h
#define mammoray_ExampleData_h

#include "mammoray/XRay/ExampleScenes.h"
#include "mammorayIOModule.h"

#include <string>

namespace mammoray
{
/**
 * The example of that name (see ExampleNames). "breast" is made from the FDA phantom of the data
 * directory, as victre-phantom-1 with materials/victre.json. Throws InputError, with near names, on
 * an unknown one.
 */
MAMMORAYIO_EXPORT ExampleScene MakeExampleScene(const std::string& name);
}

#endif
