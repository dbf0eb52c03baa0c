// SPDX-License-Identifier: Apache-2.0
// What an exposer repeats, counted with a projector that stands in for a device.
#include "SurfaceShapes.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/XRay/Exposer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <numbers>
#include <utility>

namespace
{
using namespace mammoray;

struct Calls
{
  int Built = 0;
  int Refitted = 0;
  int Projected = 0;
  std::vector<double> Points;
};

/// Every ray passes 10 mm of material 1, and as many mm more as the source stands over 500.
class CountingProjector : public PathLengthProjector
{
public:
  explicit CountingProjector(Calls& calls)
    : Counted(calls)
  {
  }
  void SetSurface(const SurfaceMesh& surface) override
  {
    ++this->Counted.Built;
    this->Counted.Points = surface.Points;
  }
  void UpdatePoints(const std::vector<double>& points) override
  {
    ++this->Counted.Refitted;
    this->Counted.Points = points;
  }
  PathLengthImage Project(const XRaySource& source, const XRayDetector& detector) override
  {
    ++this->Counted.Projected;
    PathLengthImage image;
    image.Columns = detector.Columns;
    image.Rows = detector.Rows;
    image.Materials = 2;
    image.Lengths.assign(2 * image.NumberOfPixels(), 0.0F);
    std::fill(image.Lengths.begin() + static_cast<std::ptrdiff_t>(image.NumberOfPixels()),
      image.Lengths.end(), static_cast<float>(10 + source.Position[2] - 500));
    image.Inconsistent.assign(image.NumberOfPixels(), 0);
    return image;
  }
  PathLengthImage Project(const XRaySource&, const XRayDetector&, const VectorFields&,
    PathLengthDerivatives&) override
  {
    throw Error("no derivatives");
  }
  std::vector<double> Backward(const XRaySource&, const XRayDetector&,
    const std::vector<float>&) override
  {
    throw Error("no gradient");
  }
  std::vector<float> Transmission(const Beam&) override { throw Error("no device"); }
  std::string DeviceName() const override { return "counter"; }
  ProjectorOptions::Method Method() const override
  {
    return ProjectorOptions::Method::Rasterisation;
  }

private:
  Calls& Counted;
};

class ExposerTest : public testing::Test
{
protected:
  ExposerTest()
  {
    auto box = std::make_shared<SurfaceMesh>();
    shapes::AddBox(*box, { 0, 0, 0 }, { 10, 10, 10 }, 1);
    this->Shown.Samples = { { box, 1 } };
    this->Shown.Materials.Materials = { { .Name = "air" }, { .Name = "one" }, { .Name = "two" } };
    this->Shown.Attenuations = { {}, { "one", 1, { 20 }, { 0.05 } }, {} };
    this->Shown.Source.Position = { 0, 0, 500 };
    this->Shown.Detector.Columns = 3;
    this->Shown.Detector.Rows = 2;
  }
  /// The log attenuation of all pixels.
  double Attenuation()
  {
    const Exposure exposure = this->Device.Expose(this->Shown);
    EXPECT_EQ(exposure.LogAttenuation.size(), 6u);
    for (const float value : exposure.LogAttenuation)
    {
      EXPECT_EQ(value, exposure.LogAttenuation.front());
    }
    return exposure.LogAttenuation.front();
  }

