// SPDX-License-Identifier: Apache-2.0
#include "SurfaceView.h"

#include "mammoray/Foundation/Error.h"

#include <filesystem>
#include <utility>

namespace mammoray
{
ViewedScene ReadViewedScene(const SceneArguments& arguments)
{
  const SceneDescription description = ReadSceneArguments(arguments);
  if (description.HasSource() != description.HasDetector())
  {
    throw InputError(
      arguments.File + ": expected both source and detector, or neither, to look at");
  }
  if (description.Samples.empty() && description.Mesh.empty())
  {
    throw InputError("view: expected a --scene with samples, found none");
  }
  ViewedScene viewed;
  viewed.Name = !arguments.File.empty() ? arguments.File : description.Samples.front().File;
  viewed.Name = std::filesystem::path(viewed.Name).lexically_normal().string();
  viewed.Scene = LoadScene(description);
  viewed.Scene.Samples = { { Assemble(viewed.Scene) } };
  viewed.Scene.Detector.Samples = 1;
  if (!description.HasSource())
  {
    viewed.Scene.Detector.Columns = viewed.Scene.Detector.Rows = 512;
    PlaceAround(viewed.Scene);
  }
  return viewed;
}
}
