// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Segmentation/BreastSegmentation.h"

#include "Private/ChestWall.h"
#include "Private/FatLevel.h"
#include "Private/ItkImages.h"
#include "Private/Masks.h"
#include "Private/Outline.h"
#include "Private/Plausibility.h"
#include "Private/Thresholds.h"
#include "Private/Valley.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/LabelEditing.h"
#include "mammoray/Foundation/Numbers.h"

#include <algorithm>
#include <cmath>

namespace mammoray
{
namespace
{
/// Smallest height of a breast in front of the chest wall, and smallest depth of the valley between
/// two breasts, mm.
constexpr double SmallestBreastMm = 15.0;
/// Thickness of the layer behind the chest wall's front in which muscle's intensity is measured,
/// mm.
constexpr double MuscleLayerMm = 10.0;
/// The body's outline is refined down to this far behind the cut, mm.
constexpr double BehindCutMm = 6.0;
/// Muscle at the sides of the chest extends this far in front of the cut, mm.
constexpr double SideMuscleMm = 10.0;
/// Voxels this near to the sheet can be muscle in front of it, mm.
constexpr double NextToWallMm = 3.0;
/// Tissue this many times as bright as noise shows its skin line to a voxel.
constexpr float ClarityOfSkin = 3.0f;
/// The coil's sensitivity and the chest wall are each found with the other, so many times.
constexpr int CoilRounds = 2;
/// Size of the cubic voxels for outline, chest wall and coil, mm.
constexpr double WorkMm = 2.0;
/// A tenth of a breast's columns must have at least this step at the chest wall. The step of the
/// logarithm is about 0.3 in a suppressed image and 1 in a plain one.
constexpr double SmallestLargeStep = 0.1;
/// Gland is at most this many times as bright as suppressed fat.
constexpr float BrightestGland = 4.0f;
/// Fat whose suppression failed is at least this many times as bright as muscle (gland is about as
/// bright as muscle in T1). Parts thinner than twice the radius do not count; brightened fat
/// reaches this far beyond the others. mm.
constexpr double UnsuppressedOverMuscle = 1.6;
constexpr double UnsuppressedRadiusMm = 3.0;
constexpr double UnsuppressedReachMm = 5.0;
/// Smallest ratio of the median intensities of body and air; noise alone has less.
constexpr double SmallestContrast = 3.0;
/// Smallest muscle level that can be distinguished from suppressed fat.
constexpr double DarkestSuppressedMuscle = 1.05;
/// The contrast of an image is clear if the chest wall's step under the worse of both assumptions
/// is less than this fraction of that under the better one. Measured: 0 to 0.8 of most patients;
/// near 1 of dense breasts and of phantoms without lungs.
constexpr double LargestOtherContrast = 0.9;
/// Steps, distances and multiples of noise that count in BreastQuality.
constexpr float SeenStep = 0.2f;
constexpr float AgreementMm = 4.0f;
constexpr float SkinClarity = 3.0f;

/// True if muscle can have this level, as a fraction of fat's.
bool IsMuscle(double level, bool fatBright)
{
  return fatBright ? level <= BrightestMuscle : level >= DarkestSuppressedMuscle;
}

/// One of the images of the body, in patient order.
struct Channel
{
  /// The image on the grid of the result; corrected, with fat = 1, when fat's level is known.
  FloatImage::Pointer Image;
  /// The scanned image on cubic voxels of WorkMm.
  FloatImage::Pointer Work;
  bool FatBright = true;
  double MuscleLevel = 0;
  double GlandThreshold = 0;
};

/// The steps of SegmentBreast in patient order: x towards the left, y towards the front, z towards
/// the head.
class Segmenter
{
public:
  Segmenter(const IntensityVolume& volume, const IntensityVolume* fatSuppressed,
    const SegmentationOptions& options, const ProgressCallback& progress)
    : Volume(volume)
    , Second(fatSuppressed)
    , Options(options)
    , Progress(progress)
    , Order(volume, options.Axes)
    , RimMm(*std::max_element(volume.Spacing.begin(), volume.Spacing.end()))
  {
  }

