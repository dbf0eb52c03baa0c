// SPDX-License-Identifier: Apache-2.0
// The gradient of a loss with respect to all that a scene consists of, against central differences
// of a slow computation in double precision.
#include "Private/ExposureViews.h"
#include "ProjectorTesting.h"
#include "Refusals.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/XRay/Composition.h"
#include "mammoray/XRay/Exposer.h"

#include <gmock/gmock.h>

#include <cmath>
#include <functional>
#include <numeric>
#include <random>

namespace
{
using mammoray::test::RefusalOf;
using namespace mammoray;
using namespace mammoray::shapes;

std::vector<float> RandomLosses(std::size_t count)
{
  std::mt19937 generator(21);
  std::uniform_real_distribution<float> number(-1, 1);
  std::vector<float> losses(count);
  std::generate(losses.begin(), losses.end(), [&] { return number(generator); });
  return losses;
}

/// A ball of aluminium in a block of water, before a tilted detector.
Scene BallInBlock(bool isParallel)
{
  auto mesh = std::make_shared<SurfaceMesh>();
  AddBox(*mesh, { -25, -20, -15 }, { 25, 20, 15 }, 1, 0, Rotation(0.2, 0.3, 0.1));
  AddSphere(*mesh, { 4, 3, 1 }, 9, 2, 2, 1);
  Scene scene;
  scene.Samples = { { mesh, -1 } };
  scene.Materials.Materials = { { .Name = "air" }, { .Name = "water" }, { .Name = "Al" } };
  scene.Materials.Materials[1].DensityGPerCm3 = 1;
  scene.Materials.Materials[2].DensityGPerCm3 = 2.7;
  scene.Attenuations = { {}, RequireComposition("H2O", "test"), RequireComposition("Al", "test") };
  scene.XRays = { "three lines", { 25, 40, 60 }, { 2, 0, 3 } };
  scene.Source = isParallel ? ParallelBeam({ 0.3, -0.2, -2 }) : PointSource({ 20, 10, 300 });
  const Vector3 u = (1 / std::sqrt(1.01)) * Vector3{ 1, 0, 0.1 };
  scene.Detector = CentredDetector({ 0, 3, -60 }, u, { 0, 1, 0 }, 90, 70, 17, 13);
  return scene;
}

/// The loss in double precision: transmissions times their losses, path lengths times theirs.
double LossOf(const Scene& scene, const Exposer::Loss& loss)
{
  const std::shared_ptr<const SurfaceMesh> mesh = Assemble(scene);
  const Beam beam = MakeBeam(scene, { true, true, true });
  const ExposureOptions& detection = scene.Detection;
  const XRayDetector& detector = scene.Detector;
  const int spots = detection.FocalSpotColumnMm > 0 ? detection.FocalSpotSamples : 1;
  const Vector3 u = (1 / Norm(detector.ColumnStep)) * detector.ColumnStep;
  const Vector3 v = (1 / Norm(detector.RowStep)) * detector.RowStep;
  const auto place = [](int index, int count) { return (index + 0.5) / count - 0.5; };
  double sum = 0;
  double count = 0;
  for (int spot = 0; spot < spots * spots; ++spot)
  {
    const Vector3 source = scene.Source.Position +
      place(spot % spots, spots) * detection.FocalSpotColumnMm * u +
      place(spot / spots, spots) * detection.FocalSpotRowMm * v;
    for (int sample = 0; sample < detector.Samples * detector.Samples; ++sample)
    {
      ++count;
      for (std::size_t index = 0; index < detector.NumberOfPixels(); ++index)
      {
        const int column = static_cast<int>(index) % detector.Columns;
        const int row = static_cast<int>(index) / detector.Columns;
        const Vector3 pixel =
          Pixel(detector, column + place(sample % detector.Samples, detector.Samples),
            row + place(sample / detector.Samples, detector.Samples));
        const Vector3 from = scene.Source.Type == XRaySource::Kind::Point
          ? source
          : pixel - (1e3 / Norm(scene.Source.Direction)) * scene.Source.Direction;
        std::vector<double> lengths = ReferenceLengths(*mesh, from, pixel);
        lengths.resize(3, 0.0);
        if (!loss.Transmission.empty())
        {
          sum += loss.Transmission[index] * beam.Transmission(lengths.data());
        }
        for (std::size_t material = 1; !loss.Lengths.empty() && material < 3; ++material)
        {
          sum += loss.Lengths[material * detector.NumberOfPixels() + index] * lengths[material];
        }
      }
    }
  }
  return sum / count;
}

/// Central difference with respect to a number of the scene.
double Difference(Scene scene, const Exposer::Loss& loss, double step,
  const std::function<void(Scene&, double)>& change)
{
  change(scene, step);
  const double after = LossOf(scene, loss);
  change(scene, -2 * step);
  return (after - LossOf(scene, loss)) / (2 * step);
}

class ExposerGradient : public testing::TestWithParam<Method>
{
protected:
  void SetUp() override
  {
    const auto devices = ListDevices();
    if (std::none_of(devices.begin(), devices.end(),
          [](const DeviceDescription& device)
          { return GetParam() != Method::RayTracing || device.RayTracing; }))
    {
      GTEST_SKIP() << "no device";
    }
  }

