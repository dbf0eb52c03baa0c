// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_MonteCarlo_h
#define mammoray_MonteCarlo_h

#include "mammoray/Foundation/LabelVolume.h"
#include "mammoray/Foundation/Progress.h"
#include "mammoray/XRay/Beam.h"
#include "mammoray/XRay/PathLengthProjector.h"
#include "mammoray/XRay/Scatter/AntiscatterGrid.h"
#include "mammoray/XRay/Scatter/PhotonMaterial.h"
#include "mammorayXRayModule.h"

#include <array>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

namespace mammoray
{
/// Where photons fly: regions of any shape, each of a material, within a box and around it.
class MAMMORAYXRAY_EXPORT PhotonScene
{
public:
  virtual ~PhotonScene() = default;
  /// The region at a point of the box, 0 to the number of regions - 1.
  virtual int RegionAt(const Vector3& point) const = 0;
  /// What each region is made of.
  const std::vector<PhotonMaterial>& Materials() const { return this->Regions; }
  /// Corners of the box, mm.
  const Vector3& Low() const { return this->Corners[0]; }
  const Vector3& High() const { return this->Corners[1]; }
  /// What is around the box.
  const PhotonMaterial& Surroundings() const { return this->Around; }

protected:
  PhotonScene(std::vector<PhotonMaterial> regions, PhotonMaterial surroundings)
    : Regions(std::move(regions))
    , Around(std::move(surroundings))
  {
  }
  void SetBox(const Vector3& low, const Vector3& high) { this->Corners = { low, high }; }

private:
  std::vector<PhotonMaterial> Regions;
  PhotonMaterial Around;
  std::array<Vector3, 2> Corners{};
};

/// The voxels of a volume, in its frame: region m is `materials[m]`, m what the voxel says.
class MAMMORAYXRAY_EXPORT VoxelScene : public PhotonScene
{
public:
  /// Throws InputError where a voxel says a material that is not there. Around is a vacuum.
  VoxelScene(LabelVolume volume, std::vector<PhotonMaterial> materials);
  int RegionAt(const Vector3& point) const override;
  const LabelVolume& Volume() const { return this->Voxels; }
  /// Mass of each region, g; that of region 0, what is around, too.
  std::vector<double> MassesG() const;

private:
  LabelVolume Voxels;
};

struct MAMMORAYXRAY_EXPORT MonteCarloOptions
{
  /// How many leave the source towards the detector; 1 to 1e12.
  std::int64_t Photons = 1000000;
  std::uint64_t Seed = 0;
  /// In front of the detector.
  std::optional<AntiscatterGrid> Grid;
};

struct MAMMORAYXRAY_EXPORT MonteCarloResult
{
  std::int64_t Photons = 0;
  /// Energy left in each region, keV per photon, and its standard error.
  std::vector<double> DepositedKeV;
  std::vector<double> DepositedErrorKeV;
  /// Energy in what is around the box, what left it altogether, and what the detector got.
  double SurroundingsKeV = 0;
  double EscapedKeV = 0;
  double DetectedKeV = 0;
  /// Mean energy of the photons that set out, keV.
  double EmittedKeV = 0;
  /// Signals by pixel, Rows * Columns values, relative to the primary signal without an object (but
  /// with the grid) where the ray from the focus meets the detector's plane at right angles; each
  /// with its standard error.
  std::vector<float> Primary;
  std::vector<float> PrimaryError;
  std::vector<float> Scatter;
  std::vector<float> ScatterError;
};

/// Of one photon that leaves for the pixels of a detector as FollowPhotons sends them, how many
/// would meet 1 mm^2 of its plane where the ray from the focus meets it at right angles.
MAMMORAYXRAY_EXPORT double CentralFluence(const XRaySource& source, const XRayDetector& detector);

/**
 * Follows photons that leave a point source with the same probability in every direction of the
 * detector's pixels, through the scene until they are absorbed or have left it, by delta tracking
 * (Woodcock et al. 1965): free paths in the densest material of the box, of which each collision is
 * real with the probability that the material there says. No photon is weighted or split. The
 * detector is an ideal one, which keeps all that meets its pixels.
 *
 * The same seed and number of photons give the same result, whatever the number of threads, but for
 * the rounding of sums. Throws InputError on a parallel beam, photon energies out of
 * PhotonMaterial's range and on options out of range.
 */
MAMMORAYXRAY_EXPORT MonteCarloResult FollowPhotons(const PhotonScene& scene,
  const XRaySource& source, const XRayDetector& detector, const Spectrum& spectrum,
  const DetectorResponse& response, const MonteCarloOptions& options,
  const ProgressCallback& progress = {});
}

#endif
