// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_MammogramEvaluator_h
#define mammoray_MammogramEvaluator_h

#include "mammoray/Foundation/Progress.h"
#include "mammoray/Registration/Registration.h"
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

/// Beyond this way of the plates a cold start costs less than going there from another state, mm.
inline constexpr double LongestWarmTravelMm = 8;

/// How far the plates are from those of a state, mm.
double TravelFrom(const CompressionState& state, const UnitPlacement& placement,
  const BreastPose& pose);

/// The breast of one mammogram: the model, that of its bodies which a search compresses, and the
/// unit.
struct MAMMORAYREGISTRATION_EXPORT SearchedBreast
{
  BreastModel* Model = nullptr;
  BreastBody* Body = nullptr;
  UnitPlacement Placement;

  std::shared_ptr<EvaluatedState> At(const std::vector<double>& values,
    CompressionState state) const;
};

/// What one mammogram brings to a search at one resolution.
struct SearchedMammogram
{
  struct Projection
  {
    RegistrationTarget Target;
    Vector3 FocalSpotMm{ 0, 0, 0 };
  };

  SearchedBreast Breast;
  RegistrationTarget Target;
  RegistrationOptions Options;
  /// All parameters where the search stands, and the breast there.
  std::vector<double> Values;
  std::shared_ptr<EvaluatedState> Here;
  /// Of the same compression (JointMammogram::Others).
  std::vector<Projection> Others;

  /// Target, then Others.
  std::vector<ComparedProjection> Projections() const;
};

/// The residuals of one mammogram, with the equilibrium they belong to.
class MAMMORAYREGISTRATION_EXPORT MammogramEvaluator
{
public:
  MammogramEvaluator(SearchedMammogram mammogram, const ProgressCallback& progress);
  MammogramEvaluator(const MammogramEvaluator&) = delete;

  enum class Answer
  {
    Found,
    /// Too far from the accepted equilibrium to be tried.
    Refused,
    NoEquilibrium,
    Stopped
  };

  /// Compresses at Values, from the accepted state, unless Here belongs to them.
  Answer Compress();
  /// Steps are taken from Here on. Not from a step that was refused: one that went too far can fall
  /// to the breast's other side between the plates, and all shorter ones from there would stay.
  void Accept() { this->Accepted = this->Mammogram.Here; }
  /// Residuals at Here.
  void Compare();
  /// Columns[parameter] of those numbered in `wanted`, at Here.
  RegistrationResiduals::Jacobian Differentiate(const std::vector<int>& wanted);
  /// See RegistrationResiduals::Weigh.
  std::vector<double> Weigh(const std::vector<double>& factors);
  /// Back to an equilibrium, that of the values given.
  void ReturnTo(const std::vector<double>& values, std::shared_ptr<EvaluatedState> state);
  /// Residuals beside Here. Throws ConvergenceError, Interrupted.
  std::vector<double> Beside(const std::vector<double>& values);
  /// Residuals where the plates' chest-wall edges are as round as this, at Here's values; counted.
  /// Empty where there is no equilibrium, or when stopped.
  std::vector<double> WithEdges(double radiusMm);
  RegistrationCosts Costs() const { return this->Compared.Costs(this->Residuals); }

  SearchedMammogram Mammogram;
  RegistrationResiduals Compared;
  std::vector<double> Residuals;
  int Evaluations = 0;
  int Projections = 0;
  double MechanicsSeconds = 0;
  double ProjectionSeconds = 0;
  double JacobianSeconds = 0;

private:
  /// The equilibrium of `breast` at these values, from Here. Throws ConvergenceError, Interrupted.
  std::shared_ptr<EvaluatedState> CompressBeside(const SearchedBreast& breast,
    const std::vector<double>& values) const;

  const ProgressCallback& Progress;
  std::shared_ptr<EvaluatedState> Accepted;
  /// A longer way of the plates from it is refused unseen: half of what failed last, twice of
  /// what succeeded. The first is a step that a phantom's compression still follows.
  double LongestTravelMm = 20;
  /// The values whose equilibrium Here is.
  std::vector<double> HereIsAt;
};
}

#endif
