// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Private_ImitatedMammogram_h
#define mammoray_Private_ImitatedMammogram_h

#include "mammoray/Foundation/Mammogram.h"
#include "mammoray/Registration/RegistrationTarget.h"

#include <cstdint>
#include <random>
#include <vector>

namespace mammoray
{
/// Numbers of a problem, the same on every machine.
class Draws
{
public:
  Draws(std::uint32_t seed, int number, int attempt)
  {
    std::seed_seq sequence{ seed, static_cast<std::uint32_t>(number),
      static_cast<std::uint32_t>(attempt) };
    this->Generator.seed(sequence);
  }
  double Between(double low, double high)
  {
    return low + (high - low) * (this->Generator() + 0.5) / 4294967296.0;
  }
  double Sign() { return this->Between(-1, 1) < 0 ? -1 : 1; }
  std::mt19937& Bits() { return this->Generator; }

private:
  std::mt19937 Generator;
};

/**
 * A detector of 24 x 18 cm, its rows from chest wall to nipple, hung with the side of the body up
 * that `up` (1 or -1 along gantry x) names.
 */
RegistrationTarget ImitatedDetector(double pixelMm, double up = 1);

/// As a unit stores it for display: noisy intensities through a sigmoid, 12 bits. `header`: what
/// else the image says.
Mammogram Develop(Mammogram header, const std::vector<float>& logAttenuation,
  const RegistrationTarget& grid, double noise, Draws& draws);
}

#endif
