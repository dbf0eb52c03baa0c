// SPDX-License-Identifier: Apache-2.0
#include "Private/DeviceProjector.h"

#include "Grazing.h"
#include "Private/ProjectionChecks.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/XRay/Beam.h"

#include <algorithm>
#include <string>
#include <utility>

namespace mammoray
{
namespace
{
using Usage = vk::BufferUsageFlagBits;

/// Largest number of path lengths of an image; they take 4 GiB.
constexpr std::uint64_t MostLengths = 1u << 30;
constexpr std::uint64_t MostWorkBytes = 256u << 20;
/// Hits of a ray on triangles of one point, and materials on both sides of them.
constexpr double HitsPerRayAndPoint = 64;
}

DeviceProjector::DeviceProjector(std::unique_ptr<VulkanDevice> device,
  const ProjectorOptions& options, vk::BufferUsageFlags surfaceUsage)
  : OwnedDevice(std::move(device))
  , Device(*this->OwnedDevice)
  , Doubles(options.DoublePrecision && this->Device.HasDoubles())
  , SurfaceUsage(surfaceUsage)
{
  // Shaders without derivatives are bound to these as well.
  Reserve(this->Velocities, this->Device, 1, Usage::eStorageBuffer, MemoryUse::Upload);
  this->Rates.Reserve(this->Device, 1);
  Reserve(this->FailedCount, this->Device, sizeof(std::uint32_t), Usage::eTransferDst,
    MemoryUse::Download);
}

void DeviceProjector::SetSurface(const SurfaceMesh& surface)
{
  surface.Validate("surface");
  CheckPoints(surface.Points, surface.NumberOfPoints());
  this->Forget();
  this->HasSurface = false; // until all is written
  WithDeviceErrors(
    [&]
    {
      this->Surface.Set(this->Device, surface, this->TriangleOrder(surface), this->Doubles,
        this->SurfaceUsage);
      this->BindingsStale = true;
      this->SurfaceChanged(surface.Points, false);
    });
  this->HasSurface = true;
}

void DeviceProjector::UpdatePoints(const std::vector<double>& points)
{
  if (!this->HasSurface)
  {
    throw InputError("projector: expected a surface before its points are moved, found none");
  }
  CheckPoints(points, this->Surface.PointCount);
  this->Forget();
  WithDeviceErrors(
    [&]
    {
      this->Surface.Move(points, this->Doubles);
      this->SurfaceChanged(points, true);
    });
}

void DeviceProjector::RequireSurface() const
{
  if (!this->HasSurface)
  {
    throw InputError("projector: expected a surface before the projection, found none");
  }
}

void DeviceProjector::CheckImage(const XRaySource& source, const XRayDetector& detector) const
{
  CheckGeometry(source, detector);
  this->RequireSurface();
  const std::uint64_t pixels = detector.NumberOfPixels();
  if (pixels * this->Surface.MaterialCount > MostLengths)
  {
    throw InputError("detector: " + std::to_string(pixels) + " pixels of " +
      std::to_string(this->Surface.MaterialCount) + " materials, expected at most " +
      std::to_string(MostLengths) + " path lengths in an image");
  }
  if (!this->HasRoomFor(this->StripAt(detector, 0).Part))
  {
    throw InputError("detector: " + std::to_string(pixels) + " pixels of " +
      std::to_string(this->Surface.MaterialCount) + " materials are more than " +
      this->Device.Name() + " takes in one image");
  }
}

PathLengthImage DeviceProjector::MakeImage(int columns, int rows) const
{
  PathLengthImage image;
  image.Columns = columns;
  image.Rows = rows;
  image.Materials = static_cast<int>(this->Surface.MaterialCount);
  return image;
}

PixelRange DeviceProjector::Strip::Pixels() const
{
  const auto columns = static_cast<std::size_t>(this->Part.Columns);
  return { static_cast<std::size_t>(this->FirstRow) * columns,
    static_cast<std::size_t>(this->Part.Rows) * columns };
}

int DeviceProjector::RowsAtOnce(const XRayDetector& detector) const
{
  const std::uint64_t rowBytes =
    std::uint64_t(detector.Columns) * this->Surface.MaterialCount * sizeof(float);
  return static_cast<int>(
    std::clamp<std::uint64_t>(this->Device.Limits().maxStorageBufferRange / rowBytes, 1,
      static_cast<std::uint64_t>(detector.Rows)));
}

DeviceProjector::Strip DeviceProjector::StripAt(const XRayDetector& detector, int firstRow) const
{
  Strip strip{ firstRow, detector };
  strip.Part.Origin = detector.Origin + static_cast<double>(firstRow) * detector.RowStep;
  strip.Part.Rows = std::min(this->RowsAtOnce(detector), detector.Rows - firstRow);
  return strip;
}

template <typename Work>
PathLengthImage DeviceProjector::ProjectStrips(const XRayDetector& detector, const Work& render)
{
  this->Forget();
  PathLengthImage image = this->MakeImage(detector.Columns, detector.Rows);
  std::vector<std::size_t> holes;
  for (int row = 0; row < detector.Rows;)
  {
    const Strip strip = this->StripAt(detector, row);
    const std::uint32_t failed = render(strip);
    const PixelRange pixels = strip.Pixels();
    const ProjectionOutput output =
      WithDeviceErrors([&] { return this->FetchOutput(pixels.Count, failed); });
    const std::vector<std::size_t> found = ReadLengths(output, pixels, detector.Samples, image);
    holes.insert(holes.end(), found.begin(), found.end());
    row += strip.Part.Rows;
  }
  FillFromNeighbours(image.Lengths, image.Columns, image.Rows, holes);
  this->LastImage = DeviceImage{ image.Columns, image.Rows, image.Materials, std::move(holes) };
  if (this->RowsAtOnce(detector) < detector.Rows)
  {
    this->LastInStrips = image;
  }
  return image;
}

void DeviceProjector::Render(const XRaySource& source, const XRayDetector& detector)
{
  this->CheckImage(source, detector);
  const Strip strip = this->StripAt(detector, 0);
  if (strip.Part.Rows < detector.Rows)
  {
    this->Project(source, detector); // no buffer of the device keeps it
    return;
  }
  this->Forget();
  const std::size_t pixels = strip.Pixels().Count;
  std::vector<std::size_t> holes;
  if (this->FillStrip(source, strip.Part, 0) > 0)
  {
    const std::uint32_t* failures = WithDeviceErrors([&] { return this->FetchFailures(pixels); });
    holes = FindHoles(failures, pixels, detector.Samples);
  }
  this->LastImage = DeviceImage{ detector.Columns, detector.Rows,
    static_cast<int>(this->Surface.MaterialCount), std::move(holes) };
}

PathLengthImage DeviceProjector::Project(const XRaySource& source, const XRayDetector& detector)
{
  this->CheckImage(source, detector);
  return this->ProjectStrips(detector,
    [&](const Strip& strip) { return this->FillStrip(source, strip.Part, 0); });
}

PathLengthImage DeviceProjector::Project(const XRaySource& source, const XRayDetector& detector,
  const VectorFields& velocities, PathLengthDerivatives& derivatives)
{
  this->CheckImage(source, detector);
  CheckVelocities(velocities, this->Surface.PointCount);
  const auto fields = static_cast<int>(velocities.Count());
  const int atOnce = this->FieldsAtOnce(this->StripAt(detector, 0).Part, fields);
  PrepareDerivatives(detector, static_cast<int>(this->Surface.MaterialCount), fields, derivatives);
  PathLengthImage image = this->ProjectStrips(detector,
    [&](const Strip& strip)
    {
      std::uint32_t failed = 0;
      for (int next = 0; next < fields;)
      {
        const FieldBatch batch = this->NextBatch(velocities, next, atOnce);
        WithDeviceErrors(
          [&]
          {
            this->Ensure(this->Velocities,
              3 * sizeof(float) * this->Surface.PointCount * static_cast<std::size_t>(batch.Count),
              Usage::eStorageBuffer, MemoryUse::Upload);
          });
        WriteVelocities(velocities, batch, this->Velocities.Data<float>());
        failed = this->FillStrip(source, strip.Part, batch.Count);
        const PixelRange pixels = strip.Pixels();
        const float* rates =
          WithDeviceErrors([&] { return this->FetchRates(pixels.Count, batch.Count); });
        ReadRates(rates, batch, pixels, derivatives);
        next = batch.First + batch.Count;
      }
      return failed;
    });
  FillFromNeighbours(derivatives.Lengths, image.Columns, image.Rows, this->LastImage->Holes);
  return image;
}

std::vector<double> DeviceProjector::Backward(const XRaySource& source,
  const XRayDetector& detector, const std::vector<float>& lossByLength)
{
  this->CheckImage(source, detector);
  const std::uint64_t pixels = detector.NumberOfPixels();
  const double largest = LargestLoss(lossByLength, pixels, this->Surface.MaterialCount);
  std::vector<double> gradient(3 * this->Surface.PointCount, 0.0);
  const vk::DeviceSize bytes = gradient.size() * sizeof(std::int64_t);
  if (bytes > this->Device.Limits().maxStorageBufferRange)
  {
    throw InputError("projector: a gradient with respect to " +
      std::to_string(this->Surface.PointCount) + " points is more than " + this->Device.Name() +
      " takes in one buffer");
  }
  if (largest == 0)
  {
    return gradient;
  }
  this->Forget();
  // No sum overflows if every ray meets all triangles of a point at the guard's angle.
  const double rays = static_cast<double>(pixels) * detector.Samples * detector.Samples;
  const double units =
    0x1p62 / (largest * rays * HitsPerRayAndPoint / double{ MAMMORAY_GRAZING_COSINE });
  WithDeviceErrors(
    [&]
    {
      this->Ensure(this->Rates, bytes);
      this->Device.Run([&](const vk::raii::CommandBuffer& commands)
        { commands.fillBuffer(this->Rates.OnDevice().Handle(), 0, bytes, 0); });
      for (int row = 0; row < detector.Rows;)
      {
        const Strip strip = this->StripAt(detector, row);
        const PixelRange range = strip.Pixels();
        this->Ensure(this->Velocities, sizeof(float) * range.Count * this->Surface.MaterialCount,
          Usage::eStorageBuffer, MemoryUse::Upload);
        this->ReserveOutput(range.Count, 0);
        WriteLosses(lossByLength, pixels, range, units, this->Velocities.Data<float>());
        this->AddGradient(source, strip.Part);
        row += strip.Part.Rows;
      }
      this->Rates.Fetch(this->Device, { { 0, bytes } });
    });
  const std::int64_t* sums = this->Rates.Data<std::int64_t>();
  std::transform(sums, sums + gradient.size(), gradient.begin(),
    [units](std::int64_t sum) { return static_cast<double>(sum) / units; });
  return gradient;
}

int DeviceProjector::FieldsAtOnce(const XRayDetector& part, int fields) const
{
  const std::uint64_t most = this->MostBytes();
  const std::uint64_t rates = part.NumberOfPixels() * this->Surface.MaterialCount * sizeof(float);
  const std::uint64_t velocities = 3 * this->Surface.PointCount * sizeof(float);
  const std::uint64_t count = std::min(
    { static_cast<std::uint64_t>(this->MostFields(part)), std::uint64_t{ MostFieldsPerPass },
      most / velocities, std::max<std::uint64_t>(1, most / rates) });
  if (count == 0)
  {
    throw InputError("projector: derivatives by velocities of " +
      std::to_string(this->Surface.PointCount) + " points are more than " + this->Device.Name() +
      " takes in one buffer");
  }
  return FieldsPerPass(fields, static_cast<int>(count));
}

std::uint32_t DeviceProjector::FillStrip(const XRaySource& source, const XRayDetector& part,
  int fields)
{
  return WithDeviceErrors(
    [&]
    {
      this->ReserveOutput(part.NumberOfPixels(), fields);
      return this->Fill(source, part, fields);
    });
}

void DeviceProjector::RecordClearing(const vk::raii::CommandBuffer& commands,
  std::uint64_t pixels) const
{
  commands.fillBuffer(this->Failures.OnDevice().Handle(), pixels * sizeof(std::uint32_t),
    sizeof(std::uint32_t), 0);
}

void DeviceProjector::RecordResults(const vk::raii::CommandBuffer& commands,
  vk::PipelineStageFlagBits stage, std::uint64_t pixels) const
{
  using Stage = vk::PipelineStageFlagBits;
  using Access = vk::AccessFlagBits;
  const vk::MemoryBarrier written(Access::eShaderWrite,
    Access::eShaderRead | Access::eTransferRead | Access::eHostRead);
  commands.pipelineBarrier(stage, Stage::eComputeShader | Stage::eTransfer | Stage::eHost, {},
    written, nullptr, nullptr);
  commands.copyBuffer(this->Failures.OnDevice().Handle(), this->FailedCount.Handle(),
    vk::BufferCopy(pixels * sizeof(std::uint32_t), 0, sizeof(std::uint32_t)));
  const vk::MemoryBarrier copied(Access::eTransferWrite, Access::eHostRead);
  commands.pipelineBarrier(Stage::eTransfer, Stage::eHost, {}, copied, nullptr, nullptr);
}

const std::uint32_t* DeviceProjector::FetchFailures(std::uint64_t pixels)
{
  this->Failures.Fetch(this->Device, { { 0, pixels * sizeof(std::uint32_t) } });
  return this->Failures.Data<std::uint32_t>();
}

ProjectionOutput DeviceProjector::FetchOutput(std::uint64_t pixels, std::uint32_t failed)
{
  const vk::DeviceSize plane = pixels * sizeof(float);
  this->Lengths.Fetch(this->Device, { { plane, plane * (this->Surface.MaterialCount - 1) } });
  return { this->Lengths.Data<float>(), failed > 0 ? this->FetchFailures(pixels) : nullptr };
}

const float* DeviceProjector::FetchRates(std::uint64_t pixels, int fields)
{
  const vk::DeviceSize plane = pixels * sizeof(float);
  std::vector<ResultBuffer::Range> ranges;
  for (int field = 0; field < fields; ++field)
  {
    const vk::DeviceSize begin =
      plane * this->Surface.MaterialCount * static_cast<vk::DeviceSize>(field);
    ranges.push_back({ begin + plane, plane * (this->Surface.MaterialCount - 1) });
  }
  this->Rates.Fetch(this->Device, ranges);
  return this->Rates.Data<float>();
}

std::uint64_t DeviceProjector::MostBytes() const
{
  return std::min<std::uint64_t>(MostWorkBytes, this->Device.Limits().maxStorageBufferRange);
}

void DeviceProjector::Ensure(Buffer& buffer, vk::DeviceSize bytes, vk::BufferUsageFlags usage,
  MemoryUse use)
{
  if (Reserve(buffer, this->Device, bytes, usage, use))
  {
    this->BindingsStale = true;
  }
}

void DeviceProjector::Ensure(ResultBuffer& buffer, vk::DeviceSize bytes)
{
  if (buffer.Reserve(this->Device, bytes))
  {
    this->BindingsStale = true;
  }
}

void DeviceProjector::ReserveOutput(std::uint64_t pixels, int fields)
{
  const std::uint64_t lengthBytes = pixels * this->Surface.MaterialCount * sizeof(float);
  this->Ensure(this->Lengths, lengthBytes);
  this->Ensure(this->Failures, (pixels + 1) * sizeof(std::uint32_t));
  this->Ensure(this->Rates, lengthBytes * static_cast<std::uint64_t>(fields));
}

std::vector<float> DeviceProjector::Transmission(const Beam& beam)
{
  if (!this->LastImage)
  {
    throw InputError("projector: expected a projection before its transmission, found none");
  }
  if (this->LastInStrips)
  {
    std::vector<float> image = beam.Transmission(*this->LastInStrips);
    FillFromNeighbours(image, this->LastImage->Columns, this->LastImage->Rows,
      this->LastImage->Holes);
    return image;
  }
  return WithDeviceErrors(
    [&]
    {
      if (!this->BeamOnDevice)
      {
        this->BeamOnDevice.emplace(this->Device);
      }
      return this->BeamOnDevice->Transmission(this->Lengths.OnDevice(), *this->LastImage, beam);
    });
}
}