  Calls Counted;
  Exposer Device{ std::make_unique<CountingProjector>(Counted) };
  Scene Shown;
};

TEST_F(ExposerTest, AnswersForItsViewWhateverWasKept)
{
  // One view, another one, the first again, each with another beam after it: 1e-6, a float.
  for (const double height : { 500.0, 520.0, 500.0 })
  {
    this->Shown.Source.Position[2] = height;
    for (const double mu : { 0.05, 0.1 })
    {
      this->Shown.Attenuations[1].MuPerMm = { mu };
      EXPECT_NEAR(this->Attenuation(), mu * (10 + height - 500), 1e-6);
    }
  }
  EXPECT_EQ(this->Counted.Projected, 3);
  EXPECT_EQ(this->Device.NumberOfTraces(), 3u);
}

TEST_F(ExposerTest, AnotherBeamNoiseOrResponseTracesNothing)
{
  this->Shown.Detector.Samples = 2;
  this->Attenuation();
  this->Shown.XRays = Spectrum::Monochromatic(20);
  this->Shown.Response = DetectorResponse::PhotonCounting;
  this->Attenuation();
  this->Shown.Detection.PhotonsPerPixel = 100;
  this->Device.Expose(this->Shown);
  EXPECT_EQ(this->Counted.Projected, 4);
  EXPECT_EQ(this->Counted.Built, 1);
  // The spot's points see other rays.
  this->Shown.Detection = {};
  this->Shown.Detection.FocalSpotRowMm = 0.3;
  this->Shown.Detection.FocalSpotSamples = 3;
  this->Attenuation();
  EXPECT_EQ(this->Counted.Projected, 16);
}

TEST_F(ExposerTest, MovedSamplesRefitAndOthersAreBuiltAnew)
{
  const std::vector<double> own = this->Shown.Samples[0].Surface->Points;
  this->Attenuation();
  EXPECT_EQ(this->Counted.Points, own);
  this->Shown.Samples[0].Rotation = { 0, 0, std::numbers::pi / 2 };
  this->Shown.Samples[0].TranslationMm = { 1, 2, 3 };
  this->Attenuation();
  EXPECT_EQ(this->Counted.Built, 1);
  EXPECT_EQ(this->Counted.Refitted, 1);
  EXPECT_EQ(this->Counted.Projected, 2);
  for (std::size_t point = 0; point < own.size(); point += 3)
  {
    // x becomes y, y becomes -x; 1e-12 mm: rounding of the turn.
    EXPECT_NEAR(this->Counted.Points[point], 1 - own[point + 1], 1e-12);
    EXPECT_NEAR(this->Counted.Points[point + 1], 2 + own[point], 1e-12);
    EXPECT_NEAR(this->Counted.Points[point + 2], 3 + own[point + 2], 1e-12);
  }
  // The same points in a new mesh change nothing.
  this->Shown.Samples[0].Surface =
    std::make_shared<const SurfaceMesh>(*this->Shown.Samples[0].Surface);
  this->Attenuation();
  EXPECT_EQ(this->Counted.Projected, 2);
  this->Shown.Samples.push_back(this->Shown.Samples[0]);
  this->Attenuation();
  EXPECT_EQ(this->Counted.Built, 2);
  EXPECT_EQ(this->Counted.Points.size(), 2 * own.size());
}

TEST_F(ExposerTest, FlatFieldsNeedNoDevice)
{
  this->Shown.Field.InverseSquare = true;
  const Exposure air = Exposer::ExposeAir(this->Shown);
  EXPECT_EQ(this->Counted.Built, 0);
  // The cube of the cosine where the ray comes in obliquely.
  EXPECT_NEAR(air.Transmission[1], std::pow(500 / std::hypot(500, 0.1), 3), 1e-7);
  const Exposure body = this->Device.Expose(this->Shown);
  EXPECT_NEAR(body.Transmission[1] / air.Transmission[1], std::exp(-0.5), 1e-6);
}

TEST_F(ExposerTest, RefusesContradictions)
{
  const Scene good = this->Shown;
  const auto refused = [&](auto change)
  {
    this->Shown = good;
    change(this->Shown);
    EXPECT_THROW(this->Device.Expose(this->Shown), InputError);
  };
  refused([](Scene& scene) { scene.Samples[0].Surface.reset(); });
  refused([](Scene& scene) { scene.Samples[0].Material = 3; });
  refused([](Scene& scene) { scene.Samples[0].Material = 2; }); // without an attenuation
  refused([](Scene& scene) { scene.OverlapPriority = { 1 }; }); // of a projector of one's own
  refused([](Scene& scene) { scene.Scatter.Grid.emplace(); });
  refused([](Scene& scene) { scene.Scatter.Method = SceneScatter::Model::Kernels; });
  refused([](Scene& scene) { scene.Scatter.Method = SceneScatter::Model::MonteCarlo; });
  refused([](Scene& scene) { scene.Dose = true; }); // without voxels
  refused(
    [](Scene& scene)
    {
      scene.Refraction.emplace();
      scene.Detection.PhotonsPerPixel = 10;
    });
  this->Shown = good;
  EXPECT_NEAR(this->Attenuation(), 0.5, 1e-6);
}
}