  SegmentationResult Run()
  {
    this->Report(0.0, "read the MRI");
    this->Prepare();
    this->Report(0.2, "find the body");
    this->FindBody();
    this->Report(0.3, "find the chest wall");
    this->FindWall();
    this->FindBreasts();
    this->Report(0.65, "find the skin line");
    this->RefineBody();
    this->Report(0.75, "tell gland from fat");
    this->FindThresholds();
    this->Report(0.85, "label the tissues");
    return this->Label();
  }

private:
  // -- voxels --
  const FloatImage& Grid() const { return *this->Channels.front().Image; }
  static bool Has(const MaskImage* mask, std::size_t voxel)
  {
    return mask->GetBufferPointer()[voxel] != 0;
  }
  template <typename Accept>
  MaskImage::Pointer Select(Accept accept) const
  {
    return MakeFrom<MaskImage>(this->Grid(), accept);
  }
  std::size_t Column(std::size_t voxel) const
  {
    const std::array<int, 3> size = SizeOf(this->Grid());
    const auto columns = static_cast<std::size_t>(size[0]);
    return voxel % columns + voxel / columns / static_cast<std::size_t>(size[1]) * columns;
  }
  double HeightMm(std::size_t voxel) const
  {
    const std::array<int, 3> size = SizeOf(this->Grid());
    const std::size_t y =
      voxel / static_cast<std::size_t>(size[0]) % static_cast<std::size_t>(size[1]);
    return (static_cast<double>(y) + 0.5) * this->Grid().GetSpacing()[1];
  }
  double LeftMm(std::size_t voxel) const
  {
    const std::size_t x = voxel % static_cast<std::size_t>(SizeOf(this->Grid())[0]);
    return (static_cast<double>(x) + 0.5) * this->Grid().GetSpacing()[0];
  }
  /// True in the axial planes that have a signal.
  bool IsClear(std::size_t voxel) const
  {
    const std::array<int, 3> size = SizeOf(this->Grid());
    const std::size_t z =
      voxel / static_cast<std::size_t>(size[0]) / static_cast<std::size_t>(size[1]);
    const double up = (static_cast<double>(z) + 0.5) * this->Grid().GetSpacing()[2];
    return up > this->Air.Planes[0] * WorkMm && up < (this->Air.Planes[1] + 1) * WorkMm;
  }
  /// Height above the chest wall's front, mm.
  double AboveChestWallMm(std::size_t voxel) const
  {
    return this->HeightMm(voxel) - this->ChestWall->GetBufferPointer()[this->Column(voxel)];
  }
  bool InBreast(std::size_t voxel) const
  {
    return this->Has(this->Body, voxel) && this->HeightMm(voxel) > this->CutMm &&
      this->AboveChestWallMm(voxel) > 0;
  }
  /// True inside the muscle behind the breast.
  bool InMuscle(std::size_t voxel) const
  {
    const double above = this->AboveChestWallMm(voxel);
    return this->Has(this->Body, voxel) && above <= -WorkMm && above > -MuscleLayerMm &&
      this->Thick[this->Column(voxel)];
  }
  void Report(double fraction, const char* stage) const
  {
    ReportProgress(this->Progress, fraction, stage);
  }

  // -- steps --
  void Prepare()
  {
    this->Source = this->Order.ToImage(this->Volume);
    for (std::size_t voxel = 0; voxel < CountOf(*this->Source); ++voxel)
    {
      float& value = this->Source->GetBufferPointer()[voxel];
      value = std::max(value, 0.0f);
    }
    Channel first;
    first.Image =
      this->Options.SpacingMm > 0 ? Resample(this->Source, this->Options.SpacingMm) : this->Source;
    first.Work = Resample(this->Source, WorkMm);
    this->Report(0.1, "read the MRI");
    this->Channels = { first };
    if (this->Second)
    {
      Channel second;
      second.Image = this->SampleSecond(*first.Image);
      second.Work = this->SampleSecond(*first.Work);
      this->Channels.push_back(second);
    }
  }

  /// Interpolates the second image at the voxels of a grid of the first; 0 outside it.
  FloatImage::Pointer SampleSecond(const FloatImage& grid) const
  {
    auto image = MakeLike<FloatImage>(grid, 0.0f);
    const VolumeGrid points = this->Order.GridOf(grid);
    std::vector<float> values;
    values.reserve(CountOf(grid));
    points.ForEachVoxel(
      [&](int i, int j, int k, std::size_t)
      {
        values.push_back(
          std::max(0.0f, this->Second->ValueAt(points.PointAt(i, j, k)).value_or(0.0f)));
      });
    this->Order.ForEachVoxel(SizeOf(grid),
      [&](std::size_t inImage, std::size_t inVolume)
      { image->GetBufferPointer()[inImage] = values[inVolume]; });
    return image;
  }

