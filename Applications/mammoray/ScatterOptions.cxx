// SPDX-License-Identifier: Apache-2.0
#include "ScatterOptions.h"

#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/ScatterData.h"
#include "mammoray/XRay/DetectorPlane.h"
#include "mammoray/XRay/OpenField.h"
#include "mammoray/XRay/Scatter/CellInterpolation.h"
#ifdef MAMMORAY_HAS_MESHING
#include "mammoray/Meshing/SurfaceVoxels.h"
#endif

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace mammoray
{
namespace
{
/// Pixels of this size gather photons that are followed; scatter changes little within.
constexpr double GatheringMm = 4;

/// The detector with larger pixels over the same field.
XRayDetector Gathering(const XRayDetector& detector)
{
  XRayDetector coarse = detector;
  const auto resize = [](Vector3& step, int& count)
  {
    const double length = count * Norm(step);
    const int wanted = std::clamp(static_cast<int>(std::ceil(length / GatheringMm)), 1, count);
    step = (static_cast<double>(count) / wanted) * step;
    count = wanted;
  };
  resize(coarse.ColumnStep, coarse.Columns);
  resize(coarse.RowStep, coarse.Rows);
  coarse.Origin = detector.Origin - 0.5 * (detector.ColumnStep + detector.RowStep) +
    0.5 * (coarse.ColumnStep + coarse.RowStep);
  coarse.Samples = 1;
  return coarse;
}
}

void DeclareKernelScatter(const OptionList& scatter, KernelScatterArguments& arguments)
{
  scatter("--air-gap", arguments.AirGapMm, Between(0, 200, "mm"),
    "of --scatter kernels: from the back of the tissue to the detector; default: the height of the "
    "unit's support");
  scatter.Numbers("--grid", arguments.Grid, "RATIO LINES UM",
    "anti-scatter grid of lead, focused: ratio, lines per cm, micrometres of a septum ('5 31 "
    "65'); septa run along the chest wall. Transmissions are relative to air behind the grid");
  scatter.Word("--grid-interspace", arguments.Interspace, { "fibre", "air", "aluminium" },
    "what is between the septa");
}

void CheckKernelScatter(const KernelScatterArguments& arguments)
{
  if (arguments.Method.empty() && (arguments.Grid || arguments.AirGapMm))
  {
    throw InputError("--grid, --air-gap: expected --scatter beside them, found none");
  }
  if (arguments.Grid)
  {
    AntiscatterGrid(AntiscatterGridOptions::OfLead(*arguments.Grid, arguments.Interspace));
  }
}

void DeclareScatter(const OptionList& add, ScatterArguments& arguments)
{
  const OptionList scatter = add.Group("Scatter and dose");
  scatter.Word("--scatter", arguments.Method, { "kernels", "monte-carlo" },
    "add what tissue scatters onto the detector: by kernels, tabulated for breast tissue by the "
    "thickness along each ray, or by following --mc-photons photons through the materials, whose "
    "compositions must be known");
  DeclareKernelScatter(scatter, arguments);
  scatter.Flag("--dose", arguments.Dose,
    "print the mean dose of each material, by following --mc-photons photons");
  scatter("--mc-photons", arguments.Photons, Between(1, 1e12),
    "photons to follow for each picture, and for --dose");
  scatter("--mc-voxels", arguments.VoxelMm, Between(0.05, 10, "mm"),
    "edge of the voxels through which photons are followed");
}

void CheckScatter(const ScatterArguments& arguments, bool isPlacedByUnit)
{
  CheckKernelScatter(arguments);
  if (arguments.Method == "kernels" && !isPlacedByUnit && !arguments.AirGapMm)
  {
    throw InputError("--scatter kernels: expected --air-gap beside explicit positions, found none");
  }
}

std::shared_ptr<const VoxelScene> MakeVoxelScene(const ScatterArguments& arguments,
  const SurfaceMesh& surface, const MaterialTable& materials, const ProgressCallback& progress)
{
#ifdef MAMMORAY_HAS_MESHING
  return std::make_shared<VoxelScene>(LabelSurfaces(surface, arguments.VoxelMm, progress),
    MakePhotonMaterials(materials));
#else
  (void)arguments;
  (void)surface;
  (void)materials;
  (void)progress;
  throw InputError("--dose, --scatter monte-carlo: expected a build with the Meshing module");
#endif
}

ScatterSource::ScatterSource(const ScatterArguments& arguments, double gapMm,
  const Spectrum& spectrum, const DetectorResponse& response,
  std::shared_ptr<const VoxelScene> scene)
  : Arguments(arguments)
  , GapMm(gapMm)
  , Energies(spectrum)
  , Response(response)
  , Scene(std::move(scene))
{
  if (arguments.Grid)
  {
    this->Grid.emplace(AntiscatterGridOptions::OfLead(*arguments.Grid, arguments.Interspace));
  }
  if (arguments.Method == "kernels")
  {
    this->Model.emplace(FindScatterKernels(), spectrum, response,
      arguments.AirGapMm.value_or(gapMm), this->Grid);
  }
}

std::vector<double> ScatterSource::FollowOnto(const XRaySource& source,
  const XRayDetector& detector, bool inverseSquare, std::uint64_t seed,
  const ProgressCallback& progress) const
{
  const XRayDetector coarse = Gathering(detector);
  MonteCarloOptions options;
  options.Photons = static_cast<std::int64_t>(this->Arguments.Photons);
  options.Seed = seed;
  options.Grid = this->Grid;
  const MonteCarloResult followed =
    FollowPhotons(*this->Scene, source, coarse, this->Energies, this->Response, options, progress);
  // Photons that are followed fall with the distance.
  std::vector<float> fall;
  if (!inverseSquare)
  {
    fall = OpenField(source, detector, this->Energies, this->Response, { .InverseSquare = true });
  }
  std::vector<double> scatter;
  scatter.reserve(detector.NumberOfPixels());
  const double columnRatio = static_cast<double>(coarse.Columns) / detector.Columns;
  const double rowRatio = static_cast<double>(coarse.Rows) / detector.Rows;
  for (int row = 0; row < detector.Rows; ++row)
  {
    for (int column = 0; column < detector.Columns; ++column)
    {
      const double value = BetweenCells(followed.Scatter, coarse.Columns, coarse.Rows,
        (column + 0.5) * columnRatio - 0.5, (row + 0.5) * rowRatio - 0.5);
      scatter.push_back(fall.empty() ? value : value / fall[scatter.size()]);
    }
  }
  return scatter;
}

decltype(ExposureOptions::Secondary) ScatterSource::Onto(const XRaySource& source,
  const XRayDetector& detector, bool inverseSquare, std::uint64_t seed,
  const ProgressCallback& progress) const
{
  if (this->Model)
  {
    return
      [this, source, detector](const PathLengthImage& lengths, const std::vector<double>& primary)
    { return this->Model->Scatter(source, detector, TissueThickness(lengths), primary); };
  }
  if (this->Arguments.Method.empty())
  {
    return {};
  }
  return [this, source, detector, inverseSquare, seed, progress](const PathLengthImage& lengths,
           const std::vector<double>& primary)
  {
    // A flat field has nothing in the beam.
    const bool empty = std::all_of(lengths.Lengths.begin(), lengths.Lengths.end(),
      [](float length) { return length == 0; });
    return empty ? std::vector<double>(primary.size())
                 : this->FollowOnto(source, detector, inverseSquare, seed, progress);
  };
}

std::string DescribeDose(const ScatterArguments& arguments, const VoxelScene& scene,
  const MaterialTable& materials, const XRaySource& source, const XRayDetector& detector,
  const Spectrum& spectrum, double photonsPerPixel, std::optional<double> heightMm,
  const ProgressCallback& progress)
{
  MonteCarloOptions options;
  options.Photons = static_cast<std::int64_t>(arguments.Photons);
  const XRayDetector coarse = Gathering(detector);
  const MonteCarloResult followed = FollowPhotons(scene, source, coarse, spectrum,
    DetectorResponse::EnergyIntegrating, options, progress);
  // Photons of one emitted that would meet 1 mm^2 of the detector at the foot of the perpendicular,
  // and of a plane through the tissue's top.
  const double pixelMm2 = Norm(detector.ColumnStep) * Norm(detector.RowStep);
  const double share = CentralFluence(source, coarse);
  const DetectorPlane plane(source, detector);
  double top = heightMm.value_or(0);
  for (int corner = 0; !heightMm && corner < 8; ++corner)
  {
    const Vector3 point{ (corner & 1) != 0 ? scene.High()[0] : scene.Low()[0],
      (corner & 2) != 0 ? scene.High()[1] : scene.Low()[1],
      (corner & 4) != 0 ? scene.High()[2] : scene.Low()[2] };
    top = std::max(top, Dot(plane.Normal, point - detector.Origin));
  }
  const double nearer = std::pow(plane.HeightMm / (plane.HeightMm - top), 2);
  double kerma = 0;
  double photons = 0;
  for (std::size_t bin = 0; bin < spectrum.Weights.size(); ++bin)
  {
    kerma += spectrum.Weights[bin] * AirKermaPerFluence(spectrum.EnergiesKeV[bin]);
    photons += spectrum.Weights[bin];
  }
  const double kermaPerPhoton = kerma / photons * share * nearer;
  const std::vector<double> masses = scene.MassesG();
  char line[200];
  std::snprintf(line, sizeof line,
    "dose, by %.3g photons, per mGy of air kerma (no backscatter) %.1f mm above the detector",
    static_cast<double>(followed.Photons), top);
  std::string text = line;
  const double emitted = photonsPerPixel / (share * pixelMm2);
  if (photonsPerPixel > 0)
  {
    std::snprintf(line, sizeof line, "; %.3g mGy of it for %g photons per pixel",
      emitted * kermaPerPhoton, photonsPerPixel);
    text += line;
  }
  for (std::size_t material = 1; material < masses.size(); ++material)
  {
    if (masses[material] <= 0)
    {
      continue;
    }
    const double toDose = MilligrayGramPerKeV / masses[material];
    const double dose = followed.DepositedKeV[material] * toDose;
    std::snprintf(line, sizeof line, "\n%12s %7.1f g %7.4f +- %.4f",
      materials.Materials[material].Name.c_str(), masses[material], dose / kermaPerPhoton,
      followed.DepositedErrorKeV[material] * toDose / kermaPerPhoton);
    text += line;
    if (photonsPerPixel > 0)
    {
      std::snprintf(line, sizeof line, "   %.3g mGy", dose * emitted);
      text += line;
    }
  }
  return text;
}
}
