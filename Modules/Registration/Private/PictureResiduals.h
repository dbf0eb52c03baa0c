// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_PictureResiduals_h
#define mammoray_PictureResiduals_h

#include "Private/RegistrationResiduals.h"
#include "mammorayRegistrationModule.h"

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

namespace mammoray
{
class PictureFeatures;

/**
 * Outline and picture of a compressed breast against one target, in standard deviations:
 * RegistrationResiduals joins those of all projections. A further residual of either kind is added
 * at the end of that kind's block: to its number, to Append, to AppendRates and to its places. The
 * target must outlive it.
 */
class MAMMORAYREGISTRATION_EXPORT PictureResiduals
{
public:
  /// The squares of the residuals count `share` times, (0, 1]. Throws InputError where the target's
  /// breast is too small or its outline outside the image.
  PictureResiduals(const RegistrationTarget& target, const RegistrationOptions& options,
    double share);

  /// The outline's come first.
  std::size_t NumberOfOutlineResiduals() const { return this->Directions.size(); }
  std::size_t NumberOfIntensityResiduals() const { return this->TargetFeatures.size(); }
  std::size_t NumberOfResiduals() const
  {
    return this->NumberOfOutlineResiduals() + this->NumberOfIntensityResiduals();
  }
  double Share() const { return this->ShareOfSquares; }

  /// Appends them; `seen`: from where the target was taken.
  void Append(PosedBreast& seen, std::vector<double>& residuals) const;

  /// Appends their derivatives to one column for each field of `velocities`
  /// (PosedBreast::Velocities).
  void AppendRates(PosedBreast& seen, const VectorFields& velocities,
    const std::vector<std::vector<double>*>& columns) const;

  /// Factors on distances of the outline, mm, and on differences of the picture: from the options,
  /// until Weigh sets others.
  double OutlineFactor() const { return this->OutlineWeight; }
  double IntensityFactor() const { return this->IntensityWeight; }
  void Weigh(double outlineFactor, double intensityFactor)
  {
    this->OutlineWeight = outlineFactor;
    this->IntensityWeight = intensityFactor;
  }
  /// Root mean square of what is compared of the target's picture.
  double TargetRms() const { return this->FeatureRms; }
  /// Positions on the receptor of the residuals of outline and picture, mm.
  std::vector<ReceptorPoint> OutlinePlaces(PosedBreast& seen) const;
  std::vector<ReceptorPoint> IntensityPlaces() const;
  /// The area that each residual of the picture stands for, mm^2. Gradients are two for a pixel.
  double AreaPerFeature() const;

private:
  void ChooseOutlineSamples();
  void ChoosePixels();
  ReceptorPoint OnOutline(std::size_t direction, double radius) const;
  /// Appends the rates of the outline's residuals for one velocity field of the surface.
  void AddOutlineRates(PosedBreast& seen, std::span<const double> velocities,
    std::vector<double>& column) const;

  const RegistrationTarget& Target;
  const RegistrationOptions Options;
  double ShareOfSquares;
  /// Directions from Centre that hit an outline inside the image.
  std::vector<ReceptorPoint> Directions;
  ReceptorPoint Centre{ 0, 0 };
  std::vector<std::size_t> Pixels;
  std::shared_ptr<const PictureFeatures> Features;
  std::vector<double> TargetFeatures;
  double OutlineWeight = 1;
  double IntensityWeight = 1;
  double FeatureRms = 1;
};
}

#endif