  void FindBody()
  {
    this->Air = FindOutline(this->Source, this->Channels.front().Work, this->Options.AirThreshold);
    const std::vector<float> inside = ValuesIn(this->Channels.front().Work, this->Air.Body);
    if (inside.size() == CountOf(*this->Air.Body))
    {
      throw InputError("MRI: expected air in front of the breast, found none at a threshold of " +
        NumberText(this->Air.AirThreshold));
    }
    if (!(this->Air.Contrast >= SmallestContrast))
    {
      throw InputError("MRI: expected tissue at least " + NumberText(SmallestContrast) +
        " times as bright as the air in front of it, found " + NumberText(this->Air.Contrast));
    }
    if (this->Options.AirThreshold == 0)
    {
      CheckSteps(this->Volume, this->Air.AirThreshold);
    }
  }

  /// The logarithms of the images, decreasing from fat to muscle.
  std::vector<FloatImage::Pointer> LogChannels() const
  {
    std::vector<FloatImage::Pointer> channels;
    for (const Channel& channel : this->Channels)
    {
      channels.push_back(
        LogChannel(channel.Work, this->Air.Body, 0.5 * this->Air.AirThreshold, channel.FatBright));
    }
    return channels;
  }

  /// Finds the chest wall's front by the steps of the images, independently of fat's level, and
  /// then that level.
  void FindWall()
  {
    if (!this->Second && this->Options.Contrast == FatContrast::Auto)
    {
      this->FindContrast();
      return;
    }
    this->Channels.back().FatBright = false;
    this->CorrectInFat(this->FindWallOf(
      this->Second != nullptr || this->Options.Contrast == FatContrast::FatBright));
  }

  /// The chest wall for this contrast of the first image, and of the second image.
  ChestWallSheet FindWallOf(bool fatBright)
  {
    this->Channels[0].FatBright = fatBright;
    return FindChestWall(this->LogChannels(), this->Air.Body, this->Air.Tissue);
  }

  /**
   * Decides whether fat is bright or dark by following both to the corrected chest wall. Where the
   * assumption is right, intensities fall there by the whole difference between fat and muscle;
   * otherwise the sheet follows muscle's back, or gland, and they fall by less.
   */
  void FindContrast()
  {
    const ChestWallSheet dark = this->FindWallOf(false);
    this->Report(0.4, "find the chest wall");
    const ChestWallSheet bright = this->FindWallOf(true);
    const std::vector<Channel> scanned = this->Channels;
    const auto follow = [&](bool fatBright)
    {
      this->Channels = scanned;
      this->Channels[0].FatBright = fatBright;
      this->CorrectInFat(fatBright ? bright : dark);
    };
    const auto fit = [&](bool fatBright)
    {
      try
      {
        follow(fatBright);
        const bool muscle = IsMuscle(this->MuscleLevelOf(this->Channels[0]), fatBright);
        return muscle ? this->WorkWall.LargeStep : 0.0;
      }
      catch (const InputError&)
      {
        return 0.0;
      }
    };
    // The guess is by the steps of the logarithm, and stands where the rest is no clearer. It is
    // followed last, so that its result is there when it wins.
    const bool guess = bright.LargeStep > dark.LargeStep;
    const double other = fit(!guess);
    const double first = fit(guess);
    this->ContrastIsClear = std::min(first, other) < LargestOtherContrast * std::max(first, other);
    if (first == 0 || (other > first && this->ContrastIsClear))
    {
      follow(other > first ? !guess : guess); // what is wrong with it is said there or further on
    }
  }

