// SPDX-License-Identifier: Apache-2.0
#include "mammoray/XRay/Scatter/MonteCarlo.h"

#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/Numbers.h"
#include "mammoray/Foundation/ParallelFor.h"
#include "mammoray/XRay/DetectorPlane.h"
#include "mammoray/XRay/Scatter/Photons.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <mutex>
#include <thread>

namespace mammoray
{
namespace
{
constexpr double Endless = std::numeric_limits<double>::infinity();
/// Photons that one thread follows before it adds to the sums.
constexpr std::size_t BatchPhotons = 20000;

struct Photon
{
  Vector3 Position;
  Vector3 Direction;
  double EnergyKeV = 0;
  bool Scattered = false;
};

/// The largest interaction coefficient of a scene's regions by energy.
class Majorant
{
public:
  explicit Majorant(const std::vector<PhotonMaterial>& materials)
    : Values(Count + 1)
  {
    std::vector<double> nodes(Count + 1);
    for (std::size_t index = 0; index <= Count; ++index)
    {
      for (const PhotonMaterial& material : materials)
      {
        nodes[index] = std::max(nodes[index], material.At(EnergyOf(index)).Total());
      }
    }
    // The larger value at the ends of each step, with a margin for edges within it.
    for (std::size_t index = 0; index <= Count; ++index)
    {
      this->Values[index] = 1.001 * std::max(nodes[index], nodes[std::min(index + 1, Count)]);
    }
  }
  double At(double energyKeV) const
  {
    const double place =
      (std::clamp(energyKeV, PhotonMaterial::LowestKeV, PhotonMaterial::HighestKeV) -
        PhotonMaterial::LowestKeV) /
      Step;
    return this->Values[std::min(static_cast<std::size_t>(place), Count)];
  }

private:
  static constexpr std::size_t Count = 8000;
  static constexpr double Step = (PhotonMaterial::HighestKeV - PhotonMaterial::LowestKeV) / Count;
  static double EnergyOf(std::size_t index)
  {
    return PhotonMaterial::LowestKeV + Step * static_cast<double>(index);
  }
  std::vector<double> Values;
};

/// Samples photon energies of a spectrum.
class EnergySource
{
public:
  explicit EnergySource(const Spectrum& spectrum)
    : Energies(spectrum.EnergiesKeV)
  {
    double sum = 0;
    for (const double weight : spectrum.Weights)
    {
      this->Sums.push_back(sum += weight);
    }
  }
  double Next(RandomStream& random) const
  {
    const double wanted = random.Uniform() * this->Sums.back();
    const auto found = std::lower_bound(this->Sums.begin(), this->Sums.end() - 1, wanted);
    return this->Energies[static_cast<std::size_t>(found - this->Sums.begin())];
  }

private:
  std::vector<double> Energies;
  std::vector<double> Sums;
};

/// The detector's plane, pixels and directions.
class PixelPlane
{
public:
  PixelPlane(const XRaySource& source, const XRayDetector& detector)
    : Detector(detector)
    , Normal(DetectorPlane(source, detector).Normal)
  {
    this->Column = (1 / Norm(detector.ColumnStep)) * detector.ColumnStep;
    this->Row = (1 / Norm(detector.RowStep)) * detector.RowStep;
  }
  Vector3 PointAt(double column, double row) const
  {
    return this->Detector.Origin + column * this->Detector.ColumnStep +
      row * this->Detector.RowStep;
  }
  double Distance(const Vector3& point) const
  {
    return Dot(this->Normal, point - this->Detector.Origin);
  }
  /// Component of a vector along the plane's normal.
  double Along(const Vector3& direction) const { return Dot(this->Normal, direction); }
  /// Where a photon meets a pixel.
  struct Meeting
  {
    double Distance = Endless;
    int Column = 0;
    int Row = 0;
  };
  Meeting MeetingOf(const Photon& photon) const
  {
    const double distance = -this->Distance(photon.Position) / this->Along(photon.Direction);
    if (!(distance >= 0) || !std::isfinite(distance))
    {
      return {};
    }
    const Vector3 offset = photon.Position + distance * photon.Direction - this->Detector.Origin;
    const double column = Dot(this->Column, offset) / Norm(this->Detector.ColumnStep) + 0.5;
    const double row = Dot(this->Row, offset) / Norm(this->Detector.RowStep) + 0.5;
    if (!(column >= 0 && row >= 0 && column < this->Detector.Columns && row < this->Detector.Rows))
    {
      return {};
    }
    return { distance, static_cast<int>(column), static_cast<int>(row) };
  }
  /// Tangents of a direction along columns and rows.
  std::array<double, 2> Slopes(const Vector3& direction) const
  {
    const double along = std::abs(this->Along(direction));
    return { Dot(this->Column, direction) / along, Dot(this->Row, direction) / along };
  }

private:
  XRayDetector Detector;
  Vector3 Normal;
  Vector3 Column;
  Vector3 Row;
};

/// Sums and sums of squares over photons.
struct Sums
{
  explicit Sums(std::size_t count)
    : First(count)
    , Second(count)
  {
  }
  void Add(std::size_t place, double value)
  {
    this->First[place] += value;
    this->Second[place] += value * value;
  }
  void Add(const Sums& other)
  {
    for (std::size_t place = 0; place < this->First.size(); ++place)
    {
      this->First[place] += other.First[place];
      this->Second[place] += other.Second[place];
    }
  }
  double Mean(std::size_t place, double photons) const { return this->First[place] / photons; }
  double Error(std::size_t place, double photons) const
  {
    const double mean = this->Mean(place, photons);
    return std::sqrt(std::max(this->Second[place] / photons - mean * mean, 0.0) / photons);
  }

