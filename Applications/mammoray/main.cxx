// SPDX-License-Identifier: Apache-2.0
#include "Commands.h"
#include "Help.h"
#include "Manual.h"
#include "MissingMemory.h"
#include "OptionNames.h"
#include "Process.h"
#include "ProgressBar.h"
#include "mammoray/Foundation/Error.h"

#include <CLI/CLI.hpp>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <new>
#include <string>
#include <vector>

namespace
{
/// The exit status, once all that was printed is out: 1, with a line, where it is not.
int CheckPrinted(int status)
{
  const bool failed = std::ferror(stdout) != 0;
  errno = 0;
  if (std::fflush(stdout) == 0 && !failed)
  {
    return status;
  }
  std::fprintf(stderr, "mammoray: standard output: cannot be written (%s)\n",
    std::strerror(errno != 0 ? errno : EIO));
  return status == 0 ? 1 : status;
}

/// CLI11's two lines; what the first repeats of a configuration may hold anything.
void ExplainMisuse(const CLI::ParseError& error)
{
  std::fprintf(stderr, "%s\nRun with --help for more information.\n",
    mammoray::EscapeControls(error.what()).c_str());
}

int Run(int argc, char* argv[])
{
  mammoray::SetUpProcess(argv);
  CLI::App application{ "MammoRay " MAMMORAY_VERSION
                        ": synthetic X-rays of meshes, and registration of breast MRI with "
                        "mammograms.\nLengths in mm, pressures in kPa, energies in keV, angles in "
                        "degrees." };
  application.set_version_flag("--version", "mammoray " MAMMORAY_VERSION);
  application.require_subcommand(1);
  mammoray::AddCompressCommand(application);
  mammoray::AddDemoCommand(application);
  mammoray::AddDevicesCommand(application);
  mammoray::AddDicomCommand(application);
  mammoray::AddDisplacementCommand(application);
  mammoray::AddEvaluateCommand(application);
#ifdef MAMMORAY_HAS_MESHING
  mammoray::AddEvidenceCommand(application);
#endif
  mammoray::AddExampleCommand(application);
  mammoray::AddFetchCommand(application);
  mammoray::AddFuseCommand(application);
  mammoray::AddIntakeCommand(application);
  mammoray::AddLocateCommand(application);
  mammoray::AddMeshCommand(application);
  mammoray::AddProjectCommand(application);
  mammoray::AddRegisterCommand(application);
  mammoray::AddSegmentCommand(application);
  mammoray::AddSendCommand(application);
#ifdef MAMMORAY_HAS_APP
  mammoray::AddViewCommand(application);
#endif
  mammoray::AddManualOptions(application);
  mammoray::SetUpHelp(application);
  mammoray::InterruptRequested();

  if (argc == 1)
  {
    std::fputs(application.help().c_str(), stderr);
    return 2;
  }
  try
  {
    mammoray::CheckWords(application, { argv + 1, argv + argc });
    application.parse(argc, argv);
  }
  catch (const CLI::Success& success) // --help, --version, --print-config
  {
    return application.exit(success);
  }
  catch (const CLI::ParseError& error)
  {
    ExplainMisuse(error);
    return 2;
  }
  return 0;
}
}

int main(int argc, char* argv[])
{
  try
  {
    return CheckPrinted(Run(argc, argv));
  }
  catch (const std::bad_alloc&)
  {
    std::fprintf(stderr, "mammoray: %s\n", mammoray::MissingMemory);
  }
  catch (const std::filesystem::filesystem_error& error) // as of a name that is too long
  {
    std::fprintf(stderr, "mammoray: %s: cannot be looked for (%s)\n",
      mammoray::EscapeControls(error.path1().string()).c_str(), error.code().message().c_str());
  }
  catch (const mammoray::InputError& error)
  {
    std::fprintf(stderr, "mammoray: %s\n", mammoray::InOptions(error).c_str());
  }
  catch (const std::exception& error)
  {
    std::fprintf(stderr, "mammoray: %s\n", mammoray::EscapeControls(error.what()).c_str());
  }
  catch (...)
  {
    std::fputs("mammoray: failed for an unknown reason\n", stderr);
  }
  return 1;
}
