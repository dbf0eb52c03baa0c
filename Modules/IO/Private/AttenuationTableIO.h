// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Private_AttenuationTableIO_h
#define mammoray_Private_AttenuationTableIO_h

#include "mammoray/XRay/Beam.h"
#include "mammorayIOModule.h"

#include <string>

namespace mammoray
{
/**
 * Reads comma-separated columns, among them energy_eV and mu_total_per_cm (1/cm at nominal
 * density), with a first comment line that says "nominal density <number> g/cm3". Throws
 * InputError, which names the line.
 */
MAMMORAYIO_EXPORT AttenuationTable ReadAttenuationTable(const std::string& path);
}

#endif
