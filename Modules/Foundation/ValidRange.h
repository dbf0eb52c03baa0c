// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_ValidRange_h
#define mammoray_ValidRange_h

#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/Vector3.h"
#include "mammorayFoundationModule.h"

#include <string>
#include <vector>

namespace mammoray
{
/// The values that a quantity of a breast or of its imaging can have. Values outside come from
/// other units (um, kg/m3, Pa) or damaged headers.
struct ValidRange
{
  const char* Quantity;
  double Least;
  double Most;
  const char* Unit;
  /// The field that holds the value (RefusedField).
  const char* Field;
  /// A thousandth of the unit, in which others state the value.
  const char* Thousandth;
};

/// Paddles close to 10 to 130 mm. Pixels of detectors are 0.05 to 0.1 mm (0.02 magnified, more
/// where they are binned), and detectors are at most 300 mm wide. Breast tissue has 0.5 to 60 kPa,
/// tumours up to 300. Calcium has 2.7 g/cm3; of what a
/// part is made of, foam has 0.01 and osmium 22.6.
namespace ValidRanges
{
inline constexpr ValidRange Thickness{ "compressed thickness", 5, 150, "mm", "ThicknessMm", "um" };
inline constexpr ValidRange PixelSpacing{ "pixel spacing", 0.02, 0.3, "mm", "PixelSpacingMm",
  "um" };
inline constexpr ValidRange VoxelSpacing{ "voxel spacing", 0.05, 10, "mm", "SpacingMm", "um" };
inline constexpr ValidRange SourceDistance{ "source to detector distance", 300, 1500, "mm",
  "SourceToDetectorMm", "um" };
inline constexpr ValidRange BreastWidth{ "breast width", 30, 300, "mm", "Width", "um" };
inline constexpr ValidRange YoungsModulus{ "Young's modulus", 0.05, 500, "kPa", "YoungsModulusKPa",
  "Pa" };
inline constexpr ValidRange Density{ "density", 0.5, 3, "g/cm3", "DensityGPerCm3", "kg/m3" };
inline constexpr ValidRange PartDensity{ "density", 5e-5, 23, "g/cm3", "DensityGPerCm3", "kg/m3" };
}

/// Throws InputError that names `where`, the range, the value and the remedies unless the value is
/// in the range. NaN is in no range.
MAMMORAYFOUNDATION_EXPORT void CheckValidRange(const ValidRange& range, double value,
  const std::string& where, const std::vector<std::string>& remedies = { "AcceptUnusual" });
/// Checks each of three values, such as a grid's spacings.
MAMMORAYFOUNDATION_EXPORT void CheckValidRange(const ValidRange& range, const Vector3& values,
  const std::string& where, const std::vector<std::string>& remedies = { "AcceptUnusual" });

/**
 * Callback of nlohmann's JSON parser. Throws InputError that names the file where values are nested
 * deeper than 64: thousands of levels overflow the stack when such a value is printed or copied.
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
