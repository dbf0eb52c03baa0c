// SPDX-License-Identifier: Apache-2.0
#include "mammoray/XRay/Refraction.h"

#include "Private/ProjectionChecks.h"
#include "Private/SampleGrid.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/Numbers.h"
#include "mammoray/XRay/Composition.h"

#include <xraylib.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace mammoray
{
namespace
{
/// Pixels beyond the detector's edges whose rays may still come in.
constexpr int Margin = 16;

using Law = RefractionOptions::Law;

/// Sums over the pixels of a detector with its margin.
struct RefractionSums
{
  RefractionSums(const XRayDetector& detector, Law law)
    : Columns(detector.Columns + 2 * Margin)
    , Rows(detector.Rows + 2 * Margin)
  {
    const std::size_t count = static_cast<std::size_t>(this->Columns) * this->Rows;
    this->Intensity.assign(count, 0.0);
    for (std::size_t axis = 0; axis < 2; ++axis)
    {
      this->Deflection[axis].assign(count, 0.0);
      this->Flux[axis].assign(law == Law::NearField ? count : 0, 0.0);
    }
  }

  /// Shares an intensity among the four pixels around a place, in pixels.
  void Deposit(double column, double row, double intensity)
  {
    const double left = std::floor(column);
    const double top = std::floor(row);
    for (int n = 0; n < 4; ++n)
    {
      const int below = n / 2;
      const double c = left + n % 2;
      const double r = top + below;
      if (c >= 0 && r >= 0 && c < this->Columns && r < this->Rows)
      {
        this
          ->Intensity[static_cast<std::size_t>(r) * this->Columns + static_cast<std::size_t>(c)] +=
          intensity * (1 - std::abs(column - c)) * (1 - std::abs(row - r));
      }
    }
  }

  int Columns;
  int Rows;
  std::vector<double> Intensity;
  std::array<std::vector<double>, 2> Deflection;
  /// Intensity times displacement, pixels.
  std::array<std::vector<double>, 2> Flux;
};

/// The detector with its margin, one sample of its grid.
XRayDetector WithMargin(const XRayDetector& detector, double column, double row)
{
  XRayDetector wide = detector;
  wide.Samples = 1;
  wide.Columns += 2 * Margin;
  wide.Rows += 2 * Margin;
  wide.Origin =
    detector.Origin + (column - Margin) * detector.ColumnStep + (row - Margin) * detector.RowStep;
  return wide;
}

/// The directions of a detector, of length 1.
struct DetectorAxes
{
  explicit DetectorAxes(const XRayDetector& detector)
    : ColumnMm(Norm(detector.ColumnStep))
    , RowMm(Norm(detector.RowStep))
    , U((1 / this->ColumnMm) * detector.ColumnStep)
    , V((1 / this->RowMm) * detector.RowStep)
    , N(Cross(this->U, this->V))
  {
  }
  double ColumnMm;
  double RowMm;
  Vector3 U;
  Vector3 V;
  Vector3 N;
};

class Refraction
{
public:
  Refraction(const XRaySource& source, const XRayDetector& detector, const Beam& beam,
    const std::vector<double>& decrements, const RefractionOptions& options)
    : Source(source)
    , Axes(detector)
    , Rays(beam)
    , Decrements(decrements)
    , Options(options)
    , Sums(detector, options.Method)
  {
  }

  /// Adds the rays of one sample of every pixel, each with this weight; `column` and `row` are the
  /// sample's offset, pixels.
  void Add(const XRayDetector& wide, const PathLengthImage& image,
    const PathLengthDerivatives& derivatives, double column, double row, double weight)
  {
    const auto materials = static_cast<std::size_t>(image.Materials);
    const std::size_t energies = this->Rays.EnergyWeights().size();
    const std::size_t stride = static_cast<std::size_t>(this->Rays.NumberOfMaterials());
    for (std::size_t pixel = 0; pixel < image.NumberOfPixels(); ++pixel)
    {
      const auto columns = static_cast<std::size_t>(wide.Columns);
      const double c = static_cast<double>(pixel % columns);
      const std::size_t rowIndex = pixel / columns;
      const auto r = static_cast<double>(rowIndex);
      const Vector3 way = this->WayOf(wide, c, r);
      for (std::size_t energy = 0; energy < energies; ++energy)
      {
        double exponent = 0;
        double bend[2] = { 0, 0 };
        for (std::size_t material = 1; material < materials; ++material)
        {
          const int m = static_cast<int>(material);
          const double delta = this->Decrements[energy * stride + material];
          exponent -= this->Rays.MuPerMm(energy, m) * image.Material(m)[pixel];
          bend[0] += delta * derivatives.Of(0, m)[pixel];
          bend[1] += delta * derivatives.Of(1, m)[pixel];
        }
        const double open = weight * this->Rays.EnergyWeights()[energy];
        const double intensity = open * std::exp(exponent);
        this->Sums.Deflection[0][pixel] += open * bend[0];
        this->Sums.Deflection[1][pixel] += open * bend[1];
        const std::array<double, 2> moved = this->Displacement(way, bend);
        if (this->Options.Method == Law::Geometric)
        {
          this->Sums.Deposit(c + column + moved[0], r + row + moved[1], intensity);
        }
        else
        {
          this->Sums.Intensity[pixel] += intensity;
          this->Sums.Flux[0][pixel] += intensity * moved[0];
          this->Sums.Flux[1][pixel] += intensity * moved[1];
        }
      }
    }
  }

  RefractedImage Finish(const XRayDetector& detector) const
  {
    RefractedImage result;
    result.Columns = detector.Columns;
    result.Rows = detector.Rows;
    const std::size_t count = static_cast<std::size_t>(detector.Columns) * detector.Rows;
    result.Deflection.resize(2 * count);
    result.Transmission.resize(count);
    for (int row = 0; row < detector.Rows; ++row)
    {
      for (int column = 0; column < detector.Columns; ++column)
      {
        const std::size_t pixel = static_cast<std::size_t>(row) * detector.Columns + column;
        const std::size_t wide =
          static_cast<std::size_t>(row + Margin) * this->Sums.Columns + column + Margin;
        result.Deflection[pixel] = static_cast<float>(this->Sums.Deflection[0][wide]);
        result.Deflection[count + pixel] = static_cast<float>(this->Sums.Deflection[1][wide]);
        double intensity = this->Sums.Intensity[wide];
        if (this->Options.Method == Law::NearField)
        {
          const auto below = static_cast<std::size_t>(this->Sums.Columns);
          intensity -= 0.5 * (this->Sums.Flux[0][wide + 1] - this->Sums.Flux[0][wide - 1]);
          intensity -= 0.5 * (this->Sums.Flux[1][wide + below] - this->Sums.Flux[1][wide - below]);
        }
        result.Transmission[pixel] = static_cast<float>(intensity);
      }
    }
    return result;
  }

private:
  /// The ray's direction, of length 1.
  Vector3 WayOf(const XRayDetector& wide, double column, double row) const
  {
    const Vector3 way = this->Source.Type == XRaySource::Kind::Parallel
      ? this->Source.Direction
      : wide.Origin + column * wide.ColumnStep + row * wide.RowStep - this->Source.Position;
    return (1 / Norm(way)) * way;
  }

  /// How far a bent ray meets the detector beside where it would, columns and rows.
  std::array<double, 2> Displacement(const Vector3& way, const double (&bend)[2]) const
  {
    const double u = Dot(way, this->Axes.U);
    const double v = Dot(way, this->Axes.V);
    const double n = Dot(way, this->Axes.N);
    // The bend is at right angles to the ray.
    const double along = -(bend[0] * u + bend[1] * v) / n;
    const double length = this->Options.DistanceMm / std::abs(n);
    return { length * (bend[0] - u * along / n) / this->Axes.ColumnMm,
      length * (bend[1] - v * along / n) / this->Axes.RowMm };
  }

  const XRaySource& Source;
  DetectorAxes Axes;
  const Beam& Rays;
  const std::vector<double>& Decrements;
  const RefractionOptions& Options;
  RefractionSums Sums;
};
}

Exposure ToExposure(const RefractedImage& refracted)
{
  Exposure exposure;
  exposure.Lengths = refracted.Lengths;
  for (const float value : refracted.Transmission)
  {
    // The near field's law can fall below nothing where it does not hold.
    const double transmission = std::max(0.0f, value);
    exposure.Transmission.push_back(static_cast<float>(transmission));
    exposure.LogAttenuation.push_back(static_cast<float>(-std::log(std::max(transmission, 1e-30))));
  }
  return exposure;
}

double RefractiveDecrement(const std::string& composition, double energyKeV, double densityGPerCm3)
{
  const auto [fractions, nominal] = ParseComposition(composition, "refraction");
  const double density = densityGPerCm3 > 0 ? densityGPerCm3 : nominal;
  double delta = 0;
  for (const auto& [element, fraction] : fractions)
  {
    xrl_error* failure = nullptr;
    const double f = Fi(element, energyKeV, &failure);
    if (failure)
    {
      const std::string reason = failure->message;
      xrl_error_free(failure);
      throw InputError("refraction: no scattering factor of element " + std::to_string(element) +
        " at " + std::to_string(energyKeV) + " keV: " + reason);
    }
    delta += fraction * (element + f) / AtomicWeight(element, nullptr);
  }
  // r_e lambda^2 N_A / (2 pi) at 1 keV, cm^3 / mol: r_e = 2.8179403e-13 cm, lambda = 12.398420e-8
  // cm.
  constexpr double perMole =
    2.8179403e-13 * 12.398420e-8 * 12.398420e-8 * 6.02214076e23 / (2 * std::numbers::pi);
  return perMole * density * delta / (energyKeV * energyKeV);
}

std::vector<double> RefractiveDecrements(const Spectrum& spectrum, const MaterialTable& materials)
{
  std::vector<double> decrements;
  for (std::size_t bin = 0; bin < spectrum.Weights.size(); ++bin)
  {
    if (spectrum.Weights[bin] == 0)
    {
      continue;
    }
    decrements.push_back(0);
    for (std::size_t m = 1; m < materials.Materials.size(); ++m)
    {
      const Material& material = materials.Materials[m];
      try
      {
        if (material.IodineMgPerMl > 0)
        {
          throw InputError("expected no iodine beside refraction, found some");
        }
        decrements.push_back(RefractiveDecrement(material.Attenuation, spectrum.EnergiesKeV[bin],
          material.DensityGPerCm3));
      }
      catch (const InputError& error)
      {
        throw InputError("material '" + material.Name + "': " + error.what());
      }
    }
  }
  return decrements;
}

RefractedImage Refract(PathLengthProjector& projector, std::size_t pointCount,
  const XRaySource& source, const XRayDetector& detector, const Beam& beam,
  const std::vector<double>& decrements, const RefractionOptions& options,
  const ProgressCallback& progress)
{
  CheckGeometry(source, detector);
  const std::size_t expected =
    beam.EnergyWeights().size() * static_cast<std::size_t>(beam.NumberOfMaterials());
  if (decrements.size() != expected)
  {
    throw InputError("refraction: expected " + std::to_string(expected) + " decrements, found " +
      std::to_string(decrements.size()));
  }
  if (!(options.DistanceMm >= 0 && std::isfinite(options.DistanceMm)))
  {
    throw InputError("refraction: expected a distance that is not negative, found " +
      NumberText(options.DistanceMm) + " mm");
  }
  const DetectorAxes axes(detector);
  std::vector<double> velocities(6 * pointCount);
  for (std::size_t point = 0; point < pointCount; ++point)
  {
    for (std::size_t axis = 0; axis < 3; ++axis)
    {
      velocities[3 * point + axis] = axes.U[axis];
      velocities[3 * (pointCount + point) + axis] = axes.V[axis];
    }
  }
  Refraction refraction(source, detector, beam, decrements, options);
  const std::vector<std::array<double, 2>> samples = SampleOffsets(detector.Samples);
  const double weight = 1.0 / static_cast<double>(samples.size());
  PathLengthDerivatives derivatives;
  double done = 0;
  for (const auto& [column, row] : samples)
  {
    ReportProgress(progress, done, "bending rays");
    done += weight;
    const XRayDetector wide = WithMargin(detector, column, row);
    const PathLengthImage image = projector.Project(source, wide, velocities, 2, derivatives);
    beam.CheckMaterials(image.Materials);
    refraction.Add(wide, image, derivatives, column, row, weight);
  }
  RefractedImage result = refraction.Finish(detector);
  result.Lengths = projector.Project(source, detector);
  return result;
}
}
