// SPDX-License-Identifier: Apache-2.0
#include "Private/ChestWall.h"

#include "Private/Masks.h"
#include "Private/Plate.h"
#include "Private/Thresholds.h"

#include <algorithm>
#include <cmath>

namespace mammoray
{
namespace
{
/// Lengths in front of and behind a height over which intensities are averaged, mm. They are less
/// than the thinnest muscle over the ribs and the thinnest fat over the sternum that can be
/// distinguished.
constexpr double WindowMm = 6.0;
/// Skin (at most 3 mm) and one blurred voxel lie in front of every chest wall, mm.
constexpr double SkinMm = 4.0;
/// Smallest thickness of skin and fat in front of the chest wall over sternum and sides, mm, and
/// the cost of less.
constexpr float ThinnestMm = 8.0f;
constexpr double ThinPrice = 0.15;
/// A stiff sheet that lies in front of the skin by half of this has left the body, mm.
constexpr float LeavingMm = 16.0f;
/// Larger steps of the logarithm do not improve the quality; fat to muscle is 0.3 (suppressed) to
/// 1.
constexpr double LargestLogStep = 0.4;
/// Voxels and reach of the mean that is taken for the coil's sensitivity, mm.
constexpr double CoilVoxelMm = 4.0;
constexpr double CoilReachMm = 30.0;
/// Gain of a full step from fat to other tissue, and cost of fat all along FatBehindMm behind the
/// front.
constexpr double FatStepWorth = 0.5;
constexpr double FatBehindPrice = 0.4;
constexpr std::array<double, 2> FatBehindMm{ 8.0, 26.0 };
/// Thickness of body in front of the chest wall that counts as breast, mm.
constexpr float BreastMm = 30.0f;
/// Cost of a height per mm behind the skin, up to 100 mm: of two equal steps the front one is
/// chosen, which is muscle and not heart or liver.
constexpr double PricePerMm = 0.0015;
constexpr double DeepestMm = 100.0;
/// Cost of a slope of 1 between neighbours; it grows with the square of the slope up to 3.
constexpr double SlopePrice = 0.05;
constexpr int LargestSlope = 3;
/// Wavelengths of the plates for the thorax and for its muscles, mm.
constexpr double StiffMm = 220.0;
constexpr double SheetMm = 20.0;

HeightMap::Pointer MakeHeightMap(const itk::ImageBase<3>& image)
{
  auto map = HeightMap::New();
  const std::array<int, 3> size = SizeOf(image);
  HeightMap::SizeType mapSize;
  HeightMap::SpacingType spacing;
  HeightMap::PointType origin;
  for (unsigned c = 0; c < 2; ++c)
  {
    mapSize[c] = static_cast<itk::SizeValueType>(size[2 * c]);
    spacing[c] = image.GetSpacing()[2 * c];
    origin[c] = image.GetOrigin()[2 * c];
  }
  map->SetRegions(mapSize);
  map->SetSpacing(spacing);
  map->SetOrigin(origin);
  map->Allocate();
  map->FillBuffer(-1.0f);
  return map;
}

/// Costs with y fastest: cost of the height y (the lower face of voxel y) in column x + z * sizeX.
struct WallCosts
{
  int Heights;
  std::vector<float> Values;
  const float* Column(std::size_t column) const
  {
    return this->Values.data() + column * static_cast<std::size_t>(this->Heights);
  }
  float* Column(std::size_t column)
  {
    return this->Values.data() + column * static_cast<std::size_t>(this->Heights);
  }
};

class WallSearch
{
public:
  explicit WallSearch(const MaskImage* body)
    : Size(SizeOf(*body))
    , StepMm(body->GetSpacing()[1])
    , Skin(FrontOf(body))
  {
    const std::size_t columns = static_cast<std::size_t>(this->Size[0]) * this->Size[2];
    this->Fit.Heights = this->Size[1];
    this->Fit.Values.assign(columns * static_cast<std::size_t>(this->Size[1]), 0.0f);
    this->Costs = this->Fit;
  }

  ChestWallSheet FindByLogarithms(const std::vector<FloatImage::Pointer>& channels,
    const MaskImage* tissue)
  {
    for (const FloatImage::Pointer& channel : channels)
    {
      this->AddSteps(channel, 1.0 / static_cast<double>(channels.size()));
    }
    this->Forbid(tissue);
    this->MakeCosts(
      [](float step) { return std::clamp<double>(step, -LargestLogStep, LargestLogStep); });
    const HeightMap::Pointer flat = this->StiffPlate(this->Cheapest(this->Costs));
    return this->FitNear(this->ThoraxPlate(this->CheapestNear(flat)));
  }

