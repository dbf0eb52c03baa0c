// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Private_SpectrumIO_h
#define mammoray_Private_SpectrumIO_h

#include "mammoray/XRay/Beam.h"
#include "mammorayIOModule.h"

#include <string>

namespace mammoray
{
/**
 * Reads a spectrum: lines of an energy (eV) and the photons per mm^2 and keV there, `#` begins a
 * comment, a last negative value ends the list. Each value stands for the interval up to the next
 * energy. Throws InputError, which names the line, on anything else. Name: the file's without
 * folder and extension.
 */
MAMMORAYIO_EXPORT Spectrum ReadSpectrum(const std::string& path);
}

#endif
