// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Scatter/ScatterModel.h"

#include "Private/AxisPlace.h"
#include "Private/FastFourier.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/Vector3.h"
#include "mammoray/Scatter/CellInterpolation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>

namespace mammoray
{
namespace
{
/// Scatter is smooth over some mm; finer cells of the plane change it by less than the table's
/// noise.
constexpr double CellMm = 2;

/// Of the thickness, how high over the back of the tissue what reaches the detector was scattered
/// last, as far as the beam's divergence goes: of 0, 1/4 and 1/2, that by which slabs of 54 mm
/// agree best with photons that are followed (within 4 %, 0 and 1/2 within 8 %).
constexpr double ScatterHeight = 0.25;

/// Pixels gathered to cells.
struct Cells
{
  explicit Cells(const XRayDetector& detector)
  {
    const auto gather = [](double pixelMm)
    { return std::max(1, static_cast<int>(std::lround(CellMm / pixelMm))); };
    this->PerColumn = gather(Norm(detector.ColumnStep));
    this->PerRow = gather(Norm(detector.RowStep));
    this->ColumnMm = this->PerColumn * Norm(detector.ColumnStep);
    this->RowMm = this->PerRow * Norm(detector.RowStep);
    this->Columns = (detector.Columns + this->PerColumn - 1) / this->PerColumn;
    this->Rows = (detector.Rows + this->PerRow - 1) / this->PerRow;
  }
  std::size_t Count() const { return static_cast<std::size_t>(this->Columns) * this->Rows; }
  /// Adds to the four cells around a place, in pixels from the middle of the first.
  void Spread(double column, double row, double value, std::vector<double>& to) const
  {
    const double x = (column + 0.5) / this->PerColumn - 0.5;
    const double y = (row + 0.5) / this->PerRow - 0.5;
    const int left = static_cast<int>(std::floor(x));
    const int top = static_cast<int>(std::floor(y));
    for (int down = 0; down < 2; ++down)
    {
      for (int right = 0; right < 2; ++right)
      {
        const int c = std::clamp(left + right, 0, this->Columns - 1);
        const int r = std::clamp(top + down, 0, this->Rows - 1);
        to[static_cast<std::size_t>(r) * static_cast<std::size_t>(this->Columns) +
          static_cast<std::size_t>(c)] +=
          value * (1 - std::abs(x - left - right)) * (1 - std::abs(y - top - down));
      }
    }
  }

  std::size_t CellOf(int column, int row) const
  {
    return static_cast<std::size_t>(row / this->PerRow) * this->Columns +
      static_cast<std::size_t>(column / this->PerColumn);
  }