  /// Sets the sheet and the coronal plane behind which the result is empty.
  void TakeWall(const ChestWallSheet& sheet)
  {
    this->WorkWall = sheet;
    this->ChestWall = HeightsOver(sheet.Front, this->Grid());
    const HeightMap::Pointer skin = FrontOf(this->Air.Body);
    std::vector<float> heights;
    std::vector<float> depths;
    double farthest = 0;
    for (std::size_t column = 0; column < skin->GetBufferedRegion().GetNumberOfPixels(); ++column)
    {
      const float height = sheet.Front->GetBufferPointer()[column];
      if (skin->GetBufferPointer()[column] > height)
      {
        heights.push_back(height);
        depths.push_back(skin->GetBufferPointer()[column] - height);
        farthest = std::max<double>(farthest, skin->GetBufferPointer()[column] - height);
      }
    }
    if (farthest < SmallestBreastMm)
    {
      throw InputError("MRI: expected a breast, found tissue that extends at most " +
        NumberText(std::round(farthest)) + " mm in front of the chest wall");
    }
    if (sheet.LargeStep < SmallestLargeStep)
    {
      throw InputError("MRI: expected a chest wall, a step between fat and muscle, found none");
    }
    this->DepthMm = Quantile(depths, 0.99);
    this->WallMm = Quantile(heights, 0.9);
    this->CutMm = this->WallMm - this->Options.ChestWallDepthMm;
    const HeightMap::Pointer skinOver = HeightsOver(skin, this->Grid());
    this->Thick.resize(this->ChestWall->GetBufferedRegion().GetNumberOfPixels());
    for (std::size_t column = 0; column < this->Thick.size(); ++column)
    {
      this->Thick[column] = skinOver->GetBufferPointer()[column] >
        this->ChestWall->GetBufferPointer()[column] + SmallestBreastMm;
    }
  }

  /// Sets the sheet, divides every image by the intensity of fat in front of it, and searches
  /// again.
  void CorrectInFat(const ChestWallSheet& sheet)
  {
    this->FirstWall = sheet.Front;
    this->TakeWall(sheet);
    this->Report(0.55, "even out the coil's sensitivity");
    this->Uncorrected = this->Channels.front().Image;
    this->HalfSkin =
      SkinThreshold(this->Air, this->Channels.front().Work, this->Channels.front().FatBright);
    const std::vector<Channel> scanned = this->Channels;
    std::vector<FloatImage::Pointer> levels(scanned.size());
    for (int round = 0; round < CoilRounds; ++round)
    {
      const MaskImage::Pointer inner =
        BeforeSheet(this->Air.Body, this->WorkWall, 2 * WorkMm, this->CutMm);
      std::vector<FloatImage::Pointer> fatness;
      for (std::size_t n = 0; n < scanned.size(); ++n)
      {
        Channel& channel = this->Channels[n];
        // In T1 gland is as bright as muscle.
        const double gland = round == 0 ? 0.0 : channel.MuscleLevel;
        const FloatImage::Pointer level = FindFatLevel(scanned[n].Work, inner, channel.FatBright,
          !this->Options.CorrectBias, gland);
        if (!level)
        {
          throw InputError("MRI: expected a breast, found no tissue in front of the chest wall");
        }
        levels[n] = level;
        channel.Work = Divide(scanned[n].Work, level);
        channel.MuscleLevel = this->MuscleLevelOf(channel);
        fatness.push_back(
          Fatness(channel.Work, this->Air.Tissue, channel.MuscleLevel, channel.FatBright));
      }
      // Lung, which is darker than muscle, and brighter tissue no longer produce steps.
      this->TakeWall(
        RefineChestWall(fatness, this->Air.Body, this->Air.Tissue, this->WorkWall.Stiff));
    }
    for (std::size_t n = 0; n < scanned.size(); ++n)
    {
      this->Channels[n].Image =
        Divide(scanned[n].Image, ResampleLike(levels[n], *scanned[n].Image));
    }
  }

  double MuscleLevelOf(const Channel& channel) const
  {
    const std::vector<float> values = BehindSheet(channel.Work, this->Air.Tissue,
      FrontOf(this->Air.Body), this->WorkWall, { WorkMm, MuscleLayerMm, SmallestBreastMm });
    if (values.empty())
    {
      throw InputError("MRI: expected muscle behind the breast's fat, found none");
    }
    return MiddleOfShortestHalf(values);
  }

  /// Counts the breasts in front of the chest wall and finds the plane between two.
  void FindBreasts()
  {
    const Valley valley = DeepestValley(HeightsOver(FrontOf(this->Air.Body), this->Grid()),
      this->ChestWall, this->CutMm);
    this->MidlineMm = valley.MiddleMm;
    this->Breasts = valley.DepthMm >= SmallestBreastMm ? 2 : 1;
    if (this->Breasts == 1 && this->Options.Side != BreastSide::Both)
    {
      throw InputError("MRI: expected two breasts, because one side is requested, found one");
    }
  }

