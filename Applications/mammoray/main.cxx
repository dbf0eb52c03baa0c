// SPDX-License-Identifier: Apache-2.0
#include "Commands.h"
#include "Help.h"
#include "OptionNames.h"
#include "ProgressBar.h"
#include "Schema.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/AtomicFile.h"

#include <CLI/CLI.hpp>

#include <fcntl.h>
#include <malloc.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <string>
#include <vector>

namespace
{
void SetUpProcess()
{
  // Output to a closed stream must not end up in a file that is opened later.
  for (const int stream : { STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO })
  {
    if (fcntl(stream, F_GETFD) == -1)
    {
      open("/dev/null", O_RDWR);
    }
  }
  // Writing beyond a limit of file sizes then fails as on a full disk.
  std::signal(SIGXFSZ, SIG_IGN);
  // The shell may have ignored it, which hides how readers' processes end.
  std::signal(SIGCHLD, SIG_DFL);
#if defined(__GLIBC__)
  // Large buffers come and go at every step: keep freed memory for the next one.
  mallopt(M_MMAP_THRESHOLD, 256 << 20);
  mallopt(M_TRIM_THRESHOLD, 512 << 20);
#endif
  // Mesa prints two lines if it has no place for its shaders, as in a container without a home.
  const char* const home = std::getenv("HOME");
  std::error_code ignored;
  if (!std::getenv("XDG_CACHE_HOME") && home &&
    (!std::filesystem::is_directory(home, ignored) || access(home, W_OK) != 0))
  {
    setenv("MESA_SHADER_CACHE_DISABLE", "true", 0);
  }
}

/// Returns the status if everything printed has been written; otherwise 1, after a line.
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
  SetUpProcess();
  CLI::App application{ "MammoRay " MAMMORAY_VERSION
                        ": synthetic X-rays of meshes, and registration of breast MRI with "
                        "mammograms.\nLengths in mm, pressures in kPa, energies in keV, angles in "
                        "degrees." };
  application.set_version_flag("--version", "mammoray " MAMMORAY_VERSION);
  application.set_help_all_flag("--help-all", "of a command: all options");
  application.require_subcommand(1);
  mammoray::AddAppCommand(application);
  mammoray::AddCompressCommand(application);
  mammoray::AddDemoCommand(application);
  mammoray::AddDevicesCommand(application);
  mammoray::AddDicomCommand(application);
  mammoray::AddDisplacementCommand(application);
  mammoray::AddEvaluateCommand(application);
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
  const auto printSchema = [&application]
  {
    std::fputs(mammoray::CaseFileSchema(application).c_str(), stdout);
    throw CLI::Success();
  };
  application
    .add_flag_callback("--print-schema", printSchema,
      "print all options as the JSON schema of case files, and stop")
    ->trigger_on_parse();
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
  catch (const CLI::Success& success) // --help, --version, --print-...
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

std::string mammoray::ProgramFolder()
{
  return std::filesystem::read_symlink("/proc/self/exe").parent_path().string();
}

int main(int argc, char* argv[])
{
  int status = 1;
  try
  {
    status = CheckPrinted(Run(argc, argv));
  }
  catch (const std::exception& error)
  {
    std::fprintf(stderr, "mammoray: %s\n", mammoray::Complaint(error).c_str());
  }
  catch (...)
  {
    std::fputs("mammoray: failed for an unknown reason\n", stderr);
  }
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  return status; // leaks are found at exit
#else
  // Nothing else is left to do. OpenBLAS would join its threads, of which one that has hardly
  // started never ends (seen on a busy machine after a refusal; OpenBLAS issue 1720, pull request
  // 2372).
  std::fflush(nullptr);
  mammoray::GiveUpReservations();
  std::_Exit(status);
#endif
}
