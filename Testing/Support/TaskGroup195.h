// SPDX-License-Identifier: Apache-2.0
// Case 3 of AAPM's report 195 (Sechopoulos et al., Med. Phys. 42, 2015, 5679): a half cylinder of
// breast (20 % gland, skin of 2 mm) between two plates, before a block of water, under a tube.
#ifndef mammoray_TaskGroup195_h
#define mammoray_TaskGroup195_h

#include "mammoray/XRay/Scatter/MonteCarlo.h"

#include <array>
#include <cmath>

namespace mammoray
{
/// Energy left in the tissue within the skin, and in seven boxes of it, eV per photon.
struct TaskGroup195Case3
{
  double BodyEV = 0;
  double BodyErrorEV = 0;
  std::array<double, 7> VolumesEV{};
  std::array<double, 7> VolumeErrorsEV{};
};

/// Mo/Mo, 30 kV, half-value layer 0.343 mm Al: photons by bins of 0.5 keV, as the report gives
/// them.
inline Spectrum TaskGroup195Spectrum()
{
  Spectrum spectrum;
  spectrum.Name = "TG-195, 30 kV";
  spectrum.Weights = { 1.551e-4, 4.691e-4, 1.199e-3, 2.405e-3, 4.263e-3, 6.797e-3, 9.761e-3,
    1.314e-2, 1.666e-2, 2.013e-2, 2.349e-2, 2.666e-2, 2.933e-2, 3.167e-2, 3.365e-2, 3.534e-2,
    3.644e-2, 3.741e-2, 3.796e-2, 3.823e-2, 3.445e-1, 3.770e-2, 3.704e-2, 3.639e-2, 9.200e-2,
    2.178e-3, 2.048e-3, 2.043e-3, 2.098e-3, 2.193e-3, 2.327e-3, 2.471e-3, 2.625e-3, 2.770e-3,
    2.907e-3, 3.000e-3, 3.062e-3, 3.058e-3, 2.988e-3, 2.823e-3, 2.575e-3, 2.233e-3, 1.815e-3,
    1.290e-3, 6.696e-4, 4.086e-5 };
  for (std::size_t bin = 0; bin < spectrum.Weights.size(); ++bin)
  {
    spectrum.EnergiesKeV.push_back(7.25 + 0.5 * static_cast<double>(bin));
  }
  return spectrum;
}

/// x from the chest wall to the nipple, z from the middle of the breast to the tube, mm.
class TaskGroup195Scene : public PhotonScene
{
public:
  TaskGroup195Scene()
    : PhotonScene(Regions(), Air())
  {
    this->SetBox({ -170, -150, -150 }, { 140, 150, 150 });
  }
  static constexpr int Breast = 4;
  int RegionAt(const Vector3& p) const override
  {
    if (p[0] < 0)
    {
      return 1;
    }
    const double height = std::abs(p[2]);
    const double radius = std::hypot(p[0], p[1]);
    if (height < 25 && radius < 100)
    {
      if (height >= 23 || radius >= 98)
      {
        return 3;
      }
      static constexpr std::array<Vector3, 7> middles{ { { 50, 50, 0 }, { 20, 0, 0 }, { 50, 0, 0 },
        { 80, 0, 0 }, { 50, -50, 0 }, { 50, 0, -15 }, { 50, 0, 15 } } };
      for (std::size_t box = 0; box < middles.size(); ++box)
      {
        const Vector3 from = p - middles[box];
        if (std::abs(from[0]) < 10 && std::abs(from[1]) < 10 && std::abs(from[2]) < 5)
        {
          return Breast + 1 + static_cast<int>(box);
        }
      }
      return Breast;
    }
    return height >= 25 && height < 27 && p[0] < 140 && std::abs(p[1]) < 130 ? 2 : 0;
  }

private:
  static PhotonMaterial Air() { return { "Air, Dry (near sea level)", 0.001205 }; }
  static std::vector<PhotonMaterial> Regions()
  {
    const PhotonMaterial skin(
      "H:0.098 C:0.178 N:0.050 O:0.667 P:0.00175 S:0.00175 K:0.00175 Ca:0.00175", 1.09);
    const PhotonMaterial breast(
      "H:0.110 C:0.532 N:0.020 O:0.3362 P:0.00045 S:0.00045 K:0.00045 Ca:0.00045", 0.952);
    std::vector<PhotonMaterial> regions{ Air(), PhotonMaterial("Water, Liquid", 1),
      PhotonMaterial("C5H8O2", 1.19), skin };
    regions.insert(regions.end(), 8, breast);
    return regions;
  }
};

inline TaskGroup195Case3 FollowTaskGroup195Case3(const Spectrum& spectrum, std::int64_t photons,
  std::uint64_t seed, const ProgressCallback& progress = {})
{
  const TaskGroup195Scene scene;
  XRaySource source;
  source.Position = { 0, 0, 620 };
  XRayDetector detector;
  detector.Origin = { 35, -65, -40 };
  detector.ColumnStep = { 70, 0, 0 };
  detector.RowStep = { 0, 130, 0 };
  detector.Columns = 2;
  detector.Rows = 2;
  MonteCarloOptions options;
  options.Photons = photons;
  options.Seed = seed;
  const MonteCarloResult result = FollowPhotons(scene, source, detector, spectrum,
    DetectorResponse::EnergyIntegrating, options, progress);
  TaskGroup195Case3 found;
  double variance = 0;
  for (std::size_t region = TaskGroup195Scene::Breast; region < result.DepositedKeV.size();
       ++region)
  {
    found.BodyEV += 1e3 * result.DepositedKeV[region];
    variance += std::pow(1e3 * result.DepositedErrorKeV[region], 2);
    if (region > TaskGroup195Scene::Breast)
    {
      const std::size_t volume = region - TaskGroup195Scene::Breast - 1;
      found.VolumesEV[volume] = 1e3 * result.DepositedKeV[region];
      found.VolumeErrorsEV[volume] = 1e3 * result.DepositedErrorKeV[region];
    }
  }
  found.BodyErrorEV = std::sqrt(variance);
  return found;
}
}

#endif