  /// Measures how well the borders of each breast show.
  std::vector<BreastQuality> Qualities() const
  {
    const HeightMap::Pointer skin = FrontOf(this->Air.Body);
    const std::array<int, 3> size = SizeOf(*this->Air.Body);
    std::array<ColumnCounts, 2> sides;
    for (int z = this->Air.Planes[0]; z <= this->Air.Planes[1]; ++z)
    {
      for (int x = 0; x < size[0]; ++x)
      {
        const float wall = this->WorkWall.Front->GetPixel({ { x, z } });
        const float front = skin->GetPixel({ { x, z } });
        if (front < wall + SmallestBreastMm || front < this->CutMm + SideMuscleMm)
        {
          continue;
        }
        ColumnCounts& side =
          sides[this->Breasts == 2 && (x + 0.5) * WorkMm > this->MidlineMm ? 1 : 0];
        ++side.All;
        side.Seen += this->WorkWall.Steps->GetPixel({ { x, z } }) >= SeenStep ? 1 : 0;
        const float other = this->FirstWall->GetPixel({ { x, z } });
        side.Agreeing += std::abs(wall - other) <= AgreementMm ? 1 : 0;
        const int y = std::min(size[1] - 1, static_cast<int>(front / WorkMm) - 1);
        side.Clear += this->Air.Clarity->GetPixel({ { x, y, z } }) >= SkinClarity ? 1 : 0;
      }
    }
    std::vector<BreastQuality> qualities;
    for (int n = 0; n < this->Breasts; ++n)
    {
      const BreastSide side = this->Breasts == 1 ? BreastSide::Both
        : n == 0                                 ? BreastSide::Right
                                                 : BreastSide::Left;
      if (this->Options.Side == BreastSide::Both || this->Options.Side == side)
      {
        qualities.push_back(
          QualityOf(side, sides[static_cast<std::size_t>(n)], this->ContrastIsClear));
      }
    }
    return qualities;
  }

  /// Refines the skin line to a voxel, within a few millimetres of the outline: voxels half filled
  /// with skin are body. Where tissue hardly stands out from noise, the outline stays as it is.
  /// Voxels behind the chest wall's front are body, however dark, so that no air reaches the lungs.
  void RefineBody()
  {
    this->Report(0.67, "find the skin line");
    const FloatImage::Pointer sure = ResampleLike(
      ToFloat(Complement(Dilate(Complement(this->Air.Body), 2 * WorkMm))), this->Grid());
    const FloatImage::Pointer near =
      ResampleLike(ToFloat(Dilate(this->Air.Body, WorkMm)), this->Grid());
    const FloatImage::Pointer half = ResampleLike(this->HalfSkin, this->Grid());
    const FloatImage::Pointer coarse = ResampleLike(ToFloat(this->Air.Body), this->Grid());
    const FloatImage::Pointer clarity = ResampleLike(this->Air.Clarity, this->Grid());
    const std::vector<bool> wall = this->WallInBody();
    const MaskImage::Pointer dark = this->Select(
      [&](std::size_t voxel)
      {
        const double above = this->AboveChestWallMm(voxel);
        const double heightMm = this->HeightMm(voxel);
        const bool atWall = above <= 0 && wall[this->Column(voxel)];
        const bool tissue = clarity->GetBufferPointer()[voxel] < ClarityOfSkin
          ? coarse->GetBufferPointer()[voxel] >= 0.5f
          : sure->GetBufferPointer()[voxel] > 0.5f ||
            (near->GetBufferPointer()[voxel] > 0.5f &&
              this->Uncorrected->GetBufferPointer()[voxel] >= half->GetBufferPointer()[voxel]);
        return !tissue && !atWall && heightMm > this->CutMm - BehindCutMm;
      });
    this->Report(0.7, "find the skin line");
    const MaskImage::Pointer body = LargestComponent(Complement(ReachedFromFront(dark)));
    const FloatImage::Pointer smooth = GaussianMean<FloatImage>(ToFloat(body), 1.0);
    this->Body =
      this->Select([&](std::size_t voxel) { return smooth->GetBufferPointer()[voxel] >= 0.5f; });
  }

