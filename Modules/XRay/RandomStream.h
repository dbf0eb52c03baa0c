// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_RandomStream_h
#define mammoray_RandomStream_h

#include <cstdint>

namespace mammoray
{
/**
 * Random numbers that depend only on a seed and on the number of a pixel or photon, so that any
 * number of threads may share the work: splitmix64 (Steele, Lea and Flood 2014).
 */
class RandomStream
{
public:
  RandomStream(std::uint64_t seed, std::uint64_t number)
    : State(Mix(seed + 0x9e3779b97f4a7c15) ^ Mix(number * 0x9e3779b97f4a7c15 + 1))
  {
  }
  /// Uniformly distributed in (0, 1), with 53 random bits.
  double Uniform()
  {
    this->State += 0x9e3779b97f4a7c15;
    return (static_cast<double>(Mix(this->State) >> 11) + 0.5) * 0x1p-53;
  }

private:
  static std::uint64_t Mix(std::uint64_t value)
  {
    value = (value ^ (value >> 30)) * 0xbf58476d1ce4e5b9;
    value = (value ^ (value >> 27)) * 0x94d049bb133111eb;
    return value ^ (value >> 31);
  }
  std::uint64_t State;
};
}

#endif
