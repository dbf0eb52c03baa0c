// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_ShippedExamples_h
#define mammoray_ShippedExamples_h

#include "mammoray/XRay/ExampleScenes.h"
#include "mammorayIOModule.h"

#include <string>

namespace mammoray
{
/**
 * Makes the example of this name (see ExampleNames). "breast" is made from victre-phantom-1, the
 * FDA's phantom in the data directory, with materials/victre.json. Throws InputError with similar
 * names on an unknown one.
 */
MAMMORAYIO_EXPORT ExampleScene MakeExampleScene(const std::string& name);
}

#endif
