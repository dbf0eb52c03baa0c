// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_RegistrationTwin_h
#define mammoray_RegistrationTwin_h

#include "TestMeshes.h"
#include "mammoray/Biomechanics/Embedding.h"
#include "mammoray/Registration/RegistrationModel.h"
#include "mammoray/Registration/TargetImage.h"
#include "mammoray/XRay/Beam.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>

/// A small half-ellipsoid "breast" with a glandular ball in it, and targets made of it.
namespace mammoray::test
{
inline constexpr double HalfAxes[3] = { 45, 55, 40 };

/// Material 3 in a ball off the middle, 2 at the chest wall, else 1.
inline int AnatomyAt(const Vector3& point)
{
  const Vector3 centre{ 12, 28, 6 };
  return Norm(point - centre) < 14 ? 3 : 1;
}

inline TetrahedralMesh MakeAnatomy(int count)
{
  TetrahedralMesh mesh = MakeHalfEllipsoidMesh(HalfAxes[0], HalfAxes[1], HalfAxes[2], count);
  for (std::size_t cell = 0; cell < mesh.NumberOfCells(); ++cell)
  {
    if (mesh.Materials[cell] == 1)
    {
      Vector3 centre{ 0, 0, 0 };
      for (int corner = 0; corner < 4; ++corner)
      {
        centre = centre + 0.25 * mesh.Point(mesh.Cells[4 * cell + corner]);
      }
      mesh.Materials[cell] = AnatomyAt(centre);
    }
  }
  return mesh;
}

inline AttenuationTable Constant(const char* name, double mu20, double mu30)
{
  AttenuationTable table;
  table.Name = name;
  table.EnergiesKeV = { 20, 30 };
  table.MuPerMm = { mu20, mu30 };
  return table;
}

/// Everything a registration needs, kept together.
struct Twin
{
  Twin(int simulationCount, int anatomyCount, double energyKeV)
    : Fat(Constant("fat", 0.0512, 0.028))
    , Gland(Constant("gland", 0.0793, 0.0376))
    , XRays(Spectrum::Monochromatic(energyKeV), DetectorResponse::EnergyIntegrating,
        { nullptr, &this->Fat, &this->Fat, &this->Gland }, { 1, 1, 1, 1 })
    , Simulation(MakeSimulation(simulationCount, ElementType::Quadratic))
    , Scout(MakeSimulation(simulationCount, ElementType::PatchAveragedLinear))
    , Surface(ExtractInterfaces(MakeAnatomy(anatomyCount)))
    , SurfaceEmbedding(this->Simulation, this->Surface.Points)
    , ScoutEmbedding(this->Scout, this->Surface.Points)
    , Projector(MakeProjector())
  {
    this->Projector->SetSurface(this->Surface);
    this->Model.Simulation = &this->Simulation;
    this->Model.Elastic = this->Simulation.Materials();
    this->Model.ScaledMaterials = { 3 };
    this->Model.Surface = &this->Surface;
    this->Model.SurfaceEmbedding = &this->SurfaceEmbedding;
    this->Model.Scout = &this->Scout;
    this->Model.ScoutEmbedding = &this->ScoutEmbedding;
    this->Model.Projector = this->Projector.get();
    this->Model.XRays = &this->XRays;
    // The test mesh has +x lateral, +y anterior, +z up: a left-handed (L, A, S) is avoided by
    // calling its +x the patient's right.
    this->Model.Axes = AnatomicalAxes::FromCode("RAS");
    this->Model.Anchor = { 0, 10, 0 };
  }

  static CompressionSimulation MakeSimulation(int count, ElementType element)
  {
    return CompressionSimulation(
      MakeHalfEllipsoidMesh(HalfAxes[0], HalfAxes[1], HalfAxes[2], std::array{ count, 4, count }),
      { {}, { 5, 0.49 }, { 5, 0.49 }, { 15, 0.49 } }, { false, false, true, false }, AnatomyAt,
      { .Element = element });
  }

  AttenuationTable Fat;
  AttenuationTable Gland;
  Beam XRays;
  CompressionSimulation Simulation;
  CompressionSimulation Scout;
  SurfaceMesh Surface;
  Embedding SurfaceEmbedding;
  Embedding ScoutEmbedding;
  std::unique_ptr<PathLengthProjector> Projector;
  RegistrationModel Model;
};

inline BreastPose Truth()
{
  BreastPose pose;
  pose.ThicknessMm = 47;
  pose.RollDeg = 8;
  pose.LateralMm = 4;
  pose.AnteriorMm = 7;
  return pose;
}

/// The mammogram of the true pose: 0.5 mm pixels, mask and exact distances to the true outline.
inline RegistrationTarget MakeTarget(const Twin& setup, const BreastPose& pose)
{
  RegistrationTarget target;
  target.Columns = 130;
  target.Rows = 240;
  target.Origin = { 60, 0.25 };
  target.ColumnStep = { 0, 0.5 };
  target.RowStep = { -0.5, 0 };
  const auto pixels = static_cast<std::size_t>(target.Columns) * target.Rows;
  target.LogAttenuation.assign(pixels, 0);
  target.BreastMask.assign(pixels, 0);
  target.SignedDistanceMm.assign(pixels, 0);
  target.BreastMask[120 * 130] = 1; // the centre of the silhouette that Synthesize looks for
  const CompressionState state = setup.Simulation.Compress(PlatesAt(setup.Model, pose));
  const SyntheticMammogram synthetic = Synthesize(setup.Model, pose, state, target, 1);
  EXPECT_EQ(synthetic.InconsistentRays, 0u);

  std::mt19937 generator(7);
  std::normal_distribution<float> noise(0.0f, 0.02f);
  for (std::size_t pixel = 0; pixel < pixels; ++pixel)
  {
    target.BreastMask[pixel] = synthetic.LogAttenuation[pixel] > 0 ? 1 : 0;
    target.LogAttenuation[pixel] =
      3.0f * (synthetic.LogAttenuation[pixel] + noise(generator)) + 7.0f;
  }
  for (int row = 0; row < target.Rows; ++row)
  {
    for (int column = 0; column < target.Columns; ++column)
    {
      const ReceptorPoint point = PixelPosition(target, column, row);
      double distance = 1e9;
      for (const ReceptorPoint& outline : synthetic.Outline)
      {
        distance = std::min(distance, std::hypot(point[0] - outline[0], point[1] - outline[1]));
      }
      const std::size_t pixel = static_cast<std::size_t>(row) * target.Columns + column;
      target.SignedDistanceMm[pixel] =
        static_cast<float>(target.BreastMask[pixel] ? -distance : distance);
    }
  }
  return target;
}
}

#endif
