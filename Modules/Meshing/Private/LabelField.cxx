// SPDX-License-Identifier: Apache-2.0
#include "Private/LabelField.h"

#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/Raster.h"

#include <algorithm>
#include <limits>

namespace mammoray
{
namespace
{
/// True for voxels with another label within `radius` voxels along every axis.
std::vector<char> NearInterface(const LabelVolume& volume, int radius)
{
  std::vector<std::uint16_t> low = volume.Voxels;
  std::vector<std::uint16_t> high = volume.Voxels;
  const auto fold = [=](auto choose)
  {
    return [=](const std::vector<std::uint16_t>& padded, std::size_t lanes,
             std::vector<std::uint16_t>& result)
    {
      std::copy_n(padded.begin(), result.size(), result.begin());
      for (int t = 1; t <= 2 * radius; ++t)
      {
        const std::uint16_t* shifted = &padded[t * lanes];
        for (std::size_t n = 0; n < result.size(); ++n)
        {
          result[n] = choose(result[n], shifted[n]);
        }
      }
      return true;
    };
  };
  for (int axis = 0; axis < 3; ++axis)
  {
    FilterLines(RasterShape(volume), axis, radius, low,
      fold([](std::uint16_t a, std::uint16_t b) { return std::min(a, b); }));
    FilterLines(RasterShape(volume), axis, radius, high,
      fold([](std::uint16_t a, std::uint16_t b) { return std::max(a, b); }));
  }
  std::vector<char> near(volume.NumberOfVoxels());
  for (std::size_t voxel = 0; voxel < near.size(); ++voxel)
  {
    near[voxel] = low[voxel] != high[voxel];
  }
  return near;
}
}

LabelField::LabelField(const LabelVolume& volume, double smoothingVoxels)
  : Volume(volume)
{
  const std::vector<float> kernel = GaussianKernel(smoothingVoxels, 2.5);
  std::vector<std::int32_t> place(65536, 0);
  for (const auto& [material, count] : volume.CountLabels())
  {
    place[material] = static_cast<std::int32_t>(this->Materials.size());
    this->Materials.push_back(material);
  }
  const std::size_t columns = this->Materials.size();
  // Between eight voxels of one material no weights are needed.
  const std::vector<char> touching = NearInterface(volume, 1);
  this->Row.resize(volume.NumberOfVoxels());
  std::size_t rows = 0;
  for (std::size_t voxel = 0; voxel < touching.size(); ++voxel)
  {
    this->Row[voxel] = touching[voxel] ? static_cast<std::int32_t>(rows++) : -1;
  }
  if (rows > static_cast<std::size_t>(std::numeric_limits<std::int32_t>::max()))
  {
    throw InputError("volume to mesh: expected fewer voxels at interfaces; resample it coarser");
  }
  this->Weights.assign(rows * columns + Lanes, 0.0f);
  std::vector<float> indicator(volume.NumberOfVoxels());
  for (std::size_t column = 0; column < columns; ++column)
  {
    for (std::size_t voxel = 0; voxel < indicator.size(); ++voxel)
    {
      indicator[voxel] = volume.Voxels[voxel] == this->Materials[column] ? 1.0f : 0.0f;
    }
    // Only the margin of air continues beyond the border.
    Convolve(RasterShape(volume), kernel, indicator);
    for (std::size_t voxel = 0; voxel < indicator.size(); ++voxel)
    {
      if (this->Row[voxel] >= 0)
      {
        this->Weights[this->Row[voxel] * columns + column] = indicator[voxel];
      }
    }
  }
  indicator = {};
  this->Balance(place, NearInterface(volume, std::max(1, static_cast<int>(kernel.size() / 2))));
}

std::vector<LabelField::Sample> LabelField::Samples(const std::vector<char>& near) const
{
  std::vector<Sample> samples;
  const Vector3& spacing = this->Volume.Spacing;
  Vector3 spread{ 0.5, 0.5, 0.5 };
  constexpr Vector3 step{ 0.8191725133961645, 0.6710436067037893, 0.5497004779019703 };
  for (int k = 1; k + 1 < this->Volume.Size[2]; ++k)
  {
    for (int j = 1; j + 1 < this->Volume.Size[1]; ++j)
    {
      for (int i = 1; i + 1 < this->Volume.Size[0]; ++i)
      {
        const std::size_t voxel = this->Volume.Index(i, j, k);
        if (!near[voxel])
        {
          continue;
        }
        for (int a = 0; a < 3; ++a)
        {
          spread[a] += step[a]; // of two numbers below 1
          spread[a] -= spread[a] >= 1 ? 1 : 0;
        }
        if (this->Row[voxel] >= 0)
        {
          samples.push_back({ voxel,
            { (i + spread[0] - 0.5) * spacing[0], (j + spread[1] - 0.5) * spacing[1],
              (k + spread[2] - 0.5) * spacing[2] } });
        }
      }
    }
  }
  return samples;
}

void LabelField::Balance(const std::vector<std::int32_t>& place, const std::vector<char>& near)
{
  const std::size_t columns = this->Materials.size();
  const std::vector<std::uint16_t>& labels = this->Volume.Voxels;
  const std::vector<float> blurred = this->Weights;
  const std::vector<Sample> samples = this->Samples(near);
  std::vector<double> voxelCount(columns, 0.0);
  std::vector<double> surface(columns, 1.0);
  for (const Sample& sample : samples)
  {
    const std::uint16_t label = labels[sample.Voxel];
    voxelCount[place[label]] += 1;
    surface[place[label]] += label != labels[sample.Voxel - 1];
    surface[place[label]] += label != labels[sample.Voxel + 1];
  }
  std::vector<double> bias(columns, 0.0);
  const int rounds = 5;
  for (int round = 0;; ++round)
  {
    for (const Sample& sample : samples)
    {
      const std::size_t row = this->Row[sample.Voxel] * columns;
      float* weights = &this->Weights[row];
      for (std::size_t column = 0; column < columns; ++column)
      {
        weights[column] = blurred[row + column] + static_cast<float>(bias[column]);
      }
      // Where another material wins, the own one shall win by the same amount; elsewhere by 0.02,
      // so that rounding does not decide.
      float& own = weights[place[labels[sample.Voxel]]];
      const float largest = *std::max_element(weights, weights + columns);
      own = largest + std::max(0.02f, largest - own);
    }
    if (round == rounds)
    {
      return;
    }
    std::vector<double> count(columns, 0.0);
    for (const Sample& sample : samples)
    {
      count[place[this->MaterialAt(sample.Point[0], sample.Point[1], sample.Point[2])]] += 1;
    }
    for (std::size_t column = 0; column < columns; ++column)
    {
      // The surface is about three times the number of faces seen along one axis, where weights
      // change by about 0.3 per voxel.
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
  const std::size_t first = this->Volume.Index(index[0], index[1], index[2]);
  const std::size_t row = this->Volume.Size[0];
  const std::size_t slice = row * this->Volume.Size[1];
  const std::size_t corners[4] = { first, first + row, first + slice, first + slice + row };
  // A material that fills all eight voxels wins at each of them and so between them.
  const std::uint16_t label = this->Volume.Voxels[first];
  unsigned differences = 0;
  for (const std::size_t corner : corners)
  {
    const std::uint16_t* pair = &this->Volume.Voxels[corner];
    __builtin_prefetch(&this->Row[corner]); // far away; most often it is wanted
    differences |= (pair[0] ^ label) | (pair[1] ^ label);
  }
  return differences == 0 ? label : this->Blend(corners, fraction);
}

int LabelField::Blend(const std::size_t (&corners)[4], const float (&fraction)[3]) const
{
  const std::size_t columns = this->Materials.size();
  float shares[8];
  const float* weights[8];
  for (int corner = 0; corner < 8; ++corner)
  {
    shares[corner] = ((corner & 1) ? fraction[0] : 1 - fraction[0]) *
      ((corner & 2) ? fraction[1] : 1 - fraction[1]) *
      ((corner & 4) ? fraction[2] : 1 - fraction[2]);
    const auto row = static_cast<std::size_t>(this->Row[corners[corner >> 1] + (corner & 1)]);
    weights[corner] = &this->Weights[row * columns];
  }
  float best = -1;
  int material = 0;
  for (std::size_t begin = 0; begin < columns; begin += Lanes)
  {
    float sums[Lanes] = {};
    for (int corner = 0; corner < 8; ++corner)
    {
      for (std::size_t lane = 0; lane < Lanes; ++lane)
      {
        sums[lane] += shares[corner] * weights[corner][begin + lane];
      }
    }
    for (std::size_t lane = 0; lane < std::min(Lanes, columns - begin); ++lane)
    {
      if (sums[lane] > best)
      {
        best = sums[lane];
        material = this->Materials[begin + lane];
      }
    }
  }
  return material;
}
}
