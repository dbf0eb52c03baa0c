// SPDX-License-Identifier: Apache-2.0
// Tests that run once for each type of element.
#ifndef mammoray_EveryElement_h
#define mammoray_EveryElement_h

#include "mammoray/Biomechanics/CompressionSimulation.h"

#include <gtest/gtest.h>

#include <ostream>
#include <string>

namespace mammoray
{
inline std::string NameOf(ElementType type)
{
  return type == ElementType::Quadratic ? "Quadratic" : "PatchAveragedLinear";
}

/// Found by GoogleTest.
inline void PrintTo(ElementType type, std::ostream* stream)
{
  *stream << NameOf(type);
}

namespace test
{
class EveryElement : public testing::TestWithParam<ElementType>
{
};
}
}

#define MAMMORAY_FOR_EVERY_ELEMENT(suite)                                                          \
  INSTANTIATE_TEST_SUITE_P(Elements, suite,                                                        \
    testing::Values(mammoray::ElementType::Quadratic, mammoray::ElementType::PatchAveragedLinear), \
    [](const auto& tested) { return mammoray::NameOf(tested.param); })

#endif