  ChestWallSheet FindByFatness(const std::vector<FloatImage::Pointer>& channels,
    const MaskImage* tissue, const HeightMap* near)
  {
    for (const FloatImage::Pointer& channel : channels)
    {
      this->AddSteps(channel, 1.0 / static_cast<double>(channels.size()));
    }
    this->Forbid(tissue);
    this->MakeCosts([](float step) { return FatStepWorth * step; });
    for (const FloatImage::Pointer& channel : channels)
    {
      this->AddFatBehind(channel, FatBehindPrice / static_cast<double>(channels.size()));
    }
    WallCosts costs = this->Costs;
    this->Attract(costs, near);
    return this->FitNear(this->ThoraxPlate(this->Cheapest(costs)));
  }

private:
  std::size_t Column(int x, int z) const
  {
    return static_cast<std::size_t>(z) * this->Size[0] + static_cast<std::size_t>(x);
  }

  /// Adds `share` times the mean in front minus the mean behind.
  void AddSteps(const FloatImage* channel, double share)
  {
    const int window = std::max(1, static_cast<int>(std::lround(WindowMm / this->StepMm)));
    std::vector<double> sums(static_cast<std::size_t>(this->Size[1]) + 1);
    for (int z = 0; z < this->Size[2]; ++z)
    {
      for (int x = 0; x < this->Size[0]; ++x)
      {
        for (int y = 0; y < this->Size[1]; ++y)
        {
          sums[static_cast<std::size_t>(y) + 1] =
            sums[static_cast<std::size_t>(y)] + channel->GetPixel({ { x, y, z } });
        }
        float* fit = this->Fit.Column(this->Column(x, z));
        // At the volume's ends the windows are shorter.
        for (int y = 1; y < this->Size[1]; ++y)
        {
          const int low = std::max(0, y - window);
          const int high = std::min(this->Size[1], y + window);
          const double front =
            sums[static_cast<std::size_t>(high)] - sums[static_cast<std::size_t>(y)];
          const double behind =
            sums[static_cast<std::size_t>(y)] - sums[static_cast<std::size_t>(low)];
          fit[y] += static_cast<float>(share * (front / (high - y) - behind / (y - low)));
        }
      }
    }
  }

  /// Excludes heights next to the skin, at the volume's ends and in front of air.
  void Forbid(const MaskImage* tissue)
  {
    const int window = std::max(1, static_cast<int>(std::lround(WindowMm / this->StepMm)));
    for (int z = 0; z < this->Size[2]; ++z)
    {
      for (int x = 0; x < this->Size[0]; ++x)
      {
        float* fit = this->Fit.Column(this->Column(x, z));
        for (int y = 0; y < this->Size[1]; ++y)
        {
          int filled = 0;
          for (int behind = std::max(0, y - window); behind < y; ++behind)
          {
            filled += tissue->GetPixel({ { x, behind, z } }) ? 1 : 0;
          }
          if (2 * filled <= std::min(window, y) || this->DepthMm(x, z, y) < SkinMm)
          {
            fit[y] = None;
          }
        }
      }
    }
  }

  double DepthMm(int x, int z, int y) const
  {
    return this->Skin->GetPixel({ { x, z } }) - y * this->StepMm;
  }

  /// Computes costs from `worth` of the step at each height.
  template <typename Worth>
  void MakeCosts(Worth worth)
  {
    for (int z = 0; z < this->Size[2]; ++z)
    {
      for (int x = 0; x < this->Size[0]; ++x)
      {
        const float* fit = this->Fit.Column(this->Column(x, z));
        float* cost = this->Costs.Column(this->Column(x, z));
        const bool hasBody = this->Skin->GetPixel({ { x, z } }) > 0;
        for (int y = 0; hasBody && y < this->Size[1]; ++y)
        {
          const double depth = this->DepthMm(x, z, y);
          const double thin = std::clamp((ThinnestMm - depth) / (ThinnestMm - SkinMm), 0.0, 1.0);
          cost[y] = static_cast<float>((depth < SkinMm ? 0.3 : ThinPrice * thin) -
            (fit[y] == None ? 0.0 : worth(fit[y])) +
            PricePerMm * std::clamp(depth, 0.0, DeepestMm));
        }
      }
    }
  }

