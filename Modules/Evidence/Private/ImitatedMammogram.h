// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Private_ImitatedMammogram_h
#define mammoray_Private_ImitatedMammogram_h

#include "mammoray/Evidence/TwinExperiment.h"
#include "mammoray/Foundation/Mammogram.h"
#include "mammoray/Foundation/ReceptorGrid.h"
#include "mammorayEvidenceModule.h"

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

/// The fields that a unit has: along the chest wall and from there to the nipple, mm.
struct DetectorField
{
  double WidthMm;
  double DepthMm;
};
inline constexpr DetectorField SmallField{ 240, 180 };
inline constexpr DetectorField LargeField{ 300, 240 };

/// A detector, hung as mammograms are: with the side of the body up that `up` names, 1 (gantry +x,
/// the left breast; chest wall at the left) or -1 (the right breast; chest wall at the right).
MAMMORAYEVIDENCE_EXPORT ReceptorGrid ImitatedDetector(double pixelMm, double up = 1,
  const DetectorField& field = SmallField);

/// Whether a picture on such a detector shows tissue at its border opposite the chest wall.
MAMMORAYEVIDENCE_EXPORT bool IsCutAtFront(const std::vector<float>& logAttenuation,
  const ReceptorGrid& grid);

struct DevelopOptions
{
  PictureKind Kind = PictureKind::Display;
  /// Standard deviation of intensities, of the intensity.
  double Noise = 0.02;
};

/// As a unit stores it, 12 bits. `header`: what else the image says.
MAMMORAYEVIDENCE_EXPORT Mammogram Develop(Mammogram header,
  const std::vector<float>& logAttenuation, const ReceptorGrid& grid, const DevelopOptions& options,
  Draws& draws);
}

#endif
