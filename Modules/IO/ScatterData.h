// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_ScatterData_h
#define mammoray_ScatterData_h

#include "mammoray/Foundation/MaterialTable.h"
#include "mammoray/XRay/Scatter/PhotonMaterial.h"
#include "mammoray/XRay/Scatter/ScatterKernels.h"
#include "mammorayIOModule.h"

#include <string>
#include <vector>

namespace mammoray
{
/**
 * Lines of a name, a comma and values: composition, density_g_per_cm3, energies_keV,
 * thicknesses_mm, gaps_mm, radii_mm, angles_deg, multiple; then `shares` lines, one for each
 * energy, thickness and gap. `#` begins a comment. Throws InputError, which names the line.
 */
MAMMORAYIO_EXPORT ScatterKernels ReadScatterKernels(const std::string& path);

/// The shipped table of what breast tissue scatters: scatter/breast.csv of the data directory.
MAMMORAYIO_EXPORT ScatterKernels FindScatterKernels();
/// Writes such a table with a first line that says where it is from. Throws InputError as
/// WriteAtomicFile does.
MAMMORAYIO_EXPORT void WriteScatterKernels(const ScatterKernels& kernels,
  const std::string& comment, const std::string& path);

/**
 * What photons collide with in the table's materials: of the shipped attenuations by their names,
 * ICRP's and Hammerstein's tissues, of others the composition that the name spells. Air is that
 * near sea level. Throws InputError on a material of which no composition is known.
 */
MAMMORAYIO_EXPORT std::vector<PhotonMaterial> MakePhotonMaterials(const MaterialTable& materials);
}

#endif
