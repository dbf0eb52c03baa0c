// SPDX-License-Identifier: Apache-2.0
#include "UnitMeasurements.h"

#include "mammoray/IO/ScatterData.h"
#include "mammoray/IO/ShippedData.h"
#include "mammoray/XRay/Exposure.h"
#include "mammoray/XRay/Refraction.h"
#include "mammoray/XRay/Scatter/ScatterModel.h"

#include <memory>

namespace mammoray::benchmarks
{
Json MeasureUnit(const ExampleScene& scene, ProjectorOptions::Method method, double budget)
{
  const auto projector = MakeProjector({ .Projection = method });
  projector->SetSurface(scene.Surface);
  const DetectorResponse response = DetectorResponse::EnergyIntegrating;
  const Spectrum spectrum = FindSpectrum("W28kVp_Rh50um_Be1mm");
  const Beam beam = MakeBeam(scene.Materials, spectrum, response);
  // Refraction asks for compositions; which ones costs nothing.
  MaterialTable water = scene.Materials;
  for (Material& material : water.Materials)
  {
    material.Attenuation = "Water, Liquid";
    material.DensityGPerCm3 = 1;
  }
  const auto materials = static_cast<int>(water.Materials.size());
  const std::vector<double> decrements = RefractiveDecrements(spectrum, water, materials,
    std::vector<bool>(water.Materials.size(), true));
  // As --realistic has them.
  const ScatterModel scatter(FindScatterKernels(), spectrum, response, 17, AntiscatterGrid({}));
  const OpenFieldOptions heel{ true, { 20, 0.0005, "W" } };
  const auto field = [&]
  { return OpenField(scene.Source, scene.Detector, spectrum, response, heel); };
  ExposureOptions scattered;
  scattered.Scatter = [&](const PathLengthImage& lengths, const std::vector<double>& primary)
  { return scatter.Scatter(scene.Source, scene.Detector, TissueThickness(lengths), primary); };
  ExposureOptions detected;
  detected.PhotonsPerPixel = 2e5;
  detected.ElectronicNoisePhotons = 5;
  detected.HalfModulationPerMm = 5;
  const auto lengths = [&](const XRaySource& source, const XRayDetector& detector)
  { return std::make_shared<const PathLengthImage>(projector->Project(source, detector)); };
  const auto expose = [&](const ExposureOptions& options)
  { Expose(lengths, scene.Source, scene.Detector, beam, options); };
  const auto refract = [&](RefractionOptions::Law law)
  {
    Refract(*projector, scene.Surface.NumberOfPoints(), scene.Source, scene.Detector, beam,
      decrements, { law, 200 });
  };
  const auto all = [&]
  {
    ExposureOptions options = detected;
    options.Scatter = scattered.Scatter;
    options.OpenField = field();
    expose(options);
  };
  const auto times = InTurn(budget,
    { [&] { expose({}); }, [&] { field(); }, [&] { expose(scattered); }, [&] { expose(detected); },
      all, [&] { refract(RefractionOptions::Law::Geometric); },
      [&] { refract(RefractionOptions::Law::NearField); } });
  Json result{ { "plain", Summary(times[0]) } };
  const char* const names[] = { "openField", "scatterAndGrid", "noiseAndBlur", "unit",
    "refractionGeometric", "refractionNearField" };
  for (std::size_t work = 1; work < times.size(); ++work)
  {
    Json summary = Summary(times[work]);
    summary["ratio"] = MedianRatio(times[work], times[0]);
    result[names[work - 1]] = summary;
  }
  return result;
}
}
