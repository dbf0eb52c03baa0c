// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Foundation/Raster.h"

#include <cmath>
#include <limits>

namespace mammoray
{
namespace
{
constexpr double NoDistance = std::numeric_limits<double>::infinity();

/// Squared distance transform of lines with `count` samples.
class LineTransform
{
public:
  LineTransform(std::size_t count, double spacing, double halfWidth)
    : Values(count)
    , Spacing(spacing)
    , HalfWidth(halfWidth)
    , Sites(2 * count)
    , Centres(2 * count)
    , Bounds(2 * count)
    , Result(count)
  {
  }

  /// Squared distances of the samples to the set in the lines' sheet; replaced by Transform.
  std::vector<double> Values;

  /// Adds the squared distances along the line. Returns false if nothing changes.
  bool Transform()
  {
    if (std::all_of(this->Values.begin(), this->Values.end(),
          [this](double value) { return value == this->Values.front(); }))
    {
      return false;
    }
    this->Last = -1;
    for (std::size_t q = 0; q < this->Values.size(); ++q)
    {
      if (this->Values[q] == NoDistance)
      {
        continue;
      }
      const auto place = static_cast<double>(q);
      this->Insert(q, place - this->HalfWidth);
      if (this->HalfWidth > 0)
      {
        this->Insert(q, place + this->HalfWidth);
      }
    }
    int piece = 0;
    for (std::size_t q = 0; q < this->Values.size(); ++q)
    {
      const auto place = static_cast<double>(q);
      while (piece < this->Last && this->Bounds[piece + 1] < place * this->Spacing)
      {
        ++piece;
      }
      const double offset = (place - this->Centres[piece]) * this->Spacing;
      const double square = offset * offset + this->Values[this->Sites[piece]];
      // Inside its own box a sample is nearer than the parabolas at the ends of the box say.
      this->Result[q] = std::min(square, this->Values[q]);
    }
    this->Values.swap(this->Result);
    return true;
  }

private:
  /// Adds the parabola of a sample to the lower envelope; centres ascend.
  void Insert(std::size_t site, double centre)
  {
    const double at = centre * this->Spacing;
    double bound = -NoDistance;
    while (this->Last >= 0)
    {
      const double before = this->Centres[this->Last] * this->Spacing;
      bound =
        (this->Values[site] + at * at - this->Values[this->Sites[this->Last]] - before * before) /
        (2 * (at - before));
      if (bound > this->Bounds[this->Last])
      {
        break;
      }
      --this->Last;
    }
    ++this->Last;
    this->Sites[this->Last] = site;
    this->Centres[this->Last] = centre;
    this->Bounds[this->Last] = this->Last == 0 ? -NoDistance : bound;
  }

  double Spacing;
  double HalfWidth;
  /// The parabolas of the envelope: their samples, their centres in samples, and the positions from
  /// which on each is the lowest.
  int Last = -1;
  std::vector<std::size_t> Sites;
  std::vector<double> Centres;
  std::vector<double> Bounds;
  std::vector<double> Result;
};

/// Runs of equal labels in rows along i, joined where their faces meet (union-find).
template <typename Label>
class Runs
{
public:
  Runs(const RasterShape& shape, const std::vector<Label>& labels)
    : RowLength(shape.Size[0])
  {
    const auto rowsPerSlice = static_cast<std::size_t>(shape.Size[1]);
    const std::size_t rows = rowsPerSlice * static_cast<std::size_t>(shape.Size[2]);
    this->FirstOfRow.reserve(rows + 1);
    for (std::size_t row = 0; row < rows; ++row)
    {
      this->FirstOfRow.push_back(this->Count());
      const Label* samples = &labels[row * static_cast<std::size_t>(this->RowLength)];
      for (int i = 0; i < this->RowLength; ++i)
      {
        if (i == 0 || samples[i] != samples[i - 1])
        {
          this->All.push_back({ i, this->Count(), samples[i] });
        }
      }
      if (row % rowsPerSlice > 0)
      {
        this->Join(row, row - 1);
      }
      if (row >= rowsPerSlice)
      {
        this->Join(row, row - rowsPerSlice);
      }
    }
  }

