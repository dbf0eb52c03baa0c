// SPDX-License-Identifier: Apache-2.0
// Coefficients of J. M. Boone, T. R. Fewell and R. J. Jennings, "Molybdenum, rhodium, and tungsten
// anode spectral models using interpolating polynomials with application to mammography", Med.
// Phys. 24 (1997) 1863-1874, as published with it (EPAPS E-MPHYA-24-1863).
#ifndef mammoray_TubeCoefficients_h
#define mammoray_TubeCoefficients_h

#include <array>
#include <vector>

namespace mammoray
{
/// Photons of a bin of 0.5 keV at U kV: a0 + a1 U + a2 U^2 + a3 U^3, none where that is negative.
using TubePolynomial = std::array<double, 4>;

struct TubeAnode
{
  const char* Name;
  /// The first bin's middle, keV; the others follow every 0.5 keV.
  double FirstKeV;
  const std::vector<TubePolynomial>* Bins;
};

const std::vector<TubeAnode>& TubeAnodes();
}

#endif
