// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_ScatterOptions_h
#define mammoray_ScatterOptions_h

#include "OptionList.h"
#include "mammoray/Foundation/MaterialTable.h"
#include "mammoray/XRay/Exposure.h"
#include "mammoray/XRay/Scatter/MonteCarlo.h"
#include "mammoray/XRay/Scatter/ScatterModel.h"

#include <array>
#include <memory>
#include <optional>
#include <string>

namespace mammoray
{
/// What every command says of scatter: 'mammoray project' and 'mammoray register'.
struct KernelScatterArguments
{
  /// Empty: none; "kernels", or of 'mammoray project' "monte-carlo".
  std::string Method;
  std::optional<double> AirGapMm;
  /// Ratio, lines per cm, septum in micrometres.
  std::optional<std::array<double, 3>> Grid;
  std::string Interspace = "fibre";
};

/// --air-gap, --grid and --grid-interspace.
void DeclareKernelScatter(const OptionList& scatter, KernelScatterArguments& arguments);
/// Refuses them without a method, and a grid that cannot be.
void CheckKernelScatter(const KernelScatterArguments& arguments);

/// Scatter, grid and dose of 'mammoray project'.
struct ScatterArguments : KernelScatterArguments
{
  /// By Monte Carlo.
  bool Dose = false;
  double Photons = 1e7;
  double VoxelMm = 1;

  bool NeedsVoxels() const { return this->Dose || this->Method == "monte-carlo"; }
};

void DeclareScatter(const OptionList& add, ScatterArguments& arguments);
/// Refuses what does not go together. `isPlacedByUnit`: whether the unit says how far the receptor
/// is from the breast.
void CheckScatter(const ScatterArguments& arguments, bool isPlacedByUnit);

/// What scatters onto pictures that are taken with one spectrum.
class ScatterSource
{
public:
  /// `scene`: where photons are followed; null for kernels alone. `gapMm` where the arguments say
  /// none.
  ScatterSource(const ScatterArguments& arguments, double gapMm, const Spectrum& spectrum,
    const DetectorResponse& response, std::shared_ptr<const VoxelScene> scene);

  /// For ExposureOptions: what comes beside the primary radiation; none where none is asked for.
  /// `inverseSquare`: whether the primary radiation falls with the distance. `progress`: of
  /// following photons.
  decltype(ExposureOptions::Secondary) Onto(const XRaySource& source, const XRayDetector& detector,
    bool inverseSquare, std::uint64_t seed, const ProgressCallback& progress) const;

  /// The same with another spectrum.
  ScatterSource Of(const Spectrum& spectrum) const
  {
    return ScatterSource(this->Arguments, this->GapMm, spectrum, this->Response, this->Scene);
  }

private:
  std::vector<double> FollowOnto(const XRaySource& source, const XRayDetector& detector,
    bool inverseSquare, std::uint64_t seed, const ProgressCallback& progress) const;

  ScatterArguments Arguments;
  double GapMm;
  Spectrum Energies;
  DetectorResponse Response;
  std::optional<AntiscatterGrid> Grid;
  std::optional<ScatterModel> Model;
  std::shared_ptr<const VoxelScene> Scene;
};

/// The materials of a surface in voxels. Throws InputError where it is not closed, and where this
/// build has no Meshing module.
std::shared_ptr<const VoxelScene> MakeVoxelScene(const ScatterArguments& arguments,
  const SurfaceMesh& surface, const MaterialTable& materials, const ProgressCallback& progress);

/**
 * Lines for people: mean dose of each material by the air kerma (without backscatter) where the ray
 * that meets the detector at right angles passes `heightMm` over it; without it, where it enters
 * the box around the tissue. In mGy, too, where `photonsPerPixel` is more than 0.
 */
std::string DescribeDose(const ScatterArguments& arguments, const VoxelScene& scene,
  const MaterialTable& materials, const XRaySource& source, const XRayDetector& detector,
  const Spectrum& spectrum, double photonsPerPixel, std::optional<double> heightMm,
  const ProgressCallback& progress);
}

#endif
