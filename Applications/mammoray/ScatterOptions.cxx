// SPDX-License-Identifier: Apache-2.0
#include "ScatterOptions.h"

#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/ScatterData.h"
#ifdef MAMMORAY_HAS_MESHING
#include "mammoray/Meshing/SurfaceMesher.h"
#endif

#include <cstdio>

namespace mammoray
{
void DeclareKernelScatter(const OptionList& scatter, KernelScatterArguments& arguments)
{
  scatter.Numbers("--grid", arguments.Grid, "RATIO LINES UM",
    "anti-scatter grid of lead: ratio, lines per cm, septum ('5 31 65')\n(focused, micrometres; "
    "septa run along the chest wall; transmissions are relative to air behind the grid)");
  scatter.Expert()("--air-gap", arguments.AirGapMm, Between(0, 200, "mm"),
    "of --scatter kernels: from the back of the tissue to the detector\n(default: the height of "
    "the "
    "unit's support)");
  scatter.CaseFile().Word("--grid-interspace", arguments.Interspace,
    { "fibre", "air", "aluminium" }, "what is between the septa");
}

void CheckKernelScatter(const KernelScatterArguments& arguments)
{
  if (arguments.Method.empty() && (arguments.Grid || arguments.AirGapMm))
  {
    throw InputError("--grid, --air-gap: expected --scatter beside them, found none");
  }
  if (arguments.Grid)
  {
    AntiscatterGrid(AntiscatterGridOptions::OfLead(*arguments.Grid, arguments.Interspace));
  }
}

void DeclareScatter(const OptionList& add, ScatterArguments& arguments)
{
  const OptionList scatter = add.Group("Scatter and dose");
  scatter.Word("--scatter", arguments.Method, { "kernels", "monte-carlo" },
    "add what tissue scatters\n(by kernels, tabulated for breast tissue by the thickness along "
    "each "
    "ray, or by following --mc-photons photons through the materials, whose compositions must be "
    "known)");
  DeclareKernelScatter(scatter, arguments);
  scatter.Flag("--dose", arguments.Dose,
    "print the mean dose of each material, by following photons");
  scatter.Expert()("--mc-photons", arguments.Photons, Between(1, 1e12),
    "photons to follow for each picture, and for --dose");
  scatter.CaseFile()("--mc-voxels", arguments.VoxelMm, Between(0.05, 10, "mm"),
    "edge of the voxels through which photons are followed");
}

void SetScatter(const ScatterArguments& arguments, SceneDescription& description)
{
  CheckKernelScatter(arguments);
  SceneScatter& scatter = description.Fixed.Scatter;
  if (!arguments.Method.empty())
  {
    scatter.Method = arguments.Method == "kernels" ? SceneScatter::Model::Kernels
                                                   : SceneScatter::Model::MonteCarlo;
  }
  scatter.AirGapMm = arguments.AirGapMm.value_or(scatter.AirGapMm);
  scatter.Photons = arguments.Photons;
  if (arguments.Grid)
  {
    scatter.Grid = AntiscatterGridOptions::OfLead(*arguments.Grid, arguments.Interspace);
  }
  description.VoxelMm = arguments.VoxelMm;
  description.Fixed.Dose = arguments.Dose;
}

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
