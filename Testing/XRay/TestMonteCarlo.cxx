// SPDX-License-Identifier: Apache-2.0
#include "TaskGroup195.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/XRay/Scatter/MonteCarlo.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

namespace
{
using namespace mammoray;

const PhotonMaterial& WaterAtOne()
{
  static const PhotonMaterial water("Water, Liquid", 1);
  return water;
}

/// A block of water 40 mm high above a detector of 5 x 5 pixels of 10 mm.
struct Block
{
  explicit Block(int edgeVoxels = 20)
    : Scene(MakeVolume(edgeVoxels), { PhotonMaterial(), WaterAtOne() })
  {
    this->Source.Position = { 0, 0, 600 };
    this->Detector.Origin = { -20, -20, 0 };
    this->Detector.ColumnStep = { 10, 0, 0 };
    this->Detector.RowStep = { 0, 10, 0 };
    this->Detector.Columns = 5;
    this->Detector.Rows = 5;
  }
  static LabelVolume MakeVolume(int edgeVoxels)
  {
    LabelVolume volume;
    volume.Size = { edgeVoxels, edgeVoxels, 4 };
    volume.Spacing = { 10, 10, 10 };
    volume.Origin = { -5.0 * (edgeVoxels - 1), -5.0 * (edgeVoxels - 1), 25 };
    volume.Voxels.assign(static_cast<std::size_t>(4 * edgeVoxels * edgeVoxels), 1);
    return volume;
  }
  MonteCarloResult Follow(std::int64_t photons, std::uint64_t seed = 1, double keV = 25) const
  {
    MonteCarloOptions options;
    options.Photons = photons;
    options.Seed = seed;
    return FollowPhotons(this->Scene, this->Source, this->Detector, Spectrum::Monochromatic(keV),
      DetectorResponse::EnergyIntegrating, options);
  }

