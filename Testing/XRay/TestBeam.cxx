// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Foundation/Error.h"
#include "mammoray/XRay/Beam.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

namespace
{
using namespace mammoray;

AttenuationTable PowerLaw(double scale)
{
  AttenuationTable table;
  table.Name = "power law";
  for (double energy = 10; energy <= 40; energy += 5)
  {
    table.EnergiesKeV.push_back(energy);
    table.MuPerMm.push_back(scale * std::pow(energy / 20, -3));
  }
  return table;
}

PathLengthImage Image(const std::vector<std::vector<float>>& lengths)
{
  PathLengthImage image;
  image.Columns = static_cast<int>(lengths.front().size());
  image.Rows = 1;
  image.Materials = static_cast<int>(lengths.size());
  for (const std::vector<float>& material : lengths)
  {
    image.Lengths.insert(image.Lengths.end(), material.begin(), material.end());
  }
  return image;
}

TEST(AttenuationTable, InterpolatesPowerLawsExactly)
{
  const AttenuationTable table = PowerLaw(0.08);
  EXPECT_NEAR(table.MuAt(20, 1), 0.08, 1e-15);
  EXPECT_NEAR(table.MuAt(17.3, 1), 0.08 * std::pow(17.3 / 20, -3), 1e-15);
  EXPECT_NEAR(table.MuAt(17.3, 1.1), 1.1 * table.MuAt(17.3, 1), 1e-15);
  EXPECT_THROW(table.MuAt(9.99, 1), InputError);
  EXPECT_THROW(table.MuAt(40.01, 1), InputError);
}

TEST(Beam, MonochromaticIsBeerLambert)
{
  const AttenuationTable soft = PowerLaw(0.05);
  const AttenuationTable hard = PowerLaw(0.5);
  const Beam beam(Spectrum::Monochromatic(20), DetectorResponse::EnergyIntegrating,
    { nullptr, &soft, &hard }, { 0, 1, 1.2 });
  const PathLengthImage image = Image({ { 0, 0, 0, 0 }, { 0, 10, 1e-6f, 40 }, { 0, 2, 0, 500 } });
  const auto transmission = beam.Transmission(image);
  const auto logarithm = beam.LogAttenuation(image);
  EXPECT_FLOAT_EQ(transmission[0], 1);
  EXPECT_FLOAT_EQ(logarithm[0], 0);
  EXPECT_FLOAT_EQ(transmission[1], std::exp(-0.5f - 1.2f));
  EXPECT_FLOAT_EQ(logarithm[1], 1.7f);
  EXPECT_FLOAT_EQ(logarithm[2], 5e-8f); // below what 1 - I / I0 can hold in a float
  EXPECT_FLOAT_EQ(logarithm[3], 302);   // I / I0 = 1e-131 does not fit a float
}

TEST(Beam, SpectrumIsWeightedByTheDetector)
{
  const AttenuationTable table = PowerLaw(0.08);
  Spectrum spectrum;
  spectrum.EnergiesKeV = { 15, 20, 30 };
  spectrum.Weights = { 1, 3, 2 };
  EXPECT_NEAR(spectrum.MeanEnergyKeV(), (15 + 60 + 60) / 6.0, 1e-12);
  const double length = 25;
  const auto expected = [&](auto detected)
  {
    double sum = 0;
    double weights = 0;
    for (std::size_t bin = 0; bin < 3; ++bin)
    {
      const double energy = spectrum.EnergiesKeV[bin];
      const double weight = spectrum.Weights[bin] * detected(energy);
      sum += weight * std::exp(-length * 0.08 * std::pow(energy / 20, -3));
      weights += weight;
    }
    return sum / weights;
  };
  const double lengths[2] = { 0, length };
  const Beam integrating(spectrum, DetectorResponse::EnergyIntegrating, { nullptr, &table },
    { 0, 1 });
  const Beam counting(spectrum, DetectorResponse::PhotonCounting, { nullptr, &table }, { 0, 1 });
  EXPECT_NEAR(integrating.Transmission(lengths), expected([](double e) { return e; }), 1e-14);
  EXPECT_NEAR(counting.Transmission(lengths), expected([](double) { return 1.0; }), 1e-14);
  // Any response, here one that falls linearly from 1 to 0 where the spectrum lies.
  const DetectorResponse falling{ false, { 5, 100 }, { 1, 0 } };
  const Beam tabulated(spectrum, falling, { nullptr, &table }, { 0, 1 });
  EXPECT_NEAR(tabulated.Transmission(lengths),
    expected([](double e) { return std::clamp((100 - e) / 95, 0.0, 1.0); }), 1e-14);
}

TEST(Beam, RefusesResponsesThatAreNone)
{
  const AttenuationTable table = PowerLaw(0.05);
  const auto make = [&](const DetectorResponse& response) {
    return Beam(Spectrum::Monochromatic(20), response, { nullptr, &table }, { 0, 1 });
  };
  EXPECT_NO_THROW(make({ true, { 10, 30 }, { 0, 1 } }));
  EXPECT_THROW(make({ true, { 10, 30 }, { 1 } }), InputError);
  EXPECT_THROW(make({ true, { 30, 10 }, { 1, 1 } }), InputError);
  EXPECT_THROW(make({ true, { 10, 30 }, { 1, -1 } }), InputError);
  EXPECT_THROW(make({ true, { 10, 30 }, { 0, 0 } }), InputError); // nothing is detected
}

TEST(Beam, MeanAttenuationIsTheDerivativeOfLogAttenuation)
{
  const AttenuationTable soft = PowerLaw(0.05);
  const AttenuationTable hard = PowerLaw(0.5);
  Spectrum spectrum;
  spectrum.EnergiesKeV = { 15, 20, 30 };
  spectrum.Weights = { 1, 3, 2 };
  const Beam beam(spectrum, DetectorResponse::EnergyIntegrating, { nullptr, &soft, &hard },
    { 0, 1, 1.2 });
  // Air, little, much, and so much that no photon is left in a double.
  const PathLengthImage image = Image({ { 0, 0, 0, 0 }, { 0, 10, 60, 400 }, { 0, 2, 7, 5000 } });
  const std::vector<float> mean = beam.MeanAttenuation(image);
  for (std::size_t pixel = 0; pixel < 3; ++pixel)
  {
    EXPECT_EQ(mean[pixel], 0);
    for (int material = 1; material < 3; ++material)
    {
      double plus[3] = { 0, image.Material(1)[pixel], image.Material(2)[pixel] };
      double minus[3] = { plus[0], plus[1], plus[2] };
      plus[material] += 1e-4;
      minus[material] -= 1e-4;
      const double difference = (beam.LogAttenuation(plus) - beam.LogAttenuation(minus)) / 2e-4;
      // Float result.
      EXPECT_NEAR(mean[static_cast<std::size_t>(material) * 4 + pixel], difference,
        2e-7 * difference);
    }
  }
  // The hardest photons are the last.
  EXPECT_FLOAT_EQ(mean[2 * 4 + 3], static_cast<float>(hard.MuAt(30, 1.2)));
}

TEST(Beam, RefusesUnusableInput)
{
  const AttenuationTable table = PowerLaw(0.08);
  const auto response = DetectorResponse::PhotonCounting;
  EXPECT_THROW(Beam(Spectrum::Monochromatic(5), response, { nullptr, &table }, { 0, 1 }),
    InputError);
  EXPECT_THROW(Beam(Spectrum::Monochromatic(20), response, { nullptr, nullptr }, { 0, 1 }),
    InputError);
  EXPECT_THROW(Beam(Spectrum::Monochromatic(20), response, { nullptr, &table }, { 0, -1 }),
    InputError);
  // 0 stands for the table's own density, where it has one.
  EXPECT_NO_THROW(Beam(Spectrum::Monochromatic(20), response, { nullptr, &table }, { 0, 0 }));
  AttenuationTable formula = table;
  formula.HasDensity = false;
  EXPECT_THROW(Beam(Spectrum::Monochromatic(20), response, { nullptr, &formula }, { 0, 0 }),
    InputError);
  EXPECT_THROW(Beam(Spectrum::Monochromatic(20), response, { nullptr, &table }, { 0 }), InputError);
  EXPECT_THROW(Beam(Spectrum{}, response, { nullptr, &table }, { 0, 1 }), InputError);
  EXPECT_THROW(Spectrum::Monochromatic(-1), InputError);
  // Whose sums or products are no numbers.
  EXPECT_THROW(Beam({ "", { 20, 30 }, { 1e308, 1e308 } }, response, { nullptr, &table }, { 0, 1 }),
    InputError);
  EXPECT_THROW(Beam({ "", { 20 }, { 1e-320 } }, response, { nullptr, &table }, { 0, 1 }),
    InputError);
  EXPECT_THROW(Beam(Spectrum::Monochromatic(20), { true, { 10, 30 }, { 1, 1e308 } },
                 { nullptr, &table }, { 0, 1 }),
    InputError);
  EXPECT_THROW(Beam(Spectrum::Monochromatic(20), response, { nullptr, &table }, { 0, 1e300 }),
    InputError);
  EXPECT_THROW(Spectrum::Monochromatic(1e300).Validate(), InputError);
  const Beam beam(Spectrum::Monochromatic(20), response, { nullptr, &table }, { 0, 1 });
  EXPECT_THROW(beam.Transmission(Image({ { 0 }, { 1 }, { 1 } })), InputError);
}
}
