// SPDX-License-Identifier: Apache-2.0
// The FDA's VICTRE phantom 1 against the FDA's own compression of it (FEBio on another mesh):
// points known in both states, the gland's voxels, the outline. Nothing here is fitted to them.
#include "EveryElement.h"
#include "Files.h"
#include "mammoray/Biomechanics/CompressionSimulation.h"
#include "mammoray/Biomechanics/Embedding.h"
#include "mammoray/IO/LabelVolumeIO.h"
#include "mammoray/Meshing/LabelMesher.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <limits>

namespace
{
using namespace mammoray;

using PhantomCompression = test::EveryElement;
MAMMORAY_FOR_EVERY_ELEMENT(PhantomCompression);

const std::filesystem::path Folder =
  std::filesystem::path(test::SharedDataFolder()) / "victre-pipeline-phantom-1";

/// Air and plates, fat, skin and nipple, other tissue (gland: lobules and ducts too), muscle.
enum Tissue : std::uint16_t
{
  Outside,
  Fat,
  Gland,
  Other,
  Muscle
};

LabelVolume ReadTissues(const char* name)
{
  LabelVolume volume = ReadLabelFile((Folder / name).string(), VolumeAxes::AsGiven);
  for (std::uint16_t& voxel : volume.Voxels)
  {
    switch (voxel)
    {
      case 0:
      case 50:
        voxel = Outside;
        break;
      case 1:
      case 2:
      case 33:
        voxel = Fat;
        break;
      case 29:
      case 95:
      case 125:
        voxel = Gland;
        break;
      case 40:
        voxel = Muscle;
        break;
      default:
        voxel = Other;
    }
  }
  return volume;
}

/// Its plates, from the folder's README; x anterior, z up.
PlatePair FdasPlates()
{
  PlatePair plates;
  plates.Support.Edge = { 8, 0, -25.32 };
  plates.Support.Inward = { 1, 0, 0 };
  plates.Paddle = plates.Support;
  plates.Paddle.Edge = { 9, 0, 24.48 };
  plates.Paddle.Normal = { 0, 0, -1 };
  return plates;
}

/// Volumes of gland in cubes of four voxels a side, and where there is tissue as seen along z.
struct Compressed
{
  static constexpr int CubeVoxels = 4;
  std::array<int, 3> Size{};
  std::vector<double> GlandMm3;
  /// Squares of two voxels a side.
  int Columns = 0;
  std::vector<char> Silhouette;

  explicit Compressed(const LabelVolume& grid)
    : Columns(grid.Size[0] / 2)
    , Silhouette(static_cast<std::size_t>(grid.Size[0] / 2) * (grid.Size[1] / 2), 0)
  {
    for (int axis = 0; axis < 3; ++axis)
    {
      this->Size[axis] = grid.Size[axis] / CubeVoxels;
    }
    this->GlandMm3.assign(static_cast<std::size_t>(this->Size[0]) * this->Size[1] * this->Size[2],
      0.0);
  }

  /// Tissue at a continuous index of the grid.
  void Add(const Vector3& index, int tissue, double mm3)
  {
    int cube[3], square[3];
    for (int axis = 0; axis < 3; ++axis)
    {
      cube[axis] = static_cast<int>(std::floor((index[axis] + 0.5) / CubeVoxels));
      square[axis] = static_cast<int>(std::floor((index[axis] + 0.5) / 2));
      if (cube[axis] < 0 || cube[axis] >= this->Size[axis])
      {
        return;
      }
    }
    this->Silhouette[static_cast<std::size_t>(square[1]) * this->Columns + square[0]] = 1;
    if (tissue == Gland)
    {
      this->GlandMm3[(static_cast<std::size_t>(cube[2]) * this->Size[1] + cube[1]) * this->Size[0] +
        cube[0]] += mm3;
    }
  }

