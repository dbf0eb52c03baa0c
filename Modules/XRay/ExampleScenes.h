// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_ExampleScenes_h
#define mammoray_ExampleScenes_h

#include "mammoray/Foundation/MaterialTable.h"
#include "mammoray/Foundation/Meshes.h"
#include "mammoray/XRay/PathLengthProjector.h"
#include "mammorayXRayModule.h"

#include <string>
#include <vector>

namespace mammoray
{
/**
 * A mesh with a source and a detector, as in the evaluation of Maul, Said, Ruiter, Hopp: X-ray
 * synthesis based on triangular mesh models (2021), which publishes the numbers of triangles and
 * pixels but not the meshes. Closed surfaces; mm.
 */
struct MAMMORAYXRAY_EXPORT ExampleScene
{
  std::string Name;
  SurfaceMesh Surface;
  /// Materials of the surface, with names of attenuation tables in Data/attenuation.
  MaterialTable Materials;
  XRaySource Source;
  XRayDetector Detector;
};

/// "test", "boxes", "veins", "breast".
MAMMORAYXRAY_EXPORT const std::vector<std::string>& ExampleNames();

/// `test`: one plate of 80 x 110 x 5 mm, gland, its faces cut into a grid. 15,626 triangles, 150 x
/// 200 pixels.
MAMMORAYXRAY_EXPORT ExampleScene MakePlateScene();

/// `boxes`: 3965 boxes of 4 x 5 x 3 mm in a lattice, of fat, gland and muscle in turn. Each has its
/// own orientation; none touches another. 47,580 triangles, 250 x 200 pixels.
MAMMORAYXRAY_EXPORT ExampleScene MakeBoxesScene();

/// `veins`: 97 winding tubes of blood. Where two of them cross, both count. 215,728 triangles, 1681
/// x 2071 pixels.
MAMMORAYXRAY_EXPORT ExampleScene MakeVeinsScene();

/**
 * `breast`: the interfaces of a segmented breast, smoothed by surface nets, with points added until
 * the published number of triangles is reached; a cranio-caudal view. `labels` has the axes +x
 * anterior, +y left, +z superior (mm); it is stretched along its axes to a thickness of 50 mm at
 * unchanged volume, which stands in for compression. 5,185,458 triangles (the published 5,185,459
 * is odd, but a closed surface has an even number), 1080 x 1080 pixels. Throws InputError for
 * labels that the table lacks and for volumes with more than 2.5 million faces between materials.
 */
MAMMORAYXRAY_EXPORT ExampleScene MakeBreastScene(const LabelVolume& labels,
  const MaterialTable& table);
}

#endif
