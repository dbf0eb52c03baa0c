// SPDX-License-Identifier: Apache-2.0
#include "mammoray/XRay/Refraction.h"

#include "Private/FastExp.h"
#include "Private/ProjectionChecks.h"
#include "Private/SampleGrid.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/Numbers.h"
#include "mammoray/Foundation/ParallelFor.h"
#include "mammoray/XRay/Composition.h"

#include <xraylib.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

namespace mammoray
{
namespace
{
/// Pixels beyond the detector's edges whose rays may be bent onto it.
constexpr int Margin = 16;

using Law = RefractionOptions::Law;

/// Intensity for four neighbouring pixels, of which this is the first.
struct Landing
{
  double Column = 0;
  double Row = 0;
  std::array<double, 4> Shares{};
};

/// Bilinear distribution of a ray that is not bent.
Landing StraightLanding(double column, double row, double intensity)
{
  const double left = std::floor(column);
  const double top = std::floor(row);
  const double across = column - left;
  const double down = row - top;
  return { left, top,
    { intensity * (1 - across) * (1 - down), intensity * across * (1 - down),
      intensity * (1 - across) * down, intensity * across * down } };
}

/// exponents -= mu length, bends += delta rate, energy by energy.
MAMMORAY_VECTOR_CLONES
void AddMaterial(std::size_t energies, const double* mu, const double* delta, double length,
  double columnRate, double rowRate, double* exponents, double* columnBends, double* rowBends)
{
  for (std::size_t energy = 0; energy < energies; ++energy)
  {
    exponents[energy] -= mu[energy] * length;
    columnBends[energy] += delta[energy] * columnRate;
    rowBends[energy] += delta[energy] * rowRate;
  }
}

/// Turns exponents into intensities.
MAMMORAY_VECTOR_CLONES
void Attenuate(std::size_t energies, const double* weights, double* exponents)
{
  for (std::size_t energy = 0; energy < energies; ++energy)
  {
    exponents[energy] = weights[energy] * FastExp(exponents[energy]);
  }
}

/// Intensity and displacement of a ray at each energy.
struct BentRay
{
  explicit BentRay(std::size_t energies)
    : Intensities(energies)
    , Moved{ std::vector<double>(energies), std::vector<double>(energies) }
  {
  }

  /// Distributes the ray, which would meet (column, row) if it were not bent, to pixels.
  void Land(double column, double row, std::vector<Landing>& landings) const
  {
    const auto [leastColumn, mostColumn] =
      std::minmax_element(this->Moved[0].begin(), this->Moved[0].end());
    const auto [leastRow, mostRow] =
      std::minmax_element(this->Moved[1].begin(), this->Moved[1].end());
    const double left = std::floor(column + *leastColumn);
    const double top = std::floor(row + *leastRow);
    if (left == std::floor(column + *mostColumn) && top == std::floor(row + *mostRow))
    {
      // Between the same pixels at all energies: shares are products of two linear functions.
      landings.push_back(this->Share(left, top, column, row, 0, this->Intensities.size()));
      return;
    }
    for (std::size_t energy = 0; energy < this->Intensities.size(); ++energy)
    {
      landings.push_back(this->Share(std::floor(column + this->Moved[0][energy]),
        std::floor(row + this->Moved[1][energy]), column, row, energy, energy + 1));
    }
  }

  /// By energy.
  std::vector<double> Intensities;
  /// Along columns and rows, pixels.
  std::array<std::vector<double>, 2> Moved;

private:
  Landing Share(double left, double top, double column, double row, std::size_t begin,
    std::size_t end) const
  {
    double sum = 0;
    double right = 0;
    double lower = 0;
    double both = 0;
    for (std::size_t energy = begin; energy < end; ++energy)
    {
      const double across = column + this->Moved[0][energy] - left;
      const double down = row + this->Moved[1][energy] - top;
      sum += this->Intensities[energy];
      right += this->Intensities[energy] * across;
      lower += this->Intensities[energy] * down;
      both += this->Intensities[energy] * across * down;
    }
    return { left, top, { sum - right - lower + both, right - both, lower - both, both } };
  }
};

/// Sums for the pixels of a detector and its margin.
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

