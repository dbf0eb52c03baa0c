// SPDX-License-Identifier: Apache-2.0
#include "mammoray/XRay/Exposer.h"

#include "Private/ExposureViews.h"
#include "Private/FollowedPhotons.h"
#include "Private/PoseGradient.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/XRay/DetectorPlane.h"
#include "mammoray/XRay/Refraction.h"
#include "mammoray/XRay/Scatter/ScatterModel.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

namespace mammoray
{
namespace
{
/// Which materials triangles have on their sides; index 0 is air.
std::vector<bool> MaterialsOf(const SurfaceMesh& surface)
{
  std::vector<bool> used(static_cast<std::size_t>(surface.NumberOfMaterials()));
  for (const auto* side : { &surface.FrontMaterials, &surface.BackMaterials })
  {
    for (const std::uint16_t material : *side)
    {
      used[material] = true;
    }
  }
  return used;
}

/// The options of the scene with an open field.
ExposureOptions WithField(const Scene& scene)
{
  ExposureOptions options = scene.Detection;
  if (options.OpenField.empty() && scene.HasField())
  {
    options.OpenField =
      OpenField(scene.Source, scene.Detector, scene.XRays, scene.Response, scene.Field);
  }
  return options;
}

/// From the middle of the surface to the detector's plane, mm.
double DistanceToDetector(const SurfaceMesh& surface, const Scene& scene)
{
  const Vector3 normal = DetectorPlane(scene.Source, scene.Detector).Normal;
  const Extent extent = ExtentsAlong<1>({ normal }, surface.Points)[0];
  return std::abs(extent.Middle() - Dot(normal, scene.Detector.Origin));
}

void RefuseIrreversible(const Scene& scene)
{
  const ExposureOptions& detection = scene.Detection;
  const char* const found = scene.Refraction                                 ? "refraction"
    : scene.Scatter.Method != SceneScatter::Model::None || detection.Scatter ? "scatter"
    : detection.PhotonsPerPixel > 0                                          ? "noise"
    : detection.HasPixelErrors()                                             ? "errors of pixels"
                                                                             : nullptr;
  if (found)
  {
    throw InputError(
      std::string(
        "gradient: expected an exposure without noise, errors of pixels, scatter and refraction, "
        "found ") +
      found);
  }
}

/// Derivatives of a picture in forward mode are those of one ray to each pixel.
void RefuseSeveralRays(const Scene& scene)
{
  const ExposureOptions& detection = scene.Detection;
  const bool hasSpot = detection.FocalSpotSamples > 1 &&
    (detection.FocalSpotColumnMm > 0 || detection.FocalSpotRowMm > 0);
  const char* const found = scene.Refraction                                 ? "refraction"
    : scene.Scatter.Method != SceneScatter::Model::None || detection.Scatter ? "scatter"
    : detection.PhotonsPerPixel > 0                                          ? "detector.photons"
    : detection.HalfModulationPerMm > 0 ? "detector.half-modulation"
    : detection.HasBlur()               ? "detector.line-spread"
    : detection.HasPixelErrors()        ? "errors of pixels"
    : hasSpot                           ? "source.focal-spot"
    : scene.Detector.Samples > 1        ? "detector.samples"
                                        : nullptr;
  if (found)
  {
    throw InputError(std::string("derivatives: expected a point-like or parallel source without "
                                 "noise, blur, averaged samples, scatter and refraction, found ") +
      found);
  }
}

void RequireSize(const std::string& what, const std::vector<float>& values, std::size_t count)
{
  if (!values.empty() && values.size() != count)
  {
    throw InputError("gradient: expected derivatives with respect to " + std::to_string(count) +
      " " + what + ", found " + std::to_string(values.size()));
  }
}

/// dLoss / dTransmission of each view, before blur and open field; empty where there is none.
std::vector<double> LossBehindDetector(const Scene& scene, const Exposer::Loss& loss, double weight)
{
  RequireSize("transmissions", loss.Transmission, scene.Detector.NumberOfPixels());
  std::vector<double> values(loss.Transmission.begin(), loss.Transmission.end());
  if (values.empty())
  {
    return values;
  }
  const ExposureOptions options = WithField(scene);
  if (options.HasBlur())
  {
    TransposeBlur(scene.Detector, options, values);
  }
  for (std::size_t pixel = 0; pixel < values.size(); ++pixel)
  {
    values[pixel] *= weight * (options.OpenField.empty() ? 1.0 : options.OpenField[pixel]);
  }
  return values;
}

/// The transpose of the step from the scene's source and detector to a view's.
void AddPose(const ExposureView& view, const PoseGradient& pose, Exposer::Gradient& gradient)
{
  gradient.Source = gradient.Source + pose.Source;
  gradient.Origin = gradient.Origin + pose.Origin;
  // A point of the focal spot is beside its middle along the unit vectors of the steps.
  const auto turned = [&](const Vector3& step, double distanceMm)
  {
    const double length = Norm(step);
    const Vector3 unit = (1 / length) * step;
    return (distanceMm / length) * (pose.Source - Dot(pose.Source, unit) * unit);
  };
  gradient.ColumnStep = gradient.ColumnStep + pose.ColumnStep + view.SampleColumn * pose.Origin +
    turned(view.Detector.ColumnStep, view.SpotColumnMm);
  gradient.RowStep = gradient.RowStep + pose.RowStep + view.SampleRow * pose.Origin +
    turned(view.Detector.RowStep, view.SpotRowMm);
}

/// The gradient with respect to the motions of samples, whose points lie one after the other.
std::vector<Exposer::Gradient::Motion> MotionsOf(const Scene& scene,
  const std::vector<double>& points, const std::vector<double>& gradient)
{
  std::vector<Exposer::Gradient::Motion> motions;
  std::size_t first = 0;
  for (const SceneSample& sample : scene.Samples)
  {
    Exposer::Gradient::Motion motion;
    Vector3 torque{ 0, 0, 0 };
    const std::size_t end = first + sample.Surface->Points.size();
    for (; first < end; first += 3)
    {
      const Vector3 part{ gradient[first], gradient[first + 1], gradient[first + 2] };
      const Vector3 turned =
        Vector3{ points[first], points[first + 1], points[first + 2] } - sample.TranslationMm;
      motion.Translation = motion.Translation + part;
      torque = torque + Cross(turned, part);
    }
    // A change c of the rotation vector r turns the sample by J c, with the left Jacobian of
    // rotations J = s + (1 - s) a a^T + (1 - cos |r|) / |r| [a x], s = sin |r| / |r|, a = r / |r|.
    const double angle = Norm(sample.Rotation);
    motion.Rotation = torque;
    if (angle > 0)
    {
      const Vector3 axis = (1 / angle) * sample.Rotation;
      const double share = std::sin(angle) / angle;
      motion.Rotation = share * torque + ((1 - share) * Dot(axis, torque)) * axis -
        ((1 - std::cos(angle)) / angle) * Cross(axis, torque);
    }
    motions.push_back(motion);
  }
  return motions;
}

/// What a scatter model depends on.
struct ScatterKey
{
  std::shared_ptr<const ScatterKernels> Kernels;
  double AirGapMm = 0;
  std::optional<AntiscatterGridOptions> Grid;
  Spectrum XRays;
  DetectorResponse Response;

