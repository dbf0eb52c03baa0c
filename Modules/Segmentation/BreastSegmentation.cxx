// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Segmentation/BreastSegmentation.h"

#include "Private/BiasField.h"
#include "Private/ChestWall.h"
#include "Private/ItkImages.h"
#include "Private/Masks.h"
#include "Private/Thresholds.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/LabelSkin.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <sstream>

namespace mammoray
{
namespace
{
/// What must stand out before the chest wall to be a breast, and between two for them to be two,
/// mm.
constexpr double SmallestBreastMm = 15.0;
/// Muscle behind the chest wall's front whose intensity is measured, mm.
constexpr double MuscleLayerMm = 20.0;
/// The body must be so many times as bright as the air (medians); noise alone has less.
constexpr double SmallestContrast = 3.0;
/// Tissue before a voxel that makes it part of the body, mm.
constexpr double TissueBeforeMm = 20.0;
/// Muscle may have this fraction of fat's intensity; brighter, the two are not told apart (no T1
/// weighting, fat suppression).
constexpr double BrightestMuscle = 0.8;

std::string Number(double value)
{
  std::ostringstream text;
  text << value;
  return text.str();
}

void CheckImage(const IntensityVolume& image)
{
  image.Validate("MRI");
  for (int a = 0; a < 3; ++a)
  {
    if (image.Size[a] < 8)
    {
      throw InputError("MRI: expected a volume of at least 8 voxels along each axis, found " +
        std::to_string(image.Size[0]) + " x " + std::to_string(image.Size[1]) + " x " +
        std::to_string(image.Size[2]));
    }
  }
  const auto [low, high] = std::minmax_element(image.Voxels.begin(), image.Voxels.end());
  if (*low == *high)
  {
    throw InputError(
      "MRI: expected air and tissue, found the intensity " + Number(*low) + " everywhere");
  }
}

std::size_t CountOf(const itk::ImageBase<3>& image)
{
  return image.GetLargestPossibleRegion().GetNumberOfPixels();
}

/// A mask of the voxels of which `accept(index)` holds.
template <typename Accept>
MaskImage::Pointer Select(const itk::ImageBase<3>& grid, Accept accept)
{
  auto mask = MakeLike<MaskImage>(grid, 0);
  for (std::size_t voxel = 0; voxel < CountOf(grid); ++voxel)
  {
    mask->GetBufferPointer()[voxel] = accept(voxel) ? 1 : 0;
  }
  return mask;
}

/**
 * The steps of SegmentBreast, in patient order: x towards the left, y towards the front, z towards
 * the head.
 */
class Segmenter
{
public:
  Segmenter(const IntensityVolume& volume, const SegmentationOptions& options,
    const ProgressCallback& progress)
    : Options(options)
    , Progress(progress)
    , Order(volume, options.Axes)
    , Image(Order.ToImage(volume))
    , RimMm(*std::max_element(volume.Spacing.begin(), volume.Spacing.end()))
  {
  }