  std::vector<double> First;
  std::vector<double> Second;
};

/// Results of the photons of one thread.
struct Tally
{
  Tally(std::size_t regions, std::size_t pixels)
    : Deposited(regions)
    , Primary(pixels)
    , Scatter(pixels)
    , OfPhoton(regions)
  {
  }
  void Add(const Tally& other)
  {
    this->Deposited.Add(other.Deposited);
    this->Primary.Add(other.Primary);
    this->Scatter.Add(other.Scatter);
    this->Surroundings += other.Surroundings;
    this->Escaped += other.Escaped;
    this->Detected += other.Detected;
    this->Emitted += other.Emitted;
  }

  Sums Deposited;
  Sums Primary;
  Sums Scatter;
  double Surroundings = 0;
  double Escaped = 0;
  double Detected = 0;
  double Emitted = 0;
  /// Energy deposited by the current photon; its collisions count as one observation.
  std::vector<double> OfPhoton;
};

class Follower
{
public:
  Follower(const PhotonScene& scene, const XRaySource& source, const XRayDetector& detector,
    const Spectrum& spectrum, const DetectorResponse& response, const MonteCarloOptions& options)
    : Scene(scene)
    , Focus(source.Position)
    , Detector(detector)
    , Plane(source, detector)
    , Energies(spectrum)
    , Response(response)
    , Options(options)
    , Densest(scene.Materials())
  {
  }

  void Follow(std::uint64_t number, Tally& tally) const
  {
    RandomStream random(this->Options.Seed, number);
    Photon photon = this->Emit(random);
    tally.Emitted += photon.EnergyKeV;
    std::fill(tally.OfPhoton.begin(), tally.OfPhoton.end(), 0);
    while (photon.EnergyKeV > 0 && this->Fly(photon, tally, random))
    {
    }
    for (std::size_t region = 0; region < tally.OfPhoton.size(); ++region)
    {
      if (tally.OfPhoton[region] > 0)
      {
        tally.Deposited.Add(region, tally.OfPhoton[region]);
      }
    }
  }

private:
  /// Towards the pixels, evenly over the solid angle: (distance / r)^2 of points of the plane times
  /// the cosine are kept.
  Photon Emit(RandomStream& random) const
  {
    Photon photon;
    photon.Position = this->Focus;
    for (;;)
    {
      const double column = random.Uniform() * this->Detector.Columns - 0.5;
      const double row = random.Uniform() * this->Detector.Rows - 0.5;
      const Vector3 way = this->Plane.PointAt(column, row) - this->Focus;
      photon.Direction = (1 / Norm(way)) * way;
      const double cosine = std::abs(this->Plane.Along(photon.Direction));
      if (random.Uniform() <= cosine * cosine * cosine)
      {
        photon.EnergyKeV = this->Energies.Next(random);
        return photon;
      }
    }
  }