  /// Tolerances: normals and barycentric coordinates are floats, path lengths too, and hundreds of
  /// rays sum to a gradient that is smaller than its parts.
  static void ExpectDifferences(const Scene& scene, const Exposer::Loss& loss)
  {
    Exposer exposer({ .Projection = GetParam(), .Validation = true });
    const Exposer::Gradient gradient = exposer.Backward(scene, loss);
    const auto expect = [&](double found, double scale, const char* what, double step,
                          const std::function<void(Scene&, double)>& change)
    { EXPECT_NEAR(found, Difference(scene, loss, step, change), 2e-5 * scale) << what; };
    const auto expectVector = [&](const Vector3& found, double step, const char* what,
                                const std::function<Vector3&(Scene&)>& part)
    {
      const double scale = Norm(found);
      for (std::size_t axis = 0; axis < 3; ++axis)
      {
        expect(found[axis], scale, what, step,
          [&](Scene& changed, double by) { part(changed)[axis] += by; });
      }
    };
    if (scene.Source.Type == XRaySource::Kind::Point)
    {
      expectVector(gradient.Source, 1e-6, "source",
        [](Scene& changed) -> Vector3& { return changed.Source.Position; });
    }
    else
    {
      expectVector(gradient.Source, 1e-8, "direction",
        [](Scene& changed) -> Vector3& { return changed.Source.Direction; });
    }
    expectVector(gradient.Origin, 1e-6, "origin",
      [](Scene& changed) -> Vector3& { return changed.Detector.Origin; });
    expectVector(gradient.ColumnStep, 1e-7, "column step",
      [](Scene& changed) -> Vector3& { return changed.Detector.ColumnStep; });
    expectVector(gradient.RowStep, 1e-7, "row step",
      [](Scene& changed) -> Vector3& { return changed.Detector.RowStep; });
    const double largest = *std::max_element(gradient.Points.begin(), gradient.Points.end());
    for (std::size_t coordinate = 1; coordinate < gradient.Points.size(); coordinate += 61)
    {
      expect(gradient.Points[coordinate], largest, "point", 1e-6,
        [&](Scene& changed, double by)
        {
          SurfaceMesh mesh = *changed.Samples[0].Surface;
          mesh.Points[coordinate] += by;
          changed.Samples[0].Surface = std::make_shared<const SurfaceMesh>(mesh);
        });
    }
    for (const std::size_t material : { 1, 2 })
    {
      expect(gradient.Attenuation[material], std::abs(gradient.Attenuation[material]) + 1e-9,
        "attenuation", 1e-6,
        [&](Scene& changed, double by)
        {
          for (double& mu : changed.Attenuations[material].MuPerMm)
          {
            mu *= 1 + by;
          }
        });
    }
    for (const std::size_t bin : { 0, 2 })
    {
      expect(gradient.Spectrum[bin], std::abs(gradient.Spectrum[bin]) + 1e-9, "spectrum", 1e-6,
        [&](Scene& changed, double by) { changed.XRays.Weights[bin] += by; });
    }
    EXPECT_EQ(gradient.Spectrum[1], 0);
  }
};

TEST_P(ExposerGradient, OfTransmissionsMatchesDifferences)
{
  for (const bool isParallel : { false, true })
  {
    const Scene scene = BallInBlock(isParallel);
    ExpectDifferences(scene, { RandomLosses(scene.Detector.NumberOfPixels()), {} });
  }
}

TEST_P(ExposerGradient, OfPathLengthsMatchesDifferences)
{
  const Scene scene = BallInBlock(false);
  ExpectDifferences(scene, { {}, RandomLosses(3 * scene.Detector.NumberOfPixels()) });
}

TEST_P(ExposerGradient, ThroughFocalSpotAndSamplesMatchesDifferences)
{
  Scene scene = BallInBlock(false);
  scene.Detection.FocalSpotColumnMm = 3;
  scene.Detection.FocalSpotRowMm = 2;
  scene.Detection.FocalSpotSamples = 2;
  scene.Detector.Samples = 2;
  ExpectDifferences(scene,
    { RandomLosses(scene.Detector.NumberOfPixels()),
      RandomLosses(3 * scene.Detector.NumberOfPixels()) });
}

TEST_P(ExposerGradient, OfTheMotionsOfSamplesMatchesDifferences)
{
  Scene scene = BallInBlock(false);
  auto block = std::make_shared<SurfaceMesh>();
  AddBox(*block, { -9, -8, -7 }, { 9, 8, 7 }, 1);
  auto ball = std::make_shared<SurfaceMesh>();
  AddSphere(*ball, { 1, 2, 3 }, 8, 2, 1);
  scene.Samples = { { block, 1, { 0.3, -0.5, 0.8 }, { -15, 2, 1 } },
    { ball, 2, { 0, 0, 0 }, { 12, 1, 4 } } };
  const Exposer::Loss loss{ RandomLosses(scene.Detector.NumberOfPixels()), {} };
  Exposer exposer({ .Projection = GetParam(), .Validation = true });
  const Exposer::Gradient gradient = exposer.Backward(scene, loss);
  ASSERT_EQ(gradient.Samples.size(), 2u);
  for (std::size_t sample = 0; sample < 2; ++sample)
  {
    const auto& [translation, rotation] = gradient.Samples[sample];
    for (std::size_t axis = 0; axis < 3; ++axis)
    {
      EXPECT_NEAR(translation[axis],
        Difference(scene, loss, 1e-6,
          [&](Scene& changed, double by) { changed.Samples[sample].TranslationMm[axis] += by; }),
        2e-5 * Norm(translation))
        << "sample " << sample << " axis " << axis;
      EXPECT_NEAR(rotation[axis],
        Difference(scene, loss, 1e-7,
          [&](Scene& changed, double by) { changed.Samples[sample].Rotation[axis] += by; }),
        2e-5 * Norm(rotation))
        << "sample " << sample << " axis " << axis;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Methods, ExposerGradient,
  testing::Values(Method::RayTracing, Method::Rasterisation),
  [](const testing::TestParamInfo<Method>& instance)
  { return instance.param == Method::RayTracing ? "RayTracing" : "Rasterisation"; });

TEST(ExposerGradientParts, ExposuresAreNotTracedAgain)
{
  if (ListDevices().empty())
  {
    GTEST_SKIP() << "no Vulkan device";
  }
  const Scene scene = BallInBlock(false);
  Exposer exposer;
  exposer.Expose(scene);
  exposer.Backward(scene, { RandomLosses(scene.Detector.NumberOfPixels()), {} });
  EXPECT_EQ(exposer.NumberOfTraces(), 1u);
}

TEST(ExposerGradientParts, BlurIsTransposed)
{
  XRayDetector detector;
  detector.Columns = 31;
  detector.Rows = 23;
  detector.RowStep = { 0, 0.2, 0 };
  const std::vector<float> losses = RandomLosses(2 * detector.NumberOfPixels());
  const auto middle = losses.begin() + static_cast<std::ptrdiff_t>(detector.NumberOfPixels());
  const std::vector<double> x(losses.begin(), middle);
  const std::vector<double> y(middle, losses.end());
  std::vector<double> blurred = x;
  BlurImage(detector, { .HalfModulationPerMm = 0.7 }, blurred);
  std::vector<double> transposed = y;
  TransposeBlur(detector, { .HalfModulationPerMm = 0.7 }, transposed);
  EXPECT_NEAR(std::inner_product(blurred.begin(), blurred.end(), y.begin(), 0.0),
    std::inner_product(x.begin(), x.end(), transposed.begin(), 0.0), 1e-11);
  EXPECT_GT(std::abs(blurred[0] - x[0]), 0.1);
}

TEST(ExposerGradientParts, OpenFieldAndBlurActOnLosses)
{
  if (ListDevices().empty())
  {
    GTEST_SKIP() << "no Vulkan device";
  }
  Scene scene = BallInBlock(false);
  const std::size_t pixels = scene.Detector.NumberOfPixels();
  scene.Detection.HalfModulationPerMm = 0.2;
  scene.Detection.OpenField.assign(pixels, 0.0F);
  for (std::size_t pixel = 0; pixel < pixels; ++pixel)
  {
    scene.Detection.OpenField[pixel] = 0.5F + 0.001F * static_cast<float>(pixel);
  }
  const std::vector<float> losses = RandomLosses(pixels);
  std::vector<double> expected(losses.begin(), losses.end());
  TransposeBlur(scene.Detector, { .HalfModulationPerMm = 0.2 }, expected);
  std::vector<float> plainLosses(pixels);
  for (std::size_t pixel = 0; pixel < pixels; ++pixel)
  {
    plainLosses[pixel] = static_cast<float>(expected[pixel] * scene.Detection.OpenField[pixel]);
  }
  Exposer exposer;
  const Exposer::Gradient gradient = exposer.Backward(scene, { losses, {} });
  scene.Detection = {};
  const Exposer::Gradient plain = exposer.Backward(scene, { plainLosses, {} });
  const double largest = *std::max_element(plain.Points.begin(), plain.Points.end());
  EXPECT_GT(largest, 0);
  // The losses are rounded to floats in one of them.
  EXPECT_THAT(gradient.Points,
    testing::Pointwise(testing::DoubleNear(1e-6 * largest), plain.Points));
}

TEST(ExposerGradientParts, ForwardDerivativesRefuseSeveralRaysAPixel)
{
  const auto refusalOf = [](const std::function<void(Scene&)>& change)
  {
    Scene scene = BallInBlock(false);
    change(scene);
    return RefusalOf([&] { Exposer().Differentiate(scene, VectorFields(1, 3)); });
  };
  const std::pair<const char*, std::function<void(Scene&)>> changes[] = {
    { "refraction", [](Scene& scene) { scene.Refraction = RefractionOptions::Law::Geometric; } },
    { "detector.photons", [](Scene& scene) { scene.Detection.PhotonsPerPixel = 100; } },
    { "detector.half-modulation", [](Scene& scene) { scene.Detection.HalfModulationPerMm = 2; } },
    { "source.focal-spot", [](Scene& scene) { scene.Detection.FocalSpotRowMm = 1; } },
    { "detector.samples", [](Scene& scene) { scene.Detector.Samples = 2; } }
  };
  for (const auto& [field, change] : changes)
  {
    EXPECT_THAT(refusalOf(change), testing::EndsWith(std::string("found ") + field));
  }
}

TEST(ExposerGradientParts, RefusesWhatHasNoGradient)
{
  Scene scene = BallInBlock(false);
  const Exposer::Loss loss{ RandomLosses(scene.Detector.NumberOfPixels()), {} };
  scene.Detection.PhotonsPerPixel = 1000;
  EXPECT_THAT(RefusalOf([&] { Exposer().Backward(scene, loss); }),
    testing::HasSubstr("errors of pixels, scatter and refraction, found noise"));
  scene.Detection = {};
  scene.Refraction = RefractionOptions::Law::Geometric;
  EXPECT_THAT(RefusalOf([&] { Exposer().Backward(scene, loss); }),
    testing::EndsWith("found refraction"));
  scene.Refraction.reset();
  if (!ListDevices().empty())
  {
    EXPECT_THAT(RefusalOf(
                  [&] {
                    Exposer().Backward(scene, { { 1.0F }, {} });
                  }),
      testing::HasSubstr("221 transmissions, found 1"));
    EXPECT_THAT(RefusalOf(
                  [&] {
                    Exposer().Backward(scene, { {}, { 1.0F } });
                  }),
      testing::HasSubstr("663 lengths, found 1"));
  }
}
}