  SegmentationResult Run()
  {
    this->Report(0.0, "read the MRI");
    for (std::size_t voxel = 0; voxel < CountOf(*this->Image); ++voxel)
    {
      float& value = this->Image->GetBufferPointer()[voxel];
      value = std::max(value, 0.0f);
    }
    if (this->Options.SpacingMm > 0)
    {
      this->Image = Resample(this->Image, this->Options.SpacingMm);
    }
    this->Report(0.05, "find the body");
    this->FindBody();
    this->CorrectInBody();
    this->Report(0.4, "find the chest wall");
    this->FindWall();
    // Each knows the other better: what is before the wall, and what is as dark as muscle.
    this->CorrectInFat(0.42, 0.56);
    this->FindWall();
    this->CorrectInFat(0.58, 0.72);
    this->FindWall();
    if (this->MuscleLevel > BrightestMuscle)
    {
      throw InputError("MRI: expected muscle behind the breast at most " + Number(BrightestMuscle) +
        " times as bright as fat, found " + Number(this->MuscleLevel));
    }
    this->FindBreasts();
    this->Report(0.75, "find the skin line");
    this->RefineBody();
    this->Report(0.8, "tell gland from fat");
    this->FindGlandThreshold();
    this->Report(0.9, "label the tissues");
    return this->Label();
  }

private:
  // -- voxels --
  float Value(std::size_t voxel) const { return this->Image->GetBufferPointer()[voxel]; }
  static bool Has(const MaskImage* mask, std::size_t voxel)
  {
    return mask->GetBufferPointer()[voxel] != 0;
  }
  template <typename Accept>
  MaskImage::Pointer Select(Accept accept) const
  {
    return mammoray::Select(*this->Image, accept);
  }
  std::size_t Column(std::size_t voxel) const
  {
    const std::array<int, 3> size = SizeOf(*this->Image);
    const auto columns = static_cast<std::size_t>(size[0]);
    return voxel % columns + voxel / columns / static_cast<std::size_t>(size[1]) * columns;
  }
  double HeightMm(std::size_t voxel) const
  {
    const std::array<int, 3> size = SizeOf(*this->Image);
    const std::size_t y =
      voxel / static_cast<std::size_t>(size[0]) % static_cast<std::size_t>(size[1]);
    return (static_cast<double>(y) + 0.5) * this->Image->GetSpacing()[1];
  }
  double LeftMm(std::size_t voxel) const
  {
    const std::size_t x = voxel % static_cast<std::size_t>(SizeOf(*this->Image)[0]);
    return (static_cast<double>(x) + 0.5) * this->Image->GetSpacing()[0];
  }
  /// Height above the chest wall's front; infinity beside it.
  double AboveChestWallMm(std::size_t voxel) const
  {
    const float front = this->ChestWall->GetBufferPointer()[this->Column(voxel)];
    return front == NoChestWall ? std::numeric_limits<double>::infinity()
                                : this->HeightMm(voxel) - front;
  }
  bool InBreast(std::size_t voxel) const
  {
    return this->Has(this->Body, voxel) && this->HeightMm(voxel) > this->CutMm &&
      this->AboveChestWallMm(voxel) > 0;
  }
  /// Muscle next to the breast.
  bool InMuscle(std::size_t voxel) const
  {
    const double above = this->AboveChestWallMm(voxel);
    return this->Has(this->Bright, voxel) && above <= 0 && above > -MuscleLayerMm;
  }
  void Report(double fraction, const char* stage) const
  {
    ReportProgress(this->Progress, fraction, stage);
  }
  ProgressCallback Between(double low, double high) const
  {
    return [this, low, high](double fraction, const char* stage)
    { return !this->Progress || this->Progress(low + fraction * (high - low), stage); };
  }

  // -- steps --
  void FindBody()
  {
    double threshold = this->Options.AirThreshold;
    FloatImage::Pointer smooth = this->Image;
    if (threshold == 0)
    {
      smooth = GaussianMean<FloatImage>(this->Image, 1.0);
      // On a logarithmic scale the fall of the coil's sensitivity counts little against the step
      // from air to tissue; a hundredth of the brightest keeps zeros and noise in one class.
      const auto* voxels = smooth->GetBufferPointer();
      std::vector<float> values(voxels, voxels + CountOf(*smooth));
      const double floor = 0.01 * Quantile(values, 0.99) + std::numeric_limits<float>::min();
      for (float& value : values)
      {
        // The recursive filter undershoots beside steps.
        value = static_cast<float>(std::log(std::max(value, 0.0f) + floor));
      }
      threshold = std::exp(OtsuThresholds(values, 2).front()) - floor;
    }
    this->AirThreshold = threshold;
    const MaskImage::Pointer air = AirInFront(smooth, threshold);
    this->Body = LargestComponent(Complement(air));
    const std::vector<float> inside = ValuesIn(this->Image, this->Body);
    if (inside.empty() || inside.size() == CountOf(*this->Image))
    {
      throw InputError("MRI: expected air in front of the breast, found " +
        std::string(inside.empty() ? "nothing else" : "none") + " at a threshold of " +
        Number(threshold));
    }
    this->Bright = this->Select([&](std::size_t voxel)
      { return this->Has(this->Body, voxel) && this->Value(voxel) >= threshold; });
    const double contrast = Quantile(ValuesIn(smooth, this->Body), 0.5) /
      std::max(1e-30, std::abs(Quantile(ValuesIn(smooth, air), 0.5)));
    if (!(contrast >= SmallestContrast))
    {
      throw InputError("MRI: expected tissue at least " + Number(SmallestContrast) +
        " times as bright as the air in front of it, found " + Number(contrast));
    }
    this->FindDeep();
  }

