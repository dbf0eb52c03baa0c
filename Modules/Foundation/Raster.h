// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Raster_h
#define mammoray_Raster_h

#include "mammoray/Foundation/ParallelFor.h"
#include "mammoray/Foundation/Volumes.h"
#include "mammorayFoundationModule.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace mammoray
{
/// Number of samples of an image or a volume along i, j and k; i is fastest in memory.
struct RasterShape
{
  std::array<int, 3> Size{ 1, 1, 1 };
  /// 2 for an image, which has no border along k; 3 for a volume.
  int Dimensions = 3;

  RasterShape(int columns, int rows)
    : Size{ columns, rows, 1 }
    , Dimensions(2)
  {
  }
  explicit RasterShape(const VolumeGrid& grid)
    : Size(grid.Size)
  {
  }
  std::size_t Stride(int axis) const
  {
    const auto row = static_cast<std::size_t>(this->Size[0]);
    return axis == 0 ? 1 : axis == 1 ? row : row * static_cast<std::size_t>(this->Size[1]);
  }
  std::size_t Count() const { return this->Stride(2) * static_cast<std::size_t>(this->Size[2]); }
  /// Calls visit(index of the neighbour, axis) for the samples that share a face with a sample.
  template <typename Visit>
  void ForEachNeighbour(std::size_t index, const Visit& visit) const
  {
    for (int axis = 0; axis < this->Dimensions; ++axis)
    {
      const std::size_t stride = this->Stride(axis);
      const auto size = static_cast<std::size_t>(this->Size[axis]);
      const std::size_t place = index / stride % size;
      if (place > 0)
      {
        visit(index - stride, axis);
      }
      if (place + 1 < size)
      {
        visit(index + stride, axis);
      }
    }
  }
};

/**
 * Euclidean distance of every sample to the nearest sample with `set`, in the unit of `spacing`; 0
 * in the set, infinite if it is empty. The transform is exact: one lower envelope of parabolas per
 * line and axis (Felzenszwalb and Huttenlocher 2012). With `halfWidth` in (0, 0.5), distances are
 * to boxes that extend this fraction of the spacing to both sides of the centres in the set.
 */
MAMMORAYFOUNDATION_EXPORT std::vector<float> DistanceToSet(const RasterShape& shape,
  const Vector3& spacing, const std::vector<unsigned char>& set, double halfWidth = 0);

/// Face-connected components of samples with equal labels, in the order of their first samples.
struct RasterPieces
{
  /// Piece of every sample.
  std::vector<std::uint32_t> Of;
  /// First sample, and number of samples, of every piece.
  std::vector<std::size_t> First;
  std::vector<std::size_t> Size;
};

/// Finds the pieces. `Label` is unsigned char or std::uint16_t.
template <typename Label>
RasterPieces FindPieces(const RasterShape& shape, const std::vector<Label>& labels);

/// True for the pieces that contain a sample at the border.
MAMMORAYFOUNDATION_EXPORT std::vector<bool> PiecesAtBorder(const RasterShape& shape,
  const RasterPieces& pieces);

/// Keeps the largest piece of a mask (1 inside, 0 outside); the first one wins a tie. Returns false
/// if the mask is empty.
template <typename Label>
bool KeepLargestPiece(const RasterShape& shape, std::vector<Label>& mask);

/// Adds to a mask (1 inside, 0 outside) all pieces outside it that do not reach the border.
template <typename Label>
void FillHoles(const RasterShape& shape, std::vector<Label>& mask);

extern template MAMMORAYFOUNDATION_EXPORT RasterPieces FindPieces(const RasterShape&,
  const std::vector<unsigned char>&);
extern template MAMMORAYFOUNDATION_EXPORT RasterPieces FindPieces(const RasterShape&,
  const std::vector<std::uint16_t>&);
extern template MAMMORAYFOUNDATION_EXPORT bool KeepLargestPiece(const RasterShape&,
  std::vector<unsigned char>&);
extern template MAMMORAYFOUNDATION_EXPORT bool KeepLargestPiece(const RasterShape&,
  std::vector<std::uint16_t>&);
extern template MAMMORAYFOUNDATION_EXPORT void FillHoles(const RasterShape&,
  std::vector<unsigned char>&);
extern template MAMMORAYFOUNDATION_EXPORT void FillHoles(const RasterShape&,
  std::vector<std::uint16_t>&);

/**
 * Filters all lines along an axis, adjacent lines together. Calls filter(padded, lanes, result) in
 * parallel: `result` has one row of `lanes` values for every sample along the axis, and `padded`
 * has `radius` more rows at either end, which repeat the end values. If the filter returns false,
 * the lines stay unchanged.
 */
template <typename Value, typename Filter>
void FilterLines(const RasterShape& shape, int axis, int radius, std::vector<Value>& values,
  const Filter& filter)
{
  constexpr std::size_t mostLanes = 256;
  const std::size_t step = shape.Stride(axis);
  const std::size_t row = axis == 0 ? 1 : shape.Stride(1);
  const std::size_t toNext = axis == 1 ? shape.Stride(2) : shape.Stride(1);
  const int count = shape.Size[axis];
  const std::size_t rows = shape.Count() / (static_cast<std::size_t>(count) * row);
  const std::size_t pieces = (row + mostLanes - 1) / mostLanes;
  ParallelRanges(rows * pieces, axis == 0 ? 16 : 1,
    [&](std::size_t begin, std::size_t end)
    {
      std::vector<Value> padded;
      std::vector<Value> result;
      for (std::size_t piece = begin; piece < end; ++piece)
      {
        const std::size_t lane = piece % pieces * mostLanes;
        const std::size_t lanes = std::min(mostLanes, row - lane);
        padded.resize(static_cast<std::size_t>(count + 2 * radius) * lanes);
        result.resize(static_cast<std::size_t>(count) * lanes);
        Value* first = &values[piece / pieces * toNext + lane];
        for (int n = 0; n < count + 2 * radius; ++n)
        {
          std::copy_n(first + std::clamp(n - radius, 0, count - 1) * step, lanes,
            &padded[n * lanes]);
        }
        const bool changed = filter(padded, lanes, result);
        for (int n = 0; changed && n < count; ++n)
        {
          std::copy_n(&result[n * lanes], lanes, first + n * step);
        }
      }
    });
}

/// A Gaussian of standard deviation `sigma`, in samples, cut off at `reach` sigma; its sum is 1.
MAMMORAYFOUNDATION_EXPORT std::vector<float> GaussianKernel(double sigma, double reach);

/**
 * Convolves the values along every axis with a kernel of odd length. Values continue beyond the
 * border; lines of one constant value stay exactly constant.
 */
MAMMORAYFOUNDATION_EXPORT void Convolve(const RasterShape& shape, const std::vector<float>& kernel,
  std::vector<float>& values);
}

#endif