  /// Middles of the squares at the edge of the silhouette, mm from the grid's corner.
  std::vector<std::array<double, 2>> Outline(double squareMm) const
  {
    const int rows = static_cast<int>(this->Silhouette.size()) / this->Columns;
    std::vector<std::array<double, 2>> outline;
    for (int j = 1; j + 1 < rows; ++j)
    {
      for (int i = 1; i + 1 < this->Columns; ++i)
      {
        const char* at = &this->Silhouette[static_cast<std::size_t>(j) * this->Columns + i];
        if (at[0] && !(at[-1] && at[1] && at[-this->Columns] && at[this->Columns]))
        {
          outline.push_back({ squareMm * i, squareMm * j });
        }
      }
    }
    return outline;
  }
};

/// The phantom as FEBio left it.
Compressed ReadCompressed(const LabelVolume& after)
{
  Compressed result(after);
  for (int k = 0; k < after.Size[2]; ++k)
  {
    for (int j = 0; j < after.Size[1]; ++j)
    {
      for (int i = 0; i < after.Size[0]; ++i)
      {
        const int tissue = after.Voxels[after.Index(i, j, k)];
        if (tissue != Outside)
        {
          result.Add({ double(i), double(j), double(k) }, tissue, after.VoxelVolume());
        }
      }
    }
  }
  return result;
}

/// Every eighth voxel of the breast, carried along.
Compressed CarryVoxels(const LabelVolume& before, const LabelVolume& after,
  const CompressionSimulation& simulation, const std::vector<double>& positions)
{
  Compressed result(after);
  constexpr int step = 2;
  // Slab by slab: millions of points.
  constexpr int slab = 40;
  for (int first = 0; first < before.Size[2]; first += slab)
  {
    std::vector<double> points;
    std::vector<int> tissues;
    for (int k = first; k < std::min(first + slab, before.Size[2]); k += step)
    {
      for (int j = 0; j < before.Size[1]; j += step)
      {
        for (int i = 0; i < before.Size[0]; i += step)
        {
          const int tissue = before.Voxels[before.Index(i, j, k)];
          if (tissue != Outside && tissue != Muscle)
          {
            const Vector3 point = before.PointAt(i, j, k);
            points.insert(points.end(), point.begin(), point.end());
            tissues.push_back(tissue);
          }
        }
      }
    }
    const std::vector<double> moved = Embedding(simulation, points).Map(positions);
    for (std::size_t p = 0; p < tissues.size(); ++p)
    {
      result.Add(after.ContinuousIndex({ moved[3 * p], moved[3 * p + 1], moved[3 * p + 2] }),
        tissues[p], step * step * step * before.VoxelVolume());
    }
  }
  return result;
}

/// Counts the cubes that are gland by at least half.
double Dice(const Compressed& a, const Compressed& b, double cubeMm3)
{
  std::size_t both = 0, sum = 0;
  for (std::size_t cube = 0; cube < a.GlandMm3.size(); ++cube)
  {
    const bool inA = a.GlandMm3[cube] >= 0.5 * cubeMm3;
    const bool inB = b.GlandMm3[cube] >= 0.5 * cubeMm3;
    both += inA && inB;
    sum += inA + inB;
  }
  return 2.0 * static_cast<double>(both) / static_cast<double>(sum);
}

/// Distances of every point of either outline to the other, ascending.
std::vector<double> OutlineDistances(const std::vector<std::array<double, 2>>& a,
  const std::vector<std::array<double, 2>>& b)
{
  std::vector<double> distances;
  const auto add = [&](const auto& from, const auto& to)
  {
    for (const auto& p : from)
    {
      double nearest = std::numeric_limits<double>::infinity();
      for (const auto& q : to)
      {
        nearest = std::min(nearest, std::hypot(p[0] - q[0], p[1] - q[1]));
      }
      distances.push_back(nearest);
    }
  };
  add(a, b);
  add(b, a);
  std::sort(distances.begin(), distances.end());
  return distances;
}

struct Landmarks
{
  std::vector<double> Before;
  std::vector<double> After;
  std::vector<int> Imaged;

  Landmarks()
  {
    std::ifstream file(Folder / "landmarks.csv");
    std::string line;
    std::getline(file, line);
    while (std::getline(file, line))
    {
      double c[6];
      int flag = 0;
      EXPECT_EQ(std::sscanf(line.c_str(), "%lf,%lf,%lf,%lf,%lf,%lf,%d", c, c + 1, c + 2, c + 3,
                  c + 4, c + 5, &flag),
        7);
      this->Before.insert(this->Before.end(), c, c + 3);
      this->After.insert(this->After.end(), c + 3, c + 6);
      this->Imaged.push_back(flag);
    }
  }

