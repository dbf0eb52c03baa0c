// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_FastFourier_h
#define mammoray_FastFourier_h

#include <complex>
#include <vector>

#if defined(__GNUC__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wsign-conversion"
#endif
#include <unsupported/Eigen/FFT>
#if defined(__GNUC__)
#pragma GCC diagnostic pop
#endif

namespace mammoray
{
/// The smallest number of at least `least` without other factors than 2, 3 and 5.
inline int FourierSize(int least)
{
  for (int size = least;; ++size)
  {
    int rest = size;
    for (const int factor : { 2, 3, 5 })
    {
      while (rest % factor == 0)
      {
        rest /= factor;
      }
    }
    if (rest == 1)
    {
      return size;
    }
  }
}

/// The Fourier transform of a picture, in place; the inverse divides by the number of values.
inline void Transform(std::vector<std::complex<double>>& values, int columns, int rows,
  bool inverse)
{
  Eigen::FFT<double> fft;
  std::vector<std::complex<double>> in;
  std::vector<std::complex<double>> out;
  const auto line = [&](std::size_t first, std::size_t step, int count)
  {
    in.resize(static_cast<std::size_t>(count));
    for (std::size_t place = 0; place < in.size(); ++place)
    {
      in[place] = values[first + place * step];
    }
    if (inverse)
    {
      fft.inv(out, in);
    }
    else
    {
      fft.fwd(out, in);
    }
    for (std::size_t place = 0; place < in.size(); ++place)
    {
      values[first + place * step] = out[place];
    }
  };
  for (int row = 0; row < rows; ++row)
  {
    line(static_cast<std::size_t>(row) * columns, 1, columns);
  }
  for (int column = 0; column < columns; ++column)
  {
    line(static_cast<std::size_t>(column), static_cast<std::size_t>(columns), rows);
  }
}
}

#endif
