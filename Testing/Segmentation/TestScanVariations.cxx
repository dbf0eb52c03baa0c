// SPDX-License-Identifier: Apache-2.0
// Real scans as other scanners, protocols and patients would have made them: each must end in the
// labels of the scan itself, or in a refusal. MAMMORAY_LONG_TESTS=1 runs them (20 s a row of the
// table that each prints), MAMMORAY_VARIATION=REGEX those whose names match it alone,
// MAMMORAY_PICTURES=FOLDER draws them.
#include "Files.h"
#include "mammoray/Dicom/DicomReader.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/AtomicFile.h"
#include "mammoray/IO/ShippedData.h"
#include "mammoray/Segmentation/BreastSegmentation.h"
#include "mammoray/Study/StudyPictures.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <numbers>
#include <random>
#include <regex>

namespace
{
using namespace mammoray;

/// A point of the varied scan in the scan that it was made of.
using PointMap = std::function<Vector3(const Vector3&)>;

struct VariedScan
{
  IntensityVolume Image;
  PointMap ToOriginal = [](const Vector3& point) { return point; };
};

/// A scan and the labels found in it.
struct OriginalScan
{
  IntensityVolume Image;
  SegmentationResult Found;
  /// Of the thermal noise, from the quietest blocks of air.
  double NoiseSigma = 0;
};

struct Variation
{
  const char* Name;
  std::function<VariedScan(const OriginalScan&)> Make;
  /// Only of images where fat is dark.
  bool SuppressedOnly = false;
};

/// Mean over the voxels of other sizes, trilinear between them; axes as in the first.
IntensityVolume Resampled(const IntensityVolume& image, const Vector3& spacing)
{
  IntensityVolume result;
  static_cast<VolumeGrid&>(result) = image;
  std::array<int, 3> parts;
  Vector3 first;
  for (std::size_t a = 0; a < 3; ++a)
  {
    const double extent = image.Size[a] * image.Spacing[a];
    result.Spacing[a] = spacing[a];
    result.Size[a] = static_cast<int>(extent / spacing[a]);
    parts[a] = std::max(1, static_cast<int>(std::ceil(spacing[a] / image.Spacing[a])));
    first[a] = -0.5 + 0.5 * spacing[a] / image.Spacing[a];
  }
  result.Origin = image.PointAt(first[0], first[1], first[2]);
  result.Voxels.clear();
  result.ForEachVoxel(
    [&](int i, int j, int k, std::size_t)
    {
      double sum = 0;
      for (int n = 0; n < parts[0] * parts[1] * parts[2]; ++n)
      {
        const auto at = [&](int index, int part, std::size_t a)
        { return index + (part + 0.5) / parts[a] - 0.5; };
        sum += image
                 .ValueAt(result.PointAt(at(i, n % parts[0], 0), at(j, n / parts[0] % parts[1], 1),
                   at(k, n / parts[0] / parts[1], 2)))
                 .value_or(0.0f);
      }
      result.Voxels.push_back(static_cast<float>(sum / (parts[0] * parts[1] * parts[2])));
    });
  return result;
}

/// The axes in another order: axis a of the result is axis order[a].
IntensityVolume Reordered(const IntensityVolume& image, const std::array<int, 3>& order)
{
  IntensityVolume result;
  result.Origin = image.Origin;
  for (std::size_t a = 0; a < 3; ++a)
  {
    const auto from = static_cast<std::size_t>(order[a]);
    result.Size[a] = image.Size[from];
    result.Spacing[a] = image.Spacing[from];
    result.Direction[a] = image.Direction[from];
  }
  result.Voxels.resize(image.Voxels.size());
  result.ForEachVoxel(
    [&](int i, int j, int k, std::size_t voxel)
    {
      const std::array<int, 3> at{ i, j, k };
      std::array<int, 3> in{};
      for (std::size_t a = 0; a < 3; ++a)
      {
        in[static_cast<std::size_t>(order[a])] = at[a];
      }
      result.Voxels[voxel] = image.Voxels[image.Index(in[0], in[1], in[2])];
    });
  return result;
}

/// The voxels from `low` to `high`, fractions of the extent along each axis.
IntensityVolume Cropped(const IntensityVolume& image, const Vector3& low, const Vector3& high)
{
  IntensityVolume result;
  static_cast<VolumeGrid&>(result) = image;
  std::array<int, 3> first;
  for (std::size_t a = 0; a < 3; ++a)
  {
    first[a] = static_cast<int>(low[a] * image.Size[a]);
    result.Size[a] = static_cast<int>(high[a] * image.Size[a]) - first[a];
  }
  result.Origin = image.PointAt(first[0], first[1], first[2]);
  result.ForEachVoxel(
    [&](int i, int j, int k, std::size_t) {
      result.Voxels.push_back(image.Voxels[image.Index(first[0] + i, first[1] + j, first[2] + k)]);
    });
  return result;
}

/// Every voxel by a function of its value and its place, fractions of the extent along the axes.
IntensityVolume Changed(const IntensityVolume& image,
  const std::function<double(double value, const Vector3& at, std::size_t voxel)>& change)
{
  IntensityVolume result = image;
  image.ForEachVoxel(
    [&](int i, int j, int k, std::size_t voxel)
    {
      const Vector3 at{ (i + 0.5) / image.Size[0], (j + 0.5) / image.Size[1],
        (k + 0.5) / image.Size[2] };
      result.Voxels[voxel] = static_cast<float>(change(image.Voxels[voxel], at, voxel));
    });
  return result;
}

VariedScan WithNoise(const OriginalScan& scan, double times)
{
  std::mt19937 generator(11);
  std::normal_distribution<double> noise(0, scan.NoiseSigma * std::sqrt(times * times - 1));
  return { Changed(scan.Image,
    [&](double value, const Vector3&, std::size_t)
    { return std::round(std::hypot(value + noise(generator), noise(generator))); }) };
}

VariedScan Scaled(const OriginalScan& scan, double factor)
{
  VariedScan varied{ scan.Image };
  varied.Image.Spacing = factor * scan.Image.Spacing;
  varied.Image.Origin = factor * scan.Image.Origin;
  varied.ToOriginal = [factor](const Vector3& point) { return (1 / factor) * point; };
  return varied;
}

/// The patient's other half: left and right exchanged.
VariedScan Mirrored(const OriginalScan& scan)
{
  VariedScan varied{ scan.Image };
  varied.Image.Origin[0] = -scan.Image.Origin[0];
  for (Vector3& axis : varied.Image.Direction)
  {
    axis[0] = -axis[0];
  }
  varied.ToOriginal = [](const Vector3& point) { return Vector3{ -point[0], point[1], point[2] }; };
  return varied;
}

/// Fat as bright as gland in the outer part of one side: the field was shimmed for the other.
VariedScan FailingSuppression(const OriginalScan& scan)
{
  return { Changed(scan.Image,
    [&](double value, const Vector3& at, std::size_t voxel)
    {
      const auto k = static_cast<int>(voxel / static_cast<std::size_t>(scan.Image.Size[0]) /
        static_cast<std::size_t>(scan.Image.Size[1]));
      const auto j = static_cast<int>(voxel / static_cast<std::size_t>(scan.Image.Size[0]) %
        static_cast<std::size_t>(scan.Image.Size[1]));
      const auto i = static_cast<int>(voxel % static_cast<std::size_t>(scan.Image.Size[0]));
      const int label = scan.Found.Labels.LabelAt(scan.Image.PointAt(i, j, k));
      const double failed = 1 / (1 + std::exp((at[0] - 0.25) / 0.03));
      return label == static_cast<int>(TissueLabel::Fat) ? value * (1 + 2 * failed) : value;
    }) };
}

const Vector3 Whole{ 1, 1, 1 };

const Variation Variations[] = {
  { "256 px",
    [](const OriginalScan& s)
    {
      const double pixel = s.Image.Spacing[0] * s.Image.Size[0] / 256;
      return VariedScan{ Resampled(s.Image, { pixel, pixel, s.Image.Spacing[2] }) };
    } },
  { "slices of 2 mm",
    [](const OriginalScan& s) {
      return VariedScan{ Resampled(s.Image, { s.Image.Spacing[0], s.Image.Spacing[1], 2 }) };
    } },
  { "slices of 3 mm",
    [](const OriginalScan& s) {
      return VariedScan{ Resampled(s.Image, { s.Image.Spacing[0], s.Image.Spacing[1], 3 }) };
    } },
  { "sagittal, 3 mm",
    [](const OriginalScan& s)
    {
      const double pixel = std::max(1.0, s.Image.Spacing[0]);
      return VariedScan{ Reordered(Resampled(s.Image, { 3, pixel, pixel }), { 1, 2, 0 }) };
    } },
  { "coronal, 2 mm",
    [](const OriginalScan& s)
    {
      const double pixel = std::max(1.0, s.Image.Spacing[0]);
      return VariedScan{ Reordered(Resampled(s.Image, { pixel, 2, pixel }), { 0, 2, 1 }) };
    } },
  { "mirrored", Mirrored },
  { "noise x2", [](const OriginalScan& s) { return WithNoise(s, 2); } },
  { "noise x4", [](const OriginalScan& s) { return WithNoise(s, 4); } },
  { "bias x2, across",
    [](const OriginalScan& s)
    {
      return VariedScan{ Changed(s.Image,
        [](double value, const Vector3& at, std::size_t)
        { return value * std::pow(2, at[0] - 0.5); }) };
    } },
  { "bias x2, along",
    [](const OriginalScan& s)
    {
      return VariedScan{ Changed(s.Image,
        [](double value, const Vector3& at, std::size_t)
        { return value * std::pow(2, std::cos(std::numbers::pi * at[2]) - at[1]); }) };
    } },
  { "intensity x0.1",
    [](const OriginalScan& s)
    {
      return VariedScan{ Changed(s.Image,
        [](double value, const Vector3&, std::size_t) { return std::round(0.1 * value); }) };
    } },
  { "intensity x10",
    [](const OriginalScan& s)
    {
      return VariedScan{ Changed(s.Image,
        [](double value, const Vector3&, std::size_t) { return 10 * value; }) };
    } },
  { "cut at the sides",
    [](const OriginalScan& s) {
      return VariedScan{ Cropped(s.Image, { 0.12, 0, 0 }, { 0.88, 1, 1 }) };
    } },
  { "no back",
    [](const OriginalScan& s) {
      return VariedScan{ Cropped(s.Image, { 0, 0, 0 }, { 1, 0.7, 1 }) };
    } },
  { "less high",
    [](const OriginalScan& s) {
      return VariedScan{ Cropped(s.Image, { 0, 0, 0.15 }, { 1, 1, 0.9 }) };
    } },
  { "one breast alone",
    [](const OriginalScan& s) {
      return VariedScan{ Cropped(s.Image, { 0.5, 0, 0 }, Whole) };
    } },
  { "patient x0.7", [](const OriginalScan& s) { return Scaled(s, 0.7); } },
  { "patient x1.25", [](const OriginalScan& s) { return Scaled(s, 1.25); } },
  { "suppression fails at one side", FailingSuppression, true },
};

struct Agreement
{
  double Breast = 0;
  double Gland = 0;
  double Wall = 0;
};

/// Dice over the voxels of the varied result that both results have in their field: what a smaller
/// field lacks is not counted.
Agreement Compare(const SegmentationResult& found, const VariedScan& varied,
  const OriginalScan& original)
{
  std::array<double, 3> both{};
  std::array<double, 3> sum{};
  const LabelVolume& labels = found.Labels;
  const auto classOf = [](int label)
  {
    const bool breast = label != static_cast<int>(TissueLabel::Air) &&
      label != static_cast<int>(TissueLabel::ChestWall);
    return std::array<bool, 3>{ breast, label == static_cast<int>(TissueLabel::Gland),
      label == static_cast<int>(TissueLabel::ChestWall) };
  };
  labels.ForEachVoxel(
    [&](int i, int j, int k, std::size_t voxel)
    {
      const auto here = classOf(labels.Voxels[voxel]);
      const auto there =
        classOf(original.Found.Labels.LabelAt(varied.ToOriginal(labels.PointAt(i, j, k))));
      for (std::size_t what = 0; what < 3; ++what)
      {
        both[what] += here[what] && there[what] ? 2 : 0;
        sum[what] += (here[what] ? 1 : 0) + (there[what] ? 1 : 0);
      }
    });
  return { both[0] / sum[0], both[1] / sum[1], both[2] / sum[2] };
}

/// The deviation of thermal noise: the mean of a magnitude image's air over 1.253 (Rayleigh), of
/// the quietest tenth of blocks that are not empty.
double NoiseOf(const IntensityVolume& image)
{
  constexpr int edge = 8;
  std::vector<double> means;
  for (int k = 0; k < image.Size[2]; ++k)
  {
    for (int j = 0; j + edge <= image.Size[1]; j += edge)
    {
      for (int i = 0; i + edge <= image.Size[0]; i += edge)
      {
        double sum = 0;
        for (int n = 0; n < edge * edge; ++n)
        {
          sum += image.Voxels[image.Index(i + n % edge, j + n / edge, k)];
        }
        if (sum > 0)
        {
          means.push_back(sum / (edge * edge));
        }
      }
    }
  }
  std::sort(means.begin(), means.end());
  return means[means.size() / 10] / std::sqrt(std::numbers::pi / 2);
}

void Print(const char* name, const SegmentationResult& found, const Agreement& agreement)
{
  const BreastMeasures& m = found.Measures;
  std::printf("  %-30s %d %7.0f cm3 %5.1f %% gland %6.0f cm3 wall %4.0f mm   %.3f %.3f %.3f%s\n",
    name, found.Breasts, m.FatCm3 + m.GlandCm3 + m.SkinCm3, 100 * m.GlandFraction, m.ChestWallCm3,
    m.DepthMm, agreement.Breast, agreement.Gland, agreement.Wall,
    found.Warnings.empty() ? "" : ("  " + found.Warnings.front()).c_str());
  std::fflush(stdout);
}

void Draw(const std::string& name, const SegmentationResult& found)
{
  if (const char* folder = std::getenv("MAMMORAY_PICTURES"))
  {
    WriteAtomicFile(std::string(folder) + "/" + name + ".png",
      DrawLabelSlices(found.Corrected, found.Labels, AnatomicalAxes(),
        FindMaterialTable("segment").Names())
        .Png);
  }
}

bool IsAsked(const std::string& name)
{
  const char* asked = std::getenv("MAMMORAY_VARIATION");
  return !asked || std::regex_search(name, std::regex(asked));
}

void RunVariations(const std::string& name, const std::string& series)
{
  const std::filesystem::path folder = std::filesystem::path(test::SharedDataFolder()) / series;
  if (!std::filesystem::exists(folder) || !std::getenv("MAMMORAY_LONG_TESTS"))
  {
    GTEST_SKIP() << "absent: " << folder << ", or MAMMORAY_LONG_TESTS";
  }
  SegmentationOptions options;
  options.SpacingMm = 1.5;
  OriginalScan scan;
  scan.Image = ReadIntensityVolume(folder.string());
  scan.Found = SegmentBreast(scan.Image, options);
  scan.NoiseSigma = NoiseOf(scan.Image);
  std::printf("%s: breasts, volumes, gland, depth; Dice of breast, gland, wall with the scan "
              "itself\n",
    name.c_str());
  Print("as it is", scan.Found, { 1, 1, 1 });
  Draw(name, scan.Found);
  for (const Variation& variation : Variations)
  {
    if (!IsAsked(variation.Name) ||
      (variation.SuppressedOnly && scan.Found.Contrast != FatContrast::FatDark))
    {
      continue;
    }
    const VariedScan varied = variation.Make(scan);
    try
    {
      const SegmentationResult found = SegmentBreast(varied.Image, options);
      const Agreement agreement = Compare(found, varied, scan);
      Print(variation.Name, found, agreement);
      Draw(name + ", " + variation.Name, found);
      EXPECT_EQ(found.Contrast, scan.Found.Contrast) << variation.Name;
      // A tenth of a breast is a smaller error than two readers make at its back, where it has no
      // edge; what is beyond is another body.
      EXPECT_GT(agreement.Breast, 0.9) << variation.Name;
    }
    catch (const InputError& refusal)
    {
      std::printf("  %-30s refused: %s\n", variation.Name, refusal.what());
    }
  }
}
}

TEST(ScanVariations, OfAPlainScan)
{
  RunVariations("uta11-a plain", "uta11-breast-mri-CC-BY-SA-4.0/a/t1-tse");
}

TEST(ScanVariations, OfAFatSuppressedScan)
{
  RunVariations("uta11-a suppressed", "uta11-breast-mri-CC-BY-SA-4.0/a/t1-fat-suppressed");
}

TEST(ScanVariations, OfADenseBreast)
{
  RunVariations("uta11-b suppressed", "uta11-breast-mri-CC-BY-SA-4.0/b/t1-fat-suppressed");
}

TEST(ScanVariations, OfAFattyBreast)
{
  RunVariations("duke plain", "duke-breast-mri-153-CC-BY-NC-4.0/t1_tse");
}
