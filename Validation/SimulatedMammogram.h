// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Validation_SimulatedMammogram_h
#define mammoray_Validation_SimulatedMammogram_h

#include "mammoray/Foundation/Mammogram.h"

#include <array>
#include <cstdint>
#include <random>
#include <vector>

namespace mammoray
{
/// Random numbers of a problem, the same on every machine.
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

/// How the unit stores the picture.
enum class PictureKind
{
  /// For Presentation: logarithm, then a sigmoid.
  Display,
  /// For Presentation with equalisation as vendors apply it: 0.7 of the variation over more than
  /// 12 mm within the breast is subtracted before the sigmoid.
  Equalised,
  /// For Processing: intensities.
  Raw,
  /// For Processing with a heel effect, which takes up to 20 % of the intensity towards the nipple,
  /// and scatter: half of the primary radiation behind the breast, spread over 15 mm. (Boone 2000:
  /// 0.3 to 1 without a grid.)
  Scattered
};

inline constexpr std::array<PictureKind, 4> PictureKinds{ PictureKind::Display,
  PictureKind::Equalised, PictureKind::Raw, PictureKind::Scattered };

/// "display", "equalised", "raw", "scattered".
const char* NameOf(PictureKind kind);

/// Size of a detector along the chest wall and from the chest wall to the nipple, mm.
struct DetectorField
{
  double WidthMm;
  double DepthMm;
};
inline constexpr DetectorField SmallField{ 240, 180 };
inline constexpr DetectorField LargeField{ 300, 240 };

/// The pixel grid of a detector, displayed as mammograms are. `up` is the gantry x direction of the
/// image's upper side: 1 for the left breast (chest wall at the left), -1 for the right one (chest
/// wall at the right).
ReceptorGrid SimulatedDetector(double pixelMm, double up = 1,
  const DetectorField& field = SmallField);

/// Whether a picture on such a detector shows tissue at the border opposite the chest wall.
bool IsCutAtFront(const std::vector<float>& logAttenuation, const ReceptorGrid& grid);

struct DevelopOptions
{
  PictureKind Kind = PictureKind::Display;
  /// Standard deviation of the noise relative to the intensity.
  double Noise = 0.02;
};

/// The mammogram as a unit stores it, in 12 bits. `header`: its other fields.
Mammogram Develop(Mammogram header, const std::vector<float>& logAttenuation,
  const ReceptorGrid& grid, const DevelopOptions& options, Draws& draws);
}

#endif
