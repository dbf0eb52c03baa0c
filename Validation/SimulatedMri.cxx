// SPDX-License-Identifier: Apache-2.0
#include "SimulatedMri.h"

#include <algorithm>
#include <cmath>

namespace mammoray
{
double CoilPair::At(const Vector3& point) const
{
  const auto sum = [this](const Vector3& at)
  {
    double total = 0;
    for (const Vector3& centre : this->Centres)
    {
      const double distance = Norm(at - centre) / this->HalfAtMm;
      total += 1 / (1 + distance * distance);
    }
    return total;
  };
  return sum(point) / sum(this->Reference);
}

std::vector<IntensityVolume> SimulateMri(const LabelVolume& tissue, const VolumeGrid& grid,
  const std::vector<TissueSignals>& signals, const CoilPair& coils, double deviation, double scale,
  Draws& draws, const ProgressCallback& progress)
{
  std::vector<IntensityVolume> volumes(signals.size());
  for (IntensityVolume& volume : volumes)
  {
    static_cast<VolumeGrid&>(volume) = grid;
    volume.Voxels.reserve(static_cast<std::size_t>(grid.Size[0]) * grid.Size[1] * grid.Size[2]);
  }
  std::normal_distribution<double> noise(0, deviation);
  for (int k = 0; k < grid.Size[2]; ++k)
  {
    ReportProgress(progress, static_cast<double>(k) / grid.Size[2], "simulating the MRI");
    for (int j = 0; j < grid.Size[1]; ++j)
    {
      for (int i = 0; i < grid.Size[0]; ++i)
      {
        std::array<int, TissueCount> counts{};
        for (int part = 0; part < 8; ++part)
        {
          const auto offset = [part](int axis) { return (part >> axis & 1) != 0 ? 0.25 : -0.25; };
          ++counts[tissue.LabelAt(grid.PointAt(i + offset(0), j + offset(1), k + offset(2)))];
        }
        const double sensitivity = coils.At(grid.PointAt(i, j, k));
        for (std::size_t volume = 0; volume < signals.size(); ++volume)
        {
          double signal = 0;
          for (std::size_t kind = 0; kind < TissueCount; ++kind)
          {
            signal += counts[kind] * signals[volume][kind] / 8;
          }
          // Magnitude of a complex signal with noise in both parts (Gudbjartsson 1995).
          const double real = sensitivity * signal + noise(draws.Bits());
          const double imaginary = noise(draws.Bits());
          volumes[volume].Voxels.push_back(
            static_cast<float>(std::min(4095.0, std::round(scale * std::hypot(real, imaginary)))));
        }
      }
    }
  }
  return volumes;
}
}
