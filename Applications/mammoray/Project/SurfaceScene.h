// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_SurfaceScene_h
#define mammoray_SurfaceScene_h

#include "mammoray/Foundation/MaterialTable.h"
#include "mammoray/Foundation/SurfaceMesh.h"

#include <string>
#include <vector>

namespace mammoray
{
/// What is X-rayed, and of what it is.
struct SurfaceScene
{
  SurfaceMesh Surface;
  MaterialTable Materials;
};

/// The interfaces of a mesh's file, whose materials are of `table`. Throws InputError.
SurfaceScene ReadMeshScene(const std::string& path, const MaterialTable& table);

/**
 * Closed surfaces, each of one material: "MATERIAL=FILE", where MATERIAL is one of `table` or what
 * it is made of, "Ti90Al6V4@4.43", with the density in g/cm3 where the composition does not tell it
 * (see FindComposition). They are added to the table in their order. Throws InputError that names
 * the surface.
 */
SurfaceScene ReadSurfaceScene(const std::vector<std::string>& surfaces, MaterialTable table);
}

#endif
