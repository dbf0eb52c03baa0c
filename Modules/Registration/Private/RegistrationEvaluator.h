// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_RegistrationEvaluator_h
#define mammoray_RegistrationEvaluator_h

#include "mammoray/Foundation/Progress.h"
#include "mammoray/Registration/Registration.h"

#include <ceres/evaluation_callback.h>

#include <chrono>
#include <cstddef>
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
double TravelFrom(const CompressionState& state, const RegistrationModel& model,
  const std::vector<double>& values);

/// What one mammogram brings to a search at one resolution.
struct EvaluatedView
{
  const RegistrationModel* Model = nullptr;
  RegistrationTarget Target;
  RegistrationOptions Options;
  /// All parameters where the search stands, and the equilibrium there.
  std::vector<double> Values;
  CompressionState State;
};

/// The residuals of one mammogram, with the equilibrium they belong to.
class ViewEvaluator
{
public:
  ViewEvaluator(EvaluatedView view, const ProgressCallback& progress);
  ViewEvaluator(const ViewEvaluator&) = delete;

  enum class Answer
  {
    Found,
    /// Too far from the last equilibrium to be tried.
    Refused,
    NoEquilibrium,
    Stopped
  };

  /// Compresses at View.Values, from the nearest state, unless State belongs to them.
  Answer Compress();
  /// Residuals at View.Values and State.
  void Compare();
  /// Columns[parameter] of those numbered in `wanted`.
  RegistrationResiduals::Jacobian Differentiate(const std::vector<int>& wanted);
  /// Back to an equilibrium, that of the values given.
  void ReturnTo(const std::vector<double>& values, const CompressionState& state);
  /// Residuals beside View.Values. Throws ConvergenceError, Interrupted.
  std::vector<double> Beside(const std::vector<double>& values) const;
  RegistrationCosts Costs() const { return this->Compared.Costs(this->Residuals); }

  EvaluatedView View;
  const RegistrationResiduals Compared;
  std::vector<double> Residuals;
  int Evaluations = 0;
  int Projections = 0;
  double MechanicsSeconds = 0;
  double ProjectionSeconds = 0;
  double JacobianSeconds = 0;

private:
  const ProgressCallback& Progress;
  /// A longer way of the plates from State is refused unseen: half of what failed last, twice of
  /// what succeeded. The first is a step that a phantom's compression still follows.
  double LongestTravelMm = 20;
  /// The values whose equilibrium State is.
  std::vector<double> StateIsAt;
};

/// A free parameter of a search, of one mammogram or shared by all.
struct SearchUnknown
{
  int Parameter = 0;
  /// The views that have it.
  std::vector<std::size_t> Views;
  /// As in the first of them.
  double Lower = 0;
  double Upper = 0;
  double Scale = 1;
};

/// The residuals of all mammograms for Ceres, one parameter block for all unknowns.
class RegistrationEvaluator : public ceres::EvaluationCallback
{
public:
  /// Poses without an equilibrium, of one resolution, after which a search ends: each costs many
  /// times what a good one does, and the best match lies where the breast cannot be compressed to.
  static constexpr int LargestNumberOfFailures = 5;

  RegistrationEvaluator(std::vector<EvaluatedView> views, std::vector<SearchUnknown> unknowns,
    const ProgressCallback& progress);

  void PrepareForEvaluation(bool evaluateJacobians, bool newPoint) override;

  /// Back to equilibria, those of the unknowns as they are now.
  void ReturnTo(const std::vector<CompressionState>& states);

  /**
   * How far the cost falls from the evaluated point to the bottom of its Gauss-Newton model,
   * g^T H^-1 g / 2, residuals weighted as by the robust loss. Parameters that are at a bound and
   * would go beyond it stay.
   */
  double PredictedFall() const;
  /// By which the robust loss multiplies the square of each residual.
  std::vector<double> Weights() const;

  /// Residuals beside the evaluated point for Ceres' differences, which are relative to their
  /// argument: offsets[0][u] is 1 at the point, and 1 more one scale of unknown u beside it.
  bool operator()(const double* const* offsets, double* residuals) const;

  const std::vector<SearchUnknown> Unknowns;
  std::vector<std::unique_ptr<ViewEvaluator>> Views;
  /// Ceres' parameter block: the unknowns over their scales.
  std::vector<double> Block;
  /// Of all views, one after the other.
  std::vector<double> Residuals;
  /// Which of them the robust loss weighs: all but the priors.
  std::vector<bool> Robust;
  /// Column u is d residuals / d Block[u].
  std::vector<std::vector<double>> Jacobian;
  bool Valid = false;
  bool Stopped = false;
  /// Poses without an equilibrium that were tried.
  int Failures = 0;

private:
  bool EvaluateResiduals();
  void EvaluateJacobian();
  bool DifferentiateByDifferences();
  bool IsStoppedByBound(std::size_t unknown, double slope) const;
  bool Stop();
  std::vector<double> ValuesOf(std::size_t view) const;
  /// Of each view the unknowns it has: their numbers and its parameters.
  struct Selection
  {
    std::vector<std::size_t> Unknowns;
    std::vector<int> Parameters;
  };

  std::vector<Selection> Selected;
  /// Where each view's residuals begin.
  std::vector<std::size_t> First;
  const ProgressCallback& Progress;
  std::vector<double> EvaluatedAt;
  bool Evaluated = false;
  bool HasJacobian = false;
};
}

#endif
