// SPDX-License-Identifier: Apache-2.0
#include "CommandLine.h"

#include <cstdio>

int main(int argc, char* argv[])
{
  CLI::App application{ "MammoRay " MAMMORAY_VERSION
                        ": synthetic X-rays of meshes, and registration of breast MRI with "
                        "mammograms.\nLengths in mm, pressures in kPa, energies in keV, angles in "
                        "degrees." };
  application.set_version_flag("--version", "mammoray " MAMMORAY_VERSION);
  application.require_subcommand(1);
  mammoray::AddCompressCommand(application);
  mammoray::AddDevicesCommand(application);
  mammoray::AddEvaluateCommand(application);
  mammoray::AddExampleCommand(application);
  mammoray::AddLocateCommand(application);
  mammoray::AddMeshCommand(application);
  mammoray::AddProjectCommand(application);
  mammoray::AddRegisterCommand(application);
  mammoray::AddSegmentCommand(application);
  mammoray::InterruptRequested();

  try
  {
    application.parse(argc, argv);
  }
  catch (const CLI::Success& success) // --help, --version, --print-config
  {
    return application.exit(success);
  }
  catch (const CLI::ParseError& error)
  {
    application.exit(error);
    return 2;
  }
  catch (const std::exception& error)
  {
    std::fprintf(stderr, "mammoray: %s\n", error.what());
    return 1;
  }
  return 0;
}
