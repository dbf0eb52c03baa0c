// SPDX-License-Identifier: Apache-2.0
#include "ExampleData.h"

#include "Error.h"
#include "LabelVolumeIO.h"
#include "MaterialTableIO.h"
#include "NearNames.h"
#include "PhysicsData.h"

namespace mammoray
{
ExampleScene MakeExampleScene(const std::string& name)
{
  if (name == "test")
  {
    return MakePlateScene();
  }
  if (name == "boxes")
  {
    return MakeBoxesScene();
  }
  if (name == "veins")
  {
    return MakeVeinsScene();
  }
  if (name == "breast")
  {
    const std::string folder = DataDirectory();
    return MakeBreastScene(ReadLabelVolume(folder + "/victre-phantom-1/labels.nrrd"),
      ReadMaterialTable(folder + "/materials/victre.json"));
  }
  throw InputError("unknown example '" + name + "'; " + SuggestNames(name, ExampleNames()));
}
}