  /// What has so much tissue before it is no air, however dark: muscle and lungs far from the coil.
  void FindDeep()
  {
    this->Deep = MakeLike<MaskImage>(*this->Image, 0);
    const std::array<int, 3> size = SizeOf(*this->Image);
    for (int z = 0; z < size[2]; ++z)
    {
      for (int x = 0; x < size[0]; ++x)
      {
        double tissueMm = 0;
        for (int y = size[1] - 1; y >= 0; --y)
        {
          const FloatImage::IndexType index{ { x, y, z } };
          this->Deep->SetPixel(index, tissueMm >= TissueBeforeMm ? 1 : 0);
          tissueMm += this->Body->GetPixel(index) ? this->Image->GetSpacing()[1] : 0;
        }
      }
    }
  }

  void CorrectInBody()
  {
    if (this->Options.CorrectBias)
    {
      this->Image = CorrectBias(this->Image, this->Bright, this->Between(0.1, 0.4));
    }
    // Lungs and noise, muscle and organs, fat.
    this->FatThreshold = OtsuThresholds(ValuesIn(this->Image, this->Body), 3).back();
  }

  /// The chest wall's front, and the coronal plane behind which the result has nothing.
  void FindWall()
  {
    this->ChestWall = FindChestWall(this->Select(
      [&](std::size_t voxel)
      {
        return (this->Has(this->Body, voxel) || this->Has(this->Deep, voxel)) &&
          this->Value(voxel) < this->FatThreshold;
      }));
    std::vector<float> heights;
    for (std::size_t column = 0;
         column < this->ChestWall->GetLargestPossibleRegion().GetNumberOfPixels(); ++column)
    {
      const float height = this->ChestWall->GetBufferPointer()[column];
      if (height != NoChestWall)
      {
        heights.push_back(height);
      }
    }
    if (heights.empty())
    {
      throw InputError("MRI: expected a chest wall, dark behind bright fat, found none");
    }
    this->WallMm = Quantile(heights, 0.9);
    this->CutMm = this->WallMm - this->Options.ChestWallDepthMm;
  }

  /**
   * How many breasts stand before the chest wall, and the plane between two: the middle of the
   * valley of the body's front, which is the air line over the sternum.
   */
  void FindBreasts()
  {
    const std::array<int, 3> size = SizeOf(*this->Image);
    const double stepMm = this->Image->GetSpacing()[0];
    std::vector<float> profile(static_cast<std::size_t>(size[0]), 0.0f);
    double largest = 0;
    for (std::size_t voxel = 0; voxel < CountOf(*this->Image); ++voxel)
    {
      if (this->InBreast(voxel))
      {
        float& front = profile[voxel % profile.size()];
        front = std::max(front, static_cast<float>(this->HeightMm(voxel)));
        const double above = this->AboveChestWallMm(voxel);
        largest = std::isfinite(above) ? std::max(largest, above) : largest;
      }
    }
    if (largest < SmallestBreastMm)
    {
      throw InputError("MRI: expected a breast, found tissue that stands at most " +
        Number(std::round(largest)) + " mm before the chest wall");
    }
    const auto peak = std::max_element(profile.begin(), profile.end());
    double deepest = 0;
    for (const int direction : { -1, 1 })
    {
      auto lowest = peak;
      for (auto at = peak;; at += direction)
      {
        lowest = *at < *lowest ? at : lowest;
        const double valley = *at - *lowest;
        if (valley > deepest && *lowest > 0)
        {
          deepest = valley;
          this->MidlineMm = MiddleOfValley(profile, lowest - profile.begin(), stepMm);
        }
        if (at == (direction < 0 ? profile.begin() : profile.end() - 1))
        {
          break;
        }
      }
    }
    this->Breasts = deepest >= SmallestBreastMm ? 2 : 1;
    if (this->Breasts == 1 && this->Options.Side != BreastSide::Both)
    {
      throw InputError(
        "MRI: expected two breasts to take one side of, found one; leave the side out");
    }
  }