  void AddFatBehind(const FloatImage* fatness, double price)
  {
    const int nearest = static_cast<int>(std::lround(FatBehindMm[0] / this->StepMm));
    const int farthest = static_cast<int>(std::lround(FatBehindMm[1] / this->StepMm));
    for (int z = 0; z < this->Size[2]; ++z)
    {
      for (int x = 0; x < this->Size[0]; ++x)
      {
        float* cost = this->Costs.Column(this->Column(x, z));
        for (int y = 0; y < this->Size[1]; ++y)
        {
          double sum = 0;
          for (int behind = std::max(0, y - farthest); behind < y - nearest; ++behind)
          {
            sum += fatness->GetPixel({ { x, behind, z } });
          }
          cost[y] += static_cast<float>(price * sum / (farthest - nearest));
        }
      }
    }
  }

  HeightMap::Pointer StiffPlate(const HeightMap* heights) const
  {
    return FitRobustPlate(heights, this->Weights(heights, 0.0f), StiffMm, { 50, 30, 20 });
  }

  /// A plate through heights near a flat one that keeps falling where the thorax recedes at the
  /// sides: small steps there (suppressed fat) lie more than 20 mm behind a flat plate.
  HeightMap::Pointer ThoraxPlate(const HeightMap* heights) const
  {
    return FitRobustPlate(heights, this->Weights(heights, 0.0f), StiffMm, { 20, 15 },
      PlateShape::Paraboloid);
  }

  HeightMap::Pointer CheapestNear(const HeightMap* sheet) const
  {
    WallCosts costs = this->Costs;
    this->Attract(costs, sheet);
    return this->Cheapest(costs);
  }

  ChestWallSheet FitNear(const HeightMap::Pointer& stiff) const
  {
    const HeightMap::Pointer heights = this->CheapestNear(stiff);
    ChestWallSheet sheet;
    sheet.Stiff = stiff;
    sheet.Front = FitRobustPlate(heights, this->Weights(heights, 0.02f), SheetMm, { 15, 8 });
    this->MeasureSteps(sheet);
    return sheet;
  }

  /// Adds a cost for the distance from the sheet: 0.3 at 20 mm, at most 2. Where the stiff sheet
  /// leaves the body that recedes at the sides, the cost decreases.
  void Attract(WallCosts& costs, const HeightMap* sheet) const
  {
    for (int z = 0; z < this->Size[2]; ++z)
    {
      for (int x = 0; x < this->Size[0]; ++x)
      {
        float* cost = costs.Column(this->Column(x, z));
        const float skin = this->Skin->GetPixel({ { x, z } });
        const float height = sheet->GetPixel({ { x, z } });
        const float near = skin > 0 ? std::min(height, skin - ThinnestMm) : height;
        const double trust = std::max(0.0f, 1 - (height - near) / LeavingMm);
        for (int y = 0; y < this->Size[1]; ++y)
        {
          const double away = (y * this->StepMm - near) / 20;
          cost[y] += static_cast<float>(trust * std::min(2.0, 0.3 * away * away));
        }
      }
    }
  }

  /// Adds the least cost of paths that end in each height, along a line of columns.
  void Aggregate(const WallCosts& costs, WallCosts& total, std::size_t first, std::ptrdiff_t stride,
    int length) const
  {
    const auto heights = static_cast<std::size_t>(costs.Heights);
    std::vector<float> last(heights, 0.0f);
    std::vector<float> now(heights);
    for (int n = 0; n < length; ++n)
    {
      const auto column = static_cast<std::size_t>(static_cast<std::ptrdiff_t>(first) + n * stride);
      const float* cost = costs.Column(column);
      const float least = *std::min_element(last.begin(), last.end());
      const float jump =
        least + static_cast<float>(2 * SlopePrice * (LargestSlope + 1) * (LargestSlope + 1));
      for (std::size_t y = 0; y < heights; ++y)
      {
        float best = std::min(jump, last[y]);
        for (std::size_t slope = 1; slope <= LargestSlope; ++slope)
        {
          const float price = static_cast<float>(SlopePrice) * static_cast<float>(slope * slope);
          best = y >= slope ? std::min(best, last[y - slope] + price) : best;
          best = y + slope < heights ? std::min(best, last[y + slope] + price) : best;
        }
        now[y] = cost[y] + best - least;
      }
      float* sum = total.Column(column);
      for (std::size_t y = 0; y < heights; ++y)
      {
        sum[y] += now[y];
      }
      last.swap(now);
    }
  }