  /// Errors of positions found, ascending; `all`: or of the imaged ones only.
  std::vector<double> Errors(const std::vector<double>& found, bool all) const
  {
    std::vector<double> errors;
    for (std::size_t p = 0; p < this->Imaged.size(); ++p)
    {
      if (all || this->Imaged[p])
      {
        errors.push_back(std::hypot(found[3 * p] - this->After[3 * p],
          found[3 * p + 1] - this->After[3 * p + 1], found[3 * p + 2] - this->After[3 * p + 2]));
      }
    }
    std::sort(errors.begin(), errors.end());
    return errors;
  }
};

TEST_P(PhantomCompression, MovesTissueAsTheFdasSimulationDid)
{
  if (!std::filesystem::exists(Folder / "landmarks.csv"))
  {
    GTEST_SKIP() << "no " << Folder;
  }
  const LabelVolume before = ReadTissues("p_1.nhdr");
  LabelVolume after = ReadTissues("pc_1_crop.nhdr");
  after.Origin = { 8.4, -46.4534, -26.3184 }; // of the README; its header repeats that of pc_1
  const std::vector<bool> held{ false, false, false, false, true };
  const bool quadratic = GetParam() == ElementType::Quadratic;
  const MeshingResult mesh = MeshForSimulation(before, held, quadratic ? 8 : 5);
  CompressionOptions options;
  options.Element = GetParam();
  // Constants of the FDA's simulation.
  CompressionSimulation simulation(
    mesh.Mesh, { {}, { 5, 0.49 }, { 15, 0.49 }, { 15, 0.49 }, { 5, 0.49 } }, held,
    [&](const Vector3& point) { return static_cast<int>(before.LabelAt(point)); }, options);
  const CompressionState state = simulation.Compress(FdasPlates());
  EXPECT_NEAR(state.VolumeRatio, 1, 0.01);
  EXPECT_LT(state.LargestPenetrationMm, 0.05);

  const Landmarks landmarks;
  const std::vector<double> found = Embedding(simulation, landmarks.Before).Map(state.Positions);
  const std::vector<double> errors = landmarks.Errors(found, false);
  const std::vector<double> all = landmarks.Errors(found, true);
  ASSERT_GE(errors.size(), 10u);

  const Compressed theirs = ReadCompressed(after);
  const Compressed ours = CarryVoxels(before, after, simulation, state.Positions);
  const Compressed still = CarryVoxels(before, after, simulation, simulation.RestPositions());
  const double cubeMm3 = std::pow(Compressed::CubeVoxels, 3) * after.VoxelVolume();
  const double dice = Dice(ours, theirs, cubeMm3);
  const double squareMm = 2 * after.Spacing[0];
  const std::vector<double> outline =
    OutlineDistances(ours.Outline(squareMm), theirs.Outline(squareMm));
  ASSERT_FALSE(outline.empty());
  double mean = 0;
  for (const double distance : outline)
  {
    mean += distance / static_cast<double>(outline.size());
  }
  std::printf("%s, %zu cells: landmarks imaged: median %.2f mm, largest %.2f mm; all: median %.2f "
              "mm, largest %.2f mm; gland overlap (Dice) %.3f, uncompressed %.3f; outline: mean "
              "%.2f mm, 95 %% %.2f mm, largest %.2f mm; paddle %.2f N; %d Newton steps, %.1f s\n",
    NameOf(GetParam()).c_str(), mesh.Mesh.NumberOfCells(), errors[errors.size() / 2], errors.back(),
    all[all.size() / 2], all.back(), dice, Dice(still, theirs, cubeMm3), mean,
    outline[outline.size() * 95 / 100], outline.back(), state.PaddleForceN, state.NewtonSteps,
    state.Seconds);
  RecordProperty("MedianErrorMm", std::to_string(errors[errors.size() / 2]));
  RecordProperty("GlandDice", std::to_string(dice));
  // No motion at all leaves 9.2 mm at these points and a Dice of 0.51; 0.7 mm, 0.85 and an outline
  // within 0.9 mm were measured, the latter counted in squares of 0.4 mm.
  EXPECT_LT(errors[errors.size() / 2], 1.5);
  EXPECT_LT(errors.back(), 3.0);
  EXPECT_LT(outline.back(), 1.5);
  EXPECT_GT(dice, 0.8);
}
}