  /// Columns in which the chest wall lies inside the body and is not its continuation in the air.
  std::vector<bool> WallInBody() const
  {
    const HeightMap::Pointer map = FrontOf(this->Air.Body);
    const std::array<int, 3> size = SizeOf(*this->Air.Body);
    for (int z = 0; z < size[2]; ++z)
    {
      for (int x = 0; x < size[0]; ++x)
      {
        const int front = static_cast<int>(this->WorkWall.Front->GetPixel({ { x, z } }) / WorkMm);
        bool found = false;
        for (int y = std::max(0, front - 3); y <= std::min(front + 1, size[1] - 1); ++y)
        {
          found = found || this->Air.Body->GetPixel({ { x, y, z } });
        }
        map->SetPixel({ { x, z } }, found ? 1.0f : 0.0f);
      }
    }
    const HeightMap::Pointer over = HeightsOver(map, this->Grid());
    std::vector<bool> in(over->GetBufferedRegion().GetNumberOfPixels());
    for (std::size_t column = 0; column < in.size(); ++column)
    {
      in[column] = over->GetBufferPointer()[column] > 0.5f;
    }
    return in;
  }

  void FindThresholds()
  {
    const double given = this->Options.GlandThreshold;
    if (!this->Second) // of two images it is one's
    {
      CheckGlandThreshold(given, this->Channels.front().FatBright);
    }
    const MaskImage::Pointer tissue = this->Select(
      [&](std::size_t voxel) { return this->InBreast(voxel) || this->InMuscle(voxel); });
    for (Channel& channel : this->Channels)
    {
      channel.MuscleLevel = this->MuscleLevelOf(channel);
      if (!IsMuscle(channel.MuscleLevel, channel.FatBright))
      {
        throw InputError("MRI: expected muscle behind the breast at " +
          (channel.FatBright ? "most " + NumberText(BrightestMuscle) + " times as bright as fat"
                             : "least " + NumberText(DarkestSuppressedMuscle) +
                " times as bright as suppressed fat") +
          ", found " + NumberText(channel.MuscleLevel));
      }
      std::vector<float> values = ValuesIn(channel.Image, tissue);
      for (float& value : values)
      {
        value = std::min(value, BrightestGland);
      }
      const std::vector<double> thresholds = OtsuThresholds(values, this->Options.Classes);
      channel.GlandThreshold = IsThresholdOf(given, channel.FatBright) ? given
        : channel.FatBright                                            ? thresholds.back()
                                                                       : thresholds.front();
    }
  }

  /// Score of gland: 0 at fat's level and 1 at the threshold of each image, averaged; gland is
  /// above 1.
  double GlandScore(std::size_t voxel) const
  {
    double sum = 0;
    for (const Channel& channel : this->Channels)
    {
      const double score =
        (channel.Image->GetBufferPointer()[voxel] - 1) / (channel.GlandThreshold - 1);
      sum += std::clamp(score, -1.0, 3.0);
    }
    return sum / static_cast<double>(this->Channels.size());
  }

  /// Labels gland in the volume's own order, without specks and without the dark rim of the body.
  void LabelGland(LabelVolume& labels, const std::vector<float>& depth) const
  {
    // Voxels at the air are dark because they are only partly filled; use the larger of the old and
    // the new voxel size.
    const double rimMm = this->Options.SkinThicknessMm + this->RimMm;
    const std::array<int, 3> size = SizeOf(this->Grid());
    const MaskImage::Pointer unsuppressed = this->UnsuppressedFat(depth);
    MaskImage::Pointer dark = this->Select(
      [&](std::size_t voxel)
      {
        return this->MayBeGland(voxel) && !this->Has(unsuppressed, voxel) &&
          this->GlandScore(voxel) > 1;
      });
    this->Order.ForEachVoxel(size,
      [&](std::size_t inImage, std::size_t inVolume)
      {
        unsigned char& voxel = dark->GetBufferPointer()[inImage];
        voxel = depth[inVolume] > rimMm ? voxel : 0;
      });
    const double voxelMm3 = labels.VoxelVolume();
    const ComponentImage::Pointer parts = FindComponents(dark,
      static_cast<std::size_t>(std::ceil(this->Options.SmallestGlandMm3 / voxelMm3)));
    const std::vector<bool> other = this->OtherParts(*parts, depth);
    this->Order.ForEachVoxel(size,
      [&](std::size_t inImage, std::size_t inVolume)
      {
        const unsigned part = parts->GetBufferPointer()[inImage];
        if (part != 0 && !other[part])
        {
          labels.Voxels[inVolume] = static_cast<std::uint16_t>(TissueLabel::Gland);
        }
      });
  }

