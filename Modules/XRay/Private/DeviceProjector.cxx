// SPDX-License-Identifier: Apache-2.0
#include "DeviceProjector.h"

#include "ProjectionHelpers.h"

#include <utility>

namespace mammoray
{
DeviceProjector::DeviceProjector(std::unique_ptr<VulkanDevice> device,
  const ProjectorOptions& options)
  : OwnedDevice(std::move(device))
  , Device(*this->OwnedDevice)
  , Doubles(options.DoublePrecision && this->Device.HasDoubles())
{
}

PathLengthImage DeviceProjector::Project(const XRaySource& source, const XRayDetector& detector)
{
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
