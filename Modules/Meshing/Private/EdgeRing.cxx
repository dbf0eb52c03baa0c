// SPDX-License-Identifier: Apache-2.0
#include "Private/EdgeRing.h"

#include <algorithm>
#include <utility>

namespace mammoray
{
std::optional<EdgeRing> FindRing(const EditableMesh& mesh, std::int32_t a, std::int32_t b,
  std::size_t most)
{
  EdgeRing ring;
  ring.Cells = mesh.Ring(a, b);
  if (ring.Cells.empty() || ring.Cells.size() > most)
  {
    return std::nullopt;
  }
  struct Step
  {
    std::int32_t From;
    std::int32_t To;
    std::int32_t Material;
  };
  std::vector<Step> steps;
  for (const std::int32_t cell : ring.Cells)
  {
    CellIds turned = mesh[cell].Ids; // to be (a, b, from, to), by an even number of swaps
    int swaps = 0;
    for (const std::size_t place : { 0, 1 })
    {
      const auto at = std::find(turned.begin(), turned.end(), place == 0 ? a : b);
      if (at != turned.begin() + place)
      {
        std::swap(*at, turned[place]);
        ++swaps;
      }
    }
    if (swaps == 1)
    {
      std::swap(turned[2], turned[3]);
    }
    steps.push_back({ turned[2], turned[3], mesh[cell].Material });
  }
  std::int32_t at = steps[0].From;
  for (std::size_t n = 0; n < steps.size(); ++n)
  {
    const auto next =
      std::find_if(steps.begin(), steps.end(), [&](const Step& s) { return s.From == at; });
    if (next == steps.end())
    {
      return std::nullopt;
    }
    ring.Points.push_back(at);
    ring.Materials.push_back(next->Material);
    at = next->To;
  }
  return at == steps[0].From ? std::optional(ring) : std::nullopt;
}

PolygonFill::PolygonFill(const EditableMesh& mesh, const std::vector<std::int32_t>& polygon,
  std::int32_t material, std::int32_t below, std::int32_t above)
  : Mesh(mesh)
  , Polygon(polygon)
  , Material(material)
  , Below(below)
  , Above(above)
  , Count(polygon.size())
  , Qualities(Count * Count, 1.0)
  , Middle(Count * Count, 0)
{
  for (std::size_t length = 2; length < this->Count; ++length)
  {
    for (std::size_t i = 0; i + length < this->Count; ++i)
    {
      this->FindMiddle(i, i + length);
    }
  }
}

void PolygonFill::FindMiddle(std::size_t i, std::size_t j)
{
  double& best = this->Qualities[i * this->Count + j];
  best = -1;
  for (std::size_t k = i + 1; k < j; ++k)
  {
    const double sides =
      std::min(this->Qualities[i * this->Count + k], this->Qualities[k * this->Count + j]);
    if (sides <= best)
    {
      continue;
    }
    const double own = std::min(this->Mesh.Quality(this->Upper(i, k, j), this->Material),
      this->Mesh.Quality(this->Lower(i, k, j), this->Material));
    if (std::min(own, sides) > best)
    {
      best = std::min(own, sides);
      this->Middle[i * this->Count + j] = k;
    }
  }
}

CellIds PolygonFill::Upper(std::size_t i, std::size_t k, std::size_t j) const
{
  return { this->Polygon[i], this->Polygon[k], this->Polygon[j], this->Above };
}

CellIds PolygonFill::Lower(std::size_t i, std::size_t k, std::size_t j) const
{
  return { this->Polygon[i], this->Polygon[j], this->Polygon[k], this->Below };
}

void PolygonFill::Collect(std::size_t i, std::size_t j, std::vector<CellIds>& cells) const
{
  if (j - i >= 2)
  {
    const std::size_t k = this->Middle[i * this->Count + j];
    cells.push_back(this->Upper(i, k, j));
    cells.push_back(this->Lower(i, k, j));
    this->Collect(i, k, cells);
    this->Collect(k, j, cells);
  }
}
}
