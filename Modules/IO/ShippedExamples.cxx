// SPDX-License-Identifier: Apache-2.0
#include "mammoray/IO/ShippedExamples.h"

// Apart from the other shipped data, which a build without readers of volumes has, too
// (Wrapping/Python).
#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/SpellingSuggestions.h"
#include "mammoray/IO/LabelVolumeIO.h"
#include "mammoray/IO/MaterialTableIO.h"
#include "mammoray/IO/ShippedData.h"

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
    return MakeBreastScene(ReadLabelFile(folder + "/victre-phantom-1/labels.nrrd"),
      ReadMaterialTable(folder + "/materials/victre.json"));
  }
  throw InputError("unknown example '" + name + "'; " + SpellingHint(name, ExampleNames()));
}
}
