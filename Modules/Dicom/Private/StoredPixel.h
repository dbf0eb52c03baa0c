// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Private_StoredPixel_h
#define mammoray_Private_StoredPixel_h

#include <gdcmPixelFormat.h>

#include <algorithm>
#include <cstdint>
#include <optional>
#include <utility>

namespace mammoray
{
/// What the bits of a pixel mean: unused ones are cleared, the sign is extended (PS3.5 8.1.1).
struct StoredPixel
{
  explicit StoredPixel(const gdcm::PixelFormat& format)
    : Bits(format.GetBitsStored())
    , Shift(std::max(0, format.GetHighBit() + 1 - format.GetBitsStored()))
    , IsSigned(format.GetPixelRepresentation() == 1)
  {
  }

  std::int64_t ValueOf(std::uint64_t raw) const
  {
    auto value =
      static_cast<std::int64_t>((raw >> this->Shift) & ((std::uint64_t{ 1 } << this->Bits) - 1));
    if (this->IsSigned && (value >> (this->Bits - 1)) != 0)
    {
      value -= std::int64_t{ 1 } << this->Bits;
    }
    return value;
  }

  int Bits;
  int Shift;
  bool IsSigned;
};

/// Stored values where no X-ray was measured, by a header's Pixel Padding Value and Range Limit, as
/// the bits of a short.
struct PixelPadding
{
  std::optional<std::uint16_t> Value;
  std::optional<std::uint16_t> Limit;

  /// From the least to the greatest of them; empty where there are none.
  std::pair<std::int64_t, std::int64_t> Range(bool isSigned) const
  {
    if (!this->Value)
    {
      return { 1, 0 };
    }
    const auto typed = [isSigned](std::uint16_t bits) -> std::int64_t
    { return isSigned ? static_cast<std::int16_t>(bits) : static_cast<std::int64_t>(bits); };
    return std::minmax({ typed(*this->Value), typed(this->Limit.value_or(*this->Value)) });
  }
};
}

#endif
