// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_RegistrationResiduals_h
#define mammoray_RegistrationResiduals_h

#include "mammoray/Registration/PosedBreast.h"
#include "mammoray/Registration/RegistrationProblem.h"
#include "mammorayRegistrationModule.h"

#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace mammoray
{
/// Half the sum of squared residuals as the robust loss counts them: of the outline, the
/// intensities and the priors (which are not robust).
struct RegistrationCosts
{
  double Outline = 0;
  double Intensity = 0;
  double Prior = 0;

  double Sum() const { return this->Outline + this->Intensity + this->Prior; }
};

/**
 * How many times a prior's residual counts in a search. Residuals beside each other are alike,
 * because tissue in the model lies beside the true by a smooth displacement: taken as independent,
 * they make parameters four times too sure (Validation/reports/accuracy.md, "How sure"). Priors
 * that count once do not hold against so many, and roll, pitch and tilt take up the model's error.
 */
inline constexpr double PriorWeight = 4;

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

  /// Order of the residuals: outline, then intensity of each projection; at the end one prior per
  /// parameter (0 if it has none).
  std::size_t NumberOfResiduals() const;
  std::size_t NumberOfPriors() const { return this->Parameters.size(); }
  /// The residuals of one projection without the priors.
  const PictureResiduals& Picture(std::size_t projection) const
  {
    return *this->Compared[projection];
  }
  std::size_t NumberOfProjections() const { return this->Compared.size(); }
  /// Size above which the cost of each residual is linear; infinite for priors.
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
