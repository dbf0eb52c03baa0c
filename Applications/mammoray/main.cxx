// SPDX-License-Identifier: Apache-2.0
#include "Commands.h"
#include "Help.h"
#include "Manual.h"
#include "ProgressBar.h"
#include "mammoray/Foundation/Error.h"

#include <CLI/CLI.hpp>

#include <dlfcn.h>
#include <fcntl.h>
#include <malloc.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <new>
#include <string>
#include <vector>

namespace
{
/**
 * OpenBLAS takes its slowest kernels on a processor that is newer than its list, whatever that can
 * do, and settles it before main begins: then begins again with the kernels named. A third of a
 * compression's time. Does nothing where another BLAS is loaded or the user has chosen.
 */
void PreferFastBlasKernels(char* argv[])
{
#if defined(__x86_64__)
  constexpr const char* Choice = "OPENBLAS_CORETYPE";
  using CoreName = char* (*)();
  const auto coreName = reinterpret_cast<CoreName>(dlsym(RTLD_DEFAULT, "openblas_get_corename"));
  if (!coreName || std::getenv(Choice) || std::string(coreName()) != "Prescott" ||
    !__builtin_cpu_supports("avx2"))
  {
    return;
  }
  setenv(Choice, __builtin_cpu_supports("avx512dq") ? "SkylakeX" : "Haswell", 1);
  execv("/proc/self/exe", argv); // comes back only when it fails, and then this goes on as it is
#else
  static_cast<void>(argv);
#endif
}

/// Large buffers come and go at every step: what is freed is kept for the next, where it came page
/// by page, zeroed, from the kernel.
void KeepFreedMemory()
{
#if defined(__GLIBC__)
  mallopt(M_MMAP_THRESHOLD, 256 << 20);
  mallopt(M_TRIM_THRESHOLD, 512 << 20);
#endif
}

/// A stream that the caller has closed gets nothing, instead of a file that is opened later. A file
/// that meets a limit of sizes is told of, as one that meets a full disk.
void SettleStreams()
{
  for (const int stream : { STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO })
  {
    if (fcntl(stream, F_GETFD) == -1)
    {
      open("/dev/null", O_RDWR);
    }
  }
  std::signal(SIGXFSZ, SIG_IGN);
}

/**
 * Ends the process, with a line, at a limit on addresses (ulimit -v) that leaves little beside the
 * libraries: OpenBLAS's threads wait for memory for ever there, or it raises SIGINT, static objects
 * end in terminate, and Mesa's driver ends by a signal where the 0.65 GiB are not to be had that it
 * takes for its compiler and threads. Before any library's set-up, hence system calls alone, none
 * of them watched by a sanitizer that is not set up either.
 */
__attribute__((no_sanitize("address", "thread", "undefined"))) void CheckAddresses(int, char**,
  char** environment)
{
  // Of the work, and of each thread of OpenBLAS beyond the first: stack, arena and buffer.
  constexpr rlim_t ofWork = rlim_t{ 1 } << 30;
  constexpr rlim_t ofThread = rlim_t{ 140 } << 20;
  constexpr char threadsGiven[] = "OPENBLAS_NUM_THREADS=";
  constexpr long mostThreads = 64; // Debian's
  rlimit limit{};
  char text[160] = "0";
  const int file = open("/proc/self/statm", O_RDONLY | O_CLOEXEC);
  const ssize_t length = file < 0 ? 0 : read(file, text, sizeof text - 1);
  close(file);
  if (length < 0 || getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY)
  {
    return;
  }
  const rlim_t mapped =
    rlim_t{ std::strtoul(text, nullptr, 10) } * static_cast<rlim_t>(sysconf(_SC_PAGESIZE));
  long threads = sysconf(_SC_NPROCESSORS_ONLN);
  for (char** variable = environment; *variable; ++variable)
  {
    if (std::strncmp(*variable, threadsGiven, sizeof threadsGiven - 1) == 0)
    {
      threads = std::strtol(*variable + sizeof threadsGiven - 1, nullptr, 10);
    }
  }
  threads = threads < 1 ? 1 : threads > mostThreads ? mostThreads : threads;
  const rlim_t least = mapped + ofWork + static_cast<rlim_t>(threads - 1) * ofThread;
  if (limit.rlim_cur < least)
  {
    const int size = std::snprintf(text, sizeof text,
      "mammoray: expected at least %lu MiB of addresses (ulimit -v), found %lu\n",
      static_cast<unsigned long>(least >> 20), static_cast<unsigned long>(limit.rlim_cur >> 20));
    const ssize_t written = write(STDERR_FILENO, text, static_cast<std::size_t>(size));
    _exit(written == size ? 1 : 2);
  }
}
[[gnu::section(".preinit_array"), gnu::used]] void (*const CheckedBeforeAll)(int, char**,
  char**) = &CheckAddresses;

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
    mammoray::Printable(error.what()).c_str());
}

int Run(int argc, char* argv[])
{
  SettleStreams();
  PreferFastBlasKernels(argv);
  KeepFreedMemory();
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
#ifdef MAMMORAY_HAS_VIEWER
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
    std::fputs("mammoray: expected memory for the work, found less free, or allowed (ulimit -v), "
               "than it takes\n",
      stderr);
  }
  catch (const std::filesystem::filesystem_error& error) // as of a name that is too long
  {
    std::fprintf(stderr, "mammoray: %s: cannot be looked for (%s)\n",
      mammoray::Printable(error.path1().string()).c_str(), error.code().message().c_str());
  }
  catch (const std::exception& error)
  {
    std::fprintf(stderr, "mammoray: %s\n", mammoray::Printable(error.what()).c_str());
  }
  catch (...)
  {
    std::fputs("mammoray: failed for an unknown reason\n", stderr);
  }
  return 1;
}
