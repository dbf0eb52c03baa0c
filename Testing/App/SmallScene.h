// SPDX-License-Identifier: Apache-2.0
// A small scene to look at.
#ifndef mammoray_SmallScene_h
#define mammoray_SmallScene_h

#include "SurfaceShapes.h"
#include "mammoray/IO/ShippedData.h"
#include "mammoray/XRay/Scene.h"

#include <memory>

namespace mammoray::test
{
/// A box of 10 x 20 x 40 um of aluminium before a parallel beam along y.
inline Scene SmallBox()
{
  Scene scene;
  SurfaceMesh box;
  shapes::AddBox(box, { 1, 2, 3 }, { 1.01, 2.02, 3.04 }, 1);
  scene.Samples = { { std::make_shared<const SurfaceMesh>(box) } };
  scene.Materials.Materials = { { .Name = "air" },
    { .Name = "Al", .Attenuation = "Al", .DensityGPerCm3 = 2.7 } };
  scene.Attenuations = FindAttenuations(scene.Materials);
  scene.XRays = Spectrum::Monochromatic(20);
  scene.Source.Type = XRaySource::Kind::Parallel;
  scene.Source.Direction = { 0, 1, 0 };
  scene.Detector.ColumnStep = { 0.001, 0, 0 };
  scene.Detector.RowStep = { 0, 0, -0.001 };
  scene.Detector.Columns = 64;
  scene.Detector.Rows = 64;
  scene.Detector.Origin = { 1.005 - 0.0315, 5, 3.02 + 0.0315 };
  return scene;
}
}

#endif
