// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_RegistrationResult_h
#define mammoray_RegistrationResult_h

#include "mammoray/Registration/PosedBreast.h"
#include "mammoray/Registration/RegistrationProblem.h"
#include "mammorayRegistrationModule.h"

#include <array>
#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace mammoray
{
/// An accepted step of a search.
struct RegistrationIteration
{
  int Number = 0;
  std::vector<double> Parameters;
  /// Edge length of the compared pixels, mm, and the comparison (NameOf). Costs of different ones
  /// are different quantities.
  double PixelSizeMm = 0;
  std::string Comparison;
  /// Half the sum of squared residuals: of everything, the outline, the intensities and the priors.
  double Cost = 0;
  double OutlineCost = 0;
  double IntensityCost = 0;
  double PriorCost = 0;
  /// Since the search began.
  double Seconds = 0;
};

/**
 * Remaining difference of the pictures where a search ended, estimated from its residuals
 * (Private/VarianceComponents.h): standard deviation of the outline, mm, and of the compared
 * features of the picture (RegistrationOptions::Comparison), and the length and the edge of the
 * square over which these residuals are correlated, mm. All 0 if unknown.
 */
struct RegistrationMisfit
{
  double OutlineSigmaMm = 0;
  double OutlineScaleMm = 0;
  double PictureSigma = 0;
  double PictureScaleMm = 0;
};

/// How far a result may be relied on.
enum class Trust
{
  Good,
  Doubtful,
  None
};

/// "good", "doubtful" or "none".
MAMMORAYREGISTRATION_EXPORT const char* NameOf(Trust trust);

/// The same in words: "The two mammograms match", "The match should be checked by eye", "The match
/// is not to be trusted".
MAMMORAYREGISTRATION_EXPORT const char* VerdictOf(Trust trust);

struct Assessment
{
  Trust Level = Trust::Good;
  /// Reasons for a level below Good, a sentence each in plain words.
  std::vector<std::string> Reasons;
};

/// A synthetic mammogram on a grid of the receptor.
struct SyntheticMammogram
{
  /// -ln(I / I0) of each pixel.
  std::vector<float> LogAttenuation;
  /// Outer silhouette on the receptor, gantry x, y, mm; from +x to -x around the nipple.
  std::vector<ReceptorPoint> Outline;
  /// Number of rays that crossed a surface which does not close.
  std::size_t InconsistentRays = 0;
};

/// How alike a synthetic and a real mammogram are.
struct Similarity
{
  /// Normalised cross-correlation of log attenuation inside both outlines, [-1, 1].
  double Correlation = 0;
  /**
   * Distances from the real outline to the synthetic one, mm: the mean where outlines are compared
   * (OutlineAlong), the largest also in the strip at the chest wall, where the search does not see
   * it. Not the other way: what an MRI holds of the body beside the breast need not be in the
   * picture.
   */
  double MeanOutlineDistanceMm = 0;
  double LargestOutlineDistanceMm = 0;
  /**
   * Correlation of the tissue alone: in pixels of 1.5 mm, of what stands out of its surroundings (3
   * mm) where a breast is as thick as the plates are apart, 20 mm and more from its outline, in one
   * that is smaller over half of the largest distance. Breasts of one size and shape have all else
   * in common. NaN where that is less than 1 cm^2.
   */
  double TissueCorrelation = 0;
};

/// Distance of tissue from where a result places it, mm: median and 95 % quantile.
struct ExpectedError
{
  double MedianMm = 0;
  double Most95Mm = 0;
};

/// The result of one view as far as result files keep it.
struct ViewFigures
{
  BreastPose Pose;
  RegistrationMisfit Misfit;
  /// Covariance of all parameters at the solution, Covariance[i * parameterCount + j], in their
  /// units; 0 for fixed ones. Empty if unknown.
  std::vector<double> Covariance;
  /**
   * The same including fixed parameters that have a prior: their own variance, and the shift of the
   * free ones that another value of them would cause. Empty if unknown.
   */
  std::vector<double> ConsideredCovariance;
  std::vector<RegistrationIteration> Iterations;
  /// Where the unit stands.
  VolumeFromGantry Placed;
  /**
   * Mean distance of the breast's nodes from the equilibrium that a cold start finds at the same
   * pose, mm, measured where the finest resolution began: 0 unless the breast has several
   * equilibria there. The search goes on from the one whose picture matches better. NaN if that
   * start has no equilibrium or was not made.
   */
  double OtherEquilibriumMm = std::numeric_limits<double>::quiet_NaN();
  /// At the end, on the target's own grid.
  Similarity After;
  bool Converged = false;
  std::string StopReason;
  /// Error of tissue between the plates, provided that picture and volume are of one breast;
  /// nothing without a covariance.
  std::optional<ExpectedError> Expected;
  Assessment Trust;
  /// Equilibria solved by the search.
  int Evaluations = 0;
  /// Whole search, s.
  double Seconds = 0;
};

/// The result of one view.
struct ViewResult : ViewFigures
{
  /// The given parameters. Bounds and start differ from them only where Warnings say so.
  std::vector<RegistrationParameter> Parameters;
  std::vector<double> Values;
  /// Standard deviation of each parameter by the covariance at the solution; NaN where fixed.
  std::vector<double> StandardDeviations;
  CompressionState State;
  /// Points of the model's anatomy between the plates, 3 x pointCount, volume frame, mm.
  std::vector<double> Points;
  /// Derivatives of Points with each parameter, seen from the unit, mm per mm or degree; empty for
  /// parameters that are fixed and have no prior.
  std::vector<std::vector<double>> Sensitivities;
  /// On the target's own grid, with one ray per pixel.
  SyntheticMammogram Synthetic;
  /// Similarity of each further projection of a tomosynthesis, at the end.
  std::vector<Similarity> ProjectionsAfter;
  /// Notes on the search for the user, a sentence each.
  std::vector<std::string> Warnings;
  /// RegistrationTarget::HeaderThicknessMm and Disagreements.
  std::optional<double> HeaderThicknessMm;
  std::vector<std::string> Disagreements;
  /// Pictures compared by the search, and the time of equilibria and of pictures, s.
  int Projections = 0;
  double MechanicsSeconds = 0;
  double ProjectionSeconds = 0;
  /// Time of all derivatives, of mechanics and pictures together, s.
  double JacobianSeconds = 0;
};

/// A parameter that was found, of one view or shared by all.
struct FreeParameter
{
  int Parameter = 0;
  /// Numbers of the views that have it.
  std::vector<std::size_t> Views;
  /// Bounds and scale in the first of these views.
  double Lower = 0;
  double Upper = 0;
  double Scale = 1;

  bool IsShared() const { return this->Views.size() > 1; }
};

/// Result of a registration. It is complete when Register returns.
struct RegistrationResult
{
  /// In the order of the problem. Counts and costs are those of each view, seconds those of all.
  std::vector<ViewResult> Views;
  /// The free parameters, view by view; a shared one once.
  std::vector<FreeParameter> FreeParameters;
  /// Covariance[i * FreeParameters.size() + j], in the parameters' units; empty if unknown.
  std::vector<double> Covariance;
};

/// Tissue correlations (Similarity::TissueCorrelation) from which on pictures are those of one
/// breast, and below which they are not. Of wrong results (of another breast, or off by more than 5
/// mm) the most was 0.47, of right ones 4 % have less than 0.55 (Validation/reports/accuracy.md,
/// "Trust").
inline constexpr double GoodTissueCorrelation = 0.55;
inline constexpr double LeastTissueCorrelation = 0.3;

/**
 * Judges a result by its figures. Whether picture and volume are of one breast, the correlation of
 * the tissue tells: below GoodTissueCorrelation doubtful, below LeastTissueCorrelation none. Also
 * doubtful: a correlation of the whole below 0.5, mean outline distance above 1.5 mm (3 mm: none),
 * largest above 5 mm (10 mm: none), a search that did not converge, a parameter at its bound or
 * more than three standard deviations (its prior's and its own) away from its start, figures that
 * are not numbers (none). Mechanics make a result doubtful if one plate presses with less than a
 * twentieth of the other's force, and if the breast has another equilibrium at this pose, 3 mm off
 * on average or more. The header does if its thickness is more than 5 mm or 15 % from the one
 * found, as far as units may be off (twice as much: none), and so do Disagreements. The limits are
 * rules of thumb, not clinical validation.
 */
MAMMORAYREGISTRATION_EXPORT Assessment Assess(const ViewResult& result);

/// True if a free parameter's value lies within a thousandth of its range from a bound.
MAMMORAYREGISTRATION_EXPORT bool AtBound(const RegistrationParameter& parameter, double value);

/// X-rays a compressed breast, with `samples` rays along each side of a pixel. The silhouette is
/// looked for along rays from `centre`, a point of its shadow at the chest wall (ChestWallCentre).
MAMMORAYREGISTRATION_EXPORT SyntheticMammogram Synthesize(PosedBreast& breast,
  const ReceptorGrid& grid, const ReceptorPoint& centre, int samples);

/// NaN where there is no outline to compare. Throws InputError on an empty mask.
MAMMORAYREGISTRATION_EXPORT Similarity Compare(const SyntheticMammogram& synthetic,
  const RegistrationTarget& target);

/**
 * Error of the model of tissue beyond the estimated parameters (stiffness, chest wall,
 * segmentation, the shape without load): standard deviation of each coordinate of a compressed
 * point. It is the root of the sum of the squares of a constant, mm; of a share of the point's
 * deformation, which is its displacement less the rigid motion of the tissue between the plates;
 * and, from a distance in front of the plates' edge on, of a share of how far the point lies behind
 * that: no plate holds the tissue there, and the body that does is not part of the model. Two
 * standard deviations hold 95 % of the coordinates in virtual studies of patients' anatomies, and
 * more in phantoms (Validation/reports/accuracy.md, "How
 * sure").
 */
inline constexpr double ModelErrorMm = 0.3;
inline constexpr double ModelErrorShare = 0.12;
inline constexpr double ModelErrorEdgeMm = 15;
inline constexpr double ModelErrorEdgeShare = 0.25;

/// The model's own error in one compressed breast.
class MAMMORAYREGISTRATION_EXPORT ModelError
{
public:
  /// `points`: those of the anatomy when compressed, 3 x pointCount, volume frame, mm.
  ModelError(const TetrahedralMesh& anatomy, const std::vector<double>& points,
    const VolumeFromGantry& placed);

  /// Standard deviation of each coordinate of a point, mm; `rest`, `compressed`: its places.
  double SigmaMm(const Vector3& rest, const Vector3& compressed) const;

  /// Cells that stand for equal shares of the tissue between the plates; of all tissue if none lies
  /// in front of the plates' edge.
  const std::vector<std::size_t>& CellsBetween() const { return this->Cells; }

private:
  VolumeFromGantry Placed;
  std::vector<std::size_t> Cells;
  /// Rigid motion nearest to theirs: rest -> Rotation rest + Shift, row by row.
  std::array<Vector3, 3> Rotation{};
  Vector3 Shift{ 0, 0, 0 };
};

/// Expected error of the tissue between the plates from the covariance of the parameters
/// (ConsideredCovariance, else Covariance) and the model's own error; nothing without a covariance.
MAMMORAYREGISTRATION_EXPORT std::optional<ExpectedError> ExpectedErrorOf(
  const TetrahedralMesh& anatomy, const ViewResult& result);
}

#endif
