// SPDX-License-Identifier: Apache-2.0
#include "Private/ReducedEquilibria.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace mammoray
{
namespace
{
/// The nearest ones that are used: others have next to no weight.
constexpr std::size_t MostUsed = 4;
/// One of this distance, mm or degrees, is the answer.
constexpr double Same = 1e-9;

std::array<double, 2> WayTo(const KnownEquilibrium& known, const BreastPose& pose)
{
  return { pose.ThicknessMm - known.Pose.ThicknessMm, pose.RollDeg - known.Pose.RollDeg };
}

double DistanceTo(const KnownEquilibrium& known, const BreastPose& pose)
{
  const auto [thickness, roll] = WayTo(known, pose);
  return std::hypot(thickness, roll);
}
}

void ReducedEquilibria::Add(KnownEquilibrium known)
{
  std::erase_if(this->Known,
    [&](const KnownEquilibrium& other) { return DistanceTo(other, known.Pose) <= Same; });
  if (this->Known.size() == MostKnown)
  {
    this->Known.erase(this->Known.begin());
  }
  this->Known.push_back(std::move(known));
}

const KnownEquilibrium* ReducedEquilibria::Nearest(const BreastPose& pose) const
{
  const auto nearest = std::min_element(this->Known.begin(), this->Known.end(),
    [&](const KnownEquilibrium& a, const KnownEquilibrium& b)
    { return DistanceTo(a, pose) < DistanceTo(b, pose); });
  return nearest == this->Known.end() ? nullptr : &*nearest;
}

double ReducedEquilibria::Distance(const BreastPose& pose) const
{
  const KnownEquilibrium* nearest = this->Nearest(pose);
  return nearest ? DistanceTo(*nearest, pose) : std::numeric_limits<double>::infinity();
}

std::optional<ReducedEquilibrium> ReducedEquilibria::At(const BreastPose& pose) const
{
  std::vector<std::pair<double, const KnownEquilibrium*>> near;
  for (const KnownEquilibrium& known : this->Known)
  {
    near.emplace_back(DistanceTo(known, pose), &known);
  }
  std::sort(near.begin(), near.end());
  if (near.empty() || near.front().first > Reach)
  {
    return std::nullopt;
  }
  near.resize(std::min(near.size(), near.front().first <= Same ? 1 : MostUsed));
  std::erase_if(near, [](const auto& one) { return one.first > Reach; });
  ReducedEquilibrium reduced;
  reduced.From = static_cast<int>(near.size());
  reduced.Nearest = near.front().first;
  reduced.Positions.assign(near.front().second->State.Positions.size(), 0.0);
  double sum = 0;
  for (const auto& [distance, known] : near)
  {
    const double weight = near.size() == 1 ? 1 : std::pow(distance, -4);
    const std::array<double, 2> way = WayTo(*known, pose);
    for (std::size_t c = 0; c < reduced.Positions.size(); ++c)
    {
      reduced.Positions[c] += weight *
        (known->State.Positions[c] + way[0] * known->PositionRates[0][c] +
          way[1] * known->PositionRates[1][c]);
    }
    reduced.PaddleForceN += weight *
      (known->State.PaddleForceN + way[0] * known->ForceRates[0] + way[1] * known->ForceRates[1]);
    sum += weight;
  }
  for (double& coordinate : reduced.Positions)
  {
    coordinate /= sum;
  }
  reduced.PaddleForceN = std::max(0.0, reduced.PaddleForceN / sum);
  return reduced;
}
}
