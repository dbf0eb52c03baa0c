// SPDX-License-Identifier: Apache-2.0
#include "SlabScatter.h"

#include "PhotonDirection.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace mammoray
{
namespace
{
/// Of the weights with which photons come through unscattered: photons of less are ended by chance.
constexpr double LeastWeight = 1e-3;
constexpr double Survival = 0.1;

/// The bin of ascending edges, or their number less one beyond them.
std::size_t BinOf(const std::vector<double>& edges, double value)
{
  const auto above = std::upper_bound(edges.begin(), edges.end(), value);
  return static_cast<std::size_t>(above - edges.begin()) - 1;
}
}

std::array<double, 2> FollowThroughSlab(const PhotonMaterial& tissue, double energyKeV,
  double thicknessMm, const ScatterKernels& axes, std::uint64_t seed, std::uint64_t begin,
  std::uint64_t end, std::vector<double>& sums)
{
  const std::size_t rings = axes.NumberOfRings();
  const std::size_t angles = axes.NumberOfAngles();
  const double toPrimary = tissue.At(energyKeV).Total() * thicknessMm;
  std::array<double, 2> left{ 0, 0 };
  const auto score = [&](const Vector3& place, const Vector3& direction, double share)
  {
    const double angle = std::acos(std::min(direction[2], 1.0)) * 180 / std::numbers::pi;
    const std::size_t side = BinOf(axes.AnglesDeg, angle);
    for (std::size_t gap = 0; side < angles && gap < axes.GapsMm.size(); ++gap)
    {
      const double way = axes.GapsMm[gap] / direction[2];
      const std::size_t ring = BinOf(axes.RadiiMm,
        std::hypot(place[0] + way * direction[0], place[1] + way * direction[1]));
      if (ring < rings)
      {
        sums[(gap * rings + ring) * angles + side] += share;
      }
    }
  };
  for (std::uint64_t number = begin; number < end; ++number)
  {
    RandomStream random(seed, number);
    double energy = energyKeV;
    PhotonInteractions here = tissue.At(energy);
    // The first collision anywhere with the same probability: whatever its depth, what leaves the
    // slab has come about as far through it. Weights are relative to those of the primary photons.
    Vector3 place{ 0, 0, thicknessMm * random.Uniform() };
    Vector3 direction{ 0, 0, 1 };
    double weight = toPrimary * std::exp(toPrimary - here.Total() * place[2]);
    const double least = LeastWeight * toPrimary;
    for (int collisions = 1;; ++collisions)
    {
      weight *= (here.Rayleigh + here.Compton) / here.Total();
      if (weight < least)
      {
        if (random.Uniform() >= Survival)
        {
          break;
        }
        weight /= Survival;
      }
      const ScatteredPhoton after =
        random.Uniform() * (here.Rayleigh + here.Compton) < here.Rayleigh
        ? tissue.Rayleigh(energy, random)
        : tissue.Compton(energy, random);
      direction = TurnDirection(direction, after.Cosine, random);
      energy = after.EnergyKeV;
      here = tissue.At(energy);
      if (energy < PhotonMaterial::LowestKeV || direction[2] == 0)
      {
        break;
      }
      const double toFace = (direction[2] > 0 ? thicknessMm - place[2] : -place[2]) / direction[2];
      const double leaves = std::exp(-here.Total() * toFace);
      if (direction[2] > 0)
      {
        const double share = weight * leaves * energy / energyKeV;
        score(place + toFace * direction, direction, share);
        left[0] += collisions > 1 ? share : 0;
        left[1] += share;
      }
      weight *= 1 - leaves;
      const double path = -std::log(1 - random.Uniform() * (1 - leaves)) / here.Total();
      place = place + path * direction;
    }
  }
  return left;
}
}
