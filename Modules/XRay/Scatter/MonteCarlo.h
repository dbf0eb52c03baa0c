// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_MonteCarlo_h
#define mammoray_MonteCarlo_h

#include "mammoray/Foundation/Progress.h"
#include "mammoray/Foundation/Volumes.h"
#include "mammoray/XRay/Beam.h"
#include "mammoray/XRay/PathLengthProjector.h"
#include "mammoray/XRay/Scatter/Photons.h"
#include "mammorayXRayModule.h"

#include <array>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

namespace mammoray
{
/// Regions of any shape and material within a box, and its surroundings.
class MAMMORAYXRAY_EXPORT PhotonScene
{
public:
  virtual ~PhotonScene() = default;
  /// Index of the region at a point of the box.
  virtual int RegionAt(const Vector3& point) const = 0;
  /// Materials by region.
  const std::vector<PhotonMaterial>& Materials() const { return this->Regions; }
  /// Corners of the box, mm.
  const Vector3& Low() const { return this->Corners[0]; }
  const Vector3& High() const { return this->Corners[1]; }
  /// Material around the box.
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

/// The voxels of a volume, in its frame. A voxel's label is its region, whose material is
/// `materials[label]`.
class MAMMORAYXRAY_EXPORT VoxelScene : public PhotonScene
{
public:
  /// A vacuum surrounds the volume. Throws InputError on a label without a material.
  VoxelScene(LabelVolume volume, std::vector<PhotonMaterial> materials);
  int RegionAt(const Vector3& point) const override;
  const LabelVolume& Volume() const { return this->Voxels; }
  /// Mass of each region, g, region 0 included.
  std::vector<double> MassesG() const;

private:
  LabelVolume Voxels;
};

struct MAMMORAYXRAY_EXPORT MonteCarloOptions
{
  /// Number of photons that leave the source towards the detector; 1 to 1e12.
  std::int64_t Photons = 1000000;
  std::uint64_t Seed = 0;
  /// Grid in front of the detector.
  std::optional<AntiscatterGrid> Grid;
};

struct MAMMORAYXRAY_EXPORT MonteCarloResult
{
  std::int64_t Photons = 0;
  /// Energy deposited in each region, keV per photon, and its standard error.
  std::vector<double> DepositedKeV;
  std::vector<double> DepositedErrorKeV;
  /// Energy deposited around the box, escaped, and detected, keV per photon.
  double SurroundingsKeV = 0;
  double EscapedKeV = 0;
  double DetectedKeV = 0;
  /// Mean energy of the emitted photons, keV.
  double EmittedKeV = 0;
  /// Signals by pixel, Rows * Columns values, relative to the primary signal without an object (but
  /// with the grid) where the ray from the focus meets the detector's plane at right angles; each
  /// with its standard error.
  std::vector<float> Primary;
  std::vector<float> PrimaryError;
  std::vector<float> Scatter;
  std::vector<float> ScatterError;
};

/// Fluence per emitted photon, 1/mm^2, at the foot of the perpendicular from the source to the
/// detector's plane, with emission as in FollowPhotons.
MAMMORAYXRAY_EXPORT double CentralFluence(const XRaySource& source, const XRayDetector& detector);

/**
 * Follows photons from a point source, emitted isotropically into the solid angle of the detector's
 * pixels, through the scene until they are absorbed or leave it. Delta tracking (Woodcock et al.
 * 1965): free paths are those of the densest material of the box, and a collision is real with the
 * probability of the local material. Photons are neither weighted nor split. The detector absorbs
 * everything that meets its pixels.
 *
 * The same seed and number of photons give the same result for any number of threads, except for
 * the rounding of sums. Throws InputError on a parallel beam, photon energies out of
 * PhotonMaterial's range and on options out of range.
 */
MAMMORAYXRAY_EXPORT MonteCarloResult FollowPhotons(const PhotonScene& scene,
  const XRaySource& source, const XRayDetector& detector, const Spectrum& spectrum,
  const DetectorResponse& response, const MonteCarloOptions& options,
  const ProgressCallback& progress = {});
}

#endif
