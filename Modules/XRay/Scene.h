// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Scene_h
#define mammoray_Scene_h

#include "mammoray/Foundation/MaterialTable.h"
#include "mammoray/Foundation/Meshes.h"
#include "mammoray/XRay/Beam.h"
#include "mammoray/XRay/Exposure.h"
#include "mammoray/XRay/PathLengthProjector.h"
#include "mammoray/XRay/Scatter/MonteCarlo.h"
#include "mammoray/XRay/Scatter/Photons.h"
#include "mammoray/XRay/Scatter/ScatterModel.h"
#include "mammorayXRayModule.h"

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace mammoray
{
/// A surface, and where it stands in the scene.
struct SceneSample
{
  /// In its own frame, mm. Samples with the same pointer are taken to be unchanged, so replace the
  /// mesh instead of editing it.
  std::shared_ptr<const SurfaceMesh> Surface;
  /// Index into Scene::Materials of the material that the closed surface encloses. -1: the labels
  /// of the surface's two sides are such indices.
  int Material = -1;
  /// Axis times angle, radians. The sample is turned right-handedly about the origin of its own
  /// frame, then moved.
  Vector3 Rotation{ 0, 0, 0 };
  Vector3 TranslationMm{ 0, 0, 0 };

  bool operator==(const SceneSample&) const = default;
};

/// How scattered photons are added to a picture.
struct SceneScatter
{
  enum class Model
  {
    None,
    /// By ScatterModel, from the thickness of all materials along each ray.
    Kernels,
    /// By FollowPhotons, through voxels of any materials.
    MonteCarlo
  };
  Model Method = Model::None;
  /// For Kernels: their table. Null: Exposer makes it (KernelAxesOf) with Photons, and keeps it
  /// until another is needed.
  std::shared_ptr<const ScatterKernels> Kernels;
  /// For kernels that are made: compositions by material, as ParseComposition reads them.
  std::vector<std::string> Compositions;
  /// For Kernels: the distance from the back of the bodies to the detector, 0 to 2000 mm.
  double AirGapMm = 17;
  /// For MonteCarlo and Scene::Dose: the voxels, and the number of photons, 1 to 1e12.
  std::shared_ptr<const VoxelScene> Voxels;
  double Photons = 1e7;
  /// In front of the detector. Transmissions are relative to the open field behind it.
  std::optional<AntiscatterGridOptions> Grid;
};

/**
 * Everything that one picture depends on. Lengths are mm, in the frame of the scene. The file form
 * is in mammoray/IO/SceneIO.h.
 */
struct MAMMORAYXRAY_EXPORT Scene
{
  /// The X-rayed bodies.
  std::vector<SceneSample> Samples;
  /// [0] is air.
  MaterialTable Materials;
  /// One for each material, at its nominal density; Materials has the density. One without energies
  /// is unknown, which is allowed for air and for materials that no sample has.
  std::vector<AttenuationTable> Attenuations;
  /// Indices of materials: see ProjectorOptions::Priority.
  std::vector<int> OverlapPriority;

  XRaySource Source;
  XRayDetector Detector;
  /// The X-rays behind all filters.
  Spectrum XRays = Spectrum::Monochromatic(20);
  DetectorResponse Response;

  /// Focal spot, noise and blur. Where OpenField is empty, it is computed from Field. Where Scatter
  /// is unset, it follows from the scene's Scatter.
  ExposureOptions Detection;
  /// Heel effect and inverse square law.
  OpenFieldOptions Field;
  SceneScatter Scatter;
  /// Bends rays. Allows no noise, blur, focal spot, open field or scatter. The distance is that of
  /// RefractionOptions; default: from the middle of the samples along the detector's normal.
  std::optional<RefractionOptions::Law> Refraction;
  std::optional<double> BendDistanceMm;
  /// Whether Exposure::Dose is wanted, and at which height over the detector the air kerma is
  /// stated, mm. Default: where the ray that meets the detector at right angles enters the box
  /// around the tissue.
  bool Dose = false;
  std::optional<double> DoseHeightMm;

  bool HasField() const
  {
    return this->Field.InverseSquare || this->Field.Heel.TargetAngleDeg != 0;
  }
  /// Throws InputError where parts contradict each other. Exposer calls it.
  void Validate() const;
};

/// The law of Beer and Lambert for the path lengths of the scene. Materials that are not `used`
/// have length 0 and need no attenuation; a missing entry counts as false. Throws InputError.
MAMMORAYXRAY_EXPORT Beam MakeBeam(const Scene& scene, const std::vector<bool>& used = {});

/// The samples as one surface in the frame of the scene, labelled by Scene::Materials. A single
/// sample that is labelled and not moved is not copied. Throws InputError where a sample has no
/// surface or an unknown material.
MAMMORAYXRAY_EXPORT std::shared_ptr<const SurfaceMesh> Assemble(const Scene& scene);

/**
 * Places source and detector where nobody says where: the source four times the diagonal d of the
 * samples' box before its middle, looking along +y, the detector 1.5 d behind it, with columns
 * along +x and rows along -z; its square pixels, as many as it has, hold the samples however they
 * turn. Throws InputError where the surface has no extent.
 */
MAMMORAYXRAY_EXPORT void PlaceAround(Scene& scene);
}

#endif
