// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Private_SpectrumIO_h
#define mammoray_Private_SpectrumIO_h

#include "mammoray/XRay/Beam.h"
#include "mammorayIOModule.h"

#include <string>

namespace mammoray
{
/**
 * Reads a spectrum. Name: the file's without folder and extension.
 *
 * .spc: lines of an energy (eV) and the photons per mm^2 and keV there, `#` begins a comment, a
 * last negative value ends the list. Each value stands for the interval up to the next energy.
 *
 * Other extensions: two columns, parted by comma, semicolon (then with decimal commas, too), tab or
 * blanks, after any header lines; or three, both edges of a bin and its photons. The header names
 * the unit (eV, keV, MeV), otherwise it follows from the last energy, which lies between 2 keV and
 * 2 MeV. Energies are the centres of bins; lower edges if the header says so, if the first one is 0
 * or if a last edge without photons follows. Values are photons per bin, or per energy if the
 * header says so. A note tells what was inferred.
 *
 * Throws InputError, which names the line, on anything else.
 */
MAMMORAYIO_EXPORT Spectrum ReadSpectrum(const std::string& path);
}

#endif
