// SPDX-License-Identifier: Apache-2.0
#include "Process.h"

#include "MissingMemory.h"

#include <dlfcn.h>
#include <fcntl.h>
#include <malloc.h>
#include <pwd.h>
#include <sys/resource.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <string>

/// Of what runs before a sanitizer is set up.
#define UNWATCHED __attribute__((no_sanitize("address", "thread", "undefined")))

namespace mammoray
{
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

/// Ends the process, with a line, at a limit of `found` `unit` where `least` are needed.
UNWATCHED void CheckLimit(const char* what, const char* option, rlim_t least, rlim_t found,
  const char* unit, int bitsOfUnit)
{
  if (found >= least)
  {
    return;
  }
  char text[160];
  const int size = std::snprintf(text, sizeof text,
    "mammoray: expected at least %lu %s of %s (ulimit %s), found %lu\n",
    static_cast<unsigned long>(least >> bitsOfUnit), unit, what, option,
    static_cast<unsigned long>(found >> bitsOfUnit));
  const ssize_t written = write(STDERR_FILENO, text, static_cast<std::size_t>(size));
  _exit(written == size ? 1 : 2);
}

/// Of a smaller stack the readers of files end by a signal, at 256 KiB all of them.
UNWATCHED void CheckStack(int, char**, char**)
{
  rlimit limit{};
  if (getrlimit(RLIMIT_STACK, &limit) == 0)
  {
    CheckLimit("stack", "-s", rlim_t{ 1 } << 20, limit.rlim_cur, "KiB", 10);
  }
}

/**
 * Ends the process, with a line, at a limit on addresses (ulimit -v) that leaves little beside the
 * libraries: OpenBLAS's threads wait for memory for ever there, or it raises SIGINT, static objects
 * end in terminate, and Mesa's driver ends by a signal where the 0.65 GiB are not to be had that it
 * takes for its compiler and threads. Before any library's set-up, hence system calls alone, none
 * of them watched by a sanitizer that is not set up either.
 */
UNWATCHED void CheckAddresses(int, char**, char** environment)
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
  CheckLimit("addresses", "-v", least, limit.rlim_cur, "MiB", 20);
}

// Single pointers: an array may be aligned further, and what fills the section before it is called.
using BeforeAll = void (*)(int, char**, char**);
[[gnu::section(".preinit_array"), gnu::used]] const BeforeAll StackIsChecked = &CheckStack;
[[gnu::section(".preinit_array"), gnu::used]] const BeforeAll AddressesAreChecked = &CheckAddresses;

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__) // they watch signals
/// What SIGINT did when the process began.
struct sigaction InterruptAtStart
{
};

/// OpenBLAS raises SIGINT where it gets no thread, after two lines of its own.
UNWATCHED void OnEarlyInterrupt(int, siginfo_t* from, void*)
{
  if (from->si_code == SI_TKILL && from->si_pid == getpid())
  {
    constexpr char Line[] =
      "mammoray: expected a thread for each processor, found no more of them "
      "(ulimit -u, or a container's limit); OPENBLAS_NUM_THREADS=1 takes one\n";
    const ssize_t written = write(STDERR_FILENO, Line, sizeof Line - 1);
    _exit(written > 0 ? 1 : 2);
  }
  sigaction(SIGINT, &InterruptAtStart, nullptr);
  kill(getpid(), SIGINT);
}

UNWATCHED void HearOfMissingThreads(int, char**, char**)
{
  struct sigaction early
  {
  };
  early.sa_sigaction = OnEarlyInterrupt;
  early.sa_flags = SA_SIGINFO;
  sigaction(SIGINT, &early, &InterruptAtStart);
}

[[gnu::section(".preinit_array"), gnu::used]] const BeforeAll ThreadsAreHeardOf =
  &HearOfMissingThreads;
#endif

/// Where Mesa keeps its shaders.
std::filesystem::path PlaceOfShaders()
{
  for (const char* variable : { "MESA_SHADER_CACHE_DIR", "XDG_CACHE_HOME" })
  {
    if (const char* const given = std::getenv(variable); given && *given)
    {
      return given;
    }
  }
  const char* home = std::getenv("HOME");
  if (!home)
  {
    const passwd* const user = getpwuid(getuid());
    home = user ? user->pw_dir : "";
  }
  return std::filesystem::path(home) / ".cache";
}

/// Mesa says so, in two lines, where it cannot keep its shaders: of a user without a home, as a
/// container's may be.
void KeepNoShadersWithoutPlace()
{
  namespace fs = std::filesystem;
  fs::path place = PlaceOfShaders();
  std::error_code none;
  while (!fs::exists(place, none) && place.has_relative_path())
  {
    place = place.parent_path(); // Mesa makes what is missing
  }
  if (!fs::is_directory(place, none) || access(place.c_str(), W_OK) != 0)
  {
    setenv("MESA_SHADER_CACHE_DISABLE", "true", 0);
  }
}
}

void SetUpProcess(char* argv[])
{
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
  sigaction(SIGINT, &InterruptAtStart, nullptr);
#endif
  SettleStreams();
  PreferFastBlasKernels(argv);
  KeepNoShadersWithoutPlace();
  KeepFreedMemory();
  TellOfMissingMemory();
}
}
