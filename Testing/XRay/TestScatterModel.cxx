// SPDX-License-Identifier: Apache-2.0
#include "Files.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/ScatterData.h"
#include "mammoray/IO/ShippedData.h"
#include "mammoray/XRay/Scatter/MonteCarlo.h"
#include "mammoray/XRay/Scatter/ScatterModel.h"
#include "mammoray/XRay/Scene.h"
#include "mammoray/XRay/Tube.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

namespace
{
using namespace mammoray;

ScatterModel MakeModel(double gapMm, const std::optional<AntiscatterGrid>& grid = {})
{
  return ScatterModel(FindScatterKernels(), FindSpectrum("W28kVp_Rh50um_Be1mm"),
    DetectorResponse::EnergyIntegrating, gapMm, grid);
}

XRaySource Parallel()
{
  XRaySource source;
  source.Type = XRaySource::Kind::Parallel;
  return source;
}

XRayDetector MakeDetector(int columns, int rows, double pixelMm)
{
  XRayDetector detector;
  detector.ColumnStep = { pixelMm, 0, 0 };
  detector.RowStep = { 0, pixelMm, 0 };
  detector.Columns = columns;
  detector.Rows = rows;
  return detector;
}

TEST(ScatterModel, ADiscOfLightScattersOntoItsAxisAsTheClosedFormSays)
{
  const ScatterModel model = MakeModel(15);
  const XRayDetector detector = MakeDetector(301, 301, 0.5);
  std::vector<double> thickness(301 * 301, 45);
  std::vector<double> primary(thickness.size());
  for (int row = 0; row < 301; ++row)
  {
    for (int column = 0; column < 301; ++column)
    {
      primary[static_cast<std::size_t>(301 * row + column)] =
        std::hypot(0.5 * (row - 150), 0.5 * (column - 150)) <= 60 ? 0.2 : 0;
    }
  }
  const std::vector<double> scatter = model.Scatter(Parallel(), detector, thickness, primary);
  const double expected = 0.2 * model.ScatterToPrimary(45, 120);
  // Cells of 2 mm.
  EXPECT_NEAR(scatter[150 * 301 + 150], expected, 0.01 * expected);
}

TEST(ScatterModel, SizesOfPixelsDoNotMatter)
{
  const ScatterModel model = MakeModel(15);
  double values[2];
  for (const int fine : { 0, 1 })
  {
    const int count = fine != 0 ? 400 : 80;
    const XRayDetector detector = MakeDetector(count, count, fine != 0 ? 0.25 : 1.25);
    const std::vector<double> thickness(static_cast<std::size_t>(count * count), 55);
    const std::vector<double> primary(thickness.size(), 1);
    const std::vector<double> scatter = model.Scatter(Parallel(), detector, thickness, primary);
    values[fine] = scatter[static_cast<std::size_t>(count / 2 * count + count / 2)];
  }
  EXPECT_NEAR(values[0], values[1], 0.01 * values[1]);
}

TEST(ScatterModel, IsLinearInWhatComesThroughAndNothingOfAir)
{
  const ScatterModel model = MakeModel(10);
  const XRayDetector detector = MakeDetector(60, 40, 2);
  std::vector<double> thickness(60 * 40);
  std::vector<double> primary(thickness.size());
  for (std::size_t pixel = 0; pixel < primary.size(); ++pixel)
  {
    thickness[pixel] = pixel % 60 < 30 ? 50 - static_cast<double>(pixel % 60) : 0;
    primary[pixel] = 0.1 + 0.001 * static_cast<double>(pixel % 97);
  }
  const std::vector<double> once = model.Scatter(Parallel(), detector, thickness, primary);
  std::vector<double> twice = primary;
  for (double& value : twice)
  {
    value *= 2;
  }
  const std::vector<double> doubled = model.Scatter(Parallel(), detector, thickness, twice);
  for (std::size_t pixel = 0; pixel < once.size(); ++pixel)
  {
    EXPECT_NEAR(doubled[pixel], 2 * once[pixel], 1e-9);
    EXPECT_GE(once[pixel], 0);
  }
  const std::vector<double> none =
    model.Scatter(Parallel(), detector, std::vector<double>(primary.size()), primary);
  EXPECT_NEAR(std::accumulate(none.begin(), none.end(), 0.0), 0, 1e-12);
}

TEST(ScatterModel, AGapAndAGridTakeScatterAway)
{
  const double near = MakeModel(0).ScatterToPrimary(50, 150);
  const double far = MakeModel(40).ScatterToPrimary(50, 150);
  EXPECT_LT(far, near);
  const double grid = MakeModel(15, AntiscatterGrid({})).ScatterToPrimary(50, 150);
  EXPECT_LT(grid, 0.3 * near);
  EXPECT_GT(grid, 0.03 * near);
}

/// Boone and Cooper (Med. Phys. 27, 2000), 15 mm of air, diameter and thickness in cm.
double PublishedRatio(double diameterCm, double thicknessCm)
{
  return 1 /
    (-2.35452817 + 22.39609806 * std::pow(diameterCm, -1.5) + 8.85064260 / std::sqrt(thicknessCm));
}

TEST(ScatterModel, RatiosArePublishedOnesWhereBreastsAre)
{
  // 8 to 20 cm of field and 2 to 7 cm of breast within 12 %; farther off beyond: see the README.
  const ScatterModel model = MakeModel(15);
  for (const double diameter : { 8.0, 12.0, 15.0, 20.0 })
  {
    for (const double thickness : { 2.0, 3.0, 4.0, 5.0, 6.0, 7.0 })
    {
      const double published = PublishedRatio(diameter, thickness);
      EXPECT_NEAR(model.ScatterToPrimary(10 * thickness, 10 * diameter), published,
        0.12 * published)
        << diameter << " cm, " << thickness << " cm";
    }
  }
}

TEST(ScatterModel, ABlockScattersAsPhotonsThatAreFollowed)
{
  // 120 x 60 mm of the kernels' tissue, 54 mm high, 17 mm over the detector, under a unit's tube:
  // edges, divergence and all.
  const ScatterKernels kernels = FindScatterKernels();
  const Spectrum spectrum = FindSpectrum("W28kVp_Rh50um_Be1mm");
  LabelVolume volume;
  volume.Size = { 60, 120, 54 };
  volume.Origin = { 0.5, -59.5, 17.5 };
  volume.Voxels.assign(60 * 120 * 54, 1);
  const PhotonMaterial tissue(kernels.Composition, kernels.DensityGPerCm3);
  const VoxelScene scene(volume, { PhotonMaterial(), tissue });
  XRaySource source;
  source.Position = { 0, 0, 650 };
  XRayDetector detector;
  detector.Origin = { 1.25, -98.75, 0 };
  detector.ColumnStep = { 2.5, 0, 0 };
  detector.RowStep = { 0, 2.5, 0 };
  detector.Columns = 40;
  detector.Rows = 80;
  MonteCarloOptions options;
  options.Photons = 4000000;
  const MonteCarloResult followed =
    FollowPhotons(scene, source, detector, spectrum, DetectorResponse::EnergyIntegrating, options);
  // Thickness along each ray, and what comes through, the source's distance and slant included.
  std::vector<double> thickness;
  std::vector<double> primary;
  for (int row = 0; row < 80; ++row)
  {
    for (int column = 0; column < 40; ++column)
    {
      const Vector3 way{ 1.25 + 2.5 * column, -98.75 + 2.5 * row, -650 };
      double length = 0;
      for (int step = 0; step < 540; ++step)
      {
        const double share = 1 - (17.05 + 0.1 * step) / 650;
        const bool inside =
          share * way[0] > 0 && share * way[0] < 60 && std::abs(share * way[1]) < 60;
        length += inside ? 0.1 * Norm(way) / 650 : 0;
      }
      thickness.push_back(length);
      double signal = 0;
      double open = 0;
      for (std::size_t bin = 0; bin < spectrum.Weights.size(); ++bin)
      {
        const double energy = spectrum.EnergiesKeV[bin];
        open += spectrum.Weights[bin] * energy;
        signal += spectrum.Weights[bin] * energy * std::exp(-tissue.At(energy).Total() * length);
      }
      primary.push_back(signal / open * std::pow(650 / Norm(way), 3));
    }
  }
  const std::vector<double> modelled =
    ScatterModel(kernels, spectrum, DetectorResponse::EnergyIntegrating, 17)
      .Scatter(source, detector, thickness, primary);
  // Regions of 20 x 20 mm; their photons are known to 2 %.
  const auto mean = [&](const auto& values, int column, int row)
  {
    double sum = 0;
    for (int place = 0; place < 64; ++place)
    {
      sum += values[static_cast<std::size_t>((row + place / 8) * 40 + column + place % 8)];
    }
    return sum / 64;
  };
  for (const int row : { 36, 24 })
  {
    for (const int column : { 0, 8, 14 })
    {
      const double expected = mean(followed.Scatter, column, row);
      EXPECT_NEAR(mean(modelled, column, row), expected, 0.1 * expected) << row << " " << column;
    }
  }
}

/// A body of voxels of 1 mm over a detector, and what the photons that are followed and kernels
/// that are made for it say of its scatter.
struct Comparison
{
  Comparison(const std::string& material, double densityGPerCm3, const XRayTube& tube, int steps,
    int stepMm)
  {
    // 80 x 80 mm, 20 mm over the detector; each step along x higher by stepMm.
    LabelVolume volume;
    volume.Size = { 80, 80, steps * stepMm };
    volume.Origin = { -39.5, -39.5, 20.5 };
    for (int k = 0; k < steps * stepMm; ++k)
    {
      for (int row = 0; row < 80; ++row)
      {
        for (int column = 0; column < 80; ++column)
        {
          volume.Voxels.push_back(k < stepMm * (1 + column * steps / 80) ? 1 : 0);
        }
      }
    }
    const PhotonMaterial of(material, densityGPerCm3);
    const VoxelScene body(volume, { PhotonMaterial(), of });
    Scene scene;
    scene.XRays = TubeSpectrum(tube);
    scene.Source.Position = { 0, 0, 600 };
    scene.Detector = MakeDetector(48, 48, 2.5);
    scene.Detector.Origin = { -58.75, -58.75, 0 };
    scene.Materials.Materials = { { .Name = "air" },
      { .Name = "part", .Attenuation = material, .DensityGPerCm3 = densityGPerCm3 } };
    scene.Scatter.Compositions = { "", material };
    scene.Scatter.AirGapMm = 20;
    PathLengthImage lengths;
    lengths.Columns = lengths.Rows = 48;
    lengths.Materials = 2;
    lengths.Lengths.assign(2 * 48 * 48, 0);
    std::vector<double> primary;
    const double height = steps * stepMm;
    for (std::size_t pixel = 0; pixel < 48 * 48; ++pixel)
    {
      const Vector3 way{ -58.75 + 2.5 * static_cast<double>(pixel % 48),
        -58.75 + 2.5 * static_cast<double>(pixel / 48), -600 };
      double length = 0;
      for (double z = 20.005; z < 20 + height; z += 0.01)
      {
        const Vector3 point = Vector3{ 0, 0, 600 } + ((600 - z) / 600) * way;
        const bool isBeside = std::abs(point[0]) >= 40 || std::abs(point[1]) >= 40;
        length += !isBeside && body.RegionAt(point) == 1 ? 0.01 * Norm(way) / 600 : 0;
      }
      lengths.Lengths[48 * 48 + pixel] = static_cast<float>(length);
      double signal = 0;
      double open = 0;
      for (std::size_t bin = 0; bin < scene.XRays.Weights.size(); ++bin)
      {
        const double energy = scene.XRays.EnergiesKeV[bin];
        open += scene.XRays.Weights[bin] * energy;
        signal += scene.XRays.Weights[bin] * energy * std::exp(-of.At(energy).Total() * length);
      }
      primary.push_back(signal / open * std::pow(600 / Norm(way), 3));
    }
    MonteCarloOptions options;
    options.Photons = 3000000;
    this->Followed =
      FollowPhotons(body, scene.Source, scene.Detector, scene.XRays, scene.Response, options);
    this->Kernels = KernelAxesOf(scene, lengths);
    FillScatterKernels(this->Kernels, 20000, 0);
    this->Modelled = ScatterModel(this->Kernels, scene.XRays, scene.Response, 20)
                       .Scatter(scene.Source, scene.Detector, TissueThickness(lengths), primary);
  }
  /// Mean over 20 x 20 mm from this pixel on.
  template <typename Values>
  static double Mean(const Values& values, int column, int row)
  {
    double sum = 0;
    for (int place = 0; place < 64; ++place)
    {
      sum += values[static_cast<std::size_t>((row + place / 8) * 48 + column + place % 8)];
    }
    return sum / 64;
  }