  /// Fat at the skin whose suppression failed, and its surroundings: brighter than gland.
  MaskImage::Pointer UnsuppressedFat(const std::vector<float>& depth) const
  {
    const Channel& channel = this->Channels.back();
    if (channel.FatBright)
    {
      return this->Select([](std::size_t) { return false; });
    }
    MaskImage::Pointer bright = Open(this->Select(
                                       [&](std::size_t voxel)
                                       {
                                         return this->MayBeGland(voxel) &&
                                           channel.Image->GetBufferPointer()[voxel] >
                                           UnsuppressedOverMuscle * channel.MuscleLevel;
                                       }),
      UnsuppressedRadiusMm);
    const ComponentImage::Pointer parts = FindComponents(bright, 1);
    std::vector<bool> atSkin(CountOf(this->Grid()) + 1, false);
    this->Order.ForEachVoxel(SizeOf(this->Grid()),
      [&](std::size_t inImage, std::size_t inVolume)
      {
        if (depth[inVolume] <= this->SkinReachMm())
        {
          atSkin[parts->GetBufferPointer()[inImage]] = true;
        }
      });
    atSkin[0] = false;
    bright =
      this->Select([&](std::size_t voxel) { return atSkin[parts->GetBufferPointer()[voxel]]; });
    return Dilate(bright, UnsuppressedReachMm);
  }

  /// Voxels at the sheet can be muscle in front of it; those at the sides of the chest are muscle.
  bool MayBeGland(std::size_t voxel) const
  {
    return this->InBreast(voxel) && this->AboveChestWallMm(voxel) > NextToWallMm &&
      this->HeightMm(voxel) > this->CutMm + SideMuscleMm;
  }

  /// Parts that lie mostly next to skin, chest wall or cut are skin or muscle.
  std::vector<bool> OtherParts(const ComponentImage& parts, const std::vector<float>& depth) const
  {
    const unsigned last =
      *std::max_element(parts.GetBufferPointer(), parts.GetBufferPointer() + CountOf(this->Grid()));
    std::vector<std::array<std::size_t, 2>> counts(last + 1, { 0, 0 });
    const double skinMm = this->SkinReachMm();
    this->Order.ForEachVoxel(SizeOf(this->Grid()),
      [&](std::size_t inImage, std::size_t inVolume)
      {
        const unsigned part = parts.GetBufferPointer()[inImage];
        if (part != 0)
        {
          const bool next = depth[inVolume] < skinMm ||
            this->AboveChestWallMm(inImage) < 3 * NextToWallMm ||
            this->HeightMm(inImage) < this->CutMm + 2 * SideMuscleMm;
          ++counts[part][next ? 1 : 0];
        }
      });
    std::vector<bool> other(counts.size());
    for (std::size_t part = 1; part < counts.size(); ++part)
    {
      other[part] = counts[part][1] > counts[part][0];
    }
    return other;
  }

  /// Depth of bright or dark skin, blurred by the MRI's voxels, mm.
  double SkinReachMm() const { return this->Options.SkinThicknessMm + this->RimMm + 2; }

  SegmentationResult Label()
  {
    const std::array<int, 3> size = SizeOf(this->Grid());
    SegmentationResult result;
    static_cast<VolumeGrid&>(result.Labels) = this->Order.GridOf(this->Grid());
    static_cast<VolumeGrid&>(result.Corrected) = result.Labels;
    result.Labels.Voxels.resize(CountOf(this->Grid()));
    result.Corrected.Voxels.resize(CountOf(this->Grid()));
    const auto put = [&](std::size_t inVolume, TissueLabel label)
    { result.Labels.Voxels[inVolume] = static_cast<std::uint16_t>(label); };
    this->Order.ForEachVoxel(size,
      [&](std::size_t inImage, std::size_t inVolume)
      {
        result.Corrected.Voxels[inVolume] = this->Grid().GetBufferPointer()[inImage];
        put(inVolume,
          !this->Has(this->Body, inImage)          ? TissueLabel::Air
            : this->AboveChestWallMm(inImage) <= 0 ? TissueLabel::ChestWall
                                                   : TissueLabel::Fat);
      });
    std::vector<bool> fixed(5, false);
    fixed[static_cast<std::size_t>(TissueLabel::ChestWall)] = true;
    this->LabelGland(result.Labels, DepthBelowAir(result.Labels, this->SkinReachMm(), fixed));
    this->Report(0.95, "label the tissues");
    // Add skin before cutting, because cut faces have none.
    if (this->Options.SkinThicknessMm > 0)
    {
      result.Labels = AddSkin(result.Labels, this->Options.SkinThicknessMm,
        static_cast<int>(TissueLabel::Skin), fixed);
    }
    this->Cut(result.Labels);
    const Channel& first = this->Channels.front();
    result.AirThreshold = this->Air.AirThreshold;
    result.GlandThreshold = first.GlandThreshold;
    result.MuscleLevel = first.MuscleLevel;
    result.Contrast = first.FatBright ? FatContrast::FatBright : FatContrast::FatDark;
    result.Breasts = this->Breasts;
    result.Measures.DepthMm = this->DepthMm;
    result.Quality = this->Qualities();
    this->TellMissingPlanes(result);
    Measure(result);
    Judge(result, this->Options.Side == BreastSide::Both ? this->Breasts : 1,
      this->Options.GlandThreshold > 0);
    return result;
  }

