// SPDX-License-Identifier: Apache-2.0
// Expose is tested with path lengths of closed forms, so that nothing but it is under test.
#include "mammoray/Foundation/Error.h"
#include "mammoray/XRay/Exposure.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <numbers>
#include <random>

namespace
{
using namespace mammoray;

/// Path lengths of material 1 from a function of source and pixel position.
PathLengthFunction Analytic(std::function<double(const Vector3&, const Vector3&)> length)
{
  return [length = std::move(length)](const XRaySource& source, const XRayDetector& detector)
  {
    EXPECT_EQ(detector.Samples, 1);
    auto image = std::make_shared<PathLengthImage>();
    image->Columns = detector.Columns;
    image->Rows = detector.Rows;
    image->Materials = 2;
    image->Lengths.assign(2 * image->NumberOfPixels(), 0.0f);
    image->Inconsistent.assign(image->NumberOfPixels(), 0);
    for (std::size_t pixel = 0; pixel < image->NumberOfPixels(); ++pixel)
    {
      const Vector3 place = detector.Origin +
        static_cast<double>(pixel % detector.Columns) * detector.ColumnStep +
        static_cast<double>(pixel / detector.Columns) * detector.RowStep;
      image->Lengths[image->NumberOfPixels() + pixel] =
        static_cast<float>(length(source.Position, place));
    }
    return image;
  };
}

/// 0.05 / mm at 20 keV, falling with the cube of the energy.
AttenuationTable Tissue()
{
  AttenuationTable table;
  table.Name = "tissue";
  for (double energy = 10; energy <= 60; energy += 1)
  {
    table.EnergiesKeV.push_back(energy);
    table.MuPerMm.push_back(0.05 * std::pow(energy / 20, -3));
  }
  return table;
}

Beam MakeBeam(const Spectrum& spectrum, const DetectorResponse& response)
{
  static const AttenuationTable table = Tissue();
  return Beam(spectrum, response, { nullptr, &table }, { 0, 1 });
}

XRayDetector Row(int columns, double spacing)
{
  XRayDetector detector;
  detector.Columns = columns;
  detector.ColumnStep = { spacing, 0, 0 };
  detector.RowStep = { 0, spacing, 0 };
  detector.Origin = { -0.5 * (columns - 1) * spacing, 0, 0 };
  return detector;
}

struct Moments
{
  double Mean = 0;
  double Variance = 0;
};

Moments MomentsOf(const std::vector<float>& values)
{
  Moments moments;
  for (const float value : values)
  {
    moments.Mean += value / static_cast<double>(values.size());
  }
  for (const float value : values)
  {
    moments.Variance += std::pow(value - moments.Mean, 2) / static_cast<double>(values.size() - 1);
  }
  return moments;
}

/// 40,000 pixels behind 20 mm.
Moments NoiseBehindTissue(const Beam& beam, double photons)
{
  const PathLengthFunction projector =
    Analytic([](const Vector3&, const Vector3&) { return 20.0; });
  XRayDetector detector = Row(200, 0.1);
  detector.Rows = 200;
  ExposureOptions options;
  options.PhotonsPerPixel = photons;
  options.Seed = 7;
  return MomentsOf(Expose(projector, {}, detector, beam, options).Transmission);
}
}

TEST(Exposure, ModulationTransferIsTheStatedOne)
{
  // A wave of transmission of 8 pixels per period, f = 1.25 / mm, and one of 4 pixels.
  const Beam beam = MakeBeam(Spectrum::Monochromatic(20), DetectorResponse::PhotonCounting);
  for (const double period : { 8.0, 4.0 })
  {
    const PathLengthFunction projector = Analytic(
      [&](const Vector3&, const Vector3& pixel)
      {
        const double column = pixel[0] / 0.1 + 200;
        return -std::log(0.5 + 0.4 * std::cos(2 * std::numbers::pi * column / period)) / 0.05;
      });
    XRayDetector detector = Row(400, 0.1);
    ExposureOptions options;
    options.HalfModulationPerMm = 2;
    const auto seen = Expose(projector, {}, detector, beam, options).Transmission;
    const auto sharp = Expose(projector, {}, detector, beam).Transmission;
    const double f = 1 / (0.1 * period);
    const double transfer = std::exp(-std::log(2.0) * (f / 2) * (f / 2));
    for (std::size_t column = 100; column < 300; ++column)
    {
      // The transfer is exact but for the kernel's ends: 1e-7.
      EXPECT_NEAR(seen[column] - 0.5, transfer * (sharp[column] - 0.5), 2e-6);
    }
    // What is even stays even, up to the edges.
    const PathLengthFunction even = Analytic([](const Vector3&, const Vector3&) { return 20.0; });
    for (const float value : Expose(even, {}, detector, beam, options).Transmission)
    {
      EXPECT_NEAR(value, std::exp(-1.0), 1e-6);
    }
  }
}

