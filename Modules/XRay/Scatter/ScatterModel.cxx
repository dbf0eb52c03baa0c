// SPDX-License-Identifier: Apache-2.0
#include "mammoray/XRay/Scatter/ScatterModel.h"

#include "Private/Interpolation.h"
#include "Private/ScatterCells.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/Numbers.h"
#include "mammoray/Foundation/ParallelFor.h"
#include "mammoray/XRay/DetectorPlane.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <tuple>
#include <utility>

namespace mammoray
{
namespace
{
/// Height of the last scattering over the back of the tissue, as a fraction of its thickness. It
/// determines the effect of the beam's divergence. With 1/4, slabs of 54 mm agree within 4 % with
/// the Monte Carlo method; with 0 and 1/2, within 8 %.
constexpr double ScatterHeight = 0.25;
/// Largest distance along a body, as a fraction of its greatest thickness, from which multiple
/// scatter comes. With 1/2, blocks of PMMA agree with the Monte Carlo method.
constexpr double ReachInThickness = 0.5;

/**
 * The thickness between the plates: the mean of the 85th to 95th percentiles of the tissue's
 * thickness, because rays through the chest wall, beside the plates, are longer. The weight of
 * tissue rises linearly up to a thickness of 5 mm, so that the result is continuous.
 */
class PlateDistance
{
public:
  /// `thicknessesMm`: one value for each cell.
  explicit PlateDistance(const std::vector<double>& thicknessesMm)
    : Thicknesses(thicknessesMm)
  {
    std::vector<std::size_t> order;
    for (std::size_t cell = 0; cell < thicknessesMm.size(); ++cell)
    {
      if (thicknessesMm[cell] > 0)
      {
        order.push_back(cell);
        this->Weight += std::min(thicknessesMm[cell] / Full, 1.0);
      }
    }
    std::sort(order.begin(), order.end(),
      [&](std::size_t a, std::size_t b) { return thicknessesMm[a] < thicknessesMm[b]; });
    double done = 0;
    for (const std::size_t cell : order)
    {
      const double begin = std::max(done, First * this->Weight);
      done += std::min(thicknessesMm[cell] / Full, 1.0);
      const double share =
        (std::min(done, Last * this->Weight) - begin) / ((Last - First) * this->Weight);
      if (share > 0)
      {
        this->Mm += share * thicknessesMm[cell];
        this->Counted.emplace_back(cell, share);
      }
    }
  }
  /// Derivative of Mm from those of the thicknesses; exact if the plates are more than 5 mm apart.
  double RateOf(const std::vector<double>& rates) const
  {
    double rate = 0;
    for (const auto& [cell, share] : this->Counted)
    {
      rate += share * rates[cell];
    }
    double weightRate = 0;
    for (std::size_t cell = 0; cell < rates.size(); ++cell)
    {
      weightRate += this->Thicknesses[cell] > 0 && this->Thicknesses[cell] < Full ? rates[cell] : 0;
    }
    if (!this->Counted.empty())
    {
      // More of what is thinner: what counts lies lower among the rest.
      const double low = this->Thicknesses[this->Counted.front().first];
      const double high = this->Thicknesses[this->Counted.back().first];
      rate += weightRate / Full / this->Weight *
        (((1 - First) * low - (1 - Last) * high) / (Last - First) - this->Mm);
    }
    return rate;
  }

  double Mm = 0;

private:
  static constexpr double Full = 5;
  static constexpr double First = 0.85;
  static constexpr double Last = 0.95;

