// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_MaterialTableIO_h
#define mammoray_MaterialTableIO_h

#include "mammoray/Foundation/MaterialTable.h"
#include "mammorayIOModule.h"

#include <string>

namespace mammoray
{
/**
 * Reads a material table from JSON:
 *
 *     { "name": "...", "description": "...", "materials": [
 *         { "name": "air", "labels": [0] },
 *         { "name": "fat", "labels": [1], "attenuation": "adipose", "density_g_per_cm3": 0.92,
 *           "youngs_modulus_kpa": 5, "poisson_ratio": 0.49, "fixed": false, "thin": false }, ... ]
 * }
 *
 * The first material is air and takes a name and labels only. The others need name, labels (whole
 * numbers in [0, 65535], at least one; a thin material may leave them out and be made by AddSkin)
 * and attenuation: a name or composition for
 * FindAttenuationTable, or an object of mass fractions, { "H": 0.112, "O": 0.888 }. The density is
 * needed where the attenuation has none of its own (AttenuationTable::DensityOf).
 * "iodine_mg_per_ml", elastic constants (with "fung_exponent"), "fixed" and "thin" default to those
 * of Material; the table's "name" defaults to the file's name. A density or modulus outside its
 * ValidRange requires "unusual": true. Throws InputError, with file and key, on a wrong type or
 * range, an unknown or repeated key, and a label or name used twice.
 */
MAMMORAYIO_EXPORT MaterialTable ReadMaterialTable(const std::string& path);
/// Parses such a table from a JSON text; messages begin with the key.
MAMMORAYIO_EXPORT MaterialTable ParseMaterialTable(const std::string& text);
}

#endif
