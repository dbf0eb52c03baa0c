// SPDX-License-Identifier: Apache-2.0
#include "Private/RasterisationProjector.h"

#include "RasterParameters.h"
#include "rasterMark_double.h"
#include "rasterMark_double_long.h"
#include "rasterMark_float.h"
#include "rasterMark_float_long.h"
#include "rasterResolve_double.h"
#include "rasterResolve_double_long.h"
#include "rasterResolve_float.h"
#include "rasterResolve_float_long.h"
#include "rasterTiles_double.h"
#include "rasterTiles_double_long.h"
#include "rasterTiles_float.h"
#include "rasterTiles_float_long.h"
#include "rasterTriangles_double.h"
#include "rasterTriangles_double_long.h"
#include "rasterTriangles_float.h"
#include "rasterTriangles_float_long.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace mammoray
{
namespace
{
using Usage = vk::BufferUsageFlagBits;

/// Initial capacity of the list of tiles.
constexpr std::uint32_t FirstTileCapacity = 1u << 16;
/// Number of workgroups that share the list of tiles: enough for large devices, few for a CPU.
constexpr std::uint32_t TileGroups = 1024;
/// Largest number of rows of samples: the number of workgroups that every device supports.
constexpr int MostRowsAtOnce = 65535;
/// Largest number of columns or rows of samples: tile indices have 16 bits.
constexpr int MostSamples = 65535 * MAMMORAY_RASTER_TILE;
/// A ray is traced once, and again at most four times where its crossings do not cancel.
constexpr int MostAttempts = 5;
static_assert(MostFieldsPerPass == MAMMORAY_RASTER_FIELDS);

/// Offset of the rays of an attempt, pixels: first 0, then up to a tenth, each time in another
/// direction (by the golden angle, so that none is along rows or columns).
std::pair<double, double> AttemptOffset(int attempt)
{
  if (attempt == 0)
  {
    return { 0, 0 };
  }
  const double size = 1e-5 * std::pow(10, attempt);
  return { size * std::cos(2.399963 * attempt), size * std::sin(2.399963 * attempt) };
}
}

RasterisationProjector::RasterisationProjector(std::unique_ptr<VulkanDevice> device,
  const ProjectorOptions& options)
  : DeviceProjector(std::move(device), options, Usage::eStorageBuffer)
  , Bindings(this->Device,
      { .Stages = vk::ShaderStageFlagBits::eCompute, .Count = MAMMORAY_RASTER_BINDING_COUNT })
{
  Reserve(this->Marks, this->Device, 1, Usage::eStorageBuffer | Usage::eTransferDst,
    MemoryUse::Device);
  this->ProgramsFor(Pass::Lengths);
  Reserve(this->Parameters, this->Device, sizeof(RasterParameters<double>), Usage::eStorageBuffer,
    MemoryUse::Upload);
  Reserve(this->TileCount, this->Device, sizeof(std::uint32_t), Usage::eTransferDst,
    MemoryUse::Download);
}

const RasterisationProjector::Programs& RasterisationProjector::ProgramsFor(Pass pass)
{
  std::optional<Programs>& known = this->Pipelines[static_cast<std::size_t>(pass)];
  if (known)
  {
    return *known;
  }
  const std::array<vk::Bool32, 2> values{ pass == Pass::Rates, pass == Pass::Gradient };
  const std::array<vk::SpecializationMapEntry, 2> entries{
    vk::SpecializationMapEntry(0, 0, sizeof(vk::Bool32)),
    vk::SpecializationMapEntry(1, sizeof(vk::Bool32), sizeof(vk::Bool32)),
  };
  const vk::SpecializationInfo constants(2, entries.data(), sizeof(values), values.data());
  const bool longs = this->Device.HasLongAtomics();
  const auto make = [&](std::optional<vk::raii::Pipeline>& pipeline, const auto& single,
                      const auto& singleLong, const auto& twice, const auto& twiceLong)
  {
    const vk::raii::ShaderModule module = this->Doubles
      ? (longs ? MakeShader(this->Device, twiceLong) : MakeShader(this->Device, twice))
      : (longs ? MakeShader(this->Device, singleLong) : MakeShader(this->Device, single));
    const vk::PipelineShaderStageCreateInfo stage({}, vk::ShaderStageFlagBits::eCompute, *module,
      "main", &constants);
    pipeline.emplace(this->Device.Device(), nullptr,
      vk::ComputePipelineCreateInfo({}, stage, this->Bindings.Layout()));
  };
  Programs programs;
  make(programs[0], rasterTriangles_float, rasterTriangles_float_long, rasterTriangles_double,
    rasterTriangles_double_long);
  make(programs[1], rasterTiles_float, rasterTiles_float_long, rasterTiles_double,
    rasterTiles_double_long);
  make(programs[2], rasterResolve_float, rasterResolve_float_long, rasterResolve_double,
    rasterResolve_double_long);
  make(programs[3], rasterMark_float, rasterMark_float_long, rasterMark_double,
    rasterMark_double_long);
  return known.emplace(std::move(programs));
}

void RasterisationProjector::SurfaceChanged(const std::vector<double>&, bool)
{
  this->Last.reset();
  // Room for the rounding of positions in single precision.
  this->Reach =
    1e-6 + (1 + 1e-6) * 0.5 * Norm(this->Surface.Bounds.High - this->Surface.Bounds.Low);
}

void RasterisationProjector::UpdateBindings()
{
  if (!this->BindingsStale)
  {
    return;
  }
  std::array<const Buffer*, MAMMORAY_RASTER_BINDING_COUNT> buffers{};
  buffers[MAMMORAY_RASTER_PARAMETERS] = &this->Parameters;
  buffers[MAMMORAY_RASTER_POSITIONS] = &this->Surface.Positions;
  buffers[MAMMORAY_RASTER_TRIANGLES] = &this->Surface.Triangles;
  buffers[MAMMORAY_RASTER_MATERIALS] = &this->Surface.Materials;
  buffers[MAMMORAY_RASTER_SUMS] = &this->Sums;
  buffers[MAMMORAY_RASTER_TILES] = &this->Tiles;
  buffers[MAMMORAY_RASTER_LENGTHS] = &this->Lengths.OnDevice();
  buffers[MAMMORAY_RASTER_FAILURES] = &this->Failures.OnDevice();
  buffers[MAMMORAY_RASTER_VELOCITIES] = &this->Velocities;
  buffers[MAMMORAY_RASTER_RATES] = &this->Rates.OnDevice();
  buffers[MAMMORAY_RASTER_MARKS] = &this->Marks;
  this->Bindings.Update(buffers);
  this->BindingsStale = false;
}

template <typename Real>
void RasterisationProjector::WriteParameters(const XRaySource& source, const XRayDetector& detector,
  const Work& work)
{
  RasterParameters<Real> parameters{};
  // The grid of samples.
  const int samples = detector.Samples;
  const Vector3 u = (1.0 / samples) * detector.ColumnStep;
  const Vector3 v = (1.0 / samples) * detector.RowStep;
  const Vector3 origin = detector.Origin - this->Surface.Center +
    (0.5 / samples - 0.5) * (detector.ColumnStep + detector.RowStep);
  SetReal4(parameters.DetectorOrigin, origin);
  SetReal4(parameters.ColumnStep, u);
  SetReal4(parameters.RowStep, v);

  // A point is p = base + column u + row v + depth w; for a point source, a ray's points are
  // multiples of one another.
  const bool isPoint = source.Type == XRaySource::Kind::Point;
  const Vector3 base = isPoint ? source.Position - this->Surface.Center : origin;
  const Vector3 w = isPoint ? origin - base : (1.0 / Norm(source.Direction)) * source.Direction;
  SetReal4(parameters.Source, isPoint ? base : w, isPoint ? 1 : 0);
  const double determinant = Dot(w, Cross(u, v));
  double largest = 0; // of the terms of a coordinate
  const auto coordinate = [&](const Vector3& factor, double magnitude)
  {
    const double constant = -Dot(factor, base);
    largest = std::max(largest, magnitude * (Norm(factor) * this->Reach + std::abs(constant)));
    return std::array<double, 4>{ factor[0], factor[1], factor[2], constant };
  };
  const int extent = samples * std::max(detector.Columns, detector.Rows);
  const auto columnOf = coordinate((1 / determinant) * Cross(v, w), 1);
  const auto rowOf = coordinate((1 / determinant) * Cross(w, u), 1);
  const Vector3 depthOf = (1 / determinant) * Cross(u, v);
  const auto weightOf = isPoint ? coordinate(depthOf, extent) : std::array<double, 4>{ 0, 0, 0, 1 };
  // The hit test offsets all rays slightly. Otherwise rounding would decide about rays that run
  // through corners, as in symmetric scenes. Distances stay those of the exact rays. In single
  // precision the offset is no larger than the rounding itself.
  const double rounding = std::numeric_limits<Real>::epsilon() * largest;
  const double beside = (sizeof(Real) == sizeof(double) ? 1000 : 1) * rounding;
  const auto [columnOffset, rowOffset] = AttemptOffset(work.Attempt);
  for (std::size_t axis = 0; axis < 4; ++axis)
  {
    parameters.ColumnOf[axis] =
      static_cast<Real>(columnOf[axis] - (beside + samples * columnOffset) * weightOf[axis]);
    parameters.RowOf[axis] =
      static_cast<Real>(rowOf[axis] - (0.57 * beside + samples * rowOffset) * weightOf[axis]);
    parameters.WeightOf[axis] = static_cast<Real>(weightOf[axis]);
  }

  parameters.Scales[0] = determinant > 0 ? Real(1) : Real(-1);
  // The longest path, twice the reach, is just below 2^31.
  const double unitsPerMm = 1073741824.0 / (1.001 * this->Reach);
  SetReal4(parameters.DepthOf, depthOf, unitsPerMm / Norm(depthOf));
  parameters.DetectorOrigin[3] = static_cast<Real>(-1e-3 * unitsPerMm);
  const double most = Norm(depthOf) * this->Reach;
  const auto within = [most](double depth)
  { return static_cast<Real>(std::clamp(depth, -most, most)); };
  parameters.Scales[1] = isPoint ? within(Dot(depthOf, base)) : static_cast<Real>(-most);
  parameters.Scales[2] = within(Dot(depthOf, origin));
  parameters.Scales[3] = static_cast<Real>(1e-3 + beside + 16 * rounding);
  parameters.Columns = static_cast<std::uint32_t>(samples * detector.Columns);
  parameters.FirstRow = static_cast<std::uint32_t>(samples * work.FirstRow);
  parameters.RowCount = static_cast<std::uint32_t>(samples * work.RowCount);
  parameters.Samples = static_cast<std::uint32_t>(samples);
  parameters.PixelCount = static_cast<std::uint32_t>(detector.NumberOfPixels());
  parameters.Materials = this->Surface.MaterialCount;
  parameters.Triangles = this->Surface.TriangleCount;
  parameters.TileCapacity = static_cast<std::uint32_t>(this->TileCapacity());
  parameters.Fields = work.HasMarks ? 1u : static_cast<std::uint32_t>(work.Fields);
  parameters.Left = static_cast<std::uint32_t>(samples * work.Left);
  parameters.Right = static_cast<std::uint32_t>(samples * work.Right + samples - 1);
  parameters.Top = static_cast<std::uint32_t>(samples * work.Top);
  parameters.Bottom = static_cast<std::uint32_t>(samples * work.Bottom + samples - 1);
  parameters.PixelColumns = static_cast<std::uint32_t>(detector.Columns);
  parameters.FirstPixel = static_cast<std::uint32_t>(work.FirstRow) * parameters.PixelColumns;
  parameters.Again = static_cast<std::uint32_t>(work.Attempt);
  *this->Parameters.Data<RasterParameters<Real>>() = parameters;
}

void RasterisationProjector::WriteParametersOf(const XRaySource& source,
  const XRayDetector& detector, const Work& work)
{
  if (this->Doubles)
  {
    this->WriteParameters<double>(source, detector, work);
  }
  else
  {
    this->WriteParameters<float>(source, detector, work);
  }
}

std::uint32_t RasterisationProjector::Submit(const XRayDetector& detector, const Work& work)
{
  using Stage = vk::PipelineStageFlagBits;
  using Access = vk::AccessFlagBits;
  const std::uint64_t rays = std::uint64_t(detector.Columns) *
    static_cast<std::uint64_t>(work.RowCount * detector.Samples * detector.Samples);
  const std::uint64_t pixels = detector.NumberOfPixels();
  const Programs& programs = this->ProgramsFor(work.Fields > 0 ? Pass::Rates : Pass::Lengths);
  const int samples = detector.Samples;
  const auto groups = [](int columns)
  {
    return static_cast<std::uint32_t>(
      (columns + MAMMORAY_RASTER_GROUP - 1) / MAMMORAY_RASTER_GROUP);
  };
  this->Device.Run(
    [&](const vk::raii::CommandBuffer& commands)
    {
      const auto wait =
        [&](Stage from, vk::AccessFlags written, vk::PipelineStageFlags to, vk::AccessFlags used)
      {
        const vk::MemoryBarrier barrier(written, used);
        commands.pipelineBarrier(from, to, {}, barrier, nullptr, nullptr);
      };
      const vk::AccessFlags both = Access::eShaderRead | Access::eShaderWrite;
      this->RecordClearing(commands, pixels);
      this->Bindings.Bind(commands, vk::PipelineBindPoint::eCompute);
      if (!work.KeepsTiles)
      {
        commands.fillBuffer(this->Tiles.Handle(), 0, sizeof(std::uint32_t), 0);
      }
      if (work.Attempt == 0)
      {
        commands.fillBuffer(this->Sums.Handle(), 0,
          std::max<std::uint64_t>(8,
            std::uint64_t(work.RowCount) * this->RowBytes(detector, work.Fields)),
          0);
      }
      else if (work.Attempt == 1 && !work.KeepsMarks)
      {
        commands.fillBuffer(this->Marks.Handle(), 0, rays * sizeof(std::uint32_t), 0);
      }
      wait(Stage::eTransfer, Access::eTransferWrite, Stage::eComputeShader, both);
      if (work.Attempt > 0)
      {
        commands.bindPipeline(vk::PipelineBindPoint::eCompute, **programs[3]);
        commands.dispatch(groups(samples * (work.Right - work.Left + 1)),
          static_cast<std::uint32_t>(samples * (work.Bottom - work.Top + 1)), 1);
        wait(Stage::eComputeShader, Access::eShaderWrite, Stage::eComputeShader, both);
      }
      if (!work.KeepsTiles)
      {
        commands.bindPipeline(vk::PipelineBindPoint::eCompute, **programs[0]);
        Dispatch(commands, this->Surface.TriangleCount, MAMMORAY_RASTER_GROUP);
        wait(Stage::eComputeShader, Access::eShaderWrite, Stage::eComputeShader | Stage::eTransfer,
          both | Access::eTransferRead);
      }
      commands.copyBuffer(this->Tiles.Handle(), this->TileCount.Handle(),
        vk::BufferCopy(0, 0, sizeof(std::uint32_t)));
      commands.bindPipeline(vk::PipelineBindPoint::eCompute, **programs[1]);
      commands.dispatch(TileGroups, 1, 1);
      wait(Stage::eComputeShader, Access::eShaderWrite, Stage::eComputeShader, both);
      commands.bindPipeline(vk::PipelineBindPoint::eCompute, **programs[2]);
      commands.dispatch(groups(work.Right - work.Left + 1),
        static_cast<std::uint32_t>(work.Bottom - work.Top + 1), 1);
      this->RecordResults(commands, Stage::eComputeShader, pixels);
    });
  return *this->TileCount.Data<std::uint32_t>();
}

std::uint64_t RasterisationProjector::RowBytes(const XRayDetector& detector, int fields) const
{
  const std::uint64_t samples = std::uint64_t(detector.Samples) * std::uint64_t(detector.Samples);
  const std::uint64_t pairs = 1 + (static_cast<std::uint64_t>(fields) + 1) / 2;
  return std::uint64_t(detector.Columns) * samples * (this->Surface.MaterialCount - 1) * pairs *
    sizeof(std::uint64_t);
}

bool RasterisationProjector::HasRoomFor(const XRayDetector& detector) const
{
  return this->RowBytes(detector, 0) <= this->MostBytes() &&
    detector.Samples * std::max(detector.Columns, detector.Rows) <= MostSamples;
}

int RasterisationProjector::MostFields(const XRayDetector& detector) const
{
  int count = MostFieldsPerPass;
  while (count > 0 && this->RowBytes(detector, count) > this->MostBytes())
  {
    --count;
  }
  return count;
}

FieldBatch RasterisationProjector::NextBatch(const VectorFields& velocities, int next,
  int atOnce) const
{
  FieldBatch batch{ next, std::min(atOnce, static_cast<int>(velocities.Count()) - next) };
  for (int field = 0; field < batch.Count; ++field)
  {
    const auto index = static_cast<std::size_t>(field);
    const double speed = LargestSpeed(velocities[static_cast<std::size_t>(next) + index]);
    batch.Factor[index] = speed > 0 ? MAMMORAY_RASTER_RATE_UNITS / speed : 0;
    batch.Unit[index] = speed / MAMMORAY_RASTER_RATE_UNITS;
  }
  return batch;
}

template <typename Finish>
std::uint32_t RasterisationProjector::FillBands(const XRaySource& source,
  const XRayDetector& detector, int fields, const Finish& finish)
{
  this->Last.reset();
  std::uint32_t failed = 0;
  const std::uint64_t rowBytes = std::max<std::uint64_t>(8, this->RowBytes(detector, fields));
  int band = static_cast<int>(std::min<std::uint64_t>(this->MostBytes() / rowBytes,
    static_cast<std::uint64_t>(std::min(detector.Rows, MostRowsAtOnce / detector.Samples))));
  for (int firstRow = 0; firstRow < detector.Rows;)
  {
    const int rowCount = std::min(band, detector.Rows - firstRow);
    const Work work{ fields, firstRow, rowCount, 0, detector.Columns - 1, firstRow,
      firstRow + rowCount - 1 };
    std::uint64_t tiles = 0;
    if (this->Run(source, detector, work, tiles))
    {
      std::vector<Work> attempts = this->RunAgain(source, detector, work);
      failed += this->FailedPixels();
      attempts.insert(attempts.begin(), work);
      if (fields == 0 && rowCount == detector.Rows)
      {
        this->Last = { source, detector, attempts };
      }
      finish(attempts);
      firstRow += rowCount;
    }
    else if (band > 1)
    {
      const std::uint64_t half = this->MostBytes() / (4 * sizeof(std::uint32_t));
      band = std::max(1, static_cast<int>(static_cast<std::uint64_t>(rowCount) * half / tiles));
    }
    else
    {
      throw DeviceError("Vulkan: one row of the detector is crossed by more triangles than " +
        this->Device.Name() + " has room for");
    }
  }
  return failed;
}

std::uint32_t RasterisationProjector::Fill(const XRaySource& source, const XRayDetector& detector,
  int fields)
{
  return this->FillBands(source, detector, fields, [](const std::vector<Work>&) {});
}

void RasterisationProjector::AddGradient(const XRaySource& source, const XRayDetector& detector)
{
  if (this->Last && this->Last->Source == source && this->Last->Detector == detector)
  {
    this->AddBand(source, detector, this->Last->Attempts);
    return;
  }
  this->FillBands(source, detector, 0,
    [&](const std::vector<Work>& attempts) { this->AddBand(source, detector, attempts); });
}

void RasterisationProjector::AddBand(const XRaySource& source, const XRayDetector& detector,
  const std::vector<Work>& attempts)
{
  this->UpdateBindings();
  for (Work work : attempts)
  {
    work.HasMarks = attempts.size() > 1;
    this->WriteParametersOf(source, detector, work);
    this->SubmitGradient();
  }
}

void RasterisationProjector::SubmitGradient()
{
  using Stage = vk::PipelineStageFlagBits;
  using Access = vk::AccessFlagBits;
  const Programs& programs = this->ProgramsFor(Pass::Gradient);
  const vk::AccessFlags both = Access::eShaderRead | Access::eShaderWrite;
  this->Device.Run(
    [&](const vk::raii::CommandBuffer& commands)
    {
      this->Bindings.Bind(commands, vk::PipelineBindPoint::eCompute);
      commands.fillBuffer(this->Tiles.Handle(), 0, sizeof(std::uint32_t), 0);
      const vk::MemoryBarrier cleared(Access::eTransferWrite | Access::eShaderWrite, both);
      commands.pipelineBarrier(Stage::eTransfer | Stage::eComputeShader, Stage::eComputeShader, {},
        cleared, nullptr, nullptr);
      commands.bindPipeline(vk::PipelineBindPoint::eCompute, **programs[0]);
      Dispatch(commands, this->Surface.TriangleCount, MAMMORAY_RASTER_GROUP);
      const vk::MemoryBarrier listed(Access::eShaderWrite, both | Access::eTransferRead);
      commands.pipelineBarrier(Stage::eComputeShader, Stage::eComputeShader | Stage::eTransfer, {},
        listed, nullptr, nullptr);
      commands.copyBuffer(this->Tiles.Handle(), this->TileCount.Handle(),
        vk::BufferCopy(0, 0, sizeof(std::uint32_t)));
      commands.bindPipeline(vk::PipelineBindPoint::eCompute, **programs[1]);
      commands.dispatch(TileGroups, 1, 1);
      const vk::MemoryBarrier added(Access::eShaderWrite | Access::eTransferWrite,
        Access::eTransferRead | Access::eHostRead | both);
      commands.pipelineBarrier(Stage::eComputeShader | Stage::eTransfer,
        Stage::eTransfer | Stage::eHost | Stage::eComputeShader, {}, added, nullptr, nullptr);
    });
  if (*this->TileCount.Data<std::uint32_t>() > this->TileCapacity())
  {
    throw DeviceError("Vulkan: the list of tiles grew between two runs");
  }
}

bool RasterisationProjector::Run(const XRaySource& source, const XRayDetector& detector, Work work,
  std::uint64_t& tiles)
{
  const std::uint64_t sumBytes =
    static_cast<std::uint64_t>(work.RowCount) * this->RowBytes(detector, work.Fields);
  const std::uint64_t mostTiles = this->MostBytes() / (2 * sizeof(std::uint32_t)) - 1;
  std::uint64_t capacity = FirstTileCapacity;
  while (true)
  {
    this->Ensure(this->Sums, sumBytes, Usage::eStorageBuffer | Usage::eTransferDst,
      MemoryUse::Device);
    this->Ensure(this->Tiles, 2 * sizeof(std::uint32_t) * (capacity + 1),
      Usage::eStorageBuffer | Usage::eTransferDst | Usage::eTransferSrc, MemoryUse::Device);
    this->UpdateBindings();
    this->WriteParametersOf(source, detector, work);
    tiles = this->Submit(detector, work);
    if (tiles <= this->TileCapacity())
    {
      return true;
    }
    if (tiles > mostTiles)
    {
      return false;
    }
    capacity = std::min(mostTiles, tiles + tiles / 4);
    work.KeepsMarks = true;
  }
}

std::vector<RasterisationProjector::Work> RasterisationProjector::RunAgain(const XRaySource& source,
  const XRayDetector& detector, Work work)
{
  std::vector<Work> attempts;
  const int last = work.FirstRow + work.RowCount - 1;
  for (work.Attempt = 1; work.Attempt < MostAttempts; ++work.Attempt)
  {
    if (this->FailedPixels() == 0)
    {
      return attempts;
    }
    const std::uint32_t* failures =
      this->FetchFailures(std::uint64_t(detector.Columns) * static_cast<std::uint64_t>(last + 1));
    work.Left = detector.Columns;
    work.Right = -1;
    work.Top = last + 1;
    work.Bottom = -1;
    for (int row = work.FirstRow; row <= last; ++row)
    {
      const std::uint32_t* failed = failures + static_cast<std::size_t>(row) * detector.Columns;
      for (int column = 0; column < detector.Columns; ++column)
      {
        if (failed[column] > 0)
        {
          work.Left = std::min(work.Left, column);
          work.Right = std::max(work.Right, column);
          work.Top = std::min(work.Top, row);
          work.Bottom = row;
        }
      }
    }
    this->Ensure(this->Marks,
      sizeof(std::uint32_t) * static_cast<std::uint64_t>(work.RowCount) *
        static_cast<std::uint64_t>(detector.Columns) *
        static_cast<std::uint64_t>(detector.Samples * detector.Samples),
      Usage::eStorageBuffer | Usage::eTransferDst, MemoryUse::Device);
    std::uint64_t tiles = 0;
    if (!this->Run(source, detector, work, tiles))
    {
      throw DeviceError("Vulkan: rays that failed are crossed by more triangles than " +
        this->Device.Name() + " has room for");
    }
    work.KeepsTiles = true;
    attempts.push_back(work);
  }
  return attempts;
}
}
