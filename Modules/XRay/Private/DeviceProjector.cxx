// SPDX-License-Identifier: Apache-2.0
#include "Private/DeviceProjector.h"

#include "Private/ProjectionHelpers.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/XRay/Beam.h"

#include <algorithm>
#include <limits>
#include <string>
#include <utility>

namespace mammoray
{
namespace
{
/// Path lengths of an image, 4 GiB: more is a slip of the keyboard.
constexpr std::uint64_t MostLengths = 1u << 30;
}

DeviceProjector::DeviceProjector(std::unique_ptr<VulkanDevice> device,
  const ProjectorOptions& options)
  : OwnedDevice(std::move(device))
  , Device(*this->OwnedDevice)
  , Doubles(options.DoublePrecision && this->Device.HasDoubles())
{
}

int DeviceProjector::MostRows(const XRayDetector& detector) const
{
  const std::uint64_t rowBytes = static_cast<std::uint64_t>(std::max(detector.Columns, 1)) *
    std::max(this->MaterialCount, 1u) * sizeof(float);
  return static_cast<int>(std::clamp<std::uint64_t>(
    this->Device.Limits().maxStorageBufferRange / rowBytes, 1, std::numeric_limits<int>::max()));
}

PathLengthImage DeviceProjector::ProjectInStrips(const XRaySource& source,
  const XRayDetector& detector, int rowsAtOnce)
{
  this->Forget();
  PathLengthImage image;
  std::vector<std::size_t> holes;
  for (int first = 0; first < detector.Rows; first += rowsAtOnce)
  {
    XRayDetector strip = detector;
    strip.Origin = detector.Origin + static_cast<double>(first) * detector.RowStep;
    strip.Rows = std::min(rowsAtOnce, detector.Rows - first);
    PathLengthImage part = this->MakeImage(source, strip);
    if (first == 0)
    {
      const std::uint64_t pixels = std::uint64_t(detector.Columns) * std::uint64_t(detector.Rows);
      if (pixels * this->MaterialCount > MostLengths)
      {
        throw InputError("detector: " + std::to_string(pixels) + " pixels of " +
          std::to_string(this->MaterialCount) + " materials, expected at most " +
          std::to_string(MostLengths) + " path lengths in an image");
      }
      image.Columns = detector.Columns;
      image.Rows = detector.Rows;
      image.Materials = part.Materials;
      image.Lengths.assign(image.NumberOfPixels() * static_cast<std::size_t>(part.Materials), 0);
      image.Inconsistent.resize(image.NumberOfPixels());
    }
    WithDeviceErrors([&] { this->Render(source, strip, 0); });
    const std::size_t offset = static_cast<std::size_t>(first) * detector.Columns;
    for (const std::size_t hole :
      ReadImage({ this->Lengths.Data<float>(), this->Failures.Data<std::uint32_t>() }, strip, part))
    {
      holes.push_back(offset + hole);
    }
    for (int material = 1; material < part.Materials; ++material)
    {
      std::copy_n(part.Material(material), part.NumberOfPixels(),
        image.Lengths.data() + static_cast<std::size_t>(material) * image.NumberOfPixels() +
          offset);
    }
    std::copy(part.Inconsistent.begin(), part.Inconsistent.end(),
      image.Inconsistent.begin() + static_cast<std::ptrdiff_t>(offset));
  }
  FillFromNeighbours(image.Lengths, image.Columns, image.Rows, holes);
  this->LastView = ProjectedView{ image.Columns, image.Rows, image.Materials, std::move(holes) };
  this->LastInStrips = image;
  return image;
}

PathLengthImage DeviceProjector::Project(const XRaySource& source, const XRayDetector& detector)
{
  if (const int most = this->MostRows(detector); most < detector.Rows)
  {
    return this->ProjectInStrips(source, detector, most);
  }
  PathLengthImage image = this->MakeImage(source, detector);
  this->Forget();
  WithDeviceErrors([&] { this->Render(source, detector, 0); });
  this->Read(detector, image);
  return image;
}

PathLengthImage DeviceProjector::Project(const XRaySource& source, const XRayDetector& detector,
  const std::vector<double>& velocities, int fields, PathLengthDerivatives& derivatives)
{
  PathLengthImage image = this->MakeImage(source, detector);
  this->Forget();
  CheckVelocities(velocities, fields, this->PointCount);
  const int atOnce = this->MostFields(detector, fields);
  PrepareDerivatives(image, fields, derivatives);
  this->RenderFields(source, detector, velocities, fields, atOnce, derivatives);
  this->Read(detector, image);
  FillFromNeighbours(derivatives.Lengths, image.Columns, image.Rows, this->LastView->Holes);
  return image;
}

void DeviceProjector::Read(const XRayDetector& detector, PathLengthImage& image)
{
  this->LastView = ProjectedView{ image.Columns, image.Rows, image.Materials,
    ReadImage({ this->Lengths.Data<float>(), this->Failures.Data<std::uint32_t>() }, detector,
      image) };
  FillFromNeighbours(image.Lengths, image.Columns, image.Rows, this->LastView->Holes);
}

void DeviceProjector::RenderBatch(const XRaySource& source, const XRayDetector& detector,
  const std::vector<double>& velocities, int first, const std::vector<double>& factors)
{
  WithDeviceErrors(
    [&]
    {
      if (Reserve(this->Velocities, this->Device,
            3 * sizeof(float) * this->PointCount * factors.size(),
            vk::BufferUsageFlagBits::eStorageBuffer, MemoryUse::Upload))
      {
        this->DescriptorsStale = true;
      }
      WriteVelocities(velocities, this->PointCount, first, factors, this->Velocities.Data<float>());
      this->Render(source, detector, static_cast<int>(factors.size()));
    });
}

std::vector<float> DeviceProjector::Transmission(const Beam& beam)
{
  if (this->LastInStrips)
  {
    std::vector<float> image = beam.Transmission(*this->LastInStrips);
    FillFromNeighbours(image, this->LastView->Columns, this->LastView->Rows, this->LastView->Holes);
    return image;
  }
  return WithDeviceErrors(
    [&]
    {
      if (!this->BeamOnDevice)
      {
        this->BeamOnDevice.emplace(this->Device);
      }
      return this->BeamOnDevice->Transmission(this->Lengths, this->LastView, beam);
    });
}
}
