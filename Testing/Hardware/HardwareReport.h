// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Hardware_HardwareReport_h
#define mammoray_Hardware_HardwareReport_h

#include <nlohmann/json.hpp>

#include <string>

namespace mammoray::hardware
{
using Json = nlohmann::ordered_json;

/// What GoogleTest's own JSON says, shortened: "program", "passed", "failed", "skipped" (numbers),
/// "seconds", and "failures" and "skips", each with "test" and "reason".
Json SummariseProofs(const std::string& program, const Json& googleTest);

/// "all 120 proofs hold (7 skipped)", or what does not.
std::string Verdict(const Json& report);

/// The page: device, verdict, the benchmark's tables and picture, what failed and was skipped.
std::string HardwarePage(const Json& report);
}

#endif
