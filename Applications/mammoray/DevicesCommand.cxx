// SPDX-License-Identifier: Apache-2.0
#include "Commands.h"
#include "SharedOptions.h"
#include "mammoray/XRay/PathLengthProjector.h"

#include <cstdio>

namespace mammoray
{
namespace
{
struct DevicesArguments
{
};

void Declare(const OptionList&, DevicesArguments&)
{
}

void Run(DevicesArguments&)
{
  std::string reason;
  const std::vector<DeviceDescription> devices = ListDevices(&reason);
  if (devices.empty())
  {
    throw DeviceError(reason);
  }
  for (const DeviceDescription& device : devices)
  {
    std::printf("%s\n  driver       %s\n  type         %s\n  ray tracing  %s\n",
      device.Name.c_str(), device.Driver.c_str(), device.Type.c_str(),
      device.RayTracing ? "yes" : "no");
  }
  // Making the projector is the proof that the device can be used.
  const auto projector = MakeProjector(Program().Projector);
  std::printf("chosen: %s, %s\n", projector->DeviceName().c_str(),
    MethodName(projector->Method()).c_str());
}
}

void AddDevicesCommand(CLI::App& application)
{
  AddCommand<DevicesArguments>(application, "devices",
    "Vulkan devices of this machine, and the one that would be used.", "devices", Declare, Run);
}
}
