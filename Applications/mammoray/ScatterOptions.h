// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_ScatterOptions_h
#define mammoray_ScatterOptions_h

#include "OptionList.h"
#include "mammoray/IO/SceneIO.h"

#include <array>
#include <memory>
#include <optional>
#include <string>

namespace mammoray
{
/// Scatter options of 'mammoray project' and 'mammoray register'.
struct KernelScatterArguments
{
  /// Empty: none; "kernels"; 'mammoray project' also has "monte-carlo".
  std::string Method;
  std::optional<double> AirGapMm;
  /// Ratio, lines per cm, septum in micrometres.
  std::optional<std::array<double, 3>> Grid;
  std::string Interspace = "fibre";
};

/// --air-gap, --grid and --grid-interspace.
void DeclareKernelScatter(const OptionList& scatter, KernelScatterArguments& arguments);
/// Throws InputError on these options without a method, and on an impossible grid.
void CheckKernelScatter(const KernelScatterArguments& arguments);

/// Scatter, grid and dose of 'mammoray project'.
struct ScatterArguments : KernelScatterArguments
{
  bool Dose = false;
  double Photons = 1e7;
  double VoxelMm = 1;
};

void DeclareScatter(const OptionList& add, ScatterArguments& arguments);
/// Throws InputError on options that contradict each other.
void SetScatter(const ScatterArguments& arguments, SceneDescription& description);

/// The materials of a surface in voxels. Throws InputError where it is not closed, and where this
/// build has no Meshing module.
std::shared_ptr<const VoxelScene> MakeVoxelScene(double voxelMm, const SurfaceMesh& surface,
  const MaterialTable& materials, const ProgressCallback& progress);

/// Lines for people: the mean dose of each material by the air kerma, and in mGy where it is known
/// how many photons meet a pixel.
std::string DescribeDose(const Dose& dose, const MaterialTable& materials, double photonsPerPixel);
}

#endif
