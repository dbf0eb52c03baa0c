// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_ScatterOptions_h
#define mammoray_ScatterOptions_h

#include "OptionList.h"
#include "mammoray/Foundation/MaterialTable.h"
#include "mammoray/XRay/Exposure.h"
#include "mammoray/XRay/Scatter/MonteCarlo.h"

#include <array>
#include <memory>
#include <optional>
#include <string>

namespace mammoray
{
/// Scatter options of 'mammoray register'.
struct KernelScatterArguments
{
  /// Empty: none; "kernels".
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

/// The materials of a surface in voxels. Throws InputError where it is not closed, and where this
/// build has no Meshing module.
std::shared_ptr<const VoxelScene> MakeVoxelScene(double voxelMm, const SurfaceMesh& surface,
  const MaterialTable& materials, const ProgressCallback& progress);

/// Lines for people: the mean dose of each material by the air kerma, and in mGy where it is known
/// how many photons meet a pixel.
std::string DescribeDose(const Dose& dose, const MaterialTable& materials, double photonsPerPixel);
}

#endif
