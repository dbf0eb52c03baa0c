// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_ShippedData_h
#define mammoray_ShippedData_h

#include "mammoray/Foundation/MaterialTable.h"
#include "mammoray/XRay/Beam.h"
#include "mammoray/XRay/ExampleScenes.h"
#include "mammorayIOModule.h"

#include <string>
#include <vector>

namespace mammoray
{
/**
 * Folder that holds attenuation/, spectra/ and materials/: the environment variable MAMMORAY_DATA,
 * else the source tree's Data as long as it exists, else share/mammoray of the installation. Throws
 * InputError when none of them is there.
 */
MAMMORAYIO_EXPORT std::string DataDirectory();

/**
 * The table attenuation/NAME.csv of the data directory, or the composition that the name spells
 * (see FindComposition); throws InputError with near or all known names otherwise.
 */
MAMMORAYIO_EXPORT AttenuationTable FindAttenuationTable(const std::string& name);

/**
 * A spectrum from a path, or by its name in spectra/ of the data directory; throws InputError with
 * the known names when neither exists.
 */
MAMMORAYIO_EXPORT Spectrum FindSpectrum(const std::string& pathOrName);

/**
 * A material table from a path, or by its name in materials/ of the data directory ("victre",
 * "segment"; see Data/README.md); throws InputError with near or all known names when neither
 * exists.
 */
MAMMORAYIO_EXPORT MaterialTable FindMaterialTable(const std::string& pathOrName);

/// The path of that table's file.
MAMMORAYIO_EXPORT std::string FindMaterialTablePath(const std::string& pathOrName);

/// Reads what a detector adds up of a photon: lines of an energy (keV), a comma and the signal, any
/// factor; `#` begins a comment. Throws InputError that names the line.
MAMMORAYIO_EXPORT DetectorResponse ReadDetectorResponse(const std::string& path);

/// The attenuation of a material with its iodine. Throws InputError, which names the material.
MAMMORAYIO_EXPORT AttenuationTable FindAttenuation(const Material& material);

/// The attenuations of a table's materials, with their iodine; air's has no energies. Throws
/// InputError, which names the material, on an unknown attenuation.
MAMMORAYIO_EXPORT std::vector<AttenuationTable> FindAttenuations(const MaterialTable& materials);

/// The beam for path lengths in the table's materials. Throws InputError on an unknown attenuation
/// table.
MAMMORAYIO_EXPORT Beam MakeBeam(const MaterialTable& materials, const Spectrum& spectrum,
  const DetectorResponse& response);

/**
 * The example of that name (see ExampleNames). "breast" is made from the FDA phantom of the data
 * directory, as victre-phantom-1 with materials/victre.json. Throws InputError, with near names, on
 * an unknown one.
 */
MAMMORAYIO_EXPORT ExampleScene MakeExampleScene(const std::string& name);
}

#endif
