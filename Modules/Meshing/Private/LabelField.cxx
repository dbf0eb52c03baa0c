// SPDX-License-Identifier: Apache-2.0
#include "Private/LabelField.h"

#include "mammoray/Foundation/Error.h"

#include <algorithm>
#include <limits>

namespace mammoray
{
namespace
{
/// Calls line(first voxel, voxels, step) for every row of voxels along an axis.
template <typename Line>
void ForLines(const LabelVolume& volume, int axis, Line line)
{
  const std::size_t step[3] = { 1, static_cast<std::size_t>(volume.Size[0]),
    static_cast<std::size_t>(volume.Size[0]) * volume.Size[1] };
  const int u = (axis + 1) % 3;
  const int v = (axis + 2) % 3;
  for (int b = 0; b < volume.Size[v]; ++b)
  {
    for (int a = 0; a < volume.Size[u]; ++a)
    {
      line(a * step[u] + b * step[v], volume.Size[axis], step[axis]);
    }
  }
}

/// True for voxels with another label within `radius` voxels along every axis.
std::vector<char> NearInterface(const LabelVolume& volume, int radius)
{
  std::vector<std::uint16_t> low = volume.Voxels;
  std::vector<std::uint16_t> high = volume.Voxels;
  std::vector<std::uint16_t> row;
  for (int axis = 0; axis < 3; ++axis)
  {
    for (auto* values : { &low, &high })
    {
      ForLines(volume, axis,
        [&](std::size_t first, int count, std::size_t step)
        {
          row.resize(count);
          for (int n = 0; n < count; ++n)
          {
            row[n] = (*values)[first + n * step];
          }
          for (int n = 0; n < count; ++n)
          {
            const auto begin = row.begin() + std::max(0, n - radius);
            const auto end = row.begin() + std::min(count, n + radius + 1);
            (*values)[first + n * step] =
              values == &low ? *std::min_element(begin, end) : *std::max_element(begin, end);
          }
        });
    }
  }
  std::vector<char> near(volume.NumberOfVoxels());
  for (std::size_t voxel = 0; voxel < near.size(); ++voxel)
  {
    near[voxel] = low[voxel] != high[voxel];
  }
  return near;
}

void Blur(const LabelVolume& volume, const std::vector<float>& kernel, std::vector<float>& values)
{
  const int radius = static_cast<int>(kernel.size() / 2);
  std::vector<float> row;
  for (int axis = 0; axis < 3 && radius > 0; ++axis)
  {
    ForLines(volume, axis,
      [&](std::size_t first, int count, std::size_t step)
      {
        // The ends are continued: only their margin of air is there.
        row.resize(count + 2 * radius);
        bool constant = true;
        for (int n = 0; n < count + 2 * radius; ++n)
        {
          row[n] = values[first + std::clamp(n - radius, 0, count - 1) * step];
          constant = constant && row[n] == row[0];
        }
        for (int n = 0; n < count && !constant; ++n)
        {
          float sum = 0;
          for (int t = 0; t <= 2 * radius; ++t)
          {
            sum += kernel[t] * row[n + t];
          }
          values[first + n * step] = sum;
        }
      });
  }
}
}

LabelField::LabelField(const LabelVolume& volume, double smoothingVoxels)
  : Volume(volume)
{
  const int radius = static_cast<int>(std::ceil(2.5 * smoothingVoxels));
  std::vector<float> kernel(2 * radius + 1, 1.0f);
  float sum = 0;
  for (int t = -radius; t <= radius && radius > 0; ++t)
  {
    kernel[t + radius] =
      static_cast<float>(std::exp(-0.5 * t * t / (smoothingVoxels * smoothingVoxels)));
    sum += kernel[t + radius];
  }
  for (float& weight : kernel)
  {
    weight /= radius > 0 ? sum : 1.0f;
  }

  std::vector<std::int32_t> place(65536, 0);
  for (const auto& [material, count] : volume.CountLabels())
  {
    place[material] = static_cast<std::int32_t>(this->Materials.size());
    this->Materials.push_back(material);
  }
  const std::size_t columns = this->Materials.size();
  // At least 1: where all eight voxels around a point are far from others, no weights are needed.
  const std::vector<char> near = NearInterface(volume, std::max(1, radius));
  this->Row.resize(volume.NumberOfVoxels());
  std::size_t rows = 0;
  for (std::size_t voxel = 0; voxel < near.size(); ++voxel)
  {
    this->Row[voxel] =
      near[voxel] ? static_cast<std::int32_t>(rows++) : -1 - place[volume.Voxels[voxel]];
  }
  if (rows + columns > static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max()))
  {
    throw InputError("volume to mesh: expected fewer voxels at interfaces; resample it coarser");
  }
  this->Weights.assign((rows + columns) * columns, 0.0f);
  this->FirstUnitRow = static_cast<std::int32_t>(rows);
  for (std::size_t column = 0; column < columns; ++column)
  {
    this->Weights[(rows + column) * columns + column] = 1.0f;
  }
  std::vector<float> indicator(volume.NumberOfVoxels());
  for (std::size_t column = 0; column < columns; ++column)
  {
    for (std::size_t voxel = 0; voxel < indicator.size(); ++voxel)
    {
      indicator[voxel] = volume.Voxels[voxel] == this->Materials[column] ? 1.0f : 0.0f;
    }
    Blur(volume, kernel, indicator);
    for (std::size_t voxel = 0; voxel < indicator.size(); ++voxel)
    {
      if (this->Row[voxel] >= 0)
      {
        this->Weights[this->Row[voxel] * columns + column] = indicator[voxel];
      }
    }
  }
  indicator = {};
  this->Balance(place);
}