TEST(Exposure, ALineSpreadBlursByItsTransfer)
{
  // A triangle of 0.3 mm to each side: its transfer is the square of a sinc.
  const Beam beam = MakeBeam(Spectrum::Monochromatic(20), DetectorResponse::PhotonCounting);
  ExposureOptions options;
  options.Spread = { { 0, 0.1, 0.3 }, { 3, 2, 0 } };
  for (const double f : { 0.0, 1e-9, 0.7, 2.5 })
  {
    const double x = std::numbers::pi * f * 0.3;
    EXPECT_NEAR(options.Spread.Transfer(f), x > 0 ? std::pow(std::sin(x) / x, 2) : 1, 1e-9) << f;
  }
  const PathLengthFunction projector = Analytic(
    [](const Vector3&, const Vector3& pixel)
    {
      const double column = pixel[0] / 0.1 + 200;
      return -std::log(0.5 + 0.4 * std::cos(2 * std::numbers::pi * column / 8)) / 0.05;
    });
  const XRayDetector detector = Row(400, 0.1);
  const auto seen = Expose(projector, {}, detector, beam, options).Transmission;
  const auto sharp = Expose(projector, {}, detector, beam).Transmission;
  for (std::size_t column = 100; column < 300; ++column)
  {
    // The transfer does not vanish at the Nyquist frequency: its series ends after 64 pixels.
    EXPECT_NEAR(seen[column] - 0.5, options.Spread.Transfer(1.25) * (sharp[column] - 0.5), 1e-3);
  }
  options.HalfModulationPerMm = 2;
  EXPECT_THROW(options.Validate(), InputError);
  options.HalfModulationPerMm = 0;
  const LineSpread wrong[] = { { { 0 }, { 1 } }, { { 0.1, 1 }, { 1, 1 } }, { { 0, 0 }, { 1, 1 } },
    { { 0, 1 }, { 1, -1 } }, { { 0, 1 }, { 0, 0 } }, { { 0, 1 }, { 1, 1, 1 } } };
  for (const LineSpread& spread : wrong)
  {
    options.Spread = spread;
    EXPECT_THROW(options.Validate(), InputError);
  }
}

