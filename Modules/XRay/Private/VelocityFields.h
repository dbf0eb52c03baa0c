// SPDX-License-Identifier: Apache-2.0
// Velocity fields on their way to a device, and the rates of change of path lengths back.
#ifndef mammoray_VelocityFields_h
#define mammoray_VelocityFields_h

#include "Private/ProjectionReadout.h"
#include "mammoray/XRay/PathLengthProjector.h"
#include "mammorayXRayModule.h"

#include <array>
#include <cstddef>
#include <span>

namespace mammoray
{
/// Velocity fields done in one pass at the most.
constexpr int MostFieldsPerPass = 8;

/// The fields [First, First + Count) of a pass. The device is handed each field times its Factor;
/// what it answers times Unit is mm per unit of the field's parameter.
struct FieldBatch
{
  int First = 0;
  int Count = 0;
  std::array<double, MostFieldsPerPass> Factor{ 1, 1, 1, 1, 1, 1, 1, 1 };
  std::array<double, MostFieldsPerPass> Unit{ 1, 1, 1, 1, 1, 1, 1, 1 };
};

/// Fields per pass when at most `most`, at least 1, fit into one: all passes equally large, as near
/// as can be.
MAMMORAYXRAY_EXPORT int FieldsPerPass(int fields, int most);

/// Sizes the derivatives of an image of so many materials.
MAMMORAYXRAY_EXPORT void PrepareDerivatives(const XRayDetector& detector, int materials, int fields,
  PathLengthDerivatives& derivatives);

/// Largest speed of a field, mm per unit of its parameter.
MAMMORAYXRAY_EXPORT double LargestSpeed(std::span<const double> field);

/// Writes the fields of a batch in the devices' order, value[(point * Count + field) * 3 + axis],
/// each times its factor.
MAMMORAYXRAY_EXPORT void WriteVelocities(const VectorFields& velocities, const FieldBatch& batch,
  float* target);

/// Copies the rates of a batch, planes of field and material of range.Count values each, to a range
/// of the pixels, each field times its unit.
MAMMORAYXRAY_EXPORT void ReadRates(const float* rates, const FieldBatch& batch,
  const PixelRange& range, PathLengthDerivatives& derivatives);
}

#endif