void LabelField::Balance(const std::vector<std::int32_t>& place)
{
  const std::size_t columns = this->Materials.size();
  const Vector3& spacing = this->Volume.Spacing;
  const std::vector<float> blurred = this->Weights;
  std::vector<double> voxelCount(columns, 0.0);
  std::vector<double> surface(columns, 1.0);
  std::vector<std::array<int, 3>> samples;
  for (int k = 1; k + 1 < this->Volume.Size[2]; ++k)
  {
    for (int j = 1; j + 1 < this->Volume.Size[1]; ++j)
    {
      for (int i = 1; i + 1 < this->Volume.Size[0]; ++i)
      {
        const std::size_t voxel = this->Volume.Index(i, j, k);
        if (this->Row[voxel] >= 0)
        {
          samples.push_back({ i, j, k });
          const std::int32_t own = place[this->Volume.Voxels[voxel]];
          voxelCount[own] += 1;
          surface[own] += this->Volume.Voxels[voxel] != this->Volume.Voxels[voxel - 1];
          surface[own] += this->Volume.Voxels[voxel] != this->Volume.Voxels[voxel + 1];
        }
      }
    }
  }
  std::vector<double> bias(columns, 0.0);
  const int rounds = 5;
  for (int round = 0;; ++round)
  {
    for (const std::array<int, 3>& sample : samples)
    {
      const std::size_t voxel = this->Volume.Index(sample[0], sample[1], sample[2]);
      const std::size_t row = this->Row[voxel] * columns;
      float* weights = &this->Weights[row];
      for (std::size_t column = 0; column < columns; ++column)
      {
        weights[column] = blurred[row + column] + static_cast<float>(bias[column]);
      }
      // Where another material won, the own one now wins by as much; by 0.02, not by rounding,
      // elsewhere.
      float& own = weights[place[this->Volume.Voxels[voxel]]];
      const float largest = *std::max_element(weights, weights + columns);
      own = largest + std::max(0.02f, largest - own);
    }
    if (round == rounds)
    {
      return;
    }
    // Volumes by one point per voxel, spread over the voxels by three irrational steps.
    std::vector<double> count(columns, 0.0);
    double spread[3] = { 0.5, 0.5, 0.5 };
    constexpr double step[3] = { 0.8191725133961645, 0.6710436067037893, 0.5497004779019703 };
    for (const std::array<int, 3>& sample : samples)
    {
      for (int a = 0; a < 3; ++a)
      {
        spread[a] += step[a];
        spread[a] -= std::floor(spread[a]);
      }
      count[place[this->MaterialAt((sample[0] + spread[0] - 0.5) * spacing[0],
        (sample[1] + spread[1] - 0.5) * spacing[1], (sample[2] + spread[2] - 0.5) * spacing[2])]] +=
        1;
    }
    for (std::size_t column = 0; column < columns; ++column)
    {
      // About three times the faces seen along one axis; weights change by about 0.3 per voxel
      // there.
      const double change = 0.3 * (voxelCount[column] - count[column]) / (3 * surface[column]);
      bias[column] = std::clamp(bias[column] + change, -0.3, 0.3);
    }
  }
}

int LabelField::MaterialAt(double x, double y, double z) const
{
  const double position[3] = { x / this->Volume.Spacing[0], y / this->Volume.Spacing[1],
    z / this->Volume.Spacing[2] };
  int index[3];
  float fraction[3];
  for (int a = 0; a < 3; ++a)
  {
    if (!(position[a] >= 0 && position[a] <= this->Volume.Size[a] - 1))
    {
      return 0;
    }
    index[a] = std::min(static_cast<int>(position[a]), this->Volume.Size[a] - 2);
    fraction[a] = static_cast<float>(position[a] - index[a]);
  }
  std::int32_t rows[8];
  bool pure = true;
  for (int corner = 0; corner < 8; ++corner)
  {
    rows[corner] = this->Row[this->Volume.Index(index[0] + (corner & 1),
      index[1] + (corner >> 1 & 1), index[2] + (corner >> 2))];
    pure = pure && rows[corner] < 0 && rows[corner] == rows[0];
  }
  if (pure)
  {
    return this->Materials[-1 - rows[0]];
  }
  return this->Blend(rows, fraction);
}

int LabelField::Blend(const std::int32_t (&rows)[8], const float (&fraction)[3]) const
{
  const std::size_t columns = this->Materials.size();
  float shares[8];
  const float* weights[8];
  for (int corner = 0; corner < 8; ++corner)
  {
    shares[corner] = ((corner & 1) ? fraction[0] : 1 - fraction[0]) *
      ((corner & 2) ? fraction[1] : 1 - fraction[1]) *
      ((corner & 4) ? fraction[2] : 1 - fraction[2]);
    const std::int32_t row =
      rows[corner] >= 0 ? rows[corner] : this->FirstUnitRow - 1 - rows[corner];
    weights[corner] = &this->Weights[static_cast<std::size_t>(row) * columns];
  }
  float best = -1;
  int material = 0;
  constexpr std::size_t block = 16; // sums that stay in registers
  for (std::size_t begin = 0; begin < columns; begin += block)
  {
    const std::size_t count = std::min(block, columns - begin);
    float sums[block] = {};
    for (int corner = 0; corner < 8; ++corner)
    {
      for (std::size_t column = 0; column < count; ++column)
      {
        sums[column] += shares[corner] * weights[corner][begin + column];
      }
    }
    for (std::size_t column = 0; column < count; ++column)
    {
      if (sums[column] > best)
      {
        best = sums[column];
        material = this->Materials[begin + column];
      }
    }
  }
  return material;
}
}
