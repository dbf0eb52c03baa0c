// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_ZScores_h
#define mammoray_ZScores_h

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace mammoray
{
/// The values of an image at some pixels, z-scored.
struct ZScores
{
  /// (value - mean) / Deviation.
  std::vector<double> Scores;
  /// Their standard deviation, and that plus 1e-6, which keeps an empty picture (all air) from
  /// dividing by zero; real pictures of attenuation deviate by about 0.3.
  double Spread = 0;
  double Deviation = 0;

  ZScores(const std::vector<float>& image, const std::vector<std::size_t>& pixels)
    : Scores(pixels.size())
  {
    double mean = 0;
    for (const std::size_t pixel : pixels)
    {
      mean += image[pixel];
    }
    mean /= static_cast<double>(pixels.size());
    double squares = 0;
    for (std::size_t index = 0; index < pixels.size(); ++index)
    {
      this->Scores[index] = image[pixels[index]] - mean;
      squares += this->Scores[index] * this->Scores[index];
    }
    this->Spread = std::sqrt(squares / static_cast<double>(pixels.size()));
    this->Deviation = this->Spread + 1e-6;
    for (double& score : this->Scores)
    {
      score /= this->Deviation;
    }
  }

  /// Turns the derivatives of the values at the same pixels into those of the scores.
  void Differentiate(std::vector<double>& derivatives) const
  {
    const auto count = static_cast<double>(derivatives.size());
    double mean = 0;
    double along = 0;
    for (std::size_t index = 0; index < derivatives.size(); ++index)
    {
      mean += derivatives[index] / count;
      along += this->Scores[index] * derivatives[index] / count;
    }
    // d Spread = sum (value - mean) d value / (count Spread), and value - mean = Deviation * score.
    const double spread = this->Spread > 0 ? along * this->Deviation / this->Spread : 0.0;
    for (std::size_t index = 0; index < derivatives.size(); ++index)
    {
      derivatives[index] =
        (derivatives[index] - mean - this->Scores[index] * spread) / this->Deviation;
    }
  }
};
}

#endif
