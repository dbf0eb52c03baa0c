// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_ViewEvaluator_h
#define mammoray_ViewEvaluator_h

#include "Private/RegistrationResiduals.h"
#include "mammoray/Foundation/Progress.h"
#include "mammorayRegistrationModule.h"

#include <chrono>
#include <memory>
#include <vector>

namespace mammoray
{
using Clock = std::chrono::steady_clock;

inline double SecondsSince(Clock::time_point begin)
{
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

/// Adds the time that a scope takes to a sum, s.
class ScopeTimer
{
public:
  explicit ScopeTimer(double& seconds)
    : Seconds(seconds)
  {
  }
  ScopeTimer(const ScopeTimer&) = delete;
  ScopeTimer& operator=(const ScopeTimer&) = delete;
  ~ScopeTimer() { this->Seconds += SecondsSince(this->Begin); }

private:
  double& Seconds;
  Clock::time_point Begin = Clock::now();
};

/// If the plates travel farther than this, a cold start is cheaper than starting from another
/// state, mm.
inline constexpr double LongestWarmTravelMm = 8;

/// Travel of the plates from those of a state to those of a pose, mm.
double TravelFrom(const CompressionState& state, const UnitPlacement& placement,
  const BreastPose& pose);

/// The breast of one view: the model, that of its bodies which a search compresses, and the unit.
struct MAMMORAYREGISTRATION_EXPORT SearchedBreast
{
  BreastModel* Model = nullptr;
  BreastBody* Body = nullptr;
  UnitPlacement Placement;

  std::shared_ptr<PosedBreast> At(const std::vector<double>& values, CompressionState state) const;
};

/// The residuals of one view at one resolution, and the equilibrium they belong to.
class MAMMORAYREGISTRATION_EXPORT ViewEvaluator
{
public:
  /// `values`: all parameters where the search stands, and `current` the breast there.
  ViewEvaluator(const SearchedBreast& breast, RegistrationResiduals compared,
    std::vector<double> values, std::shared_ptr<PosedBreast> current,
    const ProgressCallback& progress);
  ViewEvaluator(const ViewEvaluator&) = delete;

  enum class Answer
  {
    Found,
    /// Too far from the accepted equilibrium to be tried.
    Refused,
    NoEquilibrium,
    Stopped
  };

  /// Compresses at Values, from the accepted state, unless Current belongs to them.
  Answer Compress();
  /// Steps are taken from Current on. Not from a step that was refused: one that went too far can
  /// fall to the breast's other side between the plates, and all shorter ones from there would
  /// stay.
  void Accept() { this->Accepted = this->Current; }
  /// Appends the residuals at Current.
  void AppendResiduals(std::vector<double>& residuals);
  /// Columns[parameter] of those numbered in `wanted`, at Current.
  RegistrationResiduals::Jacobian Differentiate(const std::vector<int>& wanted);
  /// Back to an equilibrium, that of the values given.
  void ReturnTo(const std::vector<double>& values, std::shared_ptr<PosedBreast> state);
  /// Residuals where the plates' chest-wall edges are as round as this, at Current's values;
  /// counted. Empty where there is no equilibrium, or when stopped.
  std::vector<double> WithEdges(double radiusMm);

  const SearchedBreast Breast;
  std::vector<double> Values;
  std::shared_ptr<PosedBreast> Current;
  RegistrationResiduals Compared;
  int Evaluations = 0;
  int Projections = 0;
  double MechanicsSeconds = 0;
  double ProjectionSeconds = 0;
  double JacobianSeconds = 0;

private:
  const ProgressCallback& Progress;
  std::shared_ptr<PosedBreast> Accepted;
  /// A longer travel of the plates is refused without an attempt: half of the last that failed,
  /// twice the last that succeeded. The initial value is a step that a phantom's compression still
  /// follows.
  double LongestTravelMm = 20;
  /// The values whose equilibrium Current is.
  std::vector<double> CurrentValues;
};
}

#endif
