// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_ScatterData_h
#define mammoray_ScatterData_h

#include "mammoray/Foundation/MaterialTable.h"
#include "mammoray/XRay/Scatter/Photons.h"
#include "mammoray/XRay/Scatter/ScatterModel.h"
#include "mammorayIOModule.h"

#include <string>
#include <vector>

namespace mammoray
{
/**
 * Reads scatter kernels from lines of a name, a comma and values: composition, density_g_per_cm3,
 * energies_keV, thicknesses_mm, gaps_mm, radii_mm, angles_deg, multiple; then `shares` lines, one
 * for each energy, thickness and gap. `#` begins a comment. Throws InputError, which names the
 * line.
 */
MAMMORAYIO_EXPORT ScatterKernels ReadScatterKernels(const std::string& path);

/// Writes such a table, with a comment as its first line. Throws InputError if it cannot.
MAMMORAYIO_EXPORT void WriteScatterKernels(const ScatterKernels& kernels,
  const std::string& comment, const std::string& path);

/// Reads kernels from a path, or by their name from scatter/ of the data directory: "breast".
MAMMORAYIO_EXPORT ScatterKernels FindScatterKernels(const std::string& pathOrName = "breast");

/**
 * Returns the elements that photons collide with in the table's materials. The compositions are
 * ICRP's and Hammerstein's for the names of shipped attenuations, otherwise those that the names
 * spell; air is that near sea level. Throws InputError on a material without a known composition.
 */
MAMMORAYIO_EXPORT std::vector<PhotonMaterial> MakePhotonMaterials(const MaterialTable& materials);
/// The texts of the same compositions, by material; unchecked.
MAMMORAYIO_EXPORT std::vector<std::string> PhotonCompositions(const MaterialTable& materials);
}

#endif
