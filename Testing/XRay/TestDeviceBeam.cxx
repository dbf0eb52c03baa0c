// SPDX-License-Identifier: Apache-2.0
// The Beer-Lambert law on the device against the one on the host, on the same path lengths.
#include "ProjectorTesting.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/XRay/Beam.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace
{
using namespace mammoray;
using namespace mammoray::shapes;

class DeviceBeamTest : public ProjectorTest
{
protected:
  DeviceBeamTest()
  {
    for (double energy = 10; energy <= 50; energy += 1)
    {
      this->Table.EnergiesKeV.push_back(energy);
      this->Table.MuPerMm.push_back(0.08 * std::pow(energy / 20, -3));
    }
    for (int energy = 12; energy <= 49; ++energy)
    {
      this->Photons.EnergiesKeV.push_back(energy);
      this->Photons.Weights.push_back(energy * (50 - energy));
    }
  }
  Beam MakeBeam(int materials, const DetectorResponse& response, double denserBy = 0.3) const
  {
    std::vector<const AttenuationTable*> tables{ nullptr };
    std::vector<double> densities{ 0 };
    for (int material = 1; material < materials; ++material)
    {
      tables.push_back(&this->Table);
      densities.push_back(0.5 + denserBy * material);
    }
    return Beam(this->Photons, response, tables, densities);
  }

  AttenuationTable Table;
  Spectrum Photons;
  XRaySource Source = PointSource({ 20, 10, 400 });
  XRayDetector Detector =
    CentredDetector({ 10, 0, -80 }, { 1, 0, 0 }, { 0, 1, 0 }, 150, 110, 47, 37);
};

TEST_P(DeviceBeamTest, AgreesWithTheHostForEveryBeamOfOneProjection)
{
  const SurfaceMesh mesh = NestedBodies();
  this->Projector->SetSurface(mesh);
  this->Detector.Samples = 2;
  const PathLengthImage lengths = this->Projector->Project(this->Source, this->Detector);
  for (const DetectorResponse& response :
    { DetectorResponse::EnergyIntegrating, DetectorResponse::PhotonCounting })
  {
    const Beam beam = this->MakeBeam(mesh.NumberOfMaterials() + 1, response);
    const std::vector<float> expected = beam.Transmission(lengths);
    const std::vector<float> found = this->Projector->Transmission(beam);
    ASSERT_EQ(found.size(), expected.size());
    for (std::size_t pixel = 0; pixel < found.size(); ++pixel)
    {
      // Exponents and sums in single precision, and an exponential good to 3 + 2 |x| units.
      const double tolerance = 1e-6 * (1 - std::log(expected[pixel]));
      ASSERT_NEAR(found[pixel], expected[pixel], tolerance * expected[pixel]) << pixel;
    }
  }
}

TEST_P(DeviceBeamTest, DerivativesLeaveTheSamePathLengths)
{
  const SurfaceMesh mesh = NestedBodies();
  this->Projector->SetSurface(mesh);
  const Beam beam = this->MakeBeam(mesh.NumberOfMaterials(), DetectorResponse::PhotonCounting);
  this->Projector->Project(this->Source, this->Detector);
  const std::vector<float> expected = this->Projector->Transmission(beam);
  PathLengthDerivatives derivatives;
  this->Projector->Project(this->Source, this->Detector,
    VectorFields(std::vector<double>(mesh.Points.size(), 1.0), mesh.Points.size()), derivatives);
  const std::vector<float> found = this->Projector->Transmission(beam);
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t pixel = 0; pixel < found.size(); ++pixel)
  {
    ASSERT_NEAR(found[pixel], expected[pixel], 1e-5 * expected[pixel]) << pixel;
  }
}

/// A ball of 30 mm without the triangles that touch its highest point.
SurfaceMesh OpenBall()
{
  SurfaceMesh closed;
  AddSphere(closed, { 0, 0, 0 }, 30, 3, 1);
  std::uint32_t top = 0;
  for (std::uint32_t point = 1; point < closed.NumberOfPoints(); ++point)
  {
    top = closed.Points[3 * point + 2] > closed.Points[3 * top + 2] ? point : top;
  }
  SurfaceMesh mesh;
  mesh.Points = closed.Points;
  for (std::size_t triangle = 0; triangle < closed.NumberOfTriangles(); ++triangle)
  {
    const std::uint32_t* ids = &closed.Triangles[3 * triangle];
    if (std::find(ids, ids + 3, top) == ids + 3)
    {
      AddTriangle(mesh, ids[0], ids[1], ids[2], 1, 0);
    }
  }
  return mesh;
}

TEST_P(DeviceBeamTest, AHoleIsNotBright)
{
  this->Projector->SetSurface(OpenBall());
  this->Detector = CentredDetector({ 0, 0, -80 }, { 1, 0, 0 }, { 0, 1, 0 }, 60, 60, 61, 61);
  this->Source = ParallelBeam({ 0, 0, -1 });
  const PathLengthImage lengths = this->Projector->Project(this->Source, this->Detector);
  ASSERT_GT(lengths.NumberOfInconsistentRays(), 0u);
  const Beam beam = this->MakeBeam(2, DetectorResponse::PhotonCounting);
  const std::vector<float> expected = beam.Transmission(lengths);
  const std::vector<float> found = this->Projector->Transmission(beam);
  for (std::size_t pixel = 0; pixel < found.size(); ++pixel)
  {
    // In holes the mean of the neighbours' transmissions, not that of their mean path.
    const double tolerance = lengths.Inconsistent[pixel] ? 0.05 : 1e-5;
    ASSERT_NEAR(found[pixel], expected[pixel], tolerance) << pixel;
  }
}

