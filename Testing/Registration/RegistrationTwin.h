// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_RegistrationTwin_h
#define mammoray_RegistrationTwin_h

#include "TestMeshes.h"
#include "mammoray/Registration/RegistrationProblem.h"
#include "mammoray/Registration/RegistrationResult.h"
#include "mammoray/XRay/Beam.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
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

/// A model of the breast, and the unit around it.
struct Twin
{
  Twin(int simulationCount, int anatomyCount, double energyKeV, bool predicted = true,
    const CompressionOptions& compression = {})
    : Model(MakeAnatomy(anatomyCount), Materials(), { 3 },
        { .Field = AnatomyAt,
          .SimulationMesh = MakeHalfEllipsoidMesh(HalfAxes[0], HalfAxes[1], HalfAxes[2],
            std::array{ simulationCount, 4, simulationCount }),
          .Compression = compression,
          .Predicted = predicted })
    // The test mesh has +x lateral, +y anterior, +z up: a left-handed (L, A, S) is avoided by
    // calling its +x the patient's right.
    , Placement{ AnatomicalAxes::FromCode("RAS"), { 0, 10, 0 }, {} }
  {
    const AttenuationTable fat = Constant("fat", 0.0512, 0.028);
    const AttenuationTable gland = Constant("gland", 0.0793, 0.0376);
    this->Model.SetXRays(ExtractInterfaces(this->Model.Anatomy()), MakeProjector(),
      Beam(Spectrum::Monochromatic(energyKeV), DetectorResponse::EnergyIntegrating,
        { nullptr, &fat, &fat, &gland }, { 1, 1, 1, 1 }));
  }

  static ElasticTable Materials()
  {
    ElasticTable materials;
    materials.Elastic = { {}, { 5, 0.49 }, { 5, 0.49 }, { 15, 0.49 } };
    materials.Fixed = { false, false, true, false };
    return materials;
  }

  /// The breast compressed at a pose, as the full simulation has it.
  PosedBreast At(const BreastPose& pose, const CompressionState* start = nullptr)
  {
    return { this->Model, this->Model.Body(), this->Placement, pose,
      this->Model.Body().Compress(this->Placement, pose, start) };
  }

  /// Without views. The twin must outlive it.
  RegistrationProblem Problem()
  {
    return { { std::shared_ptr<void>(), &this->Model }, this->Placement.Frame, {}, {} };
  }

  BreastModel Model;
  UnitPlacement Placement;
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

/// The mammogram of the true pose: 0.5 mm pixels, mask and exact distances to the true outline;
/// from another focal spot than the unit's where one is given, gantry frame.
inline RegistrationTarget MakeTarget(Twin& twin, const BreastPose& pose,
  const std::optional<Vector3>& focalSpotMm = {})
{
  RegistrationTarget target;
  target.Grid.Columns = 130;
  target.Grid.Rows = 240;
  target.Grid.Origin = { 60, 0.25 };
  target.Grid.ColumnStep = { 0, 0.5 };
  target.Grid.RowStep = { -0.5, 0 };
  const auto pixels = target.Grid.NumberOfPixels();
  target.LogAttenuation.assign(pixels, 0);
  target.BreastMask.assign(pixels, 0);
  target.SignedDistanceMm.assign(pixels, 0);
  PosedBreast breast = twin.At(pose);
  const SyntheticMammogram synthetic =
    Synthesize(focalSpotMm ? breast.SeenFrom(*focalSpotMm) : breast, target.Grid, { 0, 0 }, 1);
  EXPECT_EQ(synthetic.InconsistentRays, 0u);

  std::mt19937 generator(7);
  std::normal_distribution<float> noise(0.0f, 0.02f);
  for (std::size_t pixel = 0; pixel < pixels; ++pixel)
  {
    target.BreastMask[pixel] = synthetic.LogAttenuation[pixel] > 0 ? 1 : 0;
    target.LogAttenuation[pixel] =
      3.0f * (synthetic.LogAttenuation[pixel] + noise(generator)) + 7.0f;
  }
  for (int row = 0; row < target.Grid.Rows; ++row)
  {
    for (int column = 0; column < target.Grid.Columns; ++column)
    {
      const ReceptorPoint point = target.Grid.PositionOf(column, row);
      double distance = 1e9;
      for (const ReceptorPoint& outline : synthetic.Outline)
      {
        distance = std::min(distance, std::hypot(point[0] - outline[0], point[1] - outline[1]));
      }
      const std::size_t pixel = target.Grid.Index(column, row);
      target.SignedDistanceMm[pixel] =
        static_cast<float>(target.BreastMask[pixel] ? -distance : distance);
    }
  }
  return target;
}
}

#endif