  std::vector<double> Thicknesses;
  double Weight = 0;
  /// Cells and their weights in the mean, thinnest first.
  std::vector<std::pair<std::size_t, double>> Counted;
};

/// Calls visit(column, row, pixel) for the pixels with tissue in some rows.
template <typename Visit>
void ForEachTissuePixel(const XRayDetector& detector, std::size_t firstRow, std::size_t endRow,
  const std::vector<double>& thicknessesMm, const Visit& visit)
{
  std::size_t pixel = firstRow * static_cast<std::size_t>(detector.Columns);
  for (std::size_t row = firstRow; row < endRow; ++row)
  {
    for (int column = 0; column < detector.Columns; ++column, ++pixel)
    {
      if (thicknessesMm[pixel] > 0)
      {
        visit(column, static_cast<double>(row), pixel);
      }
    }
  }
}
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
  const double widest = std::max(200.0, this->Gaps.back());
  if (!(gapMm >= 0 && gapMm <= widest))
  {
    throw InputError("scatter: expected a gap of 0 to " + NumberText(widest) +
      " mm for these kernels, found " + NumberText(gapMm));
  }
  const double mean = spectrum.MeanEnergyKeV();
  // Beyond the table shares are constant, which a tail of the spectrum bears.
  if (mean > 1.05 * kernels.EnergiesKeV.back() || mean < 0.8 * kernels.EnergiesKeV.front())
  {
    throw InputError("scatter: expected photons of " + NumberText(kernels.EnergiesKeV.front()) +
      " to " + NumberText(kernels.EnergiesKeV.back()) + " keV for these kernels, found a mean of " +
      NumberText(mean) + "; kernels of the scene have its energies");
  }
  this->Rings.assign(kernels.ThicknessesMm.size() + 1,
    std::vector<RingShares>(this->Gaps.size(), RingShares(kernels.NumberOfRings())));
  this->Thicknesses.insert(this->Thicknesses.end(), kernels.ThicknessesMm.begin(),
    kernels.ThicknessesMm.end());
  const PhotonMaterial tissue(kernels.Composition, kernels.DensityGPerCm3);
  std::vector<double> sums(this->Thicknesses.size());
  std::vector<double> weights(this->Thicknesses.size());
  this->Multiple.resize(this->Thicknesses.size());
  // A usual thickness; of the shipped table 40 mm.
  const double usual = kernels.ThicknessesMm[std::min<std::size_t>(3, sums.size() - 2)];
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
    const double behind = emitted * std::exp(-mu * usual);
    freePath += behind / mu;
    through += behind;
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
  // Two mean free paths; in a thin body photons leave earlier.
  const double paths = through > 0 ? 2 * freePath / through : 0;
  this->ReachMm = std::min(paths, ReachInThickness * this->Thicknesses.back());
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

ScatterModel::RingShares ScatterModel::RingRatesAt(std::size_t node, double missingMm) const
{
  const double gap = this->GapMm + 0.5 * missingMm;
  RingShares rates(this->Radii.size() - 1);
  if (missingMm > 0 && gap > this->Gaps.front() && gap < this->Gaps.back())
  {
    const std::size_t before = PlaceOn(this->Gaps, gap).first;
    for (std::size_t ring = 0; ring < rates.size(); ++ring)
    {
      rates[ring] = 0.5 * (this->Rings[node][before + 1][ring] - this->Rings[node][before][ring]) /
        (this->Gaps[before + 1] - this->Gaps[before]);
    }
  }
  return rates;
}

double ScatterModel::ScatterToPrimary(double thicknessMm, double diameterMm) const
{
  // By symmetry, the middle receives from its surroundings what a beam at the middle sends there.
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

/// Everything about an image that does not depend on its primary signal.
struct ScatterModel::Geometry
{
  Geometry(const ScatterModel& model, const XRaySource& source, const XRayDetector& detector,
    const std::vector<double>& thicknessesMm)
    : Detector(detector)
    , Cells(detector)
    , Over(source, detector)
    , Pixels(PixelsOf(Cells, detector))
    , Plates(this->CellMeans(thicknessesMm))
    // Beyond the largest ring nothing is sent; a margin of the picture's size keeps ends apart.
    , Plane(Cells, model.Radii.back())
    , Rings(Plane, model.Radii)
  {
  }
  /// Fourier transform of the kernel of a cell.
  ScatterPlane KernelOf(const RingShares& shares) const
  {
    ScatterPlane kernel = this->Plane;
    this->Rings.PutKernel(shares, kernel);
    kernel.ToFrequencies();
    return kernel;
  }
  std::vector<double> CellMeans(const std::vector<double>& pixels) const
  {
    std::vector<double> means(this->Cells.Count());
    std::size_t pixel = 0;
    for (int row = 0; row < this->Detector.Rows; ++row)
    {
      for (int column = 0; column < this->Detector.Columns; ++column, ++pixel)
      {
        means[this->Cells.CellOf(column, row)] += pixels[pixel];
      }
    }
    this->DivideByPixels(means);
    return means;
  }
  void DivideByPixels(std::vector<double>& cells) const
  {
    for (std::size_t cell = 0; cell < cells.size(); ++cell)
    {
      cells[cell] /= this->Pixels[cell];
    }
  }
  /// The value of each pixel between those of the cells.
  std::vector<double> ToPixels(const std::vector<double>& cells) const
  {
    std::vector<double> image(this->Detector.NumberOfPixels());
    ParallelFor(static_cast<std::size_t>(this->Detector.Rows),
      [&](std::size_t row)
      {
        for (int column = 0; column < this->Detector.Columns; ++column)
        {
          image[row * static_cast<std::size_t>(this->Detector.Columns) +
            static_cast<std::size_t>(column)] =
            BetweenCells(cells, this->Cells.Columns, this->Cells.Rows, this->Cells.ColumnOf(column),
              this->Cells.RowOf(static_cast<double>(row)));
        }
      });
    return image;
  }

  static std::vector<double> PixelsOf(const ScatterCells& cells, const XRayDetector& detector)
  {
    std::vector<double> pixels(cells.Count());
    for (int row = 0; row < detector.Rows; ++row)
    {
      for (int column = 0; column < detector.Columns; ++column)
      {
        pixels[cells.CellOf(column, row)] += 1;
      }
    }
    return pixels;
  }

  XRayDetector Detector;
  ScatterCells Cells;
  DetectorPlane Over;
  /// Number of pixels of each cell.
  std::vector<double> Pixels;
  PlateDistance Plates;
  ScatterPlane Plane;
  ScatterRings Rings;
};

/// Sums by cell that the convolutions start from, or their derivatives.
struct ScatterModel::SentSignal
{
  SentSignal(std::size_t nodes, std::size_t cells)
    : ByThickness(nodes)
    , Tissue(cells)
    , Multiple(cells)
  {
  }
  void Add(const SentSignal& other)
  {
    const auto add = [](const std::vector<double>& from, std::vector<double>& to)
    {
      to.resize(std::max(to.size(), from.size()));
      for (std::size_t cell = 0; cell < from.size(); ++cell)
      {
        to[cell] += from[cell];
      }
    };
    add(other.Tissue, this->Tissue);
    add(other.Multiple, this->Multiple);
    for (std::size_t node = 0; node < this->ByThickness.size(); ++node)
    {
      add(other.ByThickness[node], this->ByThickness[node]);
    }
  }
  /// Primary signal of the tissue at each node of the thickness axis; empty if there is none.
  std::vector<std::vector<double>> ByThickness;
  /// Fraction of tissue between the plates, 0 to 1.
  std::vector<double> Tissue;
  /// Fraction of multiple scatter, weighted by Tissue.
  std::vector<double> Multiple;
};

/// The tissue of a pixel as a source of scatter.
struct ScatterModel::SendingPixel
{
  SendingPixel(const ScatterModel& model, const Geometry& geometry, double thickness)
  {
    std::tie(this->Node, this->Beyond) = PlaceOn(model.Thicknesses, thickness);
    this->Share = std::min(thickness / geometry.Plates.Mm, 1.0);
    this->Closer = 1 -
      (model.GapMm + ScatterHeight * std::max(geometry.Plates.Mm, thickness)) /
        geometry.Over.HeightMm;
    this->Multiple = (1 - this->Beyond) * model.Multiple[this->Node] +
      this->Beyond * model.Multiple[this->Node + 1];
  }
  /// Node of the thickness axis, and the weight of the next node.
  std::size_t Node = 0;
  double Beyond = 0;
  /// Fraction of tissue between the plates.
  double Share = 0;
  double Multiple = 0;
  /// Factor on the distance from the foot of the source, by the divergence of the beam.
  double Closer = 1;
};

template <typename Add>
ScatterModel::SentSignal ScatterModel::SumOfBands(const Geometry& geometry,
  const std::vector<double>& thicknessesMm, const Add& add) const
{
  // The number of bands does not depend on that of cores, so rounding is always the same.
  constexpr std::size_t Bands = 8;
  const auto rows = static_cast<std::size_t>(geometry.Detector.Rows);
  std::vector<SentSignal> bands(Bands,
    SentSignal(this->Thicknesses.size(), geometry.Cells.Count()));
  ParallelRanges(Bands, 1,
    [&](std::size_t begin, std::size_t end)
    {
      for (std::size_t band = begin; band < end; ++band)
      {
        ForEachTissuePixel(geometry.Detector, rows * band / Bands, rows * (band + 1) / Bands,
          thicknessesMm,
          [&](int column, double row, std::size_t pixel) { add(column, row, pixel, bands[band]); });
      }
    });
  SentSignal sum = std::move(bands.front());
  for (std::size_t band = 1; band < Bands; ++band)
  {
    sum.Add(bands[band]);
  }
  geometry.DivideByPixels(sum.Tissue);
  geometry.DivideByPixels(sum.Multiple);
  return sum;
}

ScatterModel::SentSignal ScatterModel::Gather(const Geometry& geometry,
  const std::vector<double>& thicknessesMm, const std::vector<double>& primary) const
{
  const ScatterCells& cells = geometry.Cells;
  // A cell sends the sum of its pixels over the number it has in the picture's midst.
  const double pixelsOfCell = static_cast<double>(cells.PerColumn) * cells.PerRow;
  const DetectorPlane& over = geometry.Over;
  return this->SumOfBands(geometry, thicknessesMm,
    [&](int column, double row, std::size_t pixel, SentSignal& signal)
    {
      const SendingPixel sent(*this, geometry, thicknessesMm[pixel]);
      const std::size_t cell = cells.CellOf(column, static_cast<int>(row));
      signal.Tissue[cell] += sent.Share;
      signal.Multiple[cell] += sent.Share * sent.Multiple;
      const ScatterCells::Shares shares =
        cells.SharesAt(over.FootColumn + sent.Closer * (column - over.FootColumn),
          over.FootRow + sent.Closer * (row - over.FootRow));
      const double value = primary[pixel] / pixelsOfCell;
      for (const std::size_t next : { 0, 1 })
      {
        std::vector<double>& to = signal.ByThickness[sent.Node + next];
        to.resize(cells.Count());
        const double weighted = value * (next == 0 ? 1 - sent.Beyond : sent.Beyond);
        for (std::size_t corner = 0; corner < 4; ++corner)
        {
          to[shares.Cells[corner]] += weighted * shares.Values[corner];
        }
      }
    });
}

ScatterModel::SentSignal ScatterModel::GatherRates(const Geometry& geometry,
  const std::vector<double>& thicknessesMm, const std::vector<double>& primary,
  const SignalRates& rates) const
{
  const ScatterCells& cells = geometry.Cells;
  const double pixelsOfCell = static_cast<double>(cells.PerColumn) * cells.PerRow;
  const DetectorPlane& over = geometry.Over;
  const double plates = geometry.Plates.Mm;
  const double plateRate = geometry.Plates.RateOf(geometry.CellMeans(rates.ThicknessesMm));
  return this->SumOfBands(geometry, thicknessesMm,
    [&](int column, double row, std::size_t pixel, SentSignal& signal)
    {
      const double thickness = thicknessesMm[pixel];
      const double rate = rates.ThicknessesMm[pixel];
      const SendingPixel sent(*this, geometry, thickness);
      const std::size_t node = sent.Node;
      const double beyondRate = rate / (this->Thicknesses[node + 1] - this->Thicknesses[node]);
      const double shareRate =
        thickness < plates ? (rate - thickness / plates * plateRate) / plates : 0;
      const double closerRate =
        -ScatterHeight * (thickness > plates ? rate : plateRate) / over.HeightMm;
      const std::size_t cell = cells.CellOf(column, static_cast<int>(row));
      signal.Tissue[cell] += shareRate;
      signal.Multiple[cell] += shareRate * sent.Multiple +
        sent.Share * beyondRate * (this->Multiple[node + 1] - this->Multiple[node]);
      const double fromFoot = column - over.FootColumn;
      const double belowFoot = row - over.FootRow;
      const ScatterCells::Shares shares = cells.SharesAt(over.FootColumn + sent.Closer * fromFoot,
        over.FootRow + sent.Closer * belowFoot, closerRate * fromFoot, closerRate * belowFoot);
      const double value = primary[pixel] / pixelsOfCell;
      const double valueRate = rates.Primary[pixel] / pixelsOfCell;
      for (const std::size_t next : { 0, 1 })
      {
        std::vector<double>& to = signal.ByThickness[node + next];
        to.resize(cells.Count());
        const double weight = next == 0 ? 1 - sent.Beyond : sent.Beyond;
        const double weightRate = next == 0 ? -beyondRate : beyondRate;
        const double weightedRate = weight * valueRate + weightRate * value;
        for (std::size_t corner = 0; corner < 4; ++corner)
        {
          to[shares.Cells[corner]] +=
            weightedRate * shares.Values[corner] + weight * value * shares.Rates[corner];
        }
      }
    });
}

std::vector<double> ScatterModel::TissueAround(const Geometry& geometry,
  const std::vector<double>& tissue) const
{
  ScatterPlane plane = geometry.Plane;
  plane.PutWithBorder(tissue);
  plane.ToFrequencies();
  plane.SpreadGaussian(this->ReachMm);
  plane.FromFrequencies();
  return plane.Take()[0];
}

namespace
{
/// Throws InputError unless there are values for all of the detector's pixels.
void CheckPixels(const XRayDetector& detector, const std::vector<double>& thicknessesMm,
  const std::vector<double>& primary)
{
  const std::size_t pixels = detector.NumberOfPixels();
  if (thicknessesMm.size() != pixels || primary.size() != pixels)
  {
    throw InputError("scatter: expected thickness and signal of " + std::to_string(pixels) +
      " pixels, found " + std::to_string(thicknessesMm.size()) + " and " +
      std::to_string(primary.size()));
  }
}
}

std::vector<double> ScatterModel::Scatter(const XRaySource& source, const XRayDetector& detector,
  const std::vector<double>& thicknessesMm, const std::vector<double>& primary) const
{
  CheckPixels(detector, thicknessesMm, primary);
  const Geometry geometry(*this, source, detector, thicknessesMm);
  const SentSignal signal = this->Gather(geometry, thicknessesMm, primary);
  ScatterPlane plane = geometry.Plane;
  ScatterPlane sum = geometry.Plane;
  for (std::size_t node = 1; node < signal.ByThickness.size(); ++node)
  {
    if (!signal.ByThickness[node].empty())
    {
      plane.Put({ &signal.ByThickness[node], nullptr });
      plane.ToFrequencies();
      sum.AddProduct(plane,
        geometry.KernelOf(this->RingsAt(node, geometry.Plates.Mm - this->Thicknesses[node])));
    }
  }
  sum.FromFrequencies();
  std::vector<double> scatter = sum.Take()[0];
  // Multiple scatter needs tissue around.
  const std::vector<double> around = this->TissueAround(geometry, signal.Tissue);
  for (std::size_t cell = 0; cell < scatter.size(); ++cell)
  {
    scatter[cell] *= 1 - (1 - std::clamp(around[cell], 0.0, 1.0)) * signal.Multiple[cell];
    scatter[cell] = std::max(scatter[cell], 0.0);
  }
  return geometry.ToPixels(scatter);
}

std::vector<std::vector<double>> ScatterModel::Differentiate(const XRaySource& source,
  const XRayDetector& detector, const std::vector<double>& thicknessesMm,
  const std::vector<double>& primary, const std::vector<SignalRates>& rates) const
{
  CheckPixels(detector, thicknessesMm, primary);
  const Geometry geometry(*this, source, detector, thicknessesMm);
  const SentSignal signal = this->Gather(geometry, thicknessesMm, primary);
  std::vector<SentSignal> changes;
  for (const SignalRates& rate : rates)
  {
    CheckPixels(detector, rate.ThicknessesMm, rate.Primary);
    changes.push_back(this->GatherRates(geometry, thicknessesMm, primary, rate));
  }
  // In pairs, as real and imaginary parts: first the signal itself and what it changes by with the
  // distance of the plates.
  const std::size_t pairs = (rates.size() + 1) / 2;
  std::vector<ScatterPlane> sums(pairs + 2, geometry.Plane);
  ScatterPlane plane = geometry.Plane;
  for (std::size_t node = 1; node < signal.ByThickness.size(); ++node)
  {
    if (signal.ByThickness[node].empty())
    {
      continue;
    }
    const double missing = geometry.Plates.Mm - this->Thicknesses[node];
    const ScatterPlane kernel = geometry.KernelOf(this->RingsAt(node, missing));
    plane.Put({ &signal.ByThickness[node], nullptr });
    plane.ToFrequencies();
    sums[pairs].AddProduct(plane, kernel);
    sums[pairs + 1].AddProduct(plane, geometry.KernelOf(this->RingRatesAt(node, missing)));
    for (std::size_t pair = 0; pair < pairs; ++pair)
    {
      const auto of = [&](std::size_t field)
      { return field < changes.size() ? &changes[field].ByThickness[node] : nullptr; };
      plane.Put({ of(2 * pair), of(2 * pair + 1) });
      plane.ToFrequencies();
      sums[pair].AddProduct(plane, kernel);
    }
  }
  for (ScatterPlane& sum : sums)
  {
    sum.FromFrequencies();
  }
  const std::vector<double> scatter = sums[pairs].Take()[0];
  const std::vector<double> perPlates = sums[pairs + 1].Take()[0];
  const std::vector<double> around = this->TissueAround(geometry, signal.Tissue);
  std::vector<std::vector<double>> images;
  for (std::size_t field = 0; field < rates.size(); ++field)
  {
    const std::vector<double> changed = sums[field / 2].Take()[field % 2];
    const SentSignal& change = changes[field];
    const std::vector<double> aroundRate = this->TissueAround(geometry, change.Tissue);
    const double plateRate = geometry.Plates.RateOf(geometry.CellMeans(rates[field].ThicknessesMm));
    std::vector<double> cells(scatter.size());
    for (std::size_t cell = 0; cell < cells.size(); ++cell)
    {
      const double air = 1 - std::clamp(around[cell], 0.0, 1.0);
      const double airRate = around[cell] > 0 && around[cell] < 1 ? -aroundRate[cell] : 0;
      cells[cell] = scatter[cell] > 0
        ? (changed[cell] + plateRate * perPlates[cell]) * (1 - air * signal.Multiple[cell]) -
          scatter[cell] * (airRate * signal.Multiple[cell] + air * change.Multiple[cell])
        : 0;
    }
    images.push_back(geometry.ToPixels(cells));
  }
  return images;
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