  int PerColumn = 1;
  int PerRow = 1;
  int Columns = 0;
  int Rows = 0;
  double ColumnMm = 0;
  double RowMm = 0;
};

/// The thickness that a tenth of the tissue's pixels reaches: rays through the chest wall, beside
/// the plates, are longer than between them. Half of what a ray lacks of it is air on either side.
double PlateDistance(const std::vector<double>& thicknessesMm)
{
  std::vector<double> tissue;
  std::copy_if(thicknessesMm.begin(), thicknessesMm.end(), std::back_inserter(tissue),
    [](double thickness) { return thickness > 0; });
  if (tissue.empty())
  {
    return 0;
  }
  const auto place = tissue.begin() + static_cast<std::ptrdiff_t>(9 * tissue.size() / 10);
  std::nth_element(tissue.begin(), place, tissue.end());
  return *place;
}

/// Where the ray from the source meets the detector at right angles, in pixels, and how much nearer
/// to it rays are per mm of height.
struct Foot
{
  Foot(const XRaySource& source, const XRayDetector& detector)
  {
    if (source.Type == XRaySource::Kind::Parallel)
    {
      return;
    }
    const Vector3 normal = Cross(detector.ColumnStep, detector.RowStep);
    const Vector3 way = source.Position - detector.Origin;
    const auto along = [&](const Vector3& step) { return Dot(way, step) / Dot(step, step); };
    this->Column = along(detector.ColumnStep);
    this->Row = along(detector.RowStep);
    this->PerHeight = Norm(normal) / std::abs(Dot(way, normal));
  }
  double Column = 0;
  double Row = 0;
  double PerHeight = 0;
};

/// Values of the cells of a picture with a margin around, which repeats itself; or their Fourier
/// transform.
class CellPlane
{
public:
  /// What is farther away than `reachMm` does not matter.
  CellPlane(const Cells& cells, double reachMm)
    : Grid(cells)
  {
    const auto padded = [&](int count, double cellMm)
    {
      const int reach = static_cast<int>(std::ceil(reachMm / cellMm));
      return FourierSize(count + std::min(count, reach) + 1);
    };
    this->Columns = padded(cells.Columns, cells.ColumnMm);
    this->Rows = padded(cells.Rows, cells.RowMm);
    this->Values.resize(
      static_cast<std::size_t>(this->Columns) * static_cast<std::size_t>(this->Rows));
  }
  /// Nothing in the margin.
  void Put(const std::vector<double>& values)
  {
    std::fill(this->Values.begin(), this->Values.end(), 0);
    for (int row = 0; row < this->Grid.Rows; ++row)
    {
      std::copy_n(values.begin() + static_cast<std::ptrdiff_t>(row) * this->Grid.Columns,
        this->Grid.Columns, this->Values.begin() + static_cast<std::ptrdiff_t>(this->At(0, row)));
    }
  }
  /// The margin as the nearer border.
  void PutWithBorder(const std::vector<double>& values)
  {
    const auto within = [](int place, int count, int size) {
      return place < count ? place : place < (count + size) / 2 ? count - 1 : 0;
    };
    this->Fill(
      [&](int column, int row)
      {
        const int c = within(column, this->Grid.Columns, this->Columns);
        const int r = within(row, this->Grid.Rows, this->Rows);
        return values[static_cast<std::size_t>(r) * static_cast<std::size_t>(this->Grid.Columns) +
          static_cast<std::size_t>(c)];
      });
  }
  /// What a cell sends to those around it: each ring's share spread evenly over its area.
  void PutKernel(const std::vector<double>& rings, const std::vector<double>& radii)
  {
    std::vector<double> density(rings.size());
    for (std::size_t ring = 0; ring < rings.size(); ++ring)
    {
      density[ring] = rings[ring] /
        (std::numbers::pi * (radii[ring + 1] * radii[ring + 1] - radii[ring] * radii[ring]));
    }
    const auto at = [&](double radius)
    {
      const auto above = std::upper_bound(radii.begin(), radii.end(), radius);
      const auto ring = static_cast<std::size_t>(above - radii.begin()) - 1;
      return ring < density.size() ? density[ring] : 0.0;
    };
    const double area = this->Grid.ColumnMm * this->Grid.RowMm;
    this->Fill(
      [&](int column, int row)
      {
        const double x = Signed(column, this->Columns) * this->Grid.ColumnMm;
        const double y = Signed(row, this->Rows) * this->Grid.RowMm;
        // Where rings are narrower than a cell, many points of it.
        const int points = std::hypot(x, y) < 12 * CellMm ? 12 : 3;
        const auto offset = [points](int point) { return (point + 0.5) / points - 0.5; };
        double sum = 0;
        for (int down = 0; down < points; ++down)
        {
          for (int right = 0; right < points; ++right)
          {
            sum += at(std::hypot(x + offset(right) * this->Grid.ColumnMm,
              y + offset(down) * this->Grid.RowMm));
          }
        }
        return area * sum / (points * points);
      });
  }
  void ToFrequencies() { Transform(this->Values, this->Columns, this->Rows, false); }
  void FromFrequencies() { Transform(this->Values, this->Columns, this->Rows, true); }
  /// Of frequencies.
  void AddProduct(const CellPlane& a, const CellPlane& b)
  {
    for (std::size_t place = 0; place < this->Values.size(); ++place)
    {
      this->Values[place] += a.Values[place] * b.Values[place];
    }
  }
  /// Of frequencies.
  void SpreadGaussian(double sigmaMm)
  {
    const auto damping = [&](int place, int count, double cellMm)
    {
      const double wave = 2 * std::numbers::pi * Signed(place, count) / (count * cellMm);
      return 0.5 * wave * wave * sigmaMm * sigmaMm;
    };
    for (int row = 0; row < this->Rows; ++row)
    {
      for (int column = 0; column < this->Columns; ++column)
      {
        this->Values[this->At(column, row)] *=
          std::exp(-damping(row, this->Rows, this->Grid.RowMm) -
            damping(column, this->Columns, this->Grid.ColumnMm));
      }
    }
  }
  /// Without the margin.
  std::vector<double> Take() const
  {
    std::vector<double> values;
    values.reserve(this->Grid.Count());
    for (int row = 0; row < this->Grid.Rows; ++row)
    {
      for (int column = 0; column < this->Grid.Columns; ++column)
      {
        values.push_back(this->Values[this->At(column, row)].real());
      }
    }
    return values;
  }

private:
  static int Signed(int place, int count) { return place <= count / 2 ? place : place - count; }
  std::size_t At(int column, int row) const
  {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(this->Columns) +
      static_cast<std::size_t>(column);
  }
  template <typename Value>
  void Fill(const Value& value)
  {
    for (int row = 0; row < this->Rows; ++row)
    {
      for (int column = 0; column < this->Columns; ++column)
      {
        this->Values[this->At(column, row)] = value(column, row);
      }
    }
  }