TEST_P(DeviceBeamTest, RenderingLeavesWhatProjectingReads)
{
  this->Source = ParallelBeam({ 0, 0, -1 });
  for (const SurfaceMesh& mesh : { OpenBall(), NestedBodies() })
  {
    this->Projector->SetSurface(mesh);
    const Beam beam = this->MakeBeam(mesh.NumberOfMaterials(), DetectorResponse::PhotonCounting);
    this->Projector->Project(this->Source, this->Detector);
    const std::vector<float> expected = this->Projector->Transmission(beam);
    this->Projector->UpdatePoints(mesh.Points);
    this->Projector->Render(this->Source, this->Detector);
    // The order of hits along a ray may be another.
    EXPECT_THAT(this->Projector->Transmission(beam),
      testing::Pointwise(testing::FloatNear(1e-6F), expected));
  }
}

TEST_P(DeviceBeamTest, ResultsComeFromTheDevicesOwnMemoryToo)
{
  setenv("MAMMORAY_SEPARATE_MEMORY", "1", 1);
  const auto separate = MakeProjector({ .Projection = this->GetParam().Projection,
    .DoublePrecision = this->GetParam().Double,
    .Validation = true });
  unsetenv("MAMMORAY_SEPARATE_MEMORY");
  this->Detector.Samples = 2;
  for (const SurfaceMesh& mesh : { OpenBall(), NestedBodies() })
  {
    const Beam beam = this->MakeBeam(mesh.NumberOfMaterials(), DetectorResponse::PhotonCounting);
    const VectorFields velocities(std::vector<double>(3 * mesh.Points.size(), 1.0),
      mesh.Points.size());
    std::vector<PathLengthImage> images;
    std::vector<PathLengthDerivatives> rates(2);
    std::vector<std::vector<float>> transmissions;
    for (PathLengthProjector* projector : { this->Projector, separate.get() })
    {
      projector->SetSurface(mesh);
      images.push_back(
        projector->Project(this->Source, this->Detector, velocities, rates[images.size()]));
      transmissions.push_back(projector->Transmission(beam));
    }
    using testing::FloatNear;
    using testing::Pointwise;
    EXPECT_EQ(images[1].Inconsistent, images[0].Inconsistent);
    EXPECT_THAT(images[1].Lengths, Pointwise(FloatNear(1e-4F), images[0].Lengths));
    EXPECT_THAT(rates[1].Lengths, Pointwise(FloatNear(1e-4F), rates[0].Lengths));
    EXPECT_THAT(transmissions[1], Pointwise(FloatNear(1e-6F), transmissions[0]));
  }
}

TEST_P(DeviceBeamTest, TakesImagesLargerThanABuffer)
{
  // 200,000 pixels of 181 materials are 145 MB; lavapipe's buffers hold 134 MB. Devices with larger
  // ones do it at once.
  const SurfaceMesh mesh = NestedBodiesOfManyMaterials();
  this->Projector->SetSurface(mesh);
  const XRayDetector whole =
    CentredDetector({ 10, 0, -80 }, { 1, 0, 0 }, { 0, 1, 0 }, 150, 110, 500, 400);
  const Beam beam =
    this->MakeBeam(mesh.NumberOfMaterials(), DetectorResponse::PhotonCounting, 1e-3);
  const PathLengthImage image = this->Projector->Project(this->Source, whole);
  EXPECT_EQ(image.NumberOfInconsistentRays(), 0u);
  const std::vector<float> transmission = this->Projector->Transmission(beam);
  // In parts, one of which lies across any strip's border. Rays that graze magnify the rounding of
  // single precision; a row too far would be off by 0.1 mm.
  XRayDetector part = whole;
  part.Rows = 100;
  for (int first = 0; first < whole.Rows; first += part.Rows)
  {
    part.Origin = whole.Origin + static_cast<double>(first) * whole.RowStep;
    const PathLengthImage few = this->Projector->Project(this->Source, part);
    const std::vector<float> fewTransmitted = this->Projector->Transmission(beam);
    const std::size_t offset = static_cast<std::size_t>(first) * whole.Columns;
    for (std::size_t pixel = 0; pixel < few.NumberOfPixels(); ++pixel)
    {
      ASSERT_NEAR(transmission[offset + pixel], fewTransmitted[pixel], 1e-4);
      for (int material = 30; material < few.Materials; material += 30)
      {
        ASSERT_NEAR(image.Material(material)[offset + pixel], few.Material(material)[pixel], 5e-3);
      }
    }
  }
}

TEST_P(DeviceBeamTest, RefusesWhatIsNotThere)
{
  const SurfaceMesh mesh = NestedBodies();
  const Beam beam = this->MakeBeam(mesh.NumberOfMaterials(), DetectorResponse::PhotonCounting);
  this->Projector->SetSurface(mesh);
  EXPECT_THROW(this->Projector->Transmission(beam), InputError);
  this->Projector->Project(this->Source, this->Detector);
  EXPECT_THROW(this->Projector->Transmission(
                 this->MakeBeam(mesh.NumberOfMaterials() - 1, DetectorResponse::PhotonCounting)),
    InputError);
  EXPECT_EQ(this->Projector->Transmission(beam).size(), 47u * 37u);
  this->Projector->UpdatePoints(mesh.Points);
  EXPECT_THROW(this->Projector->Transmission(beam), InputError);
}

INSTANTIATE_TEST_SUITE_P(Methods, DeviceBeamTest, AllVariants(), VariantName);
}
