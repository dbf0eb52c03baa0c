// SPDX-License-Identifier: Apache-2.0
#include "Sha256.h"

#include "Error.h"

#include <array>
#include <bit>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <vector>

namespace mammoray
{
namespace
{
/// FIPS 180-4 section 4.2.2: first 32 bits of the fractional parts of cube roots of the first 64
/// primes.
constexpr std::array<std::uint32_t, 64> K{ 0x428a2f98, 0x71374491, 0xb5c0fbcf, 0xe9b5dba5,
  0x3956c25b, 0x59f111f1, 0x923f82a4, 0xab1c5ed5, 0xd807aa98, 0x12835b01, 0x243185be, 0x550c7dc3,
  0x72be5d74, 0x80deb1fe, 0x9bdc06a7, 0xc19bf174, 0xe49b69c1, 0xefbe4786, 0x0fc19dc6, 0x240ca1cc,
  0x2de92c6f, 0x4a7484aa, 0x5cb0a9dc, 0x76f988da, 0x983e5152, 0xa831c66d, 0xb00327c8, 0xbf597fc7,
  0xc6e00bf3, 0xd5a79147, 0x06ca6351, 0x14292967, 0x27b70a85, 0x2e1b2138, 0x4d2c6dfc, 0x53380d13,
  0x650a7354, 0x766a0abb, 0x81c2c92e, 0x92722c85, 0xa2bfe8a1, 0xa81a664b, 0xc24b8b70, 0xc76c51a3,
  0xd192e819, 0xd6990624, 0xf40e3585, 0x106aa070, 0x19a4c116, 0x1e376c08, 0x2748774c, 0x34b0bcb5,
  0x391c0cb3, 0x4ed8aa4a, 0x5b9cca4f, 0x682e6ff3, 0x748f82ee, 0x78a5636f, 0x84c87814, 0x8cc70208,
  0x90befffa, 0xa4506ceb, 0xbef9a3f7, 0xc67178f2 };

void HashBlock(const unsigned char* block, std::array<std::uint32_t, 8>& hash)
{
  std::array<std::uint32_t, 64> w{};
  for (int t = 0; t < 16; ++t)
  {
    w[t] = std::uint32_t{ block[4 * t] } << 24 | std::uint32_t{ block[4 * t + 1] } << 16 |
      std::uint32_t{ block[4 * t + 2] } << 8 | block[4 * t + 3];
  }
  for (int t = 16; t < 64; ++t)
  {
    const std::uint32_t s0 = std::rotr(w[t - 15], 7) ^ std::rotr(w[t - 15], 18) ^ w[t - 15] >> 3;
    const std::uint32_t s1 = std::rotr(w[t - 2], 17) ^ std::rotr(w[t - 2], 19) ^ w[t - 2] >> 10;
    w[t] = w[t - 16] + s0 + w[t - 7] + s1;
  }
  auto [a, b, c, d, e, f, g, h] = hash;
  for (int t = 0; t < 64; ++t)
  {
    const std::uint32_t sum1 = std::rotr(e, 6) ^ std::rotr(e, 11) ^ std::rotr(e, 25);
    const std::uint32_t t1 = h + sum1 + ((e & f) ^ (~e & g)) + K[t] + w[t];
    const std::uint32_t sum0 = std::rotr(a, 2) ^ std::rotr(a, 13) ^ std::rotr(a, 22);
    const std::uint32_t t2 = sum0 + ((a & b) ^ (a & c) ^ (b & c));
    h = g;
    g = f;
    f = e;
    e = d + t1;
    d = c;
    c = b;
    b = a;
    a = t1 + t2;
  }
  const std::array<std::uint32_t, 8> added{ a, b, c, d, e, f, g, h };
  for (int i = 0; i < 8; ++i)
  {
    hash[i] += added[i];
  }
}
}

std::string Sha256OfFile(const std::string& path)
{
  std::ifstream file(path, std::ios::binary);
  if (!file || std::filesystem::is_directory(path))
  {
    throw InputError(path + ": expected a file that can be read");
  }
  std::array<std::uint32_t, 8> hash{ 0x6a09e667, 0xbb67ae85, 0x3c6ef372, 0xa54ff53a, 0x510e527f,
    0x9b05688c, 0x1f83d9ab, 0x5be0cd19 };
  std::vector<unsigned char> buffer(1 << 20);
  std::uint64_t total = 0;
  while (true)
  {
    file.read(reinterpret_cast<char*>(buffer.data()), static_cast<std::streamsize>(buffer.size()));
    std::size_t count = static_cast<std::size_t>(file.gcount());
    total += count;
    const bool last = count < buffer.size();
    if (last)
    {
      // A one bit, zeros, and the length in bits close the message (section 5.1.1).
      buffer.resize((count + 9 + 63) / 64 * 64);
      std::fill(buffer.begin() + static_cast<std::ptrdiff_t>(count), buffer.end(), 0);
      buffer[count] = 0x80;
      for (int i = 0; i < 8; ++i)
      {
        buffer[buffer.size() - 1 - i] = static_cast<unsigned char>(8 * total >> 8 * i);
      }
      count = buffer.size();
    }
    for (std::size_t at = 0; at < count; at += 64)
    {
      HashBlock(&buffer[at], hash);
    }
    if (last)
    {
      break;
    }
  }
  static constexpr char Digits[] = "0123456789abcdef";
  std::string text;
  for (const std::uint32_t word : hash)
  {
    for (int shift = 28; shift >= 0; shift -= 4)
    {
      text += Digits[word >> shift & 15];
    }
  }
  return text;
}
}
