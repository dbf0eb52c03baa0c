// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_ReducedEquilibria_h
#define mammoray_ReducedEquilibria_h

#include "mammoray/Biomechanics/CompressionSimulation.h"
#include "mammoray/Foundation/PoseParameters.h"
#include "mammorayAppModule.h"

#include <array>
#include <optional>
#include <vector>

namespace mammoray
{
/// An equilibrium and how its nodes and its force change, to first order, with thickness (per mm)
/// and roll (per degree).
struct KnownEquilibrium
{
  BreastPose Pose;
  CompressionState State;
  /// 3 x nodeCount, mm, volume frame.
  std::array<std::vector<double>, 2> PositionRates;
  std::array<double, 2> ForceRates{ 0, 0 };
};

/// What known equilibria say of a pose between them.
struct ReducedEquilibrium
{
  std::vector<double> Positions;
  double PaddleForceN = 0;
  /// How many were used, and how far the nearest is, mm of thickness and degrees of roll.
  int From = 0;
  double Nearest = 0;
};

/**
 * Equilibria of one breast in one unit without solving for them: the first-order continuations of
 * the known ones, weighted by the inverse fourth power of their distance (Shepard 1968, with the
 * tangents of Franke & Nielson 1980). At a known one it is that one, and so are its rates there.
 */
class MAMMORAYAPP_EXPORT ReducedEquilibria
{
public:
  /// Farther from every known one, mm or degrees, there is no answer: tissue that folds or comes to
  /// rest on a plate is not foreseen.
  static constexpr double Reach = 12;
  /// As many are kept, the oldest is forgotten.
  static constexpr std::size_t MostKnown = 16;

  /// All are of one mesh.
  void Add(KnownEquilibrium known);
  /// The known one that is nearest; null without one.
  const KnownEquilibrium* Nearest(const BreastPose& pose) const;
  /// Its distance, mm or degrees; infinite without one.
  double Distance(const BreastPose& pose) const;
  /// Nothing where none is within Reach. Only thickness and roll of the pose count.
  std::optional<ReducedEquilibrium> At(const BreastPose& pose) const;

private:
  std::vector<KnownEquilibrium> Known;
};
}

#endif
