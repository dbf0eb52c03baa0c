// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Validation_SimulatedMri_h
#define mammoray_Validation_SimulatedMri_h

#include "PatientTissue.h"
#include "SimulatedMammogram.h"
#include "mammoray/Foundation/Progress.h"
#include "mammoray/Foundation/Volumes.h"

#include <array>
#include <vector>

namespace mammoray
{
/// Signal of each tissue; fat in plain T1 is 1.
using TissueSignals = std::array<double, TissueCount>;

// From the tissues' T1 (Rakow-Penner 2006 at 1.5 T: fat 0.30 s, gland 1.27 s; muscle about 1.0 s)
// and from real series: fat is brightest in plain T1, and SPAIR leaves a quarter of it.
inline constexpr TissueSignals PlainT1{ 0.005, 1.0, 0.42, 0.5, 0.38, 0.3, 0.04 };
inline constexpr TissueSignals SuppressedT1{ 0.005, 0.2, 0.68, 0.5, 0.55, 0.12, 0.03 };
inline constexpr TissueSignals EnhancedT1{ 0.005, 0.2, 0.85, 0.6, 0.62, 0.14, 0.05 };
inline constexpr TissueSignals PlainT2{ 0.005, 0.9, 0.7, 0.3, 0.2, 0.3, 0.02 };

/// Receiving coils: a loop in front of each breast.
struct CoilPair
{
  /// DICOM LPS, mm.
  std::vector<Vector3> Centres;
  /// Distance at which the sensitivity of a coil has fallen to half, mm.
  double HalfAtMm = 90;
  /// The point at which the sensitivity is 1.
  Vector3 Reference{ 0, 0, 0 };

  double At(const Vector3& point) const;
};

/**
 * Simulates one volume for each set of signals on the grid: the mean of 2 x 2 x 2 samples in each
 * voxel, times the coils' sensitivity, with Rician noise of this standard deviation; multiplied by
 * `scale`, rounded and limited to 4095. Each volume has its own noise. Throws Interrupted.
 */
std::vector<IntensityVolume> SimulateMri(const LabelVolume& tissue, const VolumeGrid& grid,
  const std::vector<TissueSignals>& signals, const CoilPair& coils, double deviation, double scale,
  Draws& draws, const ProgressCallback& progress = {});
}

#endif
