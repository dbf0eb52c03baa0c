// SPDX-License-Identifier: Apache-2.0
#include "Measurements.h"

#include "SceneFile.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/ProjectionImage.h"
#include "mammoray/IO/ShippedData.h"
#ifdef MAMMORAY_HAS_EMBREE
#include "EmbreePathLengths.h"
#endif

#include "vtkImageData.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fstream>
#include <numeric>
#include <optional>

#include <memory>

namespace mammoray::benchmarks
{
namespace
{
using Clock = std::chrono::steady_clock;

double Median(std::vector<double> values)
{
  std::sort(values.begin(), values.end());
  return 0.5 * (values[(values.size() - 1) / 2] + values[values.size() / 2]);
}

/// Most memory this process has held so far, bytes.
double PeakBytes()
{
  std::ifstream status("/proc/self/status");
  for (std::string key; status >> key;)
  {
    if (key == "VmHWM:")
    {
      double kibibytes = 0;
      status >> kibibytes;
      return 1024 * kibibytes;
    }
  }
  throw Error("benchmark: no VmHWM in /proc/self/status");
}

/// Which closed body each point belongs to: connected parts of the mesh, numbered from 0.
std::vector<std::uint32_t> BodyOfPoint(const SurfaceMesh& mesh)
{
  std::vector<std::uint32_t> parent(mesh.NumberOfPoints());
  std::iota(parent.begin(), parent.end(), 0u);
  const auto root = [&](std::uint32_t point)
  {
    while (parent[point] != point)
    {
      point = parent[point] = parent[parent[point]];
    }
    return point;
  };
  for (std::size_t corner = 0; corner < mesh.Triangles.size(); corner += 3)
  {
    parent[root(mesh.Triangles[corner + 1])] = root(mesh.Triangles[corner]);
    parent[root(mesh.Triangles[corner + 2])] = root(mesh.Triangles[corner]);
  }
  std::vector<std::uint32_t> body(parent.size(), 0);
  std::uint32_t count = 0;
  for (std::uint32_t point = 0; point < parent.size(); ++point)
  {
    body[point] = root(point) == point ? count++ : body[point];
  }
  for (std::uint32_t point = 0; point < parent.size(); ++point)
  {
    body[point] = body[root(point)];
  }
  return body;
}

/// The same triangles with `count` materials: the mesh's own, merged, or, where it has one, its
/// bodies in turn. Empty where it has a single body too and more are wanted.
std::optional<SurfaceMesh> WithMaterials(SurfaceMesh mesh, std::uint32_t count)
{
  const std::vector<std::uint32_t> body = BodyOfPoint(mesh);
  const bool byBody = mesh.NumberOfMaterials() == 2;
  if (count > 1 && byBody && *std::max_element(body.begin(), body.end()) == 0)
  {
    return std::nullopt;
  }
  for (std::size_t triangle = 0; triangle < mesh.NumberOfTriangles(); ++triangle)
  {
    const std::uint32_t offset = byBody ? body[mesh.Triangles[3 * triangle]] : 0;
    for (std::uint16_t* material :
      { &mesh.FrontMaterials[triangle], &mesh.BackMaterials[triangle] })
    {
      *material =
        static_cast<std::uint16_t>(*material == 0 ? 0 : 1 + (*material - 1u + offset) % count);
    }
  }
  return mesh;
}

/// 100 energies from 10 to 34.75 keV, as heavy as a beam of that many.
Spectrum HundredEnergies()
{
  Spectrum spectrum;
  spectrum.Name = "100 energies";
  for (int bin = 0; bin < 100; ++bin)
  {
    spectrum.EnergiesKeV.push_back(10 + 0.25 * bin);
    spectrum.Weights.push_back(1 + std::sin(0.03 * bin));
  }
  return spectrum;
}

/// One energy against a hundred; the frame includes the transmission, found on the host from path
/// lengths, and on the device, which keeps these.
void MeasureEnergies(const ExampleScene& scene, PathLengthProjector& projector, double budget,
  Json& result)
{
  const Beam one =
    MakeBeam(scene.Materials, Spectrum::Monochromatic(20), DetectorResponse::EnergyIntegrating);
  const Beam hundred =
    MakeBeam(scene.Materials, HundredEnergies(), DetectorResponse::EnergyIntegrating);
  const auto picture = [&](const Beam& beam)
  {
    projector.Render(scene.Source, scene.Detector);
    projector.Transmission(beam);
  };
  const auto times = InTurn(budget,
    { [&] { one.Transmission(projector.Project(scene.Source, scene.Detector)); },
      [&] { hundred.Transmission(projector.Project(scene.Source, scene.Detector)); },
      [&] { picture(one); }, [&] { picture(hundred); } });
  result["oneEnergy"] = Summary(times[0]);
  result["hundredEnergies"] = Summary(times[1]);
  result["hundredEnergiesRatio"] = MedianRatio(times[1], times[0]);
  result["picture"] = Summary(times[2]);
  result["hundredEnergiesOnDeviceRatio"] = MedianRatio(times[3], times[2]);
}

/// One material against three on the same triangles; rendering only.
void MeasureMaterials(const ExampleScene& scene, ProjectorOptions::Method method, double budget,
  Json& result)
{
  const auto three = WithMaterials(scene.Surface, 3);
  if (!three)
  {
    return;
  }
  const auto one = WithMaterials(scene.Surface, 1);
  const auto withOne = MakeProjector({ .Projection = method });
  const auto withThree = MakeProjector({ .Projection = method });
  withOne->SetSurface(*one);
  withThree->SetSurface(*three);
  const auto times = InTurn(budget,
    { [&] { withOne->Render(scene.Source, scene.Detector); },
      [&] { withThree->Render(scene.Source, scene.Detector); } });
  result["threeMaterialsRatio"] = MedianRatio(times[1], times[0]);
}

/// Eight fields of derivatives in the same pass, and the gradient with respect to all points, each
/// against a frame.
void MeasureDerivatives(const ExampleScene& scene, PathLengthProjector& projector, double budget,
  Json& result)
{
  constexpr std::size_t fields = 8;
  const std::vector<double>& points = scene.Surface.Points;
  VectorFields velocities(fields, points.size());
  for (std::size_t field = 0; field < fields; ++field)
  {
    for (std::size_t index = 0; index < points.size(); ++index)
    {
      velocities[field][index] = std::sin(0.01 * static_cast<double>(field + 1) * points[index]);
    }
  }
  PathLengthDerivatives derivatives;
  const PathLengthImage image = projector.Project(scene.Source, scene.Detector);
  const std::vector<float> losses(image.Lengths.size(), 1.0F);
  const auto times = InTurn(budget,
    { [&] { projector.Project(scene.Source, scene.Detector); },
      [&] { projector.Project(scene.Source, scene.Detector, velocities, derivatives); },
      [&] { projector.Backward(scene.Source, scene.Detector, losses); } });
  result["eightDerivatives"] = Summary(times[1]);
  result["eightDerivativesRatio"] = MedianRatio(times[1], times[0]);
  result["gradient"] = Summary(times[2]);
  result["gradientRatio"] = MedianRatio(times[2], times[0]);
}

#ifdef MAMMORAY_HAS_EMBREE
/// The yardstick, in turn with the projector; and how far the two images are apart.
void MeasureEmbree(const ExampleScene& scene, PathLengthProjector& projector, double budget,
  Json& result)
{
  using test::EmbreePathLengths;
  using test::HitDistance;
  std::optional<EmbreePathLengths> embree;
  result["embreeBuildMs"] = Milliseconds([&] { embree.emplace(scene.Surface); });
  const auto times = InTurn(budget,
    { [&] { projector.Project(scene.Source, scene.Detector); },
      [&] { embree->Project(scene.Source, scene.Detector, HitDistance::Single); } });
  result["frame"] = Summary(times[0]);
  result["embreeFrame"] = Summary(times[1]);
  result["embreeRatio"] = MedianRatio(times[0], times[1]);
  const PathLengthImage image = projector.Project(scene.Source, scene.Detector);
  const PathLengthImage peer = embree->Project(scene.Source, scene.Detector, HitDistance::Double);
  double largest = 0;
  for (std::size_t value = 0; value < image.Lengths.size(); ++value)
  {
    const std::size_t pixel = value % image.NumberOfPixels();
    if (image.Inconsistent[pixel] == 0 && peer.Inconsistent[pixel] == 0)
    {
      largest = std::max(largest, std::abs(double{ image.Lengths[value] } - peer.Lengths[value]));
    }
  }
  result["embreeLargestDifferenceMm"] = largest;
}
#endif
}

double Milliseconds(const std::function<void()>& run)
{
  const auto begin = Clock::now();
  run();
  return 1e3 * std::chrono::duration<double>(Clock::now() - begin).count();
}

Json Summary(std::vector<double> milliseconds)
{
  const auto [least, most] = std::minmax_element(milliseconds.begin(), milliseconds.end());
  return { { "medianMs", Median(milliseconds) }, { "leastMs", *least }, { "mostMs", *most },
    { "runs", milliseconds.size() } };
}

std::vector<std::vector<double>> InTurn(double budget,
  const std::vector<std::function<void()>>& works)
{
  std::vector<std::vector<double>> times(works.size());
  const auto start = Clock::now();
  for (const auto& work : works)
  {
    work();
  }
  for (int round = 0; round < 10; ++round)
  {
    if (round >= 2 && std::chrono::duration<double>(Clock::now() - start).count() > budget)
    {
      break;
    }
    for (std::size_t index = 0; index < works.size(); ++index)
    {
      times[index].push_back(Milliseconds(works[index]));
    }
  }
  return times;
}

double MedianRatio(const std::vector<double>& numerators, const std::vector<double>& denominators)
{
  std::vector<double> ratios;
  for (std::size_t round = 0; round < numerators.size(); ++round)
  {
    ratios.push_back(numerators[round] / denominators[round]);
  }
  return Median(ratios);
}

Json MeasureScene(const std::string& sceneFile, ProjectorOptions::Method method, double budget)
{
  Json result;
  std::unique_ptr<PathLengthProjector> projector;
  result["deviceMs"] = Milliseconds([&] { projector = MakeProjector({ .Projection = method }); });
  result["furtherDeviceMs"] = Milliseconds([&] { MakeProjector({ .Projection = method }); });
  result["device"] = projector->DeviceName();
  const double emptyBytes = PeakBytes();
  ExampleScene scene = ReadScene(sceneFile);
  const auto frame = [&] { projector->Project(scene.Source, scene.Detector); };
  result["surfaceMs"] = Milliseconds([&] { projector->SetSurface(scene.Surface); });
  result["firstFrameMs"] = Milliseconds(frame);
  result["bytesPerTriangle"] =
    (PeakBytes() - emptyBytes) / static_cast<double>(scene.Surface.NumberOfTriangles());
  const PathLengthImage image = projector->Project(scene.Source, scene.Detector);
  result["inconsistent"] = image.NumberOfInconsistentRays();
  result["meanLengthMm"] = std::accumulate(image.Lengths.begin(), image.Lengths.end(), 0.0) /
    static_cast<double>(image.NumberOfPixels());
#ifdef MAMMORAY_HAS_EMBREE
  MeasureEmbree(scene, *projector, budget, result);
#else
  result["frame"] = Summary(InTurn(budget, { frame }).front());
#endif
  MeasureEnergies(scene, *projector, budget, result);
  MeasureDerivatives(scene, *projector, budget, result);
  const auto times = InTurn(budget,
    { [&] { projector->SetSurface(scene.Surface); },
      [&] { projector->UpdatePoints(scene.Surface.Points); } });
  result["build"] = Summary(times[0]);
  result["refit"] = Summary(times[1]);
  result["refitRatio"] = MedianRatio(times[1], times[0]);
  result["render"] =
    Summary(InTurn(budget, { [&] { projector->Render(scene.Source, scene.Detector); } }).front());
  projector.reset();
  MeasureMaterials(scene, method, budget, result);
  return result;
}

void MakeImageOnce(const std::string& sceneFile, ProjectorOptions::Method method,
  const std::string& imageFile)
{
  const ExampleScene scene = ReadScene(sceneFile);
  const Beam beam = MakeBeam(scene.Materials, FindSpectrum("W28kVp_Rh50um_Be1mm"),
    DetectorResponse::EnergyIntegrating);
  const auto projector = MakeProjector({ .Projection = method });
  projector->SetSurface(scene.Surface);
  const auto lengths = [&](const XRaySource& source, const XRayDetector& detector)
  { return std::make_shared<const PathLengthImage>(projector->Project(source, detector)); };
  const auto image =
    ToImage(Expose(lengths, scene.Source, scene.Detector, beam), scene.Detector, {});
  WriteProjection(image, imageFile);
}

Json MeasureRates(const ExampleScene& scene, ProjectorOptions::Method method, double budget)
{
  std::unique_ptr<PathLengthProjector> projector;
  const double setUp = Milliseconds(
    [&]
    {
      projector = MakeProjector({ .Projection = method });
      projector->SetSurface(scene.Surface);
      projector->Project(scene.Source, scene.Detector);
    });
  const auto times = InTurn(budget, { [&] { projector->Render(scene.Source, scene.Detector); } });
  return { { "name", scene.Name }, { "triangles", scene.Surface.NumberOfTriangles() },
    { "columns", scene.Detector.Columns }, { "rows", scene.Detector.Rows },
    { "setUpAndFrameMs", setUp }, { "frame", Summary(times.front()) } };
}
}