  void TellMissingPlanes(SegmentationResult& result) const
  {
    const int planes = SizeOf(*this->Air.Body)[2];
    const double feet = this->Air.Planes[0] * WorkMm;
    const double head = (planes - 1 - this->Air.Planes[1]) * WorkMm;
    if (feet + head > 0)
    {
      result.Warnings.push_back(NumberText(feet) + " mm at the feet's end and " + NumberText(head) +
        " mm at the head's end are left out: tissue there is as dark as noise");
    }
  }

  /// Keeps the connected part in front of the cut, of one side if requested.
  void Cut(LabelVolume& labels) const
  {
    const std::array<int, 3> size = SizeOf(this->Grid());
    MaskImage::Pointer kept = MakeLike<MaskImage>(this->Grid(), 0);
    this->Order.ForEachVoxel(size,
      [&](std::size_t inImage, std::size_t inVolume)
      {
        const bool left = this->LeftMm(inImage) > this->MidlineMm;
        const bool side = this->Options.Side == BreastSide::Both ||
          left == (this->Options.Side == BreastSide::Left);
        kept->GetBufferPointer()[inImage] = labels.Voxels[inVolume] != 0 && side &&
            this->HeightMm(inImage) > this->CutMm && this->IsClear(inImage)
          ? 1
          : 0;
      });
    kept = LargestComponent(kept);
    this->Order.ForEachVoxel(size,
      [&](std::size_t inImage, std::size_t inVolume)
      {
        if (!this->Has(kept, inImage))
        {
          labels.Voxels[inVolume] = 0;
        }
      });
  }

  const IntensityVolume& Volume;
  const IntensityVolume* Second;
  const SegmentationOptions& Options;
  const ProgressCallback& Progress;
  PatientOrder Order;
  /// The MRI on its original voxels.
  FloatImage::Pointer Source;
  std::vector<Channel> Channels;
  /// The first scanned image on the result's grid.
  FloatImage::Pointer Uncorrected;
  /// Scanned intensity of voxels half filled with skin.
  FloatImage::Pointer HalfSkin;
  Outline Air;
  ChestWallSheet WorkWall;
  /// The sheet's front before the coil's correction.
  HeightMap::Pointer FirstWall;
  HeightMap::Pointer ChestWall;
  /// Columns with a breast in front of the chest wall.
  std::vector<bool> Thick;
  MaskImage::Pointer Body;
  /// Front of the chest wall (its 90th percentile) and back of the result, y in mm.
  double WallMm = 0;
  double CutMm = 0;
  double MidlineMm = 0;
  double DepthMm = 0;
  /// Largest voxel spacing of the MRI, mm.
  double RimMm;
  int Breasts = 0;
  bool ContrastIsClear = true;
};

SegmentationResult Segment(const IntensityVolume& image, const IntensityVolume* fatSuppressed,
  const SegmentationOptions& options, const ProgressCallback& progress)
{
  options.Validate();
  CheckImage(image, options.AcceptUnusual);
  if (fatSuppressed)
  {
    CheckImage(*fatSuppressed, options.AcceptUnusual);
  }
  try
  {
    return Segmenter(image, fatSuppressed, options, progress).Run();
  }
  catch (const itk::ExceptionObject& error)
  {
    throw ConvergenceError(std::string("segmentation: ") + error.GetDescription());
  }
}
}

SegmentationResult SegmentBreast(const IntensityVolume& image, const SegmentationOptions& options,
  const ProgressCallback& progress)
{
  return Segment(image, nullptr, options, progress);
}

SegmentationResult SegmentBreast(const IntensityVolume& plain, const IntensityVolume& fatSuppressed,
  const SegmentationOptions& options, const ProgressCallback& progress)
{
  return Segment(plain, &fatSuppressed, options, progress);
}
}