  Cells Grid;
  int Columns;
  int Rows;
  std::vector<std::complex<double>> Values;
};
}

ScatterModel::ScatterModel(const ScatterKernels& kernels, const Spectrum& spectrum,
  const DetectorResponse& response, double gapMm, const std::optional<AntiscatterGrid>& grid)
  : Radii(kernels.RadiiMm)
  , Thicknesses{ 0 }
  , Gaps(kernels.GapsMm)
  , GapMm(gapMm)
{
  kernels.Validate();
  spectrum.Validate();
  if (!(gapMm >= 0 && gapMm <= 200))
  {
    throw InputError("scatter: expected a gap of 0 to 200 mm, found " + std::to_string(gapMm));
  }
  this->Rings.assign(kernels.ThicknessesMm.size() + 1,
    std::vector<RingShares>(this->Gaps.size(), RingShares(kernels.NumberOfRings())));
  this->Thicknesses.insert(this->Thicknesses.end(), kernels.ThicknessesMm.begin(),
    kernels.ThicknessesMm.end());
  const PhotonMaterial tissue(kernels.Composition, kernels.DensityGPerCm3);
  std::vector<double> sums(this->Thicknesses.size());
  std::vector<double> weights(this->Thicknesses.size());
  this->Multiple.resize(this->Thicknesses.size());
  double freePath = 0;
  double through = 0;
  for (std::size_t bin = 0; bin < spectrum.Weights.size(); ++bin)
  {
    const double energy = spectrum.EnergiesKeV[bin];
    const double emitted = spectrum.Weights[bin] * response.Signal(energy);
    const double mu = tissue.At(energy).Total();
    std::vector<double> passed(kernels.NumberOfAngles(), 1);
    for (std::size_t angle = 0; grid && angle < passed.size(); ++angle)
    {
      const double middle = 0.5 * (kernels.AnglesDeg[angle] + kernels.AnglesDeg[angle + 1]);
      passed[angle] = grid->TransmissionAt(energy, middle * std::numbers::pi / 180);
    }
    constexpr double Usual = 40;
    freePath += emitted * std::exp(-mu * Usual) / mu;
    through += emitted * std::exp(-mu * Usual);
    for (std::size_t node = 1; emitted > 0 && node < this->Thicknesses.size(); ++node)
    {
      const double signal = emitted * std::exp(-mu * this->Thicknesses[node]);
      sums[node] += signal * (grid ? grid->PrimaryTransmission(energy) : 1.0);
      weights[node] += signal;
      this->Multiple[node] += signal * kernels.MultipleAt(energy, node - 1);
      for (std::size_t gap = 0; gap < this->Gaps.size(); ++gap)
      {
        const std::vector<double> shares = kernels.At(energy, node - 1, this->Gaps[gap]);
        RingShares& rings = this->Rings[node][gap];
        for (std::size_t place = 0; place < shares.size(); ++place)
        {
          rings[place / passed.size()] += signal * passed[place % passed.size()] * shares[place];
        }
      }
    }
  }
  this->FreePathMm = through > 0 ? freePath / through : 0;
  for (std::size_t node = 1; node < this->Thicknesses.size(); ++node)
  {
    this->Multiple[node] = weights[node] > 0 ? this->Multiple[node] / weights[node] : 0;
    for (RingShares& rings : this->Rings[node])
    {
      std::transform(rings.begin(), rings.end(), rings.begin(),
        [&](double ring) { return sums[node] > 0 ? ring / sums[node] : 0.0; });
    }
  }
}

ScatterModel::RingShares ScatterModel::RingsAt(std::size_t node, double missingMm) const
{
  const double gap = this->GapMm + 0.5 * std::max(missingMm, 0.0);
  const auto [before, beyond] =
    PlaceOn(this->Gaps, std::clamp(gap, this->Gaps.front(), this->Gaps.back()));
  const std::size_t next = std::min(before + 1, this->Gaps.size() - 1);
  RingShares rings(this->Radii.size() - 1);
  for (std::size_t ring = 0; ring < rings.size(); ++ring)
  {
    rings[ring] =
      (1 - beyond) * this->Rings[node][before][ring] + beyond * this->Rings[node][next][ring];
  }
  return rings;
}

double ScatterModel::ScatterToPrimary(double thicknessMm, double diameterMm) const
{
  // What the middle gets from all around is what a beam at the middle sends all around.
  const auto [node, share] = PlaceOn(this->Thicknesses, std::max(thicknessMm, 0.0));
  const RingShares low = this->RingsAt(node, 0);
  const RingShares high = this->RingsAt(node + 1, 0);
  const double edge = 0.5 * diameterMm;
  double sum = 0;
  for (std::size_t ring = 0; ring < low.size(); ++ring)
  {
    const double inner = this->Radii[ring];
    const double outer = this->Radii[ring + 1];
    const double within = std::clamp(edge, inner, outer);
    sum += ((1 - share) * low[ring] + share * high[ring]) * (within * within - inner * inner) /
      (outer * outer - inner * inner);
  }
  return sum;
}

ScatterModel::SentSignal ScatterModel::Gather(const XRaySource& source,
  const XRayDetector& detector, const std::vector<double>& thicknessesMm,
  const std::vector<double>& primary) const
{
  const Cells cells(detector);
  const Foot foot(source, detector);
  SentSignal signal;
  signal.ThickestMm = PlateDistance(thicknessesMm);
  signal.ByThickness.resize(this->Thicknesses.size());
  signal.Tissue.resize(cells.Count());
  signal.Multiple.resize(cells.Count());
  std::vector<double> pixels(cells.Count());
  // A cell sends the sum of its pixels over the number it has in the picture's midst.
  const double pixelsOfCell = static_cast<double>(cells.PerColumn) * cells.PerRow;
  std::size_t pixel = 0;
  for (int row = 0; row < detector.Rows; ++row)
  {
    for (int column = 0; column < detector.Columns; ++column, ++pixel)
    {
      const double thickness = thicknessesMm[pixel];
      const std::size_t cell = cells.CellOf(column, row);
      pixels[cell] += 1;
      if (!(thickness > 0))
      {
        continue;
      }
      const double share = std::min(thickness / signal.ThickestMm, 1.0);
      const auto [node, beyond] = PlaceOn(this->Thicknesses, thickness);
      signal.Tissue[cell] += share;
      signal.Multiple[cell] +=
        share * ((1 - beyond) * this->Multiple[node] + beyond * this->Multiple[node + 1]);
      const double closer =
        1 - foot.PerHeight * (this->GapMm + ScatterHeight * std::max(signal.ThickestMm, thickness));
      for (const auto& [at, weight] :
        { std::pair{ node, 1 - beyond }, std::pair{ node + 1, beyond } })
      {
        signal.ByThickness[at].resize(cells.Count());
        cells.Spread(foot.Column + closer * (column - foot.Column),
          foot.Row + closer * (row - foot.Row), weight * primary[pixel] / pixelsOfCell,
          signal.ByThickness[at]);
      }
    }
  }
  for (std::size_t cell = 0; cell < pixels.size(); ++cell)
  {
    signal.Tissue[cell] /= pixels[cell];
    signal.Multiple[cell] /= pixels[cell];
  }
  return signal;
}

std::vector<double> ScatterModel::Scatter(const XRaySource& source, const XRayDetector& detector,
  const std::vector<double>& thicknessesMm, const std::vector<double>& primary) const
{
  const std::size_t pixels = static_cast<std::size_t>(detector.Columns) * detector.Rows;
  if (thicknessesMm.size() != pixels || primary.size() != pixels)
  {
    throw InputError("scatter: expected thickness and signal of " + std::to_string(pixels) +
      " pixels, found " + std::to_string(thicknessesMm.size()) + " and " +
      std::to_string(primary.size()));
  }
  const Cells cells(detector);
  const SentSignal signal = this->Gather(source, detector, thicknessesMm, primary);
  // Beyond the largest ring nothing is sent; a margin of the picture's size keeps ends apart.
  CellPlane plane(cells, this->Radii.back());
  CellPlane sum = plane;
  for (std::size_t node = 1; node < signal.ByThickness.size(); ++node)
  {
    if (signal.ByThickness[node].empty())
    {
      continue;
    }
    plane.Put(signal.ByThickness[node]);
    plane.ToFrequencies();
    CellPlane kernel = plane;
    kernel.PutKernel(this->RingsAt(node, signal.ThickestMm - this->Thicknesses[node]), this->Radii);
    kernel.ToFrequencies();
    sum.AddProduct(plane, kernel);
  }
  sum.FromFrequencies();
  std::vector<double> scatter = sum.Take();
  // What is scattered more than once needs tissue around.
  plane.PutWithBorder(signal.Tissue);
  plane.ToFrequencies();
  plane.SpreadGaussian(2 * this->FreePathMm);
  plane.FromFrequencies();
  const std::vector<double> around = plane.Take();
  for (std::size_t cell = 0; cell < scatter.size(); ++cell)
  {
    scatter[cell] *= 1 - (1 - std::clamp(around[cell], 0.0, 1.0)) * signal.Multiple[cell];
  }
  std::vector<double> image;
  image.reserve(pixels);
  for (int row = 0; row < detector.Rows; ++row)
  {
    for (int column = 0; column < detector.Columns; ++column)
    {
      image.push_back(
        std::max(BetweenCells(scatter, cells.Columns, cells.Rows,
                   (column + 0.5) / cells.PerColumn - 0.5, (row + 0.5) / cells.PerRow - 0.5),
          0.0));
    }
  }
  return image;
}

std::vector<double> TissueThickness(const PathLengthImage& image)
{
  std::vector<double> thicknesses(image.NumberOfPixels());
  for (int material = 1; material < image.Materials; ++material)
  {
    const float* lengths = image.Material(material);
    for (std::size_t pixel = 0; pixel < thicknesses.size(); ++pixel)
    {
      thicknesses[pixel] += lengths[pixel];
    }
  }
  return thicknesses;
}
}
