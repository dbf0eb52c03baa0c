// SPDX-License-Identifier: Apache-2.0
#include "ScatterAndDose.h"

#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/ScatterData.h"
#ifdef MAMMORAY_HAS_MESHING
#include "mammoray/Meshing/SurfaceMesher.h"
#endif

#include <cstdio>

namespace mammoray
{
std::shared_ptr<const VoxelScene> MakeVoxelScene(double voxelMm, const SurfaceMesh& surface,
  const MaterialTable& materials, const ProgressCallback& progress)
{
#ifdef MAMMORAY_HAS_MESHING
  return std::make_shared<VoxelScene>(LabelSurfaces(surface, voxelMm, progress),
    MakePhotonMaterials(materials));
#else
  (void)voxelMm;
  (void)surface;
  (void)materials;
  (void)progress;
  throw InputError("--dose, --scatter monte-carlo: expected a build with the Meshing module");
#endif
}

std::string DescribeDose(const Dose& dose, const MaterialTable& materials, double photonsPerPixel)
{
  char line[200];
  std::snprintf(line, sizeof line,
    "dose, by %.3g photons, per mGy of air kerma (no backscatter) %.1f mm above the detector",
    static_cast<double>(dose.Photons), dose.HeightMm);
  std::string text = line;
  if (photonsPerPixel > 0)
  {
    std::snprintf(line, sizeof line, "; %.3g mGy of it for %g photons per pixel", dose.AirKermaMgy,
      photonsPerPixel);
    text += line;
  }
  for (std::size_t material = 1; material < dose.MassesG.size(); ++material)
  {
    if (dose.MassesG[material] <= 0)
    {
      continue;
    }
    std::snprintf(line, sizeof line, "\n%12s %7.1f g %7.4f +- %.4f",
      materials.Materials[material].Name.c_str(), dose.MassesG[material],
      dose.PerAirKerma[material], dose.Error[material]);
    text += line;
    if (photonsPerPixel > 0)
    {
      std::snprintf(line, sizeof line, "   %.3g mGy",
        dose.PerAirKerma[material] * dose.AirKermaMgy);
      text += line;
    }
  }
  return text;
}
}