  MonteCarloResult Followed;
  ScatterKernels Kernels;
  std::vector<double> Modelled;
};

TEST(ScatterModel, ASteelWedgeScattersAsPhotonsThatAreFollowed)
{
  // Steps of 5 and 10 mm at 160 kV behind 1 mm of copper.
  XRayTube tube{ .Anode = "W", .KilovoltagePeak = 160 };
  tube.Filters = { XRayFilter::FromText("Cu:1") };
  const Comparison wedge("Fe", 7.874, tube, 2, 5);
  EXPECT_EQ(wedge.Kernels.Composition, "Fe");
  // Numbers depend on nothing but the seed, and a file keeps what counts.
  ScatterKernels again = wedge.Kernels;
  FillScatterKernels(again, 20000, 0);
  EXPECT_EQ(again, wedge.Kernels);
  const test::TemporaryFolder folder;
  WriteScatterKernels(wedge.Kernels, "made by a test", folder.File("steel.csv"));
  const ScatterKernels read = FindScatterKernels(folder.File("steel.csv"));
  EXPECT_EQ(read.Composition, "Fe");
  ASSERT_EQ(read.Shares.size(), wedge.Kernels.Shares.size());
  for (std::size_t share = 0; share < read.Shares.size(); ++share)
  {
    ASSERT_NEAR(read.Shares[share], wedge.Kernels.Shares[share],
      0.01 * wedge.Kernels.Shares[share]); // three digits
  }
  for (const int column : { 8, 14, 26, 32 })
  {
    for (const int row : { 12, 20 })
    {
      const double expected = Comparison::Mean(wedge.Followed.Scatter, column, row);
      // Regions beside the step and near edges; 5 % is what is found, photons are known to 2 %.
      EXPECT_NEAR(Comparison::Mean(wedge.Modelled, column, row), expected, 0.1 * expected)
        << column << " " << row;
    }
  }
}

TEST(ScatterModel, ABlockOfPlasticScattersAsPhotonsThatAreFollowed)
{
  XRayTube tube{ .Anode = "W", .KilovoltagePeak = 80 };
  tube.Filters = { XRayFilter::FromText("Al:2.5") };
  const Comparison block("PMMA", 1.19, tube, 1, 40);
  for (const int column : { 8, 14, 20 })
  {
    for (const int row : { 8, 20 })
    {
      const double expected = Comparison::Mean(block.Followed.Scatter, column, row);
      // 2 to 6 % are found in the middle and at edges, 11 % in the corner: what leaves through the
      // sides is not modelled.
      EXPECT_NEAR(Comparison::Mean(block.Modelled, column, row), expected, 0.15 * expected)
        << column << " " << row;
    }
  }
}

TEST(ScatterModel, RefusesKernelsOfOtherEnergies)
{
  const ScatterKernels breast = FindScatterKernels();
  for (const double energy : { 5.0, 80.0 })
  {
    EXPECT_THROW(ScatterModel(breast, Spectrum::Monochromatic(energy), {}, 17), InputError);
  }
  EXPECT_NO_THROW(ScatterModel(breast, Spectrum::Monochromatic(50), {}, 17));
}

TEST(ScatterModel, KernelsOfASceneHaveItsMeanMaterial)
{
  Scene scene;
  scene.Materials.Materials = { { .Name = "air" },
    { .Name = "water", .Attenuation = "H2O", .DensityGPerCm3 = 1 },
    { .Name = "glass", .Attenuation = "SiO2", .DensityGPerCm3 = 2.2 },
    { .Name = "number", .Attenuation = "0.05/mm", .DensityGPerCm3 = 1 } };
  scene.Scatter.Compositions = { "", "H2O", "SiO2", "0.05/mm" };
  scene.Detector = MakeDetector(2, 1, 1);
  PathLengthImage lengths;
  lengths.Columns = 2;
  lengths.Rows = 1;
  lengths.Materials = 4;
  lengths.Lengths = { 0, 0, 20, 10, 0, 10, 0, 0 };
  const ScatterKernels kernels = KernelAxesOf(scene, lengths);
  EXPECT_NEAR(kernels.DensityGPerCm3, 0.75 * 1 + 0.25 * 2.2, 1e-12);
  // 0.75 g of water with 11.2 % of hydrogen in 1.3 g.
  EXPECT_THAT(kernels.Composition, testing::StartsWith("H:0.064"));
  EXPECT_GE(kernels.ThicknessesMm.back(), 20);
  EXPECT_LE(kernels.ThicknessesMm.back(), 22);
  EXPECT_EQ(kernels.EnergiesKeV, std::vector<double>{ 20 });
  // A material whose elements nobody knows, and nothing at all.
  lengths.Lengths = { 0, 0, 20, 10, 0, 10, 5, 5 };
  EXPECT_THROW(KernelAxesOf(scene, lengths), InputError);
  lengths.Lengths.assign(8, 0);
  EXPECT_THROW(KernelAxesOf(scene, lengths), InputError);
}

/// A breast between plates: round towards both of them, and beside what rays see of its thickness
/// and of what comes through, how both change with the distance of the plates and with the way of
/// the breast along the rows.
struct Mound
{
  std::vector<double> Thickness;
  std::vector<double> Primary;
  std::vector<ScatterModel::SignalRates> Rates{ 2 };