  HeightMap::Pointer Cheapest(const WallCosts& costs) const
  {
    const int columns = this->Size[0];
    const int rows = this->Size[2];
    WallCosts total{ costs.Heights, std::vector<float>(costs.Values.size(), 0.0f) };
    for (int z = 0; z < rows; ++z)
    {
      this->Aggregate(costs, total, this->Column(0, z), 1, columns);
      this->Aggregate(costs, total, this->Column(columns - 1, z), -1, columns);
    }
    for (int x = 0; x < columns; ++x)
    {
      this->Aggregate(costs, total, this->Column(x, 0), columns, rows);
      this->Aggregate(costs, total, this->Column(x, rows - 1), -columns, rows);
    }
    return MakeFrom<HeightMap>(*this->Skin,
      [&](std::size_t column)
      {
        // Each direction has counted the column's own cost.
        float* sum = total.Column(column);
        const float* own = costs.Column(column);
        int best = 0;
        for (int y = 0; y < costs.Heights; ++y)
        {
          sum[y] -= 3 * own[y];
          best = sum[y] < sum[best] ? y : best;
        }
        return best * this->StepMm;
      });
  }

  float StepAt(std::size_t column, double heightMm) const
  {
    const int y =
      std::clamp(static_cast<int>(std::lround(heightMm / this->StepMm)), 0, this->Fit.Heights - 1);
    const float step = this->Fit.Column(column)[y];
    return step == None ? 0.0f : std::max(0.0f, step);
  }

  /// Confidence of each height: the square of the step as a fraction of 0.5.
  HeightMap::Pointer Weights(const HeightMap* heights, float least) const
  {
    return MakeFrom<HeightMap>(*heights,
      [&](std::size_t column)
      {
        const float step =
          std::min(1.0f, 2 * this->StepAt(column, heights->GetBufferPointer()[column]));
        return this->Skin->GetBufferPointer()[column] > 0 ? std::max(least, step * step) : 0.0f;
      });
  }

  void MeasureSteps(ChestWallSheet& sheet) const
  {
    std::vector<float> steps;
    sheet.Steps = MakeFrom<HeightMap>(*sheet.Front,
      [&](std::size_t column)
      {
        const float height = sheet.Front->GetBufferPointer()[column];
        const float step = this->StepAt(column, height);
        if (this->Skin->GetBufferPointer()[column] > height + BreastMm)
        {
          steps.push_back(step);
        }
        return step;
      });
    sheet.Step = steps.empty() ? 0.0 : Quantile(steps, 0.5);
    sheet.LargeStep = steps.empty() ? 0.0 : Quantile(steps, 0.9);
  }