  void Deposit(const Landing& landing)
  {
    for (std::size_t corner = 0; corner < 4; ++corner)
    {
      const std::size_t below = corner / 2;
      const double c = landing.Column + static_cast<double>(corner % 2);
      const double r = landing.Row + static_cast<double>(below);
      if (c >= 0 && r >= 0 && c < this->Columns && r < this->Rows)
      {
        this
          ->Intensity[static_cast<std::size_t>(r) * this->Columns + static_cast<std::size_t>(c)] +=
          landing.Shares[corner];
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

/// Adds an image with a margin to the mean of the detector's own pixels.
void AddWithin(const PathLengthImage& wide, float weight, const XRayDetector& detector,
  PathLengthImage& mean)
{
  if (mean.Lengths.empty())
  {
    mean.Columns = detector.Columns;
    mean.Rows = detector.Rows;
    mean.Materials = wide.Materials;
    mean.Lengths.resize(mean.NumberOfPixels() * static_cast<std::size_t>(mean.Materials));
    mean.Inconsistent.resize(mean.NumberOfPixels());
  }
  for (int row = 0; row < mean.Rows; ++row)
  {
    const std::size_t to = static_cast<std::size_t>(row) * mean.Columns;
    const std::size_t from = static_cast<std::size_t>(row + Margin) * wide.Columns + Margin;
    for (std::size_t column = 0; column < static_cast<std::size_t>(mean.Columns); ++column)
    {
      mean.Inconsistent[to + column] |= wide.Inconsistent[from + column];
      for (int material = 1; material < mean.Materials; ++material)
      {
        mean.Lengths[static_cast<std::size_t>(material) * mean.NumberOfPixels() + to + column] +=
          weight * wide.Material(material)[from + column];
      }
    }
  }
}

/// Unit vectors and pixel sizes of a detector.
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
    , Options(options)
    , Weights(beam.EnergyWeights())
    , Sums(detector, options.Method)
  {
    const auto stride = static_cast<std::size_t>(beam.NumberOfMaterials());
    for (std::size_t material = 0; material < stride; ++material)
    {
      this->MeanDecrements.push_back(0);
      for (std::size_t energy = 0; energy < this->Weights.size(); ++energy)
      {
        this->Mu.push_back(beam.MuPerMm(energy, static_cast<int>(material)));
        this->Decrements.push_back(decrements[energy * stride + material]);
        this->MeanDecrements.back() += this->Weights[energy] * this->Decrements.back();
      }
    }
  }

  /// Adds the rays of one sample of every pixel, each with this weight; `column` and `row` are the
  /// sample's offset, pixels.
  void Add(const XRayDetector& wide, const PathLengthImage& image,
    const PathLengthDerivatives& derivatives, double column, double row, double weight)
  {
    // Rays by several threads, what they leave on others' pixels by one.
    constexpr int Band = 128;
    std::vector<std::vector<Landing>> landings(Band);
    for (int first = 0; first < wide.Rows; first += Band)
    {
      const int count = std::min(Band, wide.Rows - first);
      ParallelRanges(static_cast<std::size_t>(count), 8,
        [&](std::size_t begin, std::size_t end)
        {
          BentRay ray(this->Weights.size());
          for (std::size_t line = begin; line < end; ++line)
          {
            landings[line].clear();
            for (int c = 0; c < wide.Columns; ++c)
            {
              this->AddRay(wide, image, derivatives, c, first + static_cast<int>(line),
                { column, row }, weight, ray, landings[line]);
            }
          }
        });
      for (int line = 0; line < count; ++line)
      {
        for (const Landing& landing : landings[static_cast<std::size_t>(line)])
        {
          this->Sums.Deposit(landing);
        }
      }
    }
  }

  Exposure Finish(const XRayDetector& detector) const
  {
    Exposure result;
    const std::size_t count = detector.NumberOfPixels();
    result.Deflection.resize(2 * count);
    result.Transmission.resize(count);
    result.LogAttenuation.resize(count);
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
        // The near field's law can fall below 0 where it does not hold.
        const double transmission = std::max(0.0F, static_cast<float>(intensity));
        result.Transmission[pixel] = static_cast<float>(transmission);
        result.LogAttenuation[pixel] = static_cast<float>(-std::log(std::max(transmission, 1e-30)));
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

  /// Adds a ray to the sums of its pixel and, with geometric optics, to `landings`.
  void AddRay(const XRayDetector& wide, const PathLengthImage& image,
    const PathLengthDerivatives& derivatives, int column, int row,
    const std::array<double, 2>& offset, double weight, BentRay& ray,
    std::vector<Landing>& landings)
  {
    const std::size_t pixel = static_cast<std::size_t>(row) * wide.Columns + column;
    const std::size_t energies = this->Weights.size();
    std::fill(ray.Intensities.begin(), ray.Intensities.end(), 0);
    std::fill(ray.Moved[0].begin(), ray.Moved[0].end(), 0);
    std::fill(ray.Moved[1].begin(), ray.Moved[1].end(), 0);
    bool isAir = true;
    for (int material = 1; material < image.Materials; ++material)
    {
      const double length = image.Material(material)[pixel];
      const double rates[2] = { derivatives.Of(0, material)[pixel],
        derivatives.Of(1, material)[pixel] };
      if (length == 0 && rates[0] == 0 && rates[1] == 0)
      {
        continue;
      }
      isAir = false;
      const auto m = static_cast<std::size_t>(material);
      AddMaterial(energies, &this->Mu[m * energies], &this->Decrements[m * energies], length,
        rates[0], rates[1], ray.Intensities.data(), ray.Moved[0].data(), ray.Moved[1].data());
      this->Sums.Deflection[0][pixel] += weight * this->MeanDecrements[m] * rates[0];
      this->Sums.Deflection[1][pixel] += weight * this->MeanDecrements[m] * rates[1];
    }
    if (isAir)
    {
      if (this->Options.Method == Law::NearField)
      {
        this->Sums.Intensity[pixel] += weight;
      }
      else
      {
        landings.push_back(StraightLanding(column + offset[0], row + offset[1], weight));
      }
      return;
    }
    Attenuate(energies, this->Weights.data(), ray.Intensities.data());
    const std::array<std::array<double, 2>, 2> toPixels =
      this->PixelsPerBend(this->WayOf(wide, column, row));
    for (std::size_t energy = 0; energy < energies; ++energy)
    {
      const double bend[2] = { ray.Moved[0][energy], ray.Moved[1][energy] };
      ray.Intensities[energy] *= weight;
      ray.Moved[0][energy] = toPixels[0][0] * bend[0] + toPixels[0][1] * bend[1];
      ray.Moved[1][energy] = toPixels[1][0] * bend[0] + toPixels[1][1] * bend[1];
    }
    if (this->Options.Method == Law::Geometric)
    {
      ray.Land(column + offset[0], row + offset[1], landings);
      return;
    }
    for (std::size_t energy = 0; energy < energies; ++energy)
    {
      this->Sums.Intensity[pixel] += ray.Intensities[energy];
      this->Sums.Flux[0][pixel] += ray.Intensities[energy] * ray.Moved[0][energy];
      this->Sums.Flux[1][pixel] += ray.Intensities[energy] * ray.Moved[1][energy];
    }
  }

  /// Displacement on the detector, [columns or rows], per radian of deflection along columns and
  /// rows.
  std::array<std::array<double, 2>, 2> PixelsPerBend(const Vector3& way) const
  {
    const double u = Dot(way, this->Axes.U);
    const double v = Dot(way, this->Axes.V);
    const double n = Dot(way, this->Axes.N);
    // The bend is at right angles to the ray: along the normal it has -(u a + v b) / n.
    const double length = this->Options.DistanceMm / std::abs(n);
    const double columns = length / this->Axes.ColumnMm;
    const double rows = length / this->Axes.RowMm;
    return { { { columns * (1 + u * u / (n * n)), columns * u * v / (n * n) },
      { rows * u * v / (n * n), rows * (1 + v * v / (n * n)) } } };
  }

  const XRaySource& Source;
  DetectorAxes Axes;
  const RefractionOptions& Options;
  /// Weight of each energy.
  std::vector<double> Weights;
  /// [material * energies + energy].
  std::vector<double> Mu;
  std::vector<double> Decrements;
  /// By material, weighted as energies are detected in the open beam.
  std::vector<double> MeanDecrements;
  RefractionSums Sums;
};
}

double RefractiveDecrement(const std::string& composition, double energyKeV, double densityGPerCm3)
{
  const auto [fractions, nominal] = ParseComposition(composition, "refraction");
  const double density = densityGPerCm3 != 0 ? densityGPerCm3 : nominal;
  if (!(density > 0))
  {
    throw InputError("refraction: expected a density of '" + composition + "', found none");
  }
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

std::vector<double> RefractiveDecrements(const Spectrum& spectrum, const MaterialTable& materials,
  int count, const std::vector<bool>& used)
{
  std::vector<double> decrements;
  for (std::size_t bin = 0; bin < spectrum.Weights.size(); ++bin)
  {
    if (spectrum.Weights[bin] == 0)
    {
      continue;
    }
    decrements.push_back(0);
    for (std::size_t m = 1; m < static_cast<std::size_t>(count); ++m)
    {
      if (m >= used.size() || !used[m])
      {
        decrements.push_back(0);
        continue;
      }
      if (m >= materials.Materials.size())
      {
        throw InputError(
          "refraction: expected the composition of material " + std::to_string(m) + ", found none");
      }
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

Exposure Refract(PathLengthProjector& projector, std::size_t pointCount, const XRaySource& source,
  const XRayDetector& detector, const Beam& beam, const std::vector<double>& decrements,
  const RefractionOptions& options, const ProgressCallback& progress)
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
  VectorFields velocities(2, 3 * pointCount);
  for (std::size_t point = 0; point < pointCount; ++point)
  {
    for (std::size_t axis = 0; axis < 3; ++axis)
    {
      velocities[0][3 * point + axis] = axes.U[axis];
      velocities[1][3 * point + axis] = axes.V[axis];
    }
  }
  Refraction refraction(source, detector, beam, decrements, options);
  const std::vector<std::array<double, 2>> samples = SampleOffsets(detector.Samples);
  const double weight = 1.0 / static_cast<double>(samples.size());
  PathLengthDerivatives derivatives;
  auto lengths = std::make_shared<PathLengthImage>();
  double done = 0;
  for (const auto& [column, row] : samples)
  {
    ReportProgress(progress, done, "bending rays");
    done += weight;
    const XRayDetector wide = WithMargin(detector, column, row);
    const PathLengthImage image = projector.Project(source, wide, velocities, derivatives);
    beam.CheckMaterials(image.Materials);
    refraction.Add(wide, image, derivatives, column, row, weight);
    AddWithin(image, static_cast<float>(weight), detector, *lengths);
  }
  Exposure result = refraction.Finish(detector);
  result.Lengths = std::move(lengths);
  return result;
}
}
