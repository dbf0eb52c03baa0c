// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Private_ImitatedMri_h
#define mammoray_Private_ImitatedMri_h

#include "Private/ImitatedMammogram.h"
#include "Private/PatientTissue.h"
#include "mammoray/Foundation/IntensityVolume.h"
#include "mammoray/Foundation/Progress.h"
#include "mammorayEvidenceModule.h"

#include <array>
#include <vector>

namespace mammoray
{
/// Signal of each tissue, fat of the plain T1 being 1.
using TissueSignals = std::array<double, TissueCount>;

// By the tissues' T1 (Rakow-Penner 2006 at 1.5 T: fat 0.30 s, gland 1.27 s; muscle about
// 1.0 s) and by what real series show: fat brightest in plain T1, a quarter of it left by SPAIR.
inline constexpr TissueSignals PlainT1{ 0.005, 1.0, 0.42, 0.5, 0.38, 0.3, 0.04 };
inline constexpr TissueSignals SuppressedT1{ 0.005, 0.2, 0.68, 0.5, 0.55, 0.12, 0.03 };
inline constexpr TissueSignals EnhancedT1{ 0.005, 0.2, 0.85, 0.6, 0.62, 0.14, 0.05 };
inline constexpr TissueSignals PlainT2{ 0.005, 0.9, 0.7, 0.3, 0.2, 0.3, 0.02 };

/// Receiving coils: a loop in front of each breast.
struct MAMMORAYEVIDENCE_EXPORT CoilPair
{
  /// Centres, DICOM LPS, mm, and the distance at which their sensitivity is halved.
  std::vector<Vector3> Centres;
  double HalfAtMm = 90;
  /// Where the sensitivity counts as 1.
  Vector3 Reference{ 0, 0, 0 };

  double At(const Vector3& point) const;
};

/**
 * One volume for each set of signals on the grid: the mean of 2 x 2 x 2 places in each voxel, times
 * the coils' sensitivity, with Rician noise of this deviation; `scale` times that, rounded, at most
 * 4095. The noise is drawn anew for each volume. Throws Interrupted.
 */
MAMMORAYEVIDENCE_EXPORT std::vector<IntensityVolume> PictureTissue(const LabelVolume& tissue,
  const VolumeGrid& grid, const std::vector<TissueSignals>& signals, const CoilPair& coils,
  double deviation, double scale, Draws& draws, const ProgressCallback& progress = {});
}

#endif
