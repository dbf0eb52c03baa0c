// SPDX-License-Identifier: Apache-2.0
#include "CommandLine.h"

#include "mammoray/XRay/DeviceError.h"
#include "mammoray/XRay/PathLengthProjector.h"

#include <cstdio>
#include <memory>

namespace mammoray
{
namespace
{
void RunDevices(const std::string& wanted, const std::string& projection)
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
  ProjectorOptions options;
  options.Projection = MethodFromName(projection);
  options.Device = wanted;
  const auto projector = MakeProjector(options);
  std::printf("chosen: %s, %s\n", projector->DeviceName().c_str(),
    MethodName(projector->Method()).c_str());
}
}

void AddDevicesCommand(CLI::App& application)
{
  CLI::App* command = application.add_subcommand("devices",
    "Vulkan devices of this machine, and the one that would be used.");
  auto wanted = std::make_shared<std::string>();
  command->add_option("--device", *wanted,
    "part of the wanted device's name; empty takes MAMMORAY_DEVICE, else the most capable one");
  auto projection = std::make_shared<std::string>("auto");
  AddProjectorOption(*command, *projection);
  AddConfigurationOptions(*command);
  command->callback([wanted, projection] { RunDevices(*wanted, *projection); });
}
}