  VoxelScene Scene;
  XRaySource Source;
  XRayDetector Detector;
};

TEST(MonteCarlo, PrimaryIsBeerAndLambert)
{
  const Block block;
  const MonteCarloResult result = block.Follow(400000);
  const double mu = WaterAtOne().At(25).Total();
  for (int row = 0; row < 5; ++row)
  {
    for (int column = 0; column < 5; ++column)
    {
      const double across = std::hypot(10.0 * (column - 2), 10.0 * (row - 2));
      const double cosine = 600 / std::hypot(600, across);
      // Per area of the detector, relative to the middle: distance and slant.
      const double expected = std::exp(-mu * 40 / cosine) * std::pow(cosine, 3);
      const auto pixel = static_cast<std::size_t>(5 * row + column);
      EXPECT_NEAR(result.Primary[pixel], expected, 4 * result.PrimaryError[pixel]);
      EXPECT_LT(result.PrimaryError[pixel], 0.03 * expected);
    }
  }
}

TEST(MonteCarlo, EnergyIsSomewhere)
{
  const MonteCarloResult result = Block().Follow(20000);
  const double deposited =
    std::accumulate(result.DepositedKeV.begin(), result.DepositedKeV.end(), 0.0);
  EXPECT_NEAR(result.EmittedKeV, 25, 1e-9);
  EXPECT_NEAR(deposited + result.SurroundingsKeV + result.EscapedKeV + result.DetectedKeV,
    result.EmittedKeV, 1e-9);
  EXPECT_EQ(result.DepositedKeV[0], 0); // a vacuum
}

TEST(MonteCarlo, TheSameSeedIsTheSameAndAnotherAgrees)
{
  const Block block;
  const MonteCarloResult one = block.Follow(50000, 1);
  const MonteCarloResult again = block.Follow(50000, 1);
  const MonteCarloResult other = block.Follow(50000, 2);
  EXPECT_NEAR(one.DepositedKeV[1], again.DepositedKeV[1], 1e-9);
  EXPECT_NE(one.DepositedKeV[1], other.DepositedKeV[1]);
  EXPECT_NEAR(one.DepositedKeV[1], other.DepositedKeV[1],
    4 * std::hypot(one.DepositedErrorKeV[1], other.DepositedErrorKeV[1]));
}

/// Photons of one energy on 1 mm of a material.
void ExpectTransferInThinLayer(const PhotonMaterial& thin, double keV)
{
  LabelVolume volume;
  volume.Size = { 1, 1, 1 };
  volume.Spacing = { 1e6, 1e6, 1 };
  volume.Origin = { 0, 0, 100 };
  volume.Voxels = { 1 };
  const VoxelScene scene(volume, { PhotonMaterial(), thin });
  XRayDetector detector;
  detector.Origin = { -10, -10, 0 };
  detector.ColumnStep = { 20, 0, 0 };
  detector.RowStep = { 0, 20, 0 };
  detector.Columns = 2;
  detector.Rows = 2;
  XRaySource source;
  source.Position = { 0, 0, 5000 };
  MonteCarloOptions options;
  options.Photons = 2000000;
  const MonteCarloResult result = FollowPhotons(scene, source, detector,
    Spectrum::Monochromatic(keV), DetectorResponse::PhotonCounting, options);
  EXPECT_NEAR(result.DepositedKeV[1], keV * thin.EnergyTransfer(keV),
    4 * result.DepositedErrorKeV[1]);
  EXPECT_LT(result.DepositedErrorKeV[1], 0.04 * result.DepositedKeV[1]);
}

TEST(MonteCarlo, AThinLayerKeepsItsCrossSectionOfEnergy)
{
  // Water and iron that are so thin that next to nothing collides twice.
  ExpectTransferInThinLayer({ "Water, Liquid", 0.01 }, 20);
  ExpectTransferInThinLayer({ "Fe", 0.1 }, 160);
}

TEST(MonteCarlo, GridKeepsPrimaryAndStopsScatter)
{
  const Block block;
  MonteCarloOptions options;
  options.Photons = 400000;
  const Spectrum spectrum = Spectrum::Monochromatic(25);
  const auto sum = [](const std::vector<float>& values)
  { return std::accumulate(values.begin(), values.end(), 0.0); };
  const MonteCarloResult without = FollowPhotons(block.Scene, block.Source, block.Detector,
    spectrum, DetectorResponse::EnergyIntegrating, options);
  options.Grid.emplace(AntiscatterGridOptions{});
  const MonteCarloResult with = FollowPhotons(block.Scene, block.Source, block.Detector, spectrum,
    DetectorResponse::EnergyIntegrating, options);
  // Relative to the open field, which is behind the grid, too.
  EXPECT_NEAR(sum(with.Primary), sum(without.Primary), 1e-4 * sum(without.Primary));
  EXPECT_LT(sum(with.Scatter), 0.35 * sum(without.Scatter));
  EXPECT_GT(sum(with.Scatter), 0.05 * sum(without.Scatter));
}

TEST(MonteCarlo, RefusesWhatItCannotFollow)
{
  Block block;
  MonteCarloOptions options;
  const auto follow = [&](double keV)
  {
    return FollowPhotons(block.Scene, block.Source, block.Detector, Spectrum::Monochromatic(keV),
      DetectorResponse::EnergyIntegrating, options);
  };
  EXPECT_THROW(follow(501), InputError);
  options.Photons = 0;
  EXPECT_THROW(follow(20), InputError);
  options.Photons = 1;
  block.Source.Type = XRaySource::Kind::Parallel;
  EXPECT_THROW(follow(20), InputError);
  LabelVolume volume = Block::MakeVolume(2);
  volume.Voxels[0] = 2;
  EXPECT_THROW(VoxelScene(volume, { PhotonMaterial(), WaterAtOne() }), InputError);
}

/// AAPM's report 195, case 3 (Sechopoulos et al., Med. Phys. 42, 2015): energy in a breast and in
/// seven volumes of it, eV per photon; means of four programs.
void ExpectCase3(const Spectrum& spectrum, const TaskGroup195Case3& reference)
{
  const TaskGroup195Case3 found = FollowTaskGroup195Case3(spectrum, 2000000, 11);
  // 1 and 3 %, and three standard errors of so many photons.
  EXPECT_NEAR(found.BodyEV, reference.BodyEV, 0.01 * reference.BodyEV + 3 * found.BodyErrorEV);
  EXPECT_LT(found.BodyErrorEV, 0.002 * reference.BodyEV);
  for (std::size_t volume = 0; volume < reference.VolumesEV.size(); ++volume)
  {
    EXPECT_NEAR(found.VolumesEV[volume], reference.VolumesEV[volume],
      0.03 * reference.VolumesEV[volume] + 3 * found.VolumeErrorsEV[volume])
      << "volume " << volume + 1;
  }
}

TEST(MonteCarlo, TaskGroup195Case3At30Kilovolt)
{
  ExpectCase3(TaskGroup195Spectrum(),
    { 4293.433, 0, { 16.502, 16.658, 16.814, 16.249, 16.521, 6.041, 50.041 }, {} });
}

TEST(MonteCarlo, TaskGroup195Case3AtOneEnergy)
{
  ExpectCase3(Spectrum::Monochromatic(16.8),
    { 4697.333, 0, { 17.692, 18.070, 17.865, 17.262, 17.768, 5.417, 56.017 }, {} });
}
}
