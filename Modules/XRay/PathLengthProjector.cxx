// SPDX-License-Identifier: Apache-2.0
#include "PathLengthProjector.h"

#include <algorithm>

namespace mammoray
{
std::size_t PathLengthImage::NumberOfInconsistentRays() const
{
  return static_cast<std::size_t>(std::count(this->Inconsistent.begin(), this->Inconsistent.end(),
    static_cast<unsigned char>(1)));
}
}