  bool operator==(const ScatterKey& other) const
  {
    // Of one file that was read twice the content is the same.
    const bool isSameTable = this->Kernels == other.Kernels ||
      (this->Kernels && other.Kernels && *this->Kernels == *other.Kernels);
    return isSameTable && this->AirGapMm == other.AirGapMm && this->Grid == other.Grid &&
      this->XRays == other.XRays && this->Response == other.Response;
  }
};
}

struct Exposer::Internals
{
  /// The rays from one point to one sample of every pixel.
  struct View
  {
    XRaySource Source;
    XRayDetector Detector;
    std::shared_ptr<const PathLengthImage> Image;
  };

  ProjectorOptions Options;
  bool OwnsOptions = true;
  std::unique_ptr<PathLengthProjector> Projector;

  std::vector<SceneSample> Samples;
  /// On the device.
  std::shared_ptr<const SurfaceMesh> Surface;
  std::vector<bool> Materials;

  /// Views of one exposure.
  XRaySource Source;
  XRayDetector Detector;
  std::array<double, 3> Spot{};
  std::vector<View> Views;
  std::size_t KeptBytes = 0;
  std::size_t Traces = 0;

  /// Kernels that were made, and what they were made of.
  std::shared_ptr<const ScatterKernels> MadeKernels;
  ScatterKernels MadeAxes;
  double MadePhotons = 0;
  std::optional<ScatterKey> ModelKey;
  std::shared_ptr<const ScatterModel> Model;

