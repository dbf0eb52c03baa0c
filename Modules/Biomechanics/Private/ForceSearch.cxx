// SPDX-License-Identifier: Apache-2.0
#include "Private/ForceSearch.h"

#include "mammoray/Foundation/Error.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <limits>
#include <optional>
#include <string>

namespace mammoray
{
namespace
{
/// Relative tolerance of the force, largest change of the gap in one step, mm, and the smallest
/// step, mm, towards more force before the search gives up.
constexpr double ForceTolerance = 1e-4;
constexpr double LargestForceStepMm = 5;
constexpr double SmallestForceStepMm = 0.1;
constexpr int MostForceSteps = 60;
/// Fraction of the gap without contact at which the search begins.
constexpr double FirstGap = 0.85;

}

CompressionState FindForce(CompressionSimulation& simulation, bool hasFriction,
  const PlatePair& plates, const PlatePairVelocity& closing, double forceN,
  const ProgressCallback& progress)
{
  const auto begin = std::chrono::steady_clock::now();
  const double speed = GapMm(plates) - GapMm(MovedPlates(plates, closing, 1));
  if (!(forceN > 0) || !std::isfinite(forceN) || !(speed > 0))
  {
    throw InputError("compression: expected a positive force and a motion that closes the plates");
  }
  // `at` and the bracket are the closing of the gap from the given plates, mm.
  const double open = GapMm(simulation.OpenedPlates(plates, progress));
  double at = GapMm(plates) - FirstGap * open;
  const auto platesAt = [&](double closed) { return MovedPlates(plates, closing, closed / speed); };
  CompressionState state = simulation.Compress(platesAt(at), nullptr, progress);
  double tooLittle = -std::numeric_limits<double>::infinity();
  double tooMuch = std::numeric_limits<double>::infinity();
  int newtonSteps = state.NewtonSteps;
  int loadSteps = state.LoadSteps;
  double allowed = LargestForceStepMm;
  // With friction a state must not be reached from a more closed one: friction would point the
  // other way.
  std::optional<CompressionState> below;
  for (int step = 0; std::abs(state.PaddleForceN / forceN - 1) > ForceTolerance; ++step)
  {
    (state.PaddleForceN < forceN ? tooLittle : tooMuch) = at;
    if (hasFriction && state.PaddleForceN < forceN)
    {
      below = state;
      tooMuch = std::numeric_limits<double>::infinity(); // on the way from another state
    }
    // The force grows faster than linearly with the closing; its logarithm is closer to linear.
    double by = state.PaddleForceN < forceN ? allowed : -allowed;
    if (state.PaddleForceN > 0)
    {
      const double rate = simulation.PaddleForceDerivative(state, closing) / speed;
      const double wanted = std::log(forceN / state.PaddleForceN) * state.PaddleForceN / rate;
      by = rate > 0 ? std::clamp(wanted, -allowed, allowed) : by;
    }
    if (!(at + by > tooLittle && at + by < tooMuch))
    {
      by = 0.5 * (tooLittle + tooMuch) - at;
    }
    std::string reason;
    if (step == MostForceSteps)
    {
      reason = "not reached in " + std::to_string(step) + " steps";
    }
    else
    {
      try
      {
        const CompressionState* from = hasFriction ? (below ? &*below : nullptr) : &state;
        state = simulation.Compress(platesAt(at + by), from, progress);
        at += by;
        newtonSteps += state.NewtonSteps;
        loadSteps += state.LoadSteps;
        continue;
      }
      catch (const CompressionError& error)
      {
        allowed = 0.5 * std::min(allowed, std::abs(by));
        if (allowed > SmallestForceStepMm)
        {
          continue;
        }
        reason = "the plates cannot be closed farther";
      }
    }
    char text[160];
    std::snprintf(text, sizeof text,
      "compression: expected a force of %.2f N, found %.2f N at the last gap, %.2f mm (%s)", forceN,
      state.PaddleForceN, GapMm(state.Plates), reason.c_str());
    throw CompressionError(text, GapMm(state.Plates), reason);
  }
  state.NewtonSteps = newtonSteps;
  state.LoadSteps = loadSteps;
  state.Seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return state;
}
}