  std::uint32_t Count() const { return static_cast<std::uint32_t>(this->All.size()); }
  std::size_t Length(std::uint32_t run) const
  {
    return static_cast<std::size_t>(this->End(run) - this->All[run].Begin);
  }
  /// The first of the runs that are joined with this one.
  std::uint32_t Root(std::uint32_t run)
  {
    while (this->All[run].Parent != run)
    {
      this->All[run].Parent = this->All[this->All[run].Parent].Parent;
      run = this->All[run].Parent;
    }
    return run;
  }

private:
  struct Run
  {
    int Begin; // in its row
    std::uint32_t Parent;
    Label Value;
  };

  int End(std::uint32_t run) const
  {
    return run + 1 < this->Count() && this->All[run + 1].Begin > 0 ? this->All[run + 1].Begin
                                                                   : this->RowLength;
  }

  /// Joins the runs of the last row with those of an earlier one.
  void Join(std::size_t row, std::size_t earlier)
  {
    std::uint32_t a = this->FirstOfRow[row];
    std::uint32_t b = this->FirstOfRow[earlier];
    while (a < this->Count())
    {
      if (this->All[a].Value == this->All[b].Value)
      {
        const std::uint32_t rootA = this->Root(a);
        const std::uint32_t rootB = this->Root(b);
        this->All[std::max(rootA, rootB)].Parent = std::min(rootA, rootB);
      }
      const int endA = this->End(a);
      const int endB = this->End(b);
      a += endA <= endB ? 1 : 0;
      b += endB <= endA ? 1 : 0;
    }
  }