  PathLengthProjector& Open()
  {
    if (!this->Projector)
    {
      this->Projector = MakeProjector(this->Options);
    }
    return *this->Projector;
  }

  void Forget()
  {
    this->Views.clear();
    this->KeptBytes = 0;
  }

  void SetPriority(const std::vector<int>& priority)
  {
    if (priority == this->Options.Priority)
    {
      return;
    }
    if (!this->OwnsOptions)
    {
      throw InputError("scene: expected no overlap priority with a projector of one's own");
    }
    this->Options.Priority = priority;
    this->Projector.reset();
    this->Surface.reset();
    this->Samples.clear();
    this->Forget();
  }

  void Load(const Scene& scene)
  {
    this->SetPriority(scene.OverlapPriority);
    if (this->Surface && this->Samples == scene.Samples)
    {
      return;
    }
    const std::shared_ptr<const SurfaceMesh> surface = Assemble(scene);
    // Should the device throw, nothing on it is taken for current.
    const std::shared_ptr<const SurfaceMesh> before = std::exchange(this->Surface, nullptr);
    const bool sameTriangles = before && before->Triangles == surface->Triangles &&
      before->FrontMaterials == surface->FrontMaterials &&
      before->BackMaterials == surface->BackMaterials &&
      before->Points.size() == surface->Points.size();
    if (!sameTriangles)
    {
      this->Forget();
      this->Open().SetSurface(*surface);
      this->Materials = MaterialsOf(*surface);
    }
    else if (before->Points != surface->Points)
    {
      this->Forget();
      this->Open().UpdatePoints(surface->Points);
    }
    this->Surface = surface;
    this->Samples = scene.Samples;
  }

  std::shared_ptr<const PathLengthImage> Project(const XRaySource& source,
    const XRayDetector& detector)
  {
    for (const View& view : this->Views)
    {
      if (view.Source == source && view.Detector == detector)
      {
        return view.Image;
      }
    }
    auto image =
      std::make_shared<const PathLengthImage>(this->Projector->Project(source, detector));
    ++this->Traces;
    const std::size_t bytes = image->Lengths.size() * sizeof(float) + image->Inconsistent.size();
    if (this->KeptBytes + bytes <= MostKeptBytes)
    {
      this->KeptBytes += bytes;
      this->Views.push_back({ source, detector, image });
    }
    return image;
  }

  /// Forgets views that an exposure of the scene has no use for.
  void Aim(const Scene& scene)
  {
    const ExposureOptions& detection = scene.Detection;
    const std::array<double, 3> spot{ detection.FocalSpotColumnMm, detection.FocalSpotRowMm,
      static_cast<double>(detection.FocalSpotSamples) };
    if (!(this->Source == scene.Source && this->Detector == scene.Detector && this->Spot == spot))
    {
      this->Forget();
      this->Source = scene.Source;
      this->Detector = scene.Detector;
      this->Spot = spot;
    }
  }