  static double MiddleOfValley(const std::vector<float>& profile, std::ptrdiff_t lowest,
    double stepMm)
  {
    constexpr float flatMm = 3.0f;
    auto low = lowest;
    auto high = lowest;
    const float limit = profile[static_cast<std::size_t>(lowest)] + flatMm;
    while (low > 0 && profile[static_cast<std::size_t>(low - 1)] <= limit)
    {
      --low;
    }
    while (high + 1 < static_cast<std::ptrdiff_t>(profile.size()) &&
      profile[static_cast<std::size_t>(high + 1)] <= limit)
    {
      ++high;
    }
    return (0.5 * static_cast<double>(low + high) + 0.5) * stepMm;
  }

  /// Evens out the fat of the breast, whose level becomes 1, and finds muscle's.
  void CorrectInFat(double progressBegin, double progressEnd)
  {
    const auto isFat = [&](std::size_t voxel)
    { return this->InBreast(voxel) && this->Value(voxel) >= this->FatThreshold; };
    MaskImage::Pointer fat = this->Select(isFat);
    std::vector<float> values = ValuesIn(this->Image, fat);
    if (values.empty())
    {
      throw InputError("MRI: expected fat, bright, before the chest wall, found none");
    }
    this->Scale(1 / Quantile(values, 0.5));
    if (this->Options.CorrectBias)
    {
      this->Image = CorrectBias(this->Image, fat, this->Between(progressBegin, progressEnd));
      this->Scale(1 / Quantile(ValuesIn(this->Image, fat), 0.5));
    }
    this->MuscleLevel = this->FindMuscleLevel();
    // Half way between the two is where a voxel is half full.
    this->FatThreshold = 0.5 * (1 + this->MuscleLevel);
  }

  /// The darker of two classes behind the front of the chest wall: the front may still lie in fat.
  double FindMuscleLevel() const
  {
    std::vector<float> values =
      ValuesIn(this->Image, this->Select([&](std::size_t voxel) { return this->InMuscle(voxel); }));
    if (values.empty())
    {
      throw InputError("MRI: expected muscle behind the breast's fat, found none");
    }
    const double threshold = OtsuThresholds(values, 2).front();
    std::erase_if(values, [threshold](float value) { return value > threshold; });
    return Quantile(values, 0.5);
  }

  void Scale(double factor)
  {
    for (std::size_t voxel = 0; voxel < CountOf(*this->Image); ++voxel)
    {
      this->Image->GetBufferPointer()[voxel] *= static_cast<float>(factor);
    }
    this->FatThreshold *= factor;
  }

  /// Half way from air to the darkest tissue is where a voxel is half full.
  void RefineBody()
  {
    MaskImage::Pointer tissue = this->Body;
    if (this->Options.AirThreshold == 0)
    {
      auto masked = MakeLike<FloatImage>(*this->Image, 0.0f);
      for (std::size_t voxel = 0; voxel < CountOf(*this->Image); ++voxel)
      {
        // The field is known in the body only.
        masked->GetBufferPointer()[voxel] = this->Has(this->Body, voxel) ? this->Value(voxel) : 0;
      }
      tissue = LargestComponent(Complement(AirInFront(masked, 0.5 * this->MuscleLevel)));
    }
    this->Body = this->Select(
      [&](std::size_t voxel)
      {
        return this->Has(tissue, voxel) ||
          (this->Has(this->Deep, voxel) && this->HeightMm(voxel) < this->WallMm);
      });
  }

