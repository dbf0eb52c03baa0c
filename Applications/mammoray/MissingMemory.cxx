// SPDX-License-Identifier: Apache-2.0
#include "MissingMemory.h"

#include <fcntl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <csignal>
#include <cstring>
#include <exception>
#include <initializer_list>

namespace mammoray
{
namespace
{
rlim_t Limit = RLIM_INFINITY;
pid_t Process = 0;
std::terminate_handler TerminateBefore = nullptr;

/// The most addresses that this process has had, bytes. By system calls alone, as signals need.
rlim_t MostAddresses()
{
  constexpr char Name[] = "VmPeak:";
  char text[8192] = {}; // the groups of a user, some hundred of them, come before
  const int file = open("/proc/self/status", O_RDONLY | O_CLOEXEC);
  const ssize_t length = read(file, text, sizeof text - 1);
  close(file);
  const char* digit = length > 0 ? std::strstr(text, Name) : nullptr;
  rlim_t kibibytes = 0;
  for (digit = digit ? digit + sizeof Name - 1 : ""; *digit != '\0' && *digit != '\n'; ++digit)
  {
    kibibytes = *digit >= '0' && *digit <= '9' ? 10 * kibibytes + (*digit - '0') : kibibytes;
  }
  return kibibytes << 10;
}

/// Whether a large request, as of an arena of the C library's (128 MiB), may have been refused.
bool IsNearLimit()
{
  constexpr rlim_t Large = rlim_t{ 256 } << 20;
  return getpid() == Process && MostAddresses() + Large > Limit;
}

[[noreturn]] void End()
{
  bool isTold = true;
  for (const char* part : { "mammoray: ", MissingMemory, "\n" })
  {
    isTold = write(STDERR_FILENO, part, std::strlen(part)) > 0 && isTold;
  }
  _exit(isTold ? 1 : 2);
}

void OnFault(int signal)
{
  if (IsNearLimit())
  {
    End();
  }
  raise(signal); // which ends the process at the handler's return, once it is not handled any more
}

void OnTerminate()
{
  if (IsNearLimit())
  {
    End();
  }
  TerminateBefore();
}
}

void TellOfMissingMemory()
{
  rlimit limit{};
  if (getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY)
  {
    return;
  }
  Limit = limit.rlim_cur;
  Process = getpid();
  struct sigaction fault
  {
  };
  fault.sa_handler = OnFault;
  fault.sa_flags = static_cast<int>(SA_RESETHAND);
  for (const int signal : { SIGSEGV, SIGBUS, SIGILL, SIGABRT })
  {
    sigaction(signal, &fault, nullptr);
  }
  TerminateBefore = std::set_terminate(OnTerminate);
}
}