  int RowLength;
  std::vector<Run> All;
  std::vector<std::uint32_t> FirstOfRow;
};

/// Convolves the lines of a sheet except constant ones, which rounding would change. Returns false
/// if all are constant.
bool ConvolveSheet(const std::vector<float>& padded, std::size_t lanes,
  const std::vector<float>& kernel, std::vector<float>& result)
{
  std::vector<std::int32_t> constant(lanes, 1);
  for (std::size_t n = lanes; n < padded.size(); n += lanes)
  {
    for (std::size_t lane = 0; lane < lanes; ++lane)
    {
      constant[lane] &= padded[n + lane] == padded[lane] ? 1 : 0;
    }
  }
  if (std::find(constant.begin(), constant.end(), 0) == constant.end())
  {
    return false;
  }
  constexpr std::size_t block = 1024; // values that stay in the cache
  for (std::size_t begin = 0; begin < result.size(); begin += block)
  {
    const std::size_t end = std::min(result.size(), begin + block);
    std::fill(&result[begin], &result[0] + end, 0.0f);
    for (std::size_t t = 0; t < kernel.size(); ++t)
    {
      const float weight = kernel[t];
      const float* shifted = &padded[t * lanes];
      for (std::size_t n = begin; n < end; ++n)
      {
        result[n] += weight * shifted[n];
      }
    }
  }
  for (std::size_t n = 0; n < result.size(); n += lanes)
  {
    for (std::size_t lane = 0; lane < lanes; ++lane)
    {
      result[n + lane] = constant[lane] ? padded[lane] : result[n + lane];
    }
  }
  return true;
}
}

std::vector<float> DistanceToSet(const RasterShape& shape, const Vector3& spacing,
  const std::vector<unsigned char>& set, double halfWidth)
{
  constexpr float far = std::numeric_limits<float>::infinity();
  std::vector<float> squares(set.size());
  std::transform(set.begin(), set.end(), squares.begin(),
    [](unsigned char in) { return in ? 0.0f : far; });
  for (int axis = 0; axis < shape.Dimensions; ++axis)
  {
    const std::size_t stride = shape.Stride(axis);
    const auto count = static_cast<std::size_t>(shape.Size[axis]);
    const bool last = axis + 1 == shape.Dimensions;
    ParallelRanges(squares.size() / std::max<std::size_t>(count, 1), 64,
      [&](std::size_t begin, std::size_t end)
      {
        LineTransform line(count, spacing[axis], halfWidth);
        for (std::size_t n = begin; n < end; ++n)
        {
          float* first = &squares[n / stride * stride * count + n % stride];
          for (std::size_t q = 0; q < count; ++q)
          {
            line.Values[q] = first[q * stride];
          }
          const bool changed = line.Transform();
          for (std::size_t q = 0; (changed || last) && q < count; ++q)
          {
            first[q * stride] =
              static_cast<float>(last ? std::sqrt(line.Values[q]) : line.Values[q]);
          }
        }
      });
  }
  return squares;
}

template <typename Label>
RasterPieces FindPieces(const RasterShape& shape, const std::vector<Label>& labels)
{
  Runs<Label> runs(shape, labels);
  RasterPieces pieces;
  pieces.Of.resize(labels.size());
  std::vector<std::uint32_t> ids(runs.Count());
  std::size_t sample = 0;
  for (std::uint32_t run = 0; run < runs.Count(); ++run)
  {
    const std::uint32_t root = runs.Root(run);
    if (root == run)
    {
      ids[run] = static_cast<std::uint32_t>(pieces.First.size());
      pieces.First.push_back(sample);
      pieces.Size.push_back(0);
    }
    const std::size_t length = runs.Length(run);
    pieces.Size[ids[root]] += length;
    std::fill_n(pieces.Of.begin() + static_cast<std::ptrdiff_t>(sample), length, ids[root]);
    sample += length;
  }
  return pieces;
}

std::vector<bool> PiecesAtBorder(const RasterShape& shape, const RasterPieces& pieces)
{
  std::vector<bool> atBorder(pieces.First.size(), false);
  const std::array<int, 3>& size = shape.Size;
  std::size_t row = 0;
  for (int k = 0; k < size[2]; ++k)
  {
    const bool outerSlice = shape.Dimensions > 2 && (k == 0 || k + 1 == size[2]);
    for (int j = 0; j < size[1]; ++j, row += static_cast<std::size_t>(size[0]))
    {
      const bool whole = outerSlice || j == 0 || j + 1 == size[1];
      for (int i = 0; i < size[0]; i += whole ? 1 : std::max(1, size[0] - 1))
      {
        atBorder[pieces.Of[row + static_cast<std::size_t>(i)]] = true;
      }
    }
  }
  return atBorder;
}

template <typename Label>
bool KeepLargestPiece(const RasterShape& shape, std::vector<Label>& mask)
{
  const RasterPieces pieces = FindPieces(shape, mask);
  std::uint32_t largest = 0;
  std::size_t most = 0;
  for (std::uint32_t piece = 0; piece < pieces.First.size(); ++piece)
  {
    if (mask[pieces.First[piece]] && pieces.Size[piece] > most)
    {
      largest = piece;
      most = pieces.Size[piece];
    }
  }
  std::transform(pieces.Of.begin(), pieces.Of.end(), mask.begin(),
    [&](std::uint32_t piece) { return static_cast<Label>(most > 0 && piece == largest ? 1 : 0); });
  return most > 0;
}

template <typename Label>
void FillHoles(const RasterShape& shape, std::vector<Label>& mask)
{
  const RasterPieces pieces = FindPieces(shape, mask);
  const std::vector<bool> open = PiecesAtBorder(shape, pieces);
  for (std::size_t sample = 0; sample < mask.size(); ++sample)
  {
    mask[sample] = mask[sample] || !open[pieces.Of[sample]] ? 1 : 0;
  }
}

template RasterPieces FindPieces(const RasterShape&, const std::vector<unsigned char>&);
template RasterPieces FindPieces(const RasterShape&, const std::vector<std::uint16_t>&);
template bool KeepLargestPiece(const RasterShape&, std::vector<unsigned char>&);
template bool KeepLargestPiece(const RasterShape&, std::vector<std::uint16_t>&);
template void FillHoles(const RasterShape&, std::vector<unsigned char>&);
template void FillHoles(const RasterShape&, std::vector<std::uint16_t>&);

std::vector<float> GaussianKernel(double sigma, double reach)
{
  const int radius = static_cast<int>(std::ceil(reach * sigma));
  std::vector<float> kernel(static_cast<std::size_t>(2 * radius + 1), 1.0f);
  float sum = 0;
  for (int t = -radius; t <= radius && radius > 0; ++t)
  {
    kernel[t + radius] = static_cast<float>(std::exp(-0.5 * t * t / (sigma * sigma)));
    sum += kernel[t + radius];
  }
  for (float& weight : kernel)
  {
    weight /= radius > 0 ? sum : 1.0f;
  }
  return kernel;
}

void Convolve(const RasterShape& shape, const std::vector<float>& kernel,
  std::vector<float>& values)
{
  const int radius = static_cast<int>(kernel.size() / 2);
  for (int axis = 0; axis < shape.Dimensions && radius > 0; ++axis)
  {
    FilterLines(shape, axis, radius, values,
      [&](const std::vector<float>& padded, std::size_t lanes, std::vector<float>& result)
      { return ConvolveSheet(padded, lanes, kernel, result); });
  }
}
}
