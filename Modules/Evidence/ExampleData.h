// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_ExampleData_h
#define mammoray_ExampleData_h

#include "mammoray/XRay/ExampleScenes.h"
#include "mammorayEvidenceModule.h"

#include <string>

namespace mammoray
{
/**
 * The example of that name (see ExampleNames). "breast" is made from the FDA phantom of the data
 * directory, as victre-phantom-1 with materials/victre.json. Throws InputError, with near names, on
 * an unknown one.
 */
MAMMORAYEVIDENCE_EXPORT ExampleScene MakeExampleScene(const std::string& name);
}

#endif