  void FindGlandThreshold()
  {
    this->GlandThreshold = this->Options.GlandThreshold;
    if (this->GlandThreshold == 0)
    {
      const MaskImage::Pointer tissue = this->Select(
        [&](std::size_t voxel) { return this->InBreast(voxel) || this->InMuscle(voxel); });
      this->GlandThreshold =
        OtsuThresholds(ValuesIn(this->Image, tissue), this->Options.Classes).back();
    }
  }

  /// Gland in the volume's own order, without specks and without the dark rim of the body.
  void LabelGland(LabelVolume& labels, const std::vector<float>& depth) const
  {
    // Voxels at the air are dark as they are not full: the larger of the old and new ones' size.
    const double rimMm = this->Options.SkinThicknessMm + this->RimMm;
    const std::array<int, 3> size = SizeOf(*this->Image);
    MaskImage::Pointer dark = this->Select([&](std::size_t voxel)
      { return this->InBreast(voxel) && this->Value(voxel) < this->GlandThreshold; });
    this->Order.ForEachVoxel(size,
      [&](std::size_t inImage, std::size_t inVolume)
      {
        unsigned char& voxel = dark->GetBufferPointer()[inImage];
        voxel = depth[inVolume] > rimMm ? voxel : 0;
      });
    const double voxelMm3 = labels.VoxelVolume();
    const ComponentImage::Pointer parts = FindComponents(dark,
      static_cast<std::size_t>(std::ceil(this->Options.SmallestGlandMm3 / voxelMm3)));
    // Muscle at the side of the chest hangs together with what is behind the cut; gland does not.
    std::set<unsigned> atCut;
    for (std::size_t voxel = 0; voxel < CountOf(*this->Image); ++voxel)
    {
      if (this->HeightMm(voxel) <= this->CutMm + 2 * this->Image->GetSpacing()[1])
      {
        atCut.insert(parts->GetBufferPointer()[voxel]);
      }
    }
    this->Order.ForEachVoxel(size,
      [&](std::size_t inImage, std::size_t inVolume)
      {
        const unsigned part = parts->GetBufferPointer()[inImage];
        if (part != 0)
        {
          labels.Voxels[inVolume] = static_cast<std::uint16_t>(
            atCut.count(part) > 0 ? TissueLabel::ChestWall : TissueLabel::Gland);
        }
      });
  }

  SegmentationResult Label()
  {
    const std::array<int, 3> size = SizeOf(*this->Image);
    SegmentationResult result;
    static_cast<VolumeGrid&>(result.Labels) = this->Order.GridOf(*this->Image);
    static_cast<VolumeGrid&>(result.Corrected) = result.Labels;
    result.Labels.Voxels.resize(CountOf(*this->Image));
    result.Corrected.Voxels.resize(CountOf(*this->Image));
    const auto put = [&](std::size_t inVolume, TissueLabel label)
    { result.Labels.Voxels[inVolume] = static_cast<std::uint16_t>(label); };
    this->Order.ForEachVoxel(size,
      [&](std::size_t inImage, std::size_t inVolume)
      {
        result.Corrected.Voxels[inVolume] = this->Value(inImage);
        put(inVolume,
          this->AboveChestWallMm(inImage) <= 0 ? TissueLabel::ChestWall
            : this->Has(this->Body, inImage)   ? TissueLabel::Fat
                                               : TissueLabel::Air);
      });
    std::vector<bool> held(5, false);
    held[static_cast<std::size_t>(TissueLabel::ChestWall)] = true;
    this->LabelGland(result.Labels,
      DepthBelowAir(result.Labels, this->Options.SkinThicknessMm + this->RimMm, held));
    // Before the cuts, whose faces have no skin.
    if (this->Options.SkinThicknessMm > 0)
    {
      result.Labels = AddSkin(result.Labels, this->Options.SkinThicknessMm,
        static_cast<int>(TissueLabel::Skin), held);
    }
    this->Cut(result.Labels);
    result.AirThreshold = this->AirThreshold;
    result.GlandThreshold = this->GlandThreshold;
    result.MuscleLevel = this->MuscleLevel;
    result.Breasts = this->Breasts;
    return result;
  }

