// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_RegistrationResiduals_h
#define mammoray_RegistrationResiduals_h

#include "mammoray/Registration/PosedBreast.h"
#include "mammorayRegistrationModule.h"

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace mammoray
{
/// A parameter of one search; see PoseParameter for its name and unit.
struct RegistrationParameter
{
  std::string Name;
  std::string Unit;
  double Start = 0;
  double Lower = 0;
  double Upper = 0;
  /// Step that makes the parameters of the optimiser comparable. Positive.
  double Scale = 1;
  /// Standard deviation of the prior around Start; 0: no prior.
  double PriorSigma = 0;
  /// Not optimised: stays at Start.
  bool Fixed = false;
};

enum class RegistrationDerivatives
{
  Exact,
  /// Ceres' central differences of re-solved equilibria: to compare with.
  CentralDifferences
};

/// Features of the pictures that are compared inside the breast.
enum class PictureComparison
{
  /// Log attenuation less its mean, over its standard deviation, both of all pixels: the least
  /// squares of normalised cross-correlation.
  Global,
  /// The same in a window around each pixel: what changes slowly, such as scatter or a display
  /// curve, cancels.
  Local,
  /// Differences of neighbouring pixels of the globally normalised picture. It matches where
  /// structures overlap: a search compares globally until then.
  Gradient
};

/// "global", "local" or "gradient".
MAMMORAYREGISTRATION_EXPORT const char* NameOf(PictureComparison comparison);

struct RegistrationOptions
{
  /// Rolls beside the start at which a search may begin, degrees: of all, the one whose picture
  /// matches best once the outlines meet. Those outside the bounds are left out.
  std::vector<double> RollOffsetsDeg{ -15.0, 15.0 };
  /// Edge lengths of the pixels in which the images are compared, coarse to fine, mm.
  std::vector<double> PixelSizesMm{ 3.0, 1.5 };
  /// Rays per coarse pixel along each of its sides.
  int Samples = 6;
  /// Directions in which the outlines are compared, spread over the half circle.
  int OutlineDirections = 120;
  /**
   * Standard deviation of the model's error on the outline, mm, and of what is compared of the
   * picture, in root mean squares of the target's, and the distance over which these errors are
   * alike, mm: neighbouring samples share their weight. Where gradients are compared at last,
   * residuals tell their own (ResidualGroups).
   */
  double OutlineSigmaMm = 1.0;
  double IntensitySigma = 0.5;
  PictureComparison Comparison = PictureComparison::Gradient;
  /// Edge of the windows of PictureComparison::Local, mm.
  double WindowMm = 20.0;
  double CorrelationLengthMm = 5.0;
  /// Pixels nearer than this to the outline take no part in the comparison of intensities, mm.
  double IntensityMarginMm = 3.0;
  /// Residuals beyond this many standard deviations count linearly (Huber).
  double RobustWidth = 2.0;
  int MaximumIterations = 15;
  RegistrationDerivatives Derivatives = RegistrationDerivatives::Exact;
  /// Step of differences to both sides, in scales of the parameters. Positive.
  double DifferenceStep = 0.02;
};

/// Half the sum of squared residuals as the robust loss counts them: of the outline, the
/// intensities and the priors (which are not robust).
struct RegistrationCosts
{
  double Outline = 0;
  double Intensity = 0;
  double Prior = 0;

  double Sum() const { return this->Outline + this->Intensity + this->Prior; }
};

/// All of PoseParameters around a start, with their bounds, scales and priors there.
MAMMORAYREGISTRATION_EXPORT std::vector<RegistrationParameter> DefaultParameters(
  const BreastPose& start);

class PictureResiduals;

/// A picture that a compressed breast is compared with, and the focal spot it was taken from, in
/// the gantry frame, mm; nothing: the unit's own.
struct ComparedProjection
{
  const RegistrationTarget* Target = nullptr;
  std::optional<Vector3> FocalSpotMm;
};

/**
 * What the registration minimises: outline, intensity and prior residuals of a compressed breast
 * against a target, or several projections of one compression, at one resolution, in standard
 * deviations, with exact derivatives through mechanics (implicit function theorem), projection
 * (derivative images) and silhouette (the crossed edges). Projections of one compression share the
 * model's errors, so that all together count as much as one. Targets must outlive it.
 */
class MAMMORAYREGISTRATION_EXPORT RegistrationResiduals
{
public:
  /// Throws InputError where a target's breast is too small or its outline outside the image.
  RegistrationResiduals(std::vector<ComparedProjection> projections,
    std::vector<RegistrationParameter> parameters, const RegistrationOptions& options);
  RegistrationResiduals(const RegistrationTarget& target,
    std::vector<RegistrationParameter> parameters, const RegistrationOptions& options);

  /// One column per parameter, fixed ones too.
  struct Jacobian
  {
    /// Columns[parameter][residual], per unit of the parameter; empty for those that were not
    /// asked for.
    std::vector<std::vector<double>> Columns;
  };

  /// Of each projection outline, then intensity; at the end one prior per parameter (0 where it has
  /// none).
  std::size_t NumberOfResiduals() const;
  std::size_t NumberOfPriors() const { return this->Parameters.size(); }
  /// What is compared of each projection.
  const PictureResiduals& Picture(std::size_t projection) const
  {
    return *this->Compared[projection];
  }
  std::size_t NumberOfProjections() const { return this->Compared.size(); }
  /// Beyond which size each residual counts linearly; infinite of priors.
  std::vector<double> RobustWidths() const;

  /// The breast seen from where a projection was taken.
  PosedBreast& Seen(PosedBreast& breast, std::size_t projection) const;

  /**
   * Multiplies outline and picture of each projection by other factors than the options say
   * (PictureResiduals), in this order, two for each projection. Returns what that changes each
   * residual, and its derivatives, by: 1 of priors.
   */
  std::vector<double> Weigh(const std::vector<double>& factors);

  std::vector<double> Evaluate(PosedBreast& breast) const;
  /// Appends what Evaluate returns.
  void Append(PosedBreast& breast, std::vector<double>& residuals) const;

  RegistrationCosts Costs(std::span<const double> residuals) const;

  /**
   * Their derivatives with respect to the parameters numbered in `wanted`. Exact where the
   * residuals are smooth: the outline has kinks where its silhouette goes over to another edge.
   */
  Jacobian Differentiate(PosedBreast& breast, const std::vector<int>& wanted) const;

private:
  std::vector<ComparedProjection> Projections;
  std::vector<RegistrationParameter> Parameters;
  double RobustWidth;
  std::vector<std::shared_ptr<PictureResiduals>> Compared;
};
}

#endif
