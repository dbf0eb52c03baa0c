// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_SceneOptions_h
#define mammoray_SceneOptions_h

#include "OptionList.h"
#include "mammoray/IO/SceneIO.h"

#include <string>
#include <vector>

namespace mammoray
{
/// What options say of a scene.
struct SceneArguments
{
  std::string File;
  /// MATERIAL=FILE each, in place of samples or a mesh.
  std::vector<std::string> Surfaces;
  /// Unit of these files and of the mesh's; empty: that of their formats.
  std::string Unit;
  /// Of the options that quantities have.
  std::vector<SceneSetting> Settings;
  /// KEY=VALUE each, of --set.
  std::vector<std::string> Sets;
};

/// The option of a quantity, "--photons"; empty: only --set.
std::string OptionOf(const SceneQuantity& quantity);

/// Adds it.
void AddQuantityOption(const OptionList& add, const SceneQuantity& quantity,
  SceneArguments& arguments);

/// Splits KEY=VALUE of an option; `prefix` is put before the key.
SceneSetting ToSetting(const std::string& text, const std::string& option,
  const std::string& prefix = "");

/// The scene's file, changed by the options. Throws InputError as ReadScene and SetQuantity do, and
/// where a file of surfaces is missing.
SceneDescription ReadSceneArguments(const SceneArguments& arguments);

/// Warns of parts that count twice (the text of their measure), unless the text is empty.
void WarnOfOverlap(const std::string& overlap);
}

#endif
