// SPDX-License-Identifier: Apache-2.0
#include "Private/FollowedPhotons.h"

#include "Private/Interpolation.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/XRay/DetectorPlane.h"
#include "mammoray/XRay/Exposer.h"

#include <algorithm>
#include <cmath>

namespace mammoray
{
namespace
{
constexpr double GatheringMm = 4;

/// The detector with larger pixels over the same field.
XRayDetector Coarsened(const XRayDetector& detector)
{
  XRayDetector coarse = detector;
  const auto resize = [](Vector3& step, int& count)
  {
    const double length = count * Norm(step);
    const int wanted = std::clamp(static_cast<int>(std::ceil(length / GatheringMm)), 1, count);
    step = (static_cast<double>(count) / wanted) * step;
    count = wanted;
  };
  resize(coarse.ColumnStep, coarse.Columns);
  resize(coarse.RowStep, coarse.Rows);
  coarse.Origin = detector.Origin - 0.5 * (detector.ColumnStep + detector.RowStep) +
    0.5 * (coarse.ColumnStep + coarse.RowStep);
  coarse.Samples = 1;
  return coarse;
}

const VoxelScene& VoxelsOf(const Scene& scene)
{
  if (!scene.Scatter.Voxels)
  {
    throw InputError("Monte Carlo: expected voxels, found none");
  }
  return *scene.Scatter.Voxels;
}

/// Largest height of the box around the tissue over the detector, mm.
double TopOf(const VoxelScene& voxels, const DetectorPlane& plane, const XRayDetector& detector)
{
  double top = 0;
  for (int corner = 0; corner < 8; ++corner)
  {
    const Vector3 point{ (corner & 1) != 0 ? voxels.High()[0] : voxels.Low()[0],
      (corner & 2) != 0 ? voxels.High()[1] : voxels.Low()[1],
      (corner & 4) != 0 ? voxels.High()[2] : voxels.Low()[2] };
    top = std::max(top, Dot(plane.Normal, point - detector.Origin));
  }
  return top;
}
}

std::vector<double> FollowScatter(const Scene& scene, const ProgressCallback& progress)
{
  const XRayDetector& detector = scene.Detector;
  const XRayDetector coarse = Coarsened(detector);
  MonteCarloOptions options;
  options.Photons = static_cast<std::int64_t>(scene.Scatter.Photons);
  options.Seed = scene.Detection.Seed;
  if (scene.Scatter.Grid)
  {
    options.Grid.emplace(*scene.Scatter.Grid);
  }
  const MonteCarloResult followed = FollowPhotons(VoxelsOf(scene), scene.Source, coarse,
    scene.XRays, scene.Response, options, progress);
  // Photons that are followed obey the inverse square law, which the picture may leave out.
  std::vector<float> fall;
  if (!scene.Field.InverseSquare)
  {
    fall =
      OpenField(scene.Source, detector, scene.XRays, scene.Response, { .InverseSquare = true });
  }
  std::vector<double> scatter;
  scatter.reserve(detector.NumberOfPixels());
  const double columnRatio = static_cast<double>(coarse.Columns) / detector.Columns;
  const double rowRatio = static_cast<double>(coarse.Rows) / detector.Rows;
  for (int row = 0; row < detector.Rows; ++row)
  {
    for (int column = 0; column < detector.Columns; ++column)
    {
      const double value = BetweenCells(followed.Scatter, coarse.Columns, coarse.Rows,
        (column + 0.5) * columnRatio - 0.5, (row + 0.5) * rowRatio - 0.5);
      scatter.push_back(fall.empty() ? value : value / fall[scatter.size()]);
    }
  }
  return scatter;
}

Dose ComputeDose(const Scene& scene, const ProgressCallback& progress)
{
  const VoxelScene& voxels = VoxelsOf(scene);
  const XRayDetector coarse = Coarsened(scene.Detector);
  MonteCarloOptions options;
  options.Photons = static_cast<std::int64_t>(scene.Scatter.Photons);
  const MonteCarloResult followed = FollowPhotons(voxels, scene.Source, coarse, scene.XRays,
    DetectorResponse::EnergyIntegrating, options, progress);
  const DetectorPlane plane(scene.Source, scene.Detector);
  Dose dose;
  dose.Photons = followed.Photons;
  dose.HeightMm = scene.DoseHeightMm ? *scene.DoseHeightMm : TopOf(voxels, plane, scene.Detector);
  // Photons per emitted photon and mm^2 at the foot of the perpendicular: on the detector, and the
  // factor for a plane at that height.
  const double share = CentralFluence(scene.Source, coarse);
  const double nearer = std::pow(plane.HeightMm / (plane.HeightMm - dose.HeightMm), 2);
  double kerma = 0;
  double photons = 0;
  for (std::size_t bin = 0; bin < scene.XRays.Weights.size(); ++bin)
  {
    kerma += scene.XRays.Weights[bin] * AirKermaPerFluence(scene.XRays.EnergiesKeV[bin]);
    photons += scene.XRays.Weights[bin];
  }
  const double kermaPerPhoton = kerma / photons * share * nearer;
  const double pixelMm2 = Norm(scene.Detector.ColumnStep) * Norm(scene.Detector.RowStep);
  dose.AirKermaMgy = scene.Detection.PhotonsPerPixel / (share * pixelMm2) * kermaPerPhoton;
  dose.MassesG = voxels.MassesG();
  for (std::size_t material = 0; material < dose.MassesG.size(); ++material)
  {
    const double toDose = dose.MassesG[material] > 0
      ? MilligrayGramPerKeV / dose.MassesG[material] / kermaPerPhoton
      : 0;
    dose.PerAirKerma.push_back(followed.DepositedKeV[material] * toDose);
    dose.Error.push_back(followed.DepositedErrorKeV[material] * toDose);
  }
  return dose;
}
}
