// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Private_SceneTable_h
#define mammoray_Private_SceneTable_h

#include "mammoray/IO/SceneIO.h"

#include <nlohmann/json.hpp>

#include <functional>
#include <vector>

namespace mammoray
{
/// Largest absolute coordinate: a kilometre. A larger one has a wrong unit.
inline constexpr double MostCoordinateMm = 1e6;

/// A quantity and the member of a description that holds it. Values are plain: lengths are mm,
/// paths those from the working folder.
struct SceneRow
{
  SceneQuantity Quantity;
  std::function<void(SceneDescription&, const nlohmann::json&)> Set;
  /// Null if the description has no value.
  std::function<nlohmann::json(const SceneDescription&)> Get;
};

/// The keys of scene files, in the order of their documentation.
const std::vector<SceneRow>& SceneRows();
}

#endif
