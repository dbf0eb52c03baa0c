// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Registration/Private/PictureFeatures.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

namespace
{
using namespace mammoray;

constexpr PictureComparison AllComparisons[] = { PictureComparison::Global,
  PictureComparison::Local, PictureComparison::Gradient };

/// 12 x 9 pixels of 2 x 1.5 mm, along other axes than the picture's.
ReceptorGrid FeatureGrid()
{
  ReceptorGrid grid;
  grid.Columns = 12;
  grid.Rows = 9;
  grid.ColumnStep = { 0, 2 };
  grid.RowStep = { -1.5, 0 };
  return grid;
}

/// Those in a disc, so that rows begin and end anywhere.
std::vector<std::size_t> PixelsInDisc()
{
  std::vector<std::size_t> pixels;
  for (std::size_t pixel = 0; pixel < 12 * 9; ++pixel)
  {
    const double x = static_cast<double>(pixel % 12) - 6;
    const double y = static_cast<double>(pixel / 12) - 4;
    if (std::hypot(x, y) < 4.6)
    {
      pixels.push_back(pixel);
    }
  }
  return pixels;
}

std::vector<float> RandomPicture(unsigned seed)
{
  std::mt19937 generator(seed);
  std::normal_distribution<float> normal(1.0f, 0.3f);
  std::vector<float> picture(12 * 9);
  std::generate(picture.begin(), picture.end(), [&] { return normal(generator); });
  return picture;
}

TEST(ZScores, HaveMeanNoneAndDeviationOne)
{
  const std::vector<std::size_t> pixels = PixelsInDisc();
  const std::vector<float> picture = RandomPicture(1);
  const ZScores scores(picture, pixels);
  const double count = static_cast<double>(pixels.size());
  const double sum = std::accumulate(scores.Scores.begin(), scores.Scores.end(), 0.0);
  const double squares =
    std::inner_product(scores.Scores.begin(), scores.Scores.end(), scores.Scores.begin(), 0.0);
  EXPECT_NEAR(sum / count, 0, 1e-12);
  // 1e-6 is added to the deviation of 0.3: twice that share of the square.
  EXPECT_NEAR(squares / count, 1, 1e-5);
  EXPECT_NEAR(scores.Spread, 0.3, 0.05); // of 66 values
  // Pixels that are not named do not count, nan or not.
  std::vector<float> other = picture;
  other[0] = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(ZScores(other, pixels).Scores, scores.Scores);
}

TEST(ZScores, OfAnEvenPictureAreZeroAndHaveRates)
{
  const std::vector<std::size_t> pixels = PixelsInDisc();
  const ZScores scores(std::vector<float>(12 * 9, 0.7f), pixels);
  for (const double score : scores.Scores)
  {
    EXPECT_EQ(score, 0);
  }
  std::vector<double> rates(pixels.size(), 1.0);
  scores.Differentiate(rates);
  for (const double rate : rates)
  {
    // An even change of an even picture: rounding, over the 1e-6 that a deviation has at least.
    EXPECT_NEAR(rate, 0, 1e-8);
  }
}

TEST(PictureFeatures, AreFreeOfScaleAndOffset)
{
  const std::vector<std::size_t> pixels = PixelsInDisc();
  const std::vector<float> picture = RandomPicture(2);
  std::vector<float> other = picture;
  for (float& value : other)
  {
    value = 3 * value + 7;
  }
  for (const PictureComparison kind : AllComparisons)
  {
    const PictureFeatures features(kind, FeatureGrid(), pixels, 6);
    const auto found = features.Of(picture);
    const auto same = features.Of(other);
    ASSERT_EQ(found.Values.size(), features.Size());
    for (std::size_t n = 0; n < features.Size(); ++n)
    {
      // Floats of 10 have steps of 1e-6, 1e-6 of the deviation, and what is added to it.
      EXPECT_NEAR(same.Values[n], found.Values[n], 3e-5) << static_cast<int>(kind);
    }
  }
}

TEST(PictureFeatures, DerivativesAreThoseOfTheFeatures)
{
  const std::vector<std::size_t> pixels = PixelsInDisc();
  const std::vector<float> picture = RandomPicture(3);
  const std::vector<float> direction = RandomPicture(4);
  std::vector<double> rates;
  for (const std::size_t pixel : pixels)
  {
    rates.push_back(direction[pixel]);
  }
  for (const PictureComparison kind : AllComparisons)
  {
    const PictureFeatures features(kind, FeatureGrid(), pixels, 6);
    const std::vector<double> exact = features.Differentiate(features.Of(picture), rates);
    ASSERT_EQ(exact.size(), features.Size());
    const auto moved = [&](float step)
    {
      std::vector<float> image = picture;
      for (std::size_t pixel = 0; pixel < image.size(); ++pixel)
      {
        image[pixel] += step * direction[pixel];
      }
      return features.Of(image).Values;
    };
    constexpr float step = 1.0f / 256;
    const std::vector<double> after = moved(step);
    const std::vector<double> before = moved(-step);
    for (std::size_t n = 0; n < exact.size(); ++n)
    {
      // Floats of 1 round by 6e-8 over a step of 4e-3 and a deviation of 0.3; the step's square,
      // 1.5e-5, times third derivatives of some tens.
      EXPECT_NEAR((after[n] - before[n]) / (2 * step), exact[n], 5e-3) << static_cast<int>(kind);
    }
  }
}

TEST(PictureFeatures, GradientOfARampIsItsSlope)
{
  const ReceptorGrid grid = FeatureGrid();
  std::vector<std::size_t> pixels(12 * 9);
  std::iota(pixels.begin(), pixels.end(), 0);
  // 0.5 per mm along columns (2 mm apart) and -0.25 per mm along rows (1.5 mm apart).
  std::vector<float> ramp;
  for (int pixel = 0; pixel < 12 * 9; ++pixel)
  {
    ramp.push_back(
      0.5f * 2 * static_cast<float>(pixel % 12) - 0.25f * 1.5f * static_cast<float>(pixel / 12));
  }
  const PictureFeatures features(PictureComparison::Gradient, grid, pixels, 0);
  const auto found = features.Of(ramp);
  // Pairs within rows, and within columns: none across the end of a row.
  ASSERT_EQ(features.Size(), 11u * 9 + 12u * 8);
  const auto along = std::count_if(found.Values.begin(), found.Values.end(),
    [&](double value) { return std::abs(value * found.Whole.Deviation - 0.5) < 1e-6; });
  const auto across = std::count_if(found.Values.begin(), found.Values.end(),
    [&](double value) { return std::abs(value * found.Whole.Deviation + 0.25) < 1e-6; });
  EXPECT_EQ(along, 11 * 9);
  EXPECT_EQ(across, 12 * 8);
}

TEST(PictureFeatures, LocalTakesOutWhatChangesSlowly)
{
  const std::vector<std::size_t> pixels = PixelsInDisc();
  std::vector<float> picture = RandomPicture(5);
  // A slope far steeper than the picture's own spread.
  std::vector<float> sloped = picture;
  for (std::size_t pixel = 0; pixel < sloped.size(); ++pixel)
  {
    sloped[pixel] += 2 * static_cast<float>(pixel % 12);
  }
  const auto correlation = [&](PictureComparison kind)
  {
    const PictureFeatures features(kind, FeatureGrid(), pixels, 5);
    const std::vector<double> a = features.Of(picture).Values;
    const std::vector<double> b = features.Of(sloped).Values;
    const double both = std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
    return both /
      std::sqrt(std::inner_product(a.begin(), a.end(), a.begin(), 0.0) *
        std::inner_product(b.begin(), b.end(), b.begin(), 0.0));
  };
  EXPECT_LT(std::abs(correlation(PictureComparison::Global)), 0.3);
  // Within a window of five pixels the slope is still 2 x sqrt(2) against 0.3.
  EXPECT_GT(correlation(PictureComparison::Local), 0.35);
  // Where the breast is even, noise is not blown up: a window's deviation counts for no less than a
  // quarter of the whole picture's.
  std::vector<float> half(12 * 9, 1.0f);
  for (std::size_t pixel = 0; pixel < half.size(); ++pixel)
  {
    half[pixel] = pixel % 12 < 6 ? 1.0f + 1e-4f * static_cast<float>(pixel % 2) : picture[pixel];
  }
  const auto values =
    PictureFeatures(PictureComparison::Local, FeatureGrid(), pixels, 4).Of(half).Values;
  for (std::size_t n = 0; n < pixels.size(); ++n)
  {
    EXPECT_TRUE(pixels[n] % 12 >= 5 || std::abs(values[n]) < 0.01) << n;
  }
}
}