  explicit Mound(double platesMm, double shiftMm = 0)
  {
    for (int row = 0; row < 60; ++row)
    {
      for (int column = 0; column < 40; ++column)
      {
        const double x = 3.0 * column;
        const double y = 3.0 * (row - 30) - shiftMm;
        // Half of the square of the way from the outline, an ellipse.
        const double depth = 50 * (1 - x * x / 6400 - y * y / 4900);
        const double root = std::sqrt(std::max(depth, 0.0) * std::max(depth, 0.0) + 1);
        const double bulge = std::max(depth, 0.0) / root;
        const double bulgeRate = depth > 0 ? 1 / (root * root * root) : 0;
        // A ray is the longer the more it slants.
        const double slant = std::sqrt(1 + (x * x + y * y) / (650.0 * 650.0));
        this->Thickness.push_back(platesMm * bulge * slant);
        this->Primary.push_back(std::exp(-0.06 * this->Thickness.back()));
        const double depthRate = 50 * 2 * y / 4900;
        const double slantRate = -y / (650.0 * 650.0) / slant;
        const double rates[2] = { bulge * slant,
          platesMm * (bulgeRate * depthRate * slant + bulge * slantRate) };
        for (const std::size_t field : { 0, 1 })
        {
          this->Rates[field].ThicknessesMm.push_back(rates[field]);
          this->Rates[field].Primary.push_back(-0.06 * this->Primary.back() * rates[field]);
        }
      }
    }
  }
};

TEST(ScatterModel, DerivativesAgreeWithDifferences)
{
  XRaySource source;
  source.Position = { 0, 90, 650 };
  const XRayDetector detector = MakeDetector(40, 60, 3);
  for (const auto& grid : { std::optional<AntiscatterGrid>(), std::optional(AntiscatterGrid({})) })
  {
    const ScatterModel model = MakeModel(12, grid);
    const Mound here(47);
    const auto rates =
      model.Differentiate(source, detector, here.Thickness, here.Primary, here.Rates);
    ASSERT_EQ(rates.size(), 2U);
    for (const std::size_t field : { 0, 1 })
    {
      const double step = 1e-4; // mm: fewer kinks than pixels, more than rounding
      const auto beside = [&](double sign)
      {
        const Mound moved(47 + (field == 0 ? sign * step : 0), field == 1 ? sign * step : 0);
        return model.Scatter(source, detector, moved.Thickness, moved.Primary);
      };
      const std::vector<double> plus = beside(1);
      const std::vector<double> minus = beside(-1);
      double largest = 0;
      double off = 0;
      for (std::size_t pixel = 0; pixel < plus.size(); ++pixel)
      {
        const double difference = (plus[pixel] - minus[pixel]) / (2 * step);
        largest = std::max(largest, std::abs(difference));
        off = std::max(off, std::abs(difference - rates[field][pixel]));
      }
      EXPECT_GT(largest, 1e-5);
      EXPECT_LT(off, 1e-6 * largest) << field;
    }
  }
}

TEST(ScatterModel, RefusesWhatDoesNotFit)
{
  EXPECT_THROW(MakeModel(-1), InputError);
  EXPECT_THROW(MakeModel(300), InputError);
  const XRayDetector detector = MakeDetector(4, 4, 1);
  EXPECT_THROW(
    MakeModel(10).Scatter(Parallel(), detector, std::vector<double>(15), std::vector<double>(16)),
    InputError);
  EXPECT_THROW(MakeModel(10).Differentiate(Parallel(), detector, std::vector<double>(16),
                 std::vector<double>(16), { {} }),
    InputError);
}
}
