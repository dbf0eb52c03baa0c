// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Exposer_h
#define mammoray_Exposer_h

#include "mammoray/Foundation/Progress.h"
#include "mammoray/XRay/Exposure.h"
#include "mammoray/XRay/PathLengthProjector.h"
#include "mammoray/XRay/Scene.h"
#include "mammorayXRayModule.h"

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

namespace mammoray
{
/**
 * Turns scenes into exposures. It owns the projector and what is on the device, and repeats only
 * what a change asks for:
 *  - other triangles or labels: the device builds its structure anew;
 *  - points or samples that moved: it refits;
 *  - another source, focal spot or detector grid: rays are traced again;
 *  - another spectrum, attenuation, response, noise, blur or scatter: no ray is traced, as long as
 *    the path lengths of all rays fit into MostKeptBytes. Refraction always traces.
 *
 * The device is opened at the first use. Not thread-safe: one exposer per thread.
 */
class MAMMORAYXRAY_EXPORT Exposer
{
public:
  static constexpr std::size_t MostKeptBytes = std::size_t{ 512 } << 20;

  /// Priority is that of the scenes.
  explicit Exposer(ProjectorOptions options = {});
  /// With a projector of one's own; scenes then have no OverlapPriority.
  explicit Exposer(std::unique_ptr<PathLengthProjector> projector);
  ~Exposer();

  /**
   * A picture of the scene. Throws InputError, which names what is wrong, on an unusable scene;
   * DeviceError; Interrupted.
   */
  Exposure Expose(const Scene& scene, const ProgressCallback& progress = {});
  /// The same with nothing in the beam: a flat field. Opens no device.
  static Exposure ExposeAir(const Scene& scene);
  /// Brings the scene's samples onto the device, as Expose does first; their surface in the frame
  /// of the scene. It stays valid until samples change.
  const SurfaceMesh& Load(const Scene& scene);

  /// How a picture changes with parameters that move the points of the surface.
  struct Derivatives
  {
    PathLengthDerivatives Lengths;
    /// The path lengths themselves, and of the log attenuation with each of them the derivative
    /// (Beam::MeanAttenuation), 1/mm.
    PathLengthImage Image;
    std::vector<float> MeanAttenuation;
  };
  /// Exact derivatives for a point-like or parallel source without noise, blur and scatter;
  /// `velocities` as of PathLengthProjector::Project, of the points of Load's surface. Throws as
  /// Expose.
  Derivatives Differentiate(const Scene& scene, const VectorFields& velocities);

  /// Derivatives of a number, the loss, with respect to parts of an exposure. One or both.
  struct Loss
  {
    /// dLoss / dTransmission; Rows * Columns values. With respect to LogAttenuation: divide by -T.
    std::vector<float> Transmission;
    /// dLoss / dLength of Exposure::Lengths, 1/mm, in its order.
    std::vector<float> Lengths;
  };
  /// Derivatives of the loss with respect to what the scene consists of.
  struct Gradient
  {
    /// With respect to the points of Load's surface, 3 x pointCount, 1/mm.
    std::vector<double> Points;
    /// One value per entry of Scene::Materials: with respect to a relative change of its
    /// attenuation at all energies, or of its density. At a single energy, divide by mu for
    /// dLoss / dmu.
    std::vector<double> Attenuation;
    /// One value per entry of Scene::XRays.Weights; 0 for energies without photons.
    std::vector<double> Spectrum;
    /// With respect to the position of a point source, 1/mm, or the direction of a parallel beam.
    Vector3 Source{ 0, 0, 0 };
    /// With respect to the detector's origin and steps, 1/mm.
    Vector3 Origin{ 0, 0, 0 };
    Vector3 ColumnStep{ 0, 0, 0 };
    Vector3 RowStep{ 0, 0, 0 };
    /// With respect to TranslationMm (1/mm) and Rotation (1/rad) of each of Scene::Samples.
    struct Motion
    {
      Vector3 Translation{ 0, 0, 0 };
      Vector3 Rotation{ 0, 0, 0 };
    };
    std::vector<Motion> Samples;
  };
  /**
   * The gradient of a loss whose derivatives with respect to this scene's exposure are known, in
   * reverse mode: it costs about two projections for each point of the focal spot and sample,
   * whatever the number of points. Focal spot, averaged samples and blur are differentiated; an
   * open field is taken for constant. Throws as Expose, and InputError on noise, scatter,
   * refraction and sizes that do not fit.
   */
  Gradient Backward(const Scene& scene, const Loss& loss);

  /// How often rays have been traced: once for each point of the focal spot and each sample.
  std::size_t NumberOfTraces() const;
  /// Opens the device.
  std::string DeviceName();
  ProjectorOptions::Method Method();

private:
  struct Internals;
  std::unique_ptr<Internals> Internal;
};

/// The dose in the scene's voxels, by following scene.Scatter.Photons photons. Throws InputError.
MAMMORAYXRAY_EXPORT Dose ComputeDose(const Scene& scene, const ProgressCallback& progress = {});
}

#endif