  static constexpr float None = -1e9f;
  std::array<int, 3> Size;
  double StepMm;
  HeightMap::Pointer Skin;
  /// Step at every height; None where no chest wall is possible.
  WallCosts Fit;
  /// Costs of the heights without a sheet.
  WallCosts Costs;
};

/// The Gaussian mean of sums over the voxels that are inside.
FloatImage::Pointer MeanInside(const FloatImage* sums, const FloatImage* inside, double sigmaMm)
{
  const FloatImage::Pointer sum = GaussianMean<FloatImage>(sums, sigmaMm);
  const FloatImage::Pointer share = GaussianMean<FloatImage>(inside, sigmaMm);
  return MakeFrom<FloatImage>(*sums,
    [&](std::size_t n)
    { return sum->GetBufferPointer()[n] / std::max(1e-3f, share->GetBufferPointer()[n]); });
}
}

MaskImage::Pointer BeforeSheet(const MaskImage* body, const ChestWallSheet& sheet, double apartMm,
  double cutMm)
{
  MaskImage::Pointer before = Complement(Dilate(Complement(body), apartMm));
  const std::array<int, 3> size = SizeOf(*before);
  for (int z = 0; z < size[2]; ++z)
  {
    for (int x = 0; x < size[0]; ++x)
    {
      const double wallMm = sheet.Front->GetPixel({ { x, z } });
      for (int y = 0; y < size[1]; ++y)
      {
        const double heightMm = (y + 0.5) * before->GetSpacing()[1];
        if (heightMm < wallMm + apartMm || heightMm < cutMm)
        {
          before->SetPixel({ { x, y, z } }, 0);
        }
      }
    }
  }
  return before;
}

HeightMap::Pointer FrontOf(const MaskImage* mask)
{
  HeightMap::Pointer front = MakeHeightMap(*mask);
  const std::array<int, 3> size = SizeOf(*mask);
  for (int z = 0; z < size[2]; ++z)
  {
    for (int x = 0; x < size[0]; ++x)
    {
      for (int y = size[1] - 1; y >= 0; --y)
      {
        if (mask->GetPixel({ { x, y, z } }))
        {
          front->SetPixel({ { x, z } }, static_cast<float>((y + 1) * mask->GetSpacing()[1]));
          break;
        }
      }
    }
  }
  return front;
}

HeightMap::Pointer HeightsOver(const HeightMap* map, const itk::ImageBase<3>& image)
{
  HeightMap::Pointer over = MakeHeightMap(image);
  const auto size = map->GetLargestPossibleRegion().GetSize();
  const auto overSize = over->GetLargestPossibleRegion().GetSize();
  const auto place = [&](std::size_t n, unsigned c, itk::IndexValueType& first, float& share)
  {
    const double at = std::clamp(
      (static_cast<double>(n) + 0.5) * over->GetSpacing()[c] / map->GetSpacing()[c] - 0.5, 0.0,
      static_cast<double>(size[c] - 1));
    first = std::min(static_cast<itk::IndexValueType>(at),
      std::max<itk::IndexValueType>(0, static_cast<itk::IndexValueType>(size[c]) - 2));
    share = static_cast<float>(at - static_cast<double>(first));
  };
  for (std::size_t z = 0; z < overSize[1]; ++z)
  {
    itk::IndexValueType k = 0;
    float w = 0;
    place(z, 1, k, w);
    for (std::size_t x = 0; x < overSize[0]; ++x)
    {
      itk::IndexValueType i = 0;
      float u = 0;
      place(x, 0, i, u);
      const itk::IndexValueType i1 = u > 0 ? i + 1 : i;
      const itk::IndexValueType k1 = w > 0 ? k + 1 : k;
      over->SetPixel(
        { { static_cast<itk::IndexValueType>(x), static_cast<itk::IndexValueType>(z) } },
        (1 - w) * ((1 - u) * map->GetPixel({ { i, k } }) + u * map->GetPixel({ { i1, k } })) +
          w * ((1 - u) * map->GetPixel({ { i, k1 } }) + u * map->GetPixel({ { i1, k1 } })));
    }
  }
  return over;
}

std::vector<float> BehindSheet(const FloatImage* image, const MaskImage* tissue,
  const HeightMap* skin, const ChestWallSheet& sheet, const Behind& behind)
{
  const std::array<int, 3> size = SizeOf(*image);
  std::vector<float> values;
  for (int z = 0; z < size[2]; ++z)
  {
    for (int x = 0; x < size[0]; ++x)
    {
      const float wallMm = sheet.Front->GetPixel({ { x, z } });
      const bool counts = skin->GetPixel({ { x, z } }) > wallMm + behind.BodyMm &&
        sheet.Steps->GetPixel({ { x, z } }) >= 0.5 * sheet.LargeStep;
      for (int y = 0; counts && y < size[1]; ++y)
      {
        const double depth = wallMm - (y + 0.5) * image->GetSpacing()[1];
        if (depth >= behind.FromMm && depth < behind.ToMm && tissue->GetPixel({ { x, y, z } }))
        {
          values.push_back(image->GetPixel({ { x, y, z } }));
        }
      }
    }
  }
  return values;
}

FloatImage::Pointer LogChannel(const FloatImage* image, const MaskImage* body, double floor,
  bool fatBright)
{
  const double sign = fatBright ? 1.0 : -1.0;
  const FloatImage::Pointer in = ToFloat(body);
  const FloatImage::Pointer log = MakeFrom<FloatImage>(*image,
    [&](std::size_t voxel)
    {
      const double value = std::max(0.0f, image->GetBufferPointer()[voxel]);
      return body->GetBufferPointer()[voxel] ? sign * std::log(value + floor) : 0.0;
    });
  const FloatImage::Pointer fine = MeanInside(log, in, 2.0);
  const FloatImage::Pointer coil = ResampleLike(
    MeanInside(Shrink(log, CoilVoxelMm), Shrink(in, CoilVoxelMm), CoilReachMm), *image);
  return MakeFrom<FloatImage>(*image,
    [&](std::size_t voxel)
    { return fine->GetBufferPointer()[voxel] - coil->GetBufferPointer()[voxel]; });
}

ChestWallSheet FindChestWall(const std::vector<FloatImage::Pointer>& channels,
  const MaskImage* body, const MaskImage* tissue)
{
  return WallSearch(body).FindByLogarithms(channels, tissue);
}

ChestWallSheet RefineChestWall(const std::vector<FloatImage::Pointer>& fatness,
  const MaskImage* body, const MaskImage* tissue, const HeightMap* near)
{
  return WallSearch(body).FindByFatness(fatness, tissue, near);
}
}