  /// Leaves the part before the cut, of one side where asked for, that hangs together.
  void Cut(LabelVolume& labels) const
  {
    const std::array<int, 3> size = SizeOf(*this->Image);
    MaskImage::Pointer kept = MakeLike<MaskImage>(*this->Image, 0);
    this->Order.ForEachVoxel(size,
      [&](std::size_t inImage, std::size_t inVolume)
      {
        const bool left = this->LeftMm(inImage) > this->MidlineMm;
        const bool side = this->Options.Side == BreastSide::Both ||
          left == (this->Options.Side == BreastSide::Left);
        kept->GetBufferPointer()[inImage] =
          labels.Voxels[inVolume] != 0 && side && this->HeightMm(inImage) > this->CutMm ? 1 : 0;
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

  const SegmentationOptions& Options;
  const ProgressCallback& Progress;
  PatientOrder Order;
  /// The MRI, corrected as soon as that is done.
  FloatImage::Pointer Image;
  MaskImage::Pointer Body;
  /// The body without lungs and the like.
  MaskImage::Pointer Bright;
  /// What has much tissue before it.
  MaskImage::Pointer Deep;
  HeightMap::Pointer ChestWall;
  double AirThreshold = 0;
  double FatThreshold = 0;
  double GlandThreshold = 0;
  double MuscleLevel = 0;
  /// Front of the chest wall (its 90th percentile) and back of the result, as y.
  double WallMm = 0;
  double CutMm = 0;
  double MidlineMm = 0;
  /// Largest voxel spacing of the MRI.
  double RimMm;
  int Breasts = 0;
};
}

void SegmentationOptions::Validate() const
{
  const auto check = [](bool good, const char* name, const char* expected, double found)
  {
    if (!good)
    {
      throw InputError(std::string(name) + ": expected " + expected + ", found " + Number(found));
    }
  };
  const auto atLeastZero = [](double value) { return value >= 0 && std::isfinite(value); };
  check(atLeastZero(this->SpacingMm), "spacing", "0 or a positive number of mm", this->SpacingMm);
  check(atLeastZero(this->SkinThicknessMm), "skin thickness", "0 or a positive number of mm",
    this->SkinThicknessMm);
  check(atLeastZero(this->ChestWallDepthMm) && this->ChestWallDepthMm > 0, "chest wall depth",
    "a positive number of mm", this->ChestWallDepthMm);
  check(this->Classes >= 2 && this->Classes <= 5, "classes", "2 to 5", this->Classes);
  check(atLeastZero(this->AirThreshold), "air threshold", "0 or a positive intensity",
    this->AirThreshold);
  check(this->GlandThreshold >= 0 && this->GlandThreshold < 1, "gland threshold",
    "0 or a fraction of fat's intensity below 1", this->GlandThreshold);
  check(atLeastZero(this->SmallestGlandMm3), "smallest gland", "0 or a positive number of mm3",
    this->SmallestGlandMm3);
}

SegmentationResult SegmentBreast(const IntensityVolume& image, const SegmentationOptions& options,
  const ProgressCallback& progress)
{
  options.Validate();
  CheckImage(image);
  try
  {
    return Segmenter(image, options, progress).Run();
  }
  catch (const itk::ExceptionObject& error)
  {
    throw ConvergenceError(std::string("segmentation: ") + error.GetDescription());
  }
}
}