TEST(Exposure, PixelsHaveGainsDeathsADarkLevelAndCounts)
{
  const Beam beam = MakeBeam(Spectrum::Monochromatic(20), DetectorResponse::PhotonCounting);
  const PathLengthFunction projector =
    Analytic([](const Vector3&, const Vector3&) { return 20.0; });
  XRayDetector detector = Row(200, 0.1);
  detector.Rows = 200;
  const double mean = std::exp(-1.0);
  const auto seen = [&](const ExposureOptions& options)
  { return Expose(projector, {}, detector, beam, options).Transmission; };
  ExposureOptions options;
  options.GainSpread = 0.02;
  const auto gains = seen(options);
  const Moments spread = MomentsOf(gains);
  EXPECT_NEAR(spread.Mean, mean, 5 * 0.02 * mean / 200);
  EXPECT_NEAR(std::sqrt(spread.Variance), 0.02 * mean, 5 * 0.02 * mean / std::sqrt(8e4));
  options.Seed = 9; // of the noise, not of the detector
  EXPECT_EQ(seen(options), gains);

  options = {};
  options.DeadPixels = 0.01;
  const auto some = seen(options);
  const auto dead = std::count(some.begin(), some.end(), 0.0F);
  EXPECT_NEAR(static_cast<double>(dead), 400, 5 * 20); // of 40,000
  options.PhotonsPerPixel = 1e4;
  const auto noisy = seen(options);
  for (std::size_t pixel = 0; pixel < some.size(); ++pixel)
  {
    ASSERT_EQ(noisy[pixel] == 0, some[pixel] == 0) << "the same ones in every picture";
  }

  options = {};
  options.DarkLevel = 0.05;
  options.Bits = 14;
  const double counts = std::round(0.8 * 16383 * (mean + 0.05));
  EXPECT_NEAR(seen(options)[7], counts / (0.8 * 16383), 1e-7); // floats
  options.DarkLevel = 2;
  EXPECT_NEAR(seen(options)[7], 1.25, 1e-7) << "the largest count";
  for (const ExposureOptions& wrong : { ExposureOptions{ .GainSpread = -1 },
         ExposureOptions{ .DeadPixels = 0.6 }, ExposureOptions{ .DarkLevel = NAN },
         ExposureOptions{ .Bits = 7 }, ExposureOptions{ .Bits = 17 } })
  {
    EXPECT_THROW(wrong.Validate(), InputError);
  }
}

TEST(Exposure, BlurJoinsNoiseAndElectronicNoiseComesLast)
{
  const Beam beam = MakeBeam(Spectrum::Monochromatic(20), DetectorResponse::PhotonCounting);
  const PathLengthFunction projector =
    Analytic([](const Vector3&, const Vector3&) { return 20.0; });
  XRayDetector detector = Row(200, 0.1);
  detector.Rows = 200;
  ExposureOptions options;
  options.PhotonsPerPixel = 1000;
  options.HalfModulationPerMm = 2.5;
  const double mean = std::exp(-1.0);
  // White noise through the transfer keeps the mean of its square: over |f| < 1/2 per pixel, in
  // both directions. Half modulation at a quarter of a cycle: MTF^2 = exp(-2 ln2 (4 c)^2).
  double kept = 0;
  for (int n = 0; n < 10000; ++n)
  {
    const double cycles = 0.5 * (n + 0.5) / 10000;
    kept += std::exp(-2 * std::log(2.0) * 16 * cycles * cycles) / 10000;
  }
  const Moments blurred = MomentsOf(Expose(projector, {}, detector, beam, options).Transmission);
  // 40,000 pixels, of which about a quarter are independent: 5 standard deviations.
  EXPECT_NEAR(blurred.Mean, mean, 5 * std::sqrt(mean / 1000 / 40000));
  EXPECT_NEAR(blurred.Variance / (mean / 1000), kept * kept, 5 * kept * kept * std::sqrt(8e-4 / 4));
  options.ElectronicNoisePhotons = 30;
  const Moments both = MomentsOf(Expose(projector, {}, detector, beam, options).Transmission);
  EXPECT_NEAR(both.Variance - blurred.Variance, 30.0 * 30 / 1e6,
    5 * 9e-4 * std::sqrt(2.0 / 4e4) * 2);
  options.PhotonsPerPixel = 0;
  EXPECT_THROW(Expose(projector, {}, detector, beam, options), InputError);
}

TEST(Exposure, AnOpenFieldScalesSignalAndNoise)
{
  const Beam beam = MakeBeam(Spectrum::Monochromatic(20), DetectorResponse::PhotonCounting);
  const PathLengthFunction projector =
    Analytic([](const Vector3&, const Vector3&) { return 20.0; });
  XRayDetector detector = Row(200, 0.1);
  detector.Rows = 200;
  ExposureOptions options;
  options.OpenField.assign(40000, 0.25f);
  const Exposure quiet = Expose(projector, {}, detector, beam, options);
  EXPECT_FLOAT_EQ(quiet.Transmission[77], static_cast<float>(0.25 * std::exp(-1.0)));
  EXPECT_FLOAT_EQ(quiet.LogAttenuation[77], static_cast<float>(1 + std::log(4.0)));
  options.PhotonsPerPixel = 1000;
  const Moments noisy = MomentsOf(Expose(projector, {}, detector, beam, options).Transmission);
  const double variance = 0.25 * std::exp(-1.0) / 1000; // of as many photons as come
  EXPECT_NEAR(noisy.Variance / variance, 1, 5 * std::sqrt(2.0 / 4e4));
  options.OpenField.pop_back();
  EXPECT_THROW(Expose(projector, {}, detector, beam, options), InputError);
  options.OpenField.assign(40000, -1.0f);
  EXPECT_THROW(Expose(projector, {}, detector, beam, options), InputError);
}