  /// Distances at which a photon enters the box (0 inside) and leaves it; {infinity, 0} if it
  /// misses.
  std::array<double, 2> BoxAlong(const Photon& photon) const
  {
    double enter = 0;
    double leave = Endless;
    for (std::size_t a = 0; a < 3; ++a)
    {
      const double inverse = 1 / photon.Direction[a];
      const double first = (this->Scene.Low()[a] - photon.Position[a]) * inverse;
      const double second = (this->Scene.High()[a] - photon.Position[a]) * inverse;
      // A photon on a face that it flies along has no number here, and is taken to be inside.
      enter = std::fmax(enter, std::fmin(first, second));
      leave = std::fmin(leave, std::fmax(first, second));
    }
    return enter < leave ? std::array{ enter, leave } : std::array{ Endless, 0.0 };
  }

  /// Moves the photon to its next collision. Returns false if there is none.
  bool Fly(Photon& photon, Tally& tally, RandomStream& random) const
  {
    const auto [enter, leave] = this->BoxAlong(photon);
    if (enter > 0)
    {
      const PhotonInteractions here = this->Scene.Surroundings().At(photon.EnergyKeV);
      const double path = here.Total() > 0 ? -std::log(random.Uniform()) / here.Total() : Endless;
      const PixelPlane::Meeting meeting = this->Plane.MeetingOf(photon);
      if (meeting.Distance <= std::min(enter, path))
      {
        this->Detect(photon, meeting, tally);
        return false;
      }
      if (path < enter)
      {
        photon.Position = photon.Position + path * photon.Direction;
        tally.Surroundings += this->Collide(photon, this->Scene.Surroundings(), here, random);
        return photon.EnergyKeV > 0;
      }
      if (enter == Endless)
      {
        tally.Escaped += photon.EnergyKeV;
        return false;
      }
      photon.Position = photon.Position + enter * photon.Direction;
      return this->FlyInside(photon, leave - enter, tally, random);
    }
    return this->FlyInside(photon, leave, tally, random);
  }

  bool FlyInside(Photon& photon, double toExit, Tally& tally, RandomStream& random) const
  {
    const double densest = this->Densest.At(photon.EnergyKeV);
    const PixelPlane::Meeting meeting = this->Plane.MeetingOf(photon);
    double toDetector = meeting.Distance;
    for (;;)
    {
      const double path = densest > 0 ? -std::log(random.Uniform()) / densest : Endless;
      if (toDetector <= std::min(path, toExit))
      {
        this->Detect(photon, meeting, tally);
        return false;
      }
      if (path >= toExit)
      {
        // A trace beyond the face, so that the next flight begins outside.
        photon.Position = photon.Position + (toExit + 1e-9 * (1 + toExit)) * photon.Direction;
        return true;
      }
      photon.Position = photon.Position + path * photon.Direction;
      toExit -= path;
      toDetector -= path;
      const int region = this->Scene.RegionAt(photon.Position);
      const PhotonMaterial& material = this->Scene.Materials()[static_cast<std::size_t>(region)];
      const PhotonInteractions here = material.At(photon.EnergyKeV);
      if (random.Uniform() * densest < here.Total())
      {
        tally.OfPhoton[static_cast<std::size_t>(region)] +=
          this->Collide(photon, material, here, random);
        return photon.EnergyKeV > 0;
      }
    }
  }

  /// Changes the photon by a collision. Returns the energy deposited there, keV.
  static double Collide(Photon& photon, const PhotonMaterial& material,
    const PhotonInteractions& here, RandomStream& random)
  {
    const double before = photon.EnergyKeV;
    const double chosen = random.Uniform() * here.Total();
    if (chosen < here.Photoelectric)
    {
      photon.EnergyKeV = 0;
      return before;
    }
    const ScatteredPhoton after = chosen < here.Photoelectric + here.Rayleigh
      ? material.Rayleigh(before, random)
      : material.Compton(before, random);
    photon.Direction = TurnDirection(photon.Direction, after.Cosine, random);
    photon.EnergyKeV = after.EnergyKeV;
    photon.Scattered = true;
    // Slower ones end within a hundredth of a mm of tissue.
    if (photon.EnergyKeV < PhotonMaterial::LowestKeV)
    {
      photon.EnergyKeV = 0;
    }
    return before - photon.EnergyKeV;
  }

