// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_ShippedData_h
#define mammoray_ShippedData_h

#include "mammoray/Foundation/MaterialTable.h"
#include "mammoray/XRay/Beam.h"
#include "mammoray/XRay/Exposure.h"
#include "mammorayIOModule.h"

#include <string>
#include <vector>

namespace mammoray
{
/**
 * Returns the folder that holds attenuation/, spectra/ and materials/. It is the environment
 * variable MAMMORAY_DATA, otherwise the source tree's Data if it exists, otherwise share/mammoray
 * of the installation. Throws InputError if none exists.
 */
MAMMORAYIO_EXPORT std::string DataDirectory();

/**
 * Returns the table attenuation/NAME.csv of the data directory; or numbers, "0.05/mm" for all
 * energies or "20:0.05 30:0.02/mm" by keV; or the table of the composition which the name spells
 * (see FindComposition). Otherwise throws InputError with similar or all names.
 */
MAMMORAYIO_EXPORT AttenuationTable FindAttenuationTable(const std::string& name);

/**
 * Reads a spectrum from a path, or by its name from spectra/ of the data directory. Throws
 * InputError with the known names if neither exists.
 */
MAMMORAYIO_EXPORT Spectrum FindSpectrum(const std::string& pathOrName);

/**
 * Reads a material table from a path, or by its name from materials/ of the data directory
 * ("victre", "segment"; see Data/README.md). Throws InputError with similar or all names if neither
 * exists.
 */
MAMMORAYIO_EXPORT MaterialTable FindMaterialTable(const std::string& pathOrName);

/// Returns the path of the file that FindMaterialTable reads.
MAMMORAYIO_EXPORT std::string FindMaterialTablePath(const std::string& pathOrName);

/// Reads the signal that a detector gets from a photon: lines of an energy (keV), a comma and the
/// signal in any unit. `#` begins a comment. Throws InputError, which names the line.
MAMMORAYIO_EXPORT DetectorResponse ReadDetectorResponse(const std::string& path);

/// Reads a detector's line spread function: lines of a distance from the line, mm, a comma and a
/// value in any unit. With negative distances, which begin on the other side of the line, the mean
/// of both sides counts. `#` begins a comment. Throws InputError, which names the line.
MAMMORAYIO_EXPORT LineSpread ReadLineSpread(const std::string& path);

/// Returns the attenuation of a material with its iodine. Throws InputError, which names the
/// material.
MAMMORAYIO_EXPORT AttenuationTable FindAttenuation(const Material& material);

/// Returns the attenuations of a table's materials with their iodine; that of air has no energies.
/// Throws InputError, which names the material, on an unknown attenuation.
MAMMORAYIO_EXPORT std::vector<AttenuationTable> FindAttenuations(const MaterialTable& materials);

/// Returns the beam for path lengths in the table's materials. Throws InputError on an unknown
/// attenuation.
MAMMORAYIO_EXPORT Beam MakeBeam(const MaterialTable& materials, const Spectrum& spectrum,
  const DetectorResponse& response);
}

#endif
