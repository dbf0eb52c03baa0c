// SPDX-License-Identifier: Apache-2.0
#include "Private/CellPatches.h"

#include "mammoray/Foundation/FaceTable.h"

#include <algorithm>
#include <deque>
#include <span>
#include <tuple>

namespace mammoray
{
namespace
{
/// Smaller patches are distributed to their neighbours: the fewer cells share a constraint, the
/// stiffer they are.
constexpr std::size_t SmallestPatchSize = 6;

class PatchMaker
{
public:
  PatchMaker(const TetrahedralMesh& mesh, const std::vector<std::int32_t>& neighbours,
    const std::vector<char>& groups)
    : Mesh(mesh)
    , Neighbours(neighbours)
    , Groups(groups)
    , PatchOf(mesh.NumberOfCells(), -1)
  {
    // Patches grow next to existing ones, so that few cells remain between them.
    std::deque<std::int32_t> seeds;
    for (std::int32_t first = 0; first < static_cast<std::int32_t>(mesh.NumberOfCells()); ++first)
    {
      for (seeds.push_back(first); !seeds.empty(); seeds.pop_front())
      {
        if (this->PatchOf[seeds.front()] < 0)
        {
          this->Grow(seeds.front());
          for (const std::int32_t cell : this->Patches.back())
          {
            this->ForEachNeighbour(cell,
              [&](std::int32_t neighbour)
              {
                if (this->PatchOf[neighbour] < 0)
                {
                  seeds.push_back(neighbour);
                }
              });
          }
        }
      }
    }
    this->ShareOutSmallPatches();
  }

  std::vector<std::vector<std::int32_t>> Patches;

private:
  template <typename Function>
  void ForEachNeighbour(std::int32_t cell, const Function& function) const
  {
    for (int face = 0; face < 4; ++face)
    {
      const std::int32_t neighbour = this->Neighbours[4 * cell + face];
      if (neighbour >= 0 && this->Groups[neighbour] == this->Groups[cell])
      {
        function(neighbour);
      }
    }
  }

  void Grow(std::int32_t seed)
  {
    const auto index = static_cast<std::int32_t>(this->Patches.size());
    std::vector<std::int32_t> patch{ seed };
    std::vector<std::int32_t> nodes(&this->Mesh.Cells[4 * seed], &this->Mesh.Cells[4 * seed] + 4);
    this->PatchOf[seed] = index;
    while (patch.size() < UsualPatchSize)
    {
      // Take the free neighbour with the fewest new nodes, then with the fewest free neighbours of
      // its own.
      std::tuple<int, int, std::int32_t> best{ 5, 5, -1 };
      for (const std::int32_t cell : patch)
      {
        this->ForEachNeighbour(cell,
          [&](std::int32_t candidate)
          {
            if (this->PatchOf[candidate] < 0)
            {
              best = std::min(best,
                { this->NewNodes(candidate, nodes), this->FreeNeighbours(candidate), candidate });
            }
          });
      }
      const std::int32_t next = std::get<2>(best);
      if (next < 0)
      {
        break;
      }
      this->PatchOf[next] = index;
      patch.push_back(next);
      for (int c = 0; c < 4; ++c)
      {
        const std::int32_t node = this->Mesh.Cells[4 * next + c];
        if (std::find(nodes.begin(), nodes.end(), node) == nodes.end())
        {
          nodes.push_back(node);
        }
      }
    }
    this->Patches.push_back(std::move(patch));
  }

  int NewNodes(std::int32_t cell, const std::vector<std::int32_t>& nodes) const
  {
    const std::int32_t* corners = &this->Mesh.Cells[4 * cell];
    return static_cast<int>(std::count_if(corners, corners + 4,
      [&](std::int32_t node)
      { return std::find(nodes.begin(), nodes.end(), node) == nodes.end(); }));
  }

  int FreeNeighbours(std::int32_t cell) const
  {
    int count = 0;
    this->ForEachNeighbour(cell, [&](std::int32_t n) { count += this->PatchOf[n] < 0; });
    return count;
  }

  /// Gives the cells of small patches one by one to the smallest adjacent patch with room.
  void ShareOutSmallPatches()
  {
    for (std::size_t small = 0; small < this->Patches.size(); ++small)
    {
      std::vector<std::int32_t>& patch = this->Patches[small];
      while (!patch.empty() && patch.size() < SmallestPatchSize)
      {
        std::tuple<std::size_t, std::int32_t, std::int32_t> best{ LargestPatchSize, -1, -1 };
        for (const std::int32_t cell : patch)
        {
          this->ForEachNeighbour(cell,
            [&](std::int32_t neighbour)
            {
              const std::int32_t other = this->PatchOf[neighbour];
              if (other != static_cast<std::int32_t>(small))
              {
                best = std::min(best, { this->Patches[other].size(), other, cell });
              }
            });
        }
        const auto [size, other, cell] = best;
        if (other < 0)
        {
          break;
        }
        patch.erase(std::find(patch.begin(), patch.end(), cell));
        this->Patches[other].push_back(cell);
        this->PatchOf[cell] = other;
      }
    }
    std::erase_if(this->Patches, [](const auto& patch) { return patch.empty(); });
  }

  const TetrahedralMesh& Mesh;
  const std::vector<std::int32_t>& Neighbours;
  const std::vector<char>& Groups;
  std::vector<std::int32_t> PatchOf;
};
}

std::vector<std::int32_t> FaceNeighbours(const TetrahedralMesh& mesh)
{
  std::vector<std::int32_t> neighbours(mesh.Cells.size(), -1);
  FaceTable(mesh).ForEachFace(
    [&](std::span<const FaceTable::Entry> same)
    {
      if (same.size() >= 2)
      {
        neighbours[same[0].Face] = static_cast<std::int32_t>(same[1].Face / 4);
        neighbours[same[1].Face] = static_cast<std::int32_t>(same[0].Face / 4);
      }
    });
  return neighbours;
}

std::vector<std::vector<std::int32_t>> MakePatches(const TetrahedralMesh& mesh,
  const std::vector<std::int32_t>& neighbours, const std::vector<char>& groups)
{
  return std::move(PatchMaker(mesh, neighbours, groups).Patches);
}
}
