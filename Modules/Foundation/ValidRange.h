// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Plausible_h
#define mammoray_Plausible_h

#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/Vector3.h"
#include "mammorayFoundationModule.h"

#include <string>

namespace mammoray
{
/// What a quantity of a patient's breast, or of what pictures it, is at least and at most. Outside
/// lie other units (um, kg/m3, Pa) and damaged headers.
struct ValidRange
{
  const char* Quantity;
  double Least;
  double Most;
  const char* Unit;
};

/// All of them: paddles close to 10 to 130 mm, detectors have 0.05 to 0.1 mm (0.02 magnified, more
/// where they are binned) and are 300 mm wide at most, breast tissue 0.5 to 60 kPa, tumours up to
/// 300, calcium 2.7 g/cm3.
namespace ValidRanges
{
inline constexpr ValidRange Thickness{ "compressed thickness", 5, 150, "mm" };
inline constexpr ValidRange PixelSpacing{ "pixel spacing", 0.02, 0.3, "mm" };
inline constexpr ValidRange VoxelSpacing{ "voxel spacing", 0.05, 10, "mm" };
inline constexpr ValidRange SourceDistance{ "source to detector distance", 300, 1500, "mm" };
inline constexpr ValidRange BreastWidth{ "breast width", 30, 300, "mm" };
inline constexpr ValidRange YoungsModulus{ "Young's modulus", 0.05, 500, "kPa" };
inline constexpr ValidRange Density{ "density", 0.5, 3, "g/cm3" };
}

/// How commands let all be taken, as refusals say it.
inline constexpr const char* AcceptUnusualHint = "--accept-unusual takes it";

/// Throws InputError, which names `where`, the range, what was found and how to overrule it, unless
/// the value is in the range; NaN is in none.
MAMMORAYFOUNDATION_EXPORT void CheckValidRange(const ValidRange& range, double value,
  const std::string& where, const std::string& overrule);
/// The same of each of three, such as a grid's spacings.
MAMMORAYFOUNDATION_EXPORT void CheckValidRange(const ValidRange& range, const Vector3& values,
  const std::string& where, const std::string& overrule);

/**
 * Watches a JSON parser (the callback of nlohmann's): throws InputError, which names the file,
 * where brackets open in more than 64 others, as in none of our files. Thousands end the process
 * when such a value is printed or copied.
 */
struct JsonNestingLimit
{
  std::string Path;

  template <typename Event, typename Json>
  bool operator()(int depth, Event, Json&) const
  {
    if (depth > 64)
    {
      throw InputError(this->Path + ": expected JSON, found it nested deeper than 64");
    }
    return true;
  }
};
}

#endif
