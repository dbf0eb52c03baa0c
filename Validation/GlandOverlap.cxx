// SPDX-License-Identifier: Apache-2.0
#include "GlandOverlap.h"

#include "vtkUnstructuredGrid.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

namespace mammoray
{
namespace
{
/// Counts the gland of a breast in cubes of the gantry frame.
class GlandCubes
{
public:
  static constexpr double EdgeMm = 0.8;

  void Add(const Vector3& gantry, double mm3)
  {
    std::array<int, 3> cube{};
    for (int axis = 0; axis < 3; ++axis)
    {
      cube[axis] = static_cast<int>(std::floor(gantry[axis] / EdgeMm));
    }
    this->Mm3[cube] += mm3;
  }

  /// Dice's coefficient of the cubes that are gland by at least half.
  static double Dice(const GlandCubes& a, const GlandCubes& b)
  {
    const double least = 0.5 * EdgeMm * EdgeMm * EdgeMm;
    std::size_t both = 0;
    std::size_t sum = 0;
    for (const auto& [cube, mm3] : a.Mm3)
    {
      const auto other = b.Mm3.find(cube);
      const bool inB = other != b.Mm3.end() && other->second >= least;
      both += mm3 >= least && inB ? 1 : 0;
      sum += mm3 >= least ? 1 : 0;
    }
    for (const auto& [cube, mm3] : b.Mm3)
    {
      sum += mm3 >= least ? 1 : 0;
    }
    return 2.0 * static_cast<double>(both) / static_cast<double>(sum);
  }

private:
  std::map<std::array<int, 3>, double> Mm3;
};

std::vector<Vector3> GlandVoxels(const LabelVolume& materials, const MaterialTable& table)
{
  const std::vector<int> gland = table.Glandular();
  std::vector<Vector3> points;
  materials.ForEachVoxel(
    [&](int i, int j, int k, std::size_t voxel)
    {
      if (std::find(gland.begin(), gland.end(), materials.Voxels[voxel]) != gland.end())
      {
        points.push_back(materials.PointAt(i, j, k));
      }
    });
  return points;
}
}

GlandOverlap MeasureGland(const LandmarkCase& input, const RegistrationCaseResult& result,
  vtkUnstructuredGrid* uncompressed)
{
  LabelVolume compressed = ReadMaterials(input.CompressedLabels, result.Materials);
  if (input.CompressedOrigin)
  {
    compressed.Origin = *input.CompressedOrigin;
  }
  GlandCubes truth;
  for (const Vector3& point : GlandVoxels(compressed, result.Materials))
  {
    truth.Add(input.Truth.Placed.ToGantry(point), compressed.VoxelVolume());
  }
  LabelSource source = input.Case.Labels;
  source.SpacingMm = 0; // every voxel
  const LabelVolume rest = ReadMaterials(source, result.Materials);
  const std::vector<Vector3> points = GlandVoxels(rest, result.Materials);
  const std::vector<Vector3> moved = Displace(points, uncompressed);
  GlandCubes registered;
  GlandCubes still;
  const auto shown = [&](const Vector3& truthPoint)
  {
    const Vector3 index = compressed.ContinuousIndex(truthPoint);
    return index[0] >= -0.5 && index[0] < compressed.Size[0] - 0.5 && index[1] >= -0.5 &&
      index[1] < compressed.Size[1] - 0.5 && index[2] >= -0.5 &&
      index[2] < compressed.Size[2] - 0.5;
  };
  const auto add = [&](GlandCubes& cubes, const Vector3& gantry)
  {
    if (shown(input.Truth.Placed.Point(gantry)))
    {
      cubes.Add(gantry, rest.VoxelVolume());
    }
  };
  for (std::size_t index = 0; index < points.size(); ++index)
  {
    add(registered, result.Views.front().Registration.Placed.ToGantry(moved[index]));
    add(still, input.Truth.Placed.ToGantry(points[index]));
  }
  return { GlandCubes::Dice(registered, truth), GlandCubes::Dice(still, truth) };
}
}