TEST(Exposure, ScatterIsAddedToSignalAndNoise)
{
  const Beam beam = MakeBeam(Spectrum::Monochromatic(20), DetectorResponse::PhotonCounting);
  const PathLengthFunction projector =
    Analytic([](const Vector3&, const Vector3&) { return 20.0; });
  XRayDetector detector = Row(200, 0.1);
  detector.Rows = 200;
  ExposureOptions options;
  options.OpenField.assign(40000, 0.5f);
  options.Scatter = [](const PathLengthImage& lengths, const std::vector<double>& primary)
  {
    EXPECT_FLOAT_EQ(lengths.Material(1)[5], 20);
    EXPECT_NEAR(primary[5], 0.5 * std::exp(-1.0), 1e-9);
    return std::vector<double>(primary.size(), 0.3);
  };
  const double mean = 0.3 + 0.5 * std::exp(-1.0);
  EXPECT_FLOAT_EQ(Expose(projector, {}, detector, beam, options).Transmission[77],
    static_cast<float>(mean));
  options.PhotonsPerPixel = 1000;
  const Moments noisy = MomentsOf(Expose(projector, {}, detector, beam, options).Transmission);
  EXPECT_NEAR(noisy.Variance / (mean / 1000), 1, 5 * std::sqrt(2.0 / 4e4));
  options.Scatter = [](const PathLengthImage&, const std::vector<double>&)
  { return std::vector<double>(3); };
  EXPECT_THROW(Expose(projector, {}, detector, beam, options), InputError);
}

TEST(Exposure, AveragesTransmissionsNotPathLengths)
{
  // Half of the middle pixel is behind 60 mm, as half of its 4 x 4 samples are.
  const PathLengthFunction projector =
    Analytic([](const Vector3&, const Vector3& pixel) { return pixel[0] > 0 ? 60.0 : 0.0; });
  XRayDetector detector = Row(3, 1);
  detector.Samples = 4;
  const Beam beam = MakeBeam(Spectrum::Monochromatic(20), DetectorResponse::PhotonCounting);
  const Exposure exposure = Expose(projector, {}, detector, beam);
  const double through = std::exp(-3.0);
  EXPECT_FLOAT_EQ(exposure.Transmission[0], 1);
  EXPECT_FLOAT_EQ(exposure.Transmission[1], static_cast<float>(0.5 * (1 + through)));
  EXPECT_FLOAT_EQ(exposure.Transmission[2], static_cast<float>(through));
  EXPECT_FLOAT_EQ(exposure.LogAttenuation[1], static_cast<float>(-std::log(0.5 * (1 + through))));
  EXPECT_FLOAT_EQ(exposure.Lengths->Material(1)[1], 30); // whose transmission is 0.22, not 0.52
}