  ScatterFunction ScatterOf(const Scene& scene, const ProgressCallback& progress)
  {
    const SceneScatter& scatter = scene.Scatter;
    if (scatter.Method == SceneScatter::Model::None)
    {
      return {};
    }
    if (scatter.Method == SceneScatter::Model::MonteCarlo)
    {
      return [&scene, progress](const PathLengthImage&, const std::vector<double>&)
      { return FollowScatter(scene, progress); };
    }
    if (!scatter.Kernels && scatter.Compositions.size() != scene.Materials.Materials.size())
    {
      throw InputError("scatter: expected a table of kernels, or compositions of all materials");
    }
    return
      [this, &scene, progress](const PathLengthImage& lengths, const std::vector<double>& primary)
    {
      const auto model = this->ModelOf(scene, lengths, progress);
      return model->Scatter(scene.Source, scene.Detector, TissueThickness(lengths), primary);
    };
  }

  std::shared_ptr<const ScatterModel> ModelOf(const Scene& scene, const PathLengthImage& lengths,
    const ProgressCallback& progress)
  {
    const SceneScatter& scatter = scene.Scatter;
    std::shared_ptr<const ScatterKernels> kernels = scatter.Kernels;
    if (!kernels)
    {
      ScatterKernels made = KernelAxesOf(scene, lengths);
      if (!this->MadeKernels || this->MadeAxes != made || this->MadePhotons != scatter.Photons)
      {
        this->MadeAxes = made;
        this->MadePhotons = scatter.Photons;
        FillScatterKernels(made, PhotonsPerSlab(made, scatter.Photons), 0, progress);
        this->MadeKernels = std::make_shared<const ScatterKernels>(std::move(made));
      }
      kernels = this->MadeKernels;
    }
    ScatterKey key{ kernels, scatter.AirGapMm, scatter.Grid, scene.XRays, scene.Response };
    if (this->ModelKey != key)
    {
      this->Model = std::make_shared<const ScatterModel>(*kernels, scene.XRays, scene.Response,
        scatter.AirGapMm,
        scatter.Grid ? std::optional<AntiscatterGrid>(*scatter.Grid) : std::nullopt);
      this->ModelKey = std::move(key);
    }
    return this->Model;
  }
};

Exposer::Exposer(ProjectorOptions options)
  : Internal(std::make_unique<Internals>())
{
  options.Priority.clear();
  this->Internal->Options = std::move(options);
}

Exposer::Exposer(std::unique_ptr<PathLengthProjector> projector)
  : Internal(std::make_unique<Internals>())
{
  this->Internal->Projector = std::move(projector);
  this->Internal->OwnsOptions = false;
}

Exposer::~Exposer() = default;

const SurfaceMesh& Exposer::Load(const Scene& scene)
{
  this->Internal->Load(scene);
  return *this->Internal->Surface;
}

Exposure Exposer::Expose(const Scene& scene, const ProgressCallback& progress)
{
  Internals& internal = *this->Internal;
  scene.Validate();
  internal.Load(scene);
  const Beam beam = MakeBeam(scene, internal.Materials);
  internal.Aim(scene);
  Exposure exposure;
  if (scene.Refraction)
  {
    exposure = Refract(*internal.Projector, internal.Surface->NumberOfPoints(), scene.Source,
      scene.Detector, beam,
      RefractiveDecrements(scene.XRays, scene.Materials, beam.NumberOfMaterials(),
        internal.Materials),
      { *scene.Refraction,
        scene.BendDistanceMm.value_or(DistanceToDetector(*internal.Surface, scene)) },
      progress);
  }
  else
  {
    ExposureOptions options = WithField(scene);
    if (!options.Scatter)
    {
      options.Scatter = internal.ScatterOf(scene, progress);
    }
    exposure = mammoray::Expose([&internal](const XRaySource& from, const XRayDetector& onto)
      { return internal.Project(from, onto); },
      scene.Source, scene.Detector, beam, options, progress);
  }
  if (scene.Dose)
  {
    exposure.Absorbed = ComputeDose(scene, progress);
  }
  return exposure;
}

Exposure Exposer::ExposeAir(const Scene& scene)
{
  const auto count = std::max<std::size_t>(scene.Attenuations.size(), 1);
  const auto air = [count](const XRaySource&, const XRayDetector& onto)
  {
    auto image = std::make_shared<PathLengthImage>();
    image->Columns = onto.Columns;
    image->Rows = onto.Rows;
    image->Materials = static_cast<int>(count);
    image->Lengths.assign(image->NumberOfPixels() * count, 0.0F);
    image->Inconsistent.assign(image->NumberOfPixels(), 0);
    return std::shared_ptr<const PathLengthImage>(std::move(image));
  };
  return mammoray::Expose(air, scene.Source, scene.Detector, MakeBeam(scene, {}), WithField(scene));
}

Exposer::Derivatives Exposer::Differentiate(const Scene& scene, const VectorFields& velocities)
{
  RefuseSeveralRays(scene);
  Internals& internal = *this->Internal;
  internal.Load(scene);
  const Beam beam = MakeBeam(scene, internal.Materials);
  Derivatives derivatives;
  derivatives.Image =
    internal.Projector->Project(scene.Source, scene.Detector, velocities, derivatives.Lengths);
  derivatives.MeanAttenuation = beam.MeanAttenuation(derivatives.Image);
  return derivatives;
}

Exposer::Gradient Exposer::Backward(const Scene& scene, const Loss& loss)
{
  Internals& internal = *this->Internal;
  scene.Validate();
  RefuseIrreversible(scene);
  internal.Load(scene);
  const Beam beam = MakeBeam(scene, internal.Materials);
  internal.Aim(scene);
  const std::vector<ExposureView> views = ViewsOf(scene.Source, scene.Detector, scene.Detection);
  const double weight = 1.0 / static_cast<double>(views.size());
  const std::vector<double> transmission = LossBehindDetector(scene, loss, weight);
  const std::size_t lengthCount = scene.Detector.NumberOfPixels() * internal.Materials.size();
  RequireSize("lengths", loss.Lengths, lengthCount);

  Gradient gradient;
  gradient.Points.assign(internal.Surface->Points.size(), 0.0);
  gradient.Attenuation.assign(scene.Materials.Materials.size(), 0.0);
  std::vector<double> spectrum(beam.EnergyWeights().size(), 0.0);
  for (const ExposureView& view : views)
  {
    const std::shared_ptr<const PathLengthImage> image =
      internal.Project(view.Source, view.Detector);
    std::vector<float> lengths = transmission.empty()
      ? std::vector<float>(lengthCount, 0.0F)
      : beam.Backward(*image, transmission, gradient.Attenuation, spectrum);
    for (std::size_t index = 0; index < loss.Lengths.size(); ++index)
    {
      lengths[index] += static_cast<float>(weight) * loss.Lengths[index];
    }
    const std::vector<double> points =
      internal.Projector->Backward(view.Source, view.Detector, lengths);
    std::transform(points.begin(), points.end(), gradient.Points.begin(), gradient.Points.begin(),
      std::plus<>());
    AddPose(view,
      PoseGradientOf(internal.Surface->Points, points, view.Source, view.Detector, *image, lengths),
      gradient);
  }
  gradient.Samples = MotionsOf(scene, internal.Surface->Points, gradient.Points);
  gradient.Spectrum.assign(scene.XRays.Weights.size(), 0.0);
  for (std::size_t bin = 0, energy = 0; bin < gradient.Spectrum.size(); ++bin)
  {
    if (scene.XRays.Weights[bin] > 0)
    {
      gradient.Spectrum[bin] = spectrum[energy++] / scene.XRays.Weights[bin];
    }
  }
  return gradient;
}

std::size_t Exposer::NumberOfTraces() const
{
  return this->Internal->Traces;
}

std::string Exposer::DeviceName()
{
  return this->Internal->Open().DeviceName();
}

ProjectorOptions::Method Exposer::Method()
{
  return this->Internal->Open().Method();
}
}