  void Detect(const Photon& photon, const PixelPlane::Meeting& meeting, Tally& tally) const
  {
    tally.Detected += photon.EnergyKeV;
    double signal = this->Response.Signal(photon.EnergyKeV);
    if (this->Options.Grid)
    {
      // Septa are focused on the source: primary photons fly along them, others by what they lean
      // from those of their pixel.
      const Vector3 way = this->Plane.PointAt(meeting.Column, meeting.Row) - this->Focus;
      const auto primary = this->Plane.Slopes((1 / Norm(way)) * way);
      const auto slopes = this->Plane.Slopes(photon.Direction);
      signal *= photon.Scattered ? this->Options.Grid->Transmission(photon.EnergyKeV,
                                     slopes[0] - primary[0], slopes[1] - primary[1])
                                 : this->Options.Grid->PrimaryTransmission(photon.EnergyKeV);
    }
    const std::size_t pixel =
      static_cast<std::size_t>(meeting.Row) * static_cast<std::size_t>(this->Detector.Columns) +
      static_cast<std::size_t>(meeting.Column);
    (photon.Scattered ? tally.Scatter : tally.Primary).Add(pixel, signal);
  }

  const PhotonScene& Scene;
  Vector3 Focus;
  XRayDetector Detector;
  PixelPlane Plane;
  EnergySource Energies;
  DetectorResponse Response;
  MonteCarloOptions Options;
  Majorant Densest;
};

/// Mean signal of a photon without an object.
double OpenSignal(const Spectrum& spectrum, const DetectorResponse& response,
  const std::optional<AntiscatterGrid>& grid)
{
  double signal = 0;
  double photons = 0;
  for (std::size_t bin = 0; bin < spectrum.Weights.size(); ++bin)
  {
    const double energy = spectrum.EnergiesKeV[bin];
    signal += spectrum.Weights[bin] * response.Signal(energy) *
      (grid ? grid->PrimaryTransmission(energy) : 1.0);
    photons += spectrum.Weights[bin];
  }
  return signal / photons;
}

void CheckEnergies(const Spectrum& spectrum)
{
  spectrum.Validate();
  if (spectrum.EnergiesKeV.front() < PhotonMaterial::LowestKeV ||
    spectrum.EnergiesKeV.back() > PhotonMaterial::HighestKeV)
  {
    throw InputError("photons: expected energies of " + NumberText(PhotonMaterial::LowestKeV) +
      " to " + NumberText(PhotonMaterial::HighestKeV) + " keV, found " +
      NumberText(spectrum.EnergiesKeV.front()) + " to " + NumberText(spectrum.EnergiesKeV.back()));
  }
}
}

VoxelScene::VoxelScene(LabelVolume volume, std::vector<PhotonMaterial> materials)
  : PhotonScene(std::move(materials), {})
  , Voxels(std::move(volume))
{
  this->Voxels.Validate("voxels");
  for (const auto& [label, count] : this->Voxels.CountLabels())
  {
    if (label >= static_cast<int>(this->Materials().size()))
    {
      throw InputError("voxels: expected materials below " +
        std::to_string(this->Materials().size()) + ", found " + std::to_string(label));
    }
  }
  Box3 box;
  for (int corner = 0; corner < 8; ++corner)
  {
    const auto end = [&](int axis)
    {
      return ((corner >> axis) & 1) != 0 ? this->Voxels.Size[static_cast<std::size_t>(axis)] - 0.5
                                         : -0.5;
    };
    box.Add(this->Voxels.PointAt(end(0), end(1), end(2)));
  }
  this->SetBox(box.Low, box.High);
}

int VoxelScene::RegionAt(const Vector3& point) const
{
  return this->Voxels.LabelAt(point);
}

std::vector<double> VoxelScene::MassesG() const
{
  std::vector<double> masses(this->Materials().size());
  for (const auto& [label, count] : this->Voxels.CountLabels())
  {
    const auto region = static_cast<std::size_t>(label);
    masses[region] = 1e-3 * static_cast<double>(count) * this->Voxels.VoxelVolume() *
      this->Materials()[region].DensityGPerCm3();
  }
  return masses;
}

double CentralFluence(const XRaySource& source, const XRayDetector& detector)
{
  // The mean over the pixels of cos^3, by which they are chosen.
  const PixelPlane plane(source, detector);
  double sum = 0;
  constexpr int Points = 200;
  for (int row = 0; row < Points; ++row)
  {
    for (int column = 0; column < Points; ++column)
    {
      const Vector3 way = plane.PointAt((column + 0.5) / Points * detector.Columns - 0.5,
                            (row + 0.5) / Points * detector.Rows - 0.5) -
        source.Position;
      const double cosine = std::abs(plane.Along(way)) / Norm(way);
      sum += cosine * cosine * cosine;
    }
  }
  const double mean = sum / (Points * Points);
  return 1 /
    (mean * detector.Columns * detector.Rows * Norm(detector.ColumnStep) * Norm(detector.RowStep));
}

MonteCarloResult FollowPhotons(const PhotonScene& scene, const XRaySource& source,
  const XRayDetector& detector, const Spectrum& spectrum, const DetectorResponse& response,
  const MonteCarloOptions& options, const ProgressCallback& progress)
{
  CheckEnergies(spectrum);
  response.Validate();
  if (source.Type == XRaySource::Kind::Parallel)
  {
    throw InputError("photons: expected a point source, found a parallel beam");
  }
  if (options.Photons < 1 || options.Photons > 1000000000000)
  {
    throw InputError("photons: expected 1 to 1e12, found " + std::to_string(options.Photons));
  }
  const Follower follower(scene, source, detector, spectrum, response, options);
  const std::size_t regions = scene.Materials().size();
  const std::size_t pixels = detector.NumberOfPixels();
  Tally all(regions, pixels);
  const auto photons = static_cast<std::size_t>(options.Photons);
  const std::size_t turn = BatchPhotons * std::max(1U, std::thread::hardware_concurrency());
  for (std::size_t begun = 0; begun < photons; begun += turn)
  {
    ReportProgress(progress, static_cast<double>(begun) / static_cast<double>(photons),
      "following photons");
    std::mutex adding;
    ParallelRanges(std::min(turn, photons - begun), BatchPhotons / 4,
      [&](std::size_t begin, std::size_t end)
      {
        Tally tally(regions, pixels);
        for (std::size_t number = begun + begin; number < begun + end; ++number)
        {
          follower.Follow(number, tally);
        }
        const std::lock_guard lock(adding);
        all.Add(tally);
      });
  }

  MonteCarloResult result;
  const auto count = static_cast<double>(photons);
  result.Photons = options.Photons;
  for (std::size_t region = 0; region < regions; ++region)
  {
    result.DepositedKeV.push_back(all.Deposited.Mean(region, count));
    result.DepositedErrorKeV.push_back(all.Deposited.Error(region, count));
  }
  result.SurroundingsKeV = all.Surroundings / count;
  result.EscapedKeV = all.Escaped / count;
  result.DetectedKeV = all.Detected / count;
  result.EmittedKeV = all.Emitted / count;
  const double open = OpenSignal(spectrum, response, options.Grid) *
    CentralFluence(source, detector) * Norm(detector.ColumnStep) * Norm(detector.RowStep);
  const auto store = [&](const Sums& sums, std::vector<float>& mean, std::vector<float>& error)
  {
    for (std::size_t pixel = 0; pixel < pixels; ++pixel)
    {
      mean.push_back(static_cast<float>(sums.Mean(pixel, count) / open));
      error.push_back(static_cast<float>(sums.Error(pixel, count) / open));
    }
  };
  store(all.Primary, result.Primary, result.PrimaryError);
  store(all.Scatter, result.Scatter, result.ScatterError);
  return result;
}
}