TEST(Exposure, FocalSpotBlursAnEdgeByItsMagnification)
{
  // An opaque half plane at half of the way: a spot of 0.8 mm casts a penumbra of 0.8 mm.
  const PathLengthFunction projector = Analytic([](const Vector3& source, const Vector3& pixel)
    { return 0.5 * (source[0] + pixel[0]) > 0 ? 1e4 : 0.0; });
  const XRayDetector detector = Row(41, 0.05);
  const Beam beam = MakeBeam(Spectrum::Monochromatic(20), DetectorResponse::PhotonCounting);
  ExposureOptions options;
  options.FocalSpotColumnMm = 0.8;
  options.FocalSpotSamples = 16;
  const Exposure exposure = Expose(projector, {}, detector, beam, options);
  for (int column = 0; column < 41; ++column)
  {
    const double x = detector.Origin[0] + 0.05 * column;
    // A ramp over the penumbra, in 16 steps.
    const double expected = std::clamp(0.5 - x / 0.8, 0.0, 1.0);
    EXPECT_NEAR(exposure.Transmission[column], expected, 0.5 / 16 + 1e-6) << x;
  }
  // Along rows nothing changes, and without a spot the edge is sharp.
  options.FocalSpotColumnMm = 0;
  options.FocalSpotRowMm = 0.8;
  const Exposure sharp = Expose(projector, {}, detector, beam, options);
  EXPECT_FLOAT_EQ(sharp.Transmission[19], 1);
  EXPECT_FLOAT_EQ(sharp.Transmission[21], 0);
}

TEST(Exposure, CountingNoiseIsPoisson)
{
  const Beam beam = MakeBeam(Spectrum::Monochromatic(20), DetectorResponse::PhotonCounting);
  for (const double photons : { 0.5, 8.0, 60.0, 5000.0 })
  {
    const double mean = std::exp(-1.0);
    const Moments moments = NoiseBehindTissue(beam, photons);
    // Of 40,000 samples the mean is known to sqrt(variance / n), the variance to
    // variance sqrt((2 + 1 / lambda) / n); four of those.
    const double variance = mean / photons;
    EXPECT_NEAR(moments.Mean, mean, 4 * std::sqrt(variance / 40000)) << photons;
    EXPECT_NEAR(moments.Variance, variance,
      4 * variance * std::sqrt((2 + 1 / (mean * photons)) / 40000))
      << photons;
  }
}

TEST(Exposure, FewPhotonsHavePoissonsProbabilities)
{
  const double lambda = 0.7;
  const PathLengthFunction projector = Analytic([](const Vector3&, const Vector3&) { return 0.0; });
  XRayDetector detector = Row(200, 0.1);
  detector.Rows = 200;
  ExposureOptions options;
  options.PhotonsPerPixel = lambda;
  const Exposure exposure = Expose(projector, {}, detector,
    MakeBeam(Spectrum::Monochromatic(20), DetectorResponse::PhotonCounting), options);
  double counts[4] = {};
  for (const float value : exposure.Transmission)
  {
    const long k = std::lround(value * lambda);
    ASSERT_NEAR(value * lambda, static_cast<double>(k), 1e-5);
    counts[std::min(k, 3L)] += 1;
  }
  double probability = std::exp(-lambda);
  for (int k = 0; k < 3; ++k)
  {
    // Four standard deviations of a binomial count.
    EXPECT_NEAR(counts[k], 40000 * probability,
      4 * std::sqrt(40000 * probability * (1 - probability)))
      << k;
    probability *= lambda / (k + 1);
  }
  // Nothing detected reads as half a photon.
  EXPECT_FLOAT_EQ(*std::max_element(exposure.LogAttenuation.begin(), exposure.LogAttenuation.end()),
    static_cast<float>(-std::log(0.5 / lambda)));
}

TEST(Exposure, IntegratedNoiseWeighsEnergies)
{
  Spectrum spectrum;
  spectrum.EnergiesKeV = { 15, 20, 50 };
  spectrum.Weights = { 3, 2, 1 };
  const Beam beam = MakeBeam(spectrum, DetectorResponse::EnergyIntegrating);
  const double photons = 900;
  double open = 0;
  double mean = 0;
  double square = 0;
  for (std::size_t bin = 0; bin < 3; ++bin)
  {
    const double energy = spectrum.EnergiesKeV[bin];
    const double incident = photons * spectrum.Weights[bin] / 6;
    const double detected = incident * std::exp(-20 * 0.05 * std::pow(energy / 20, -3));
    open += energy * incident;
    mean += energy * detected;
    square += energy * energy * detected; // variance of a sum of energies times Poisson numbers
  }
  const Moments moments = NoiseBehindTissue(beam, photons);
  const double variance = square / (open * open);
  EXPECT_NEAR(moments.Mean, mean / open, 4 * std::sqrt(variance / 40000));
  EXPECT_NEAR(moments.Variance, variance, 4 * variance * std::sqrt(2.01 / 40000));
}

TEST(Exposure, NoiseIsRepeatedBySeed)
{
  const PathLengthFunction projector =
    Analytic([](const Vector3&, const Vector3& pixel) { return 5 + pixel[0]; });
  const XRayDetector detector = Row(100, 0.05);
  const Beam beam = MakeBeam(Spectrum::Monochromatic(20), DetectorResponse::PhotonCounting);
  ExposureOptions options;
  options.PhotonsPerPixel = 1000;
  options.Seed = 1;
  const auto first = Expose(projector, {}, detector, beam, options).Transmission;
  EXPECT_EQ(first, Expose(projector, {}, detector, beam, options).Transmission);
  options.Seed = 2;
  const auto second = Expose(projector, {}, detector, beam, options).Transmission;
  int equal = 0;
  for (std::size_t pixel = 0; pixel < first.size(); ++pixel)
  {
    equal += first[pixel] == second[pixel] ? 1 : 0;
  }
  EXPECT_LT(equal, 20); // of 100; two Poisson numbers of 800 are equal in one of 100 cases
}

TEST(Exposure, RefusesUnusableOptions)
{
  const PathLengthFunction projector = Analytic([](const Vector3&, const Vector3&) { return 0.0; });
  const Beam beam = MakeBeam(Spectrum::Monochromatic(20), DetectorResponse::PhotonCounting);
  const auto refused = [&](const ExposureOptions& options, const XRaySource& source = {})
  { EXPECT_THROW(Expose(projector, source, Row(3, 1), beam, options), InputError); };
  refused({ .FocalSpotColumnMm = -1 });
  refused({ .FocalSpotRowMm = NAN });
  refused({ .FocalSpotSamples = 0 });
  refused({ .PhotonsPerPixel = -5 });
  refused({ .PhotonsPerPixel = INFINITY });
  XRaySource parallel;
  parallel.Type = XRaySource::Kind::Parallel;
  refused({ .FocalSpotColumnMm = 0.3 }, parallel);
}

TEST(Exposure, VectorisedLawMatchesRayByRay)
{
  std::mt19937 random(3);
  const AttenuationTable table = Tissue();
  Spectrum spectrum;
  for (int bin = 0; bin < 100; ++bin)
  {
    spectrum.EnergiesKeV.push_back(10 + 0.5 * bin);
    spectrum.Weights.push_back(std::uniform_real_distribution<double>(0, 1)(random));
  }
  const Beam beam(spectrum, DetectorResponse::EnergyIntegrating,
    { nullptr, &table, &table, &table }, { 0, 1, 2.5, 7 });
  PathLengthImage image;
  image.Columns = 1001; // not a multiple of any block
  image.Rows = 3;
  image.Materials = 4;
  image.Lengths.assign(4 * image.NumberOfPixels(), 0.0f);
  for (std::size_t value = image.NumberOfPixels(); value < image.Lengths.size(); ++value)
  {
    const double exponent = std::uniform_real_distribution<double>(-8, 3)(random);
    image.Lengths[value] = random() % 3 == 0 ? 0.0f : static_cast<float>(std::pow(10, exponent));
  }
  const auto transmission = beam.Transmission(image);
  const auto logarithm = beam.LogAttenuation(image);
  for (std::size_t pixel = 0; pixel < image.NumberOfPixels(); ++pixel)
  {
    double lengths[4] = {};
    for (int material = 1; material < 4; ++material)
    {
      lengths[material] = image.Material(material)[pixel];
    }
    const double expected = beam.Transmission(lengths);
    // Rounding to float, and to its smallest number.
    ASSERT_NEAR(transmission[pixel], expected, 1e-7 * expected + 1e-45) << pixel;
    const double expectedLog = beam.LogAttenuation(lengths);
    ASSERT_NEAR(logarithm[pixel], expectedLog, 1e-7 * expectedLog) << pixel;
  }
}
