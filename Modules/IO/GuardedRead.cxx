// SPDX-License-Identifier: Apache-2.0
#include "mammoray/IO/GuardedRead.h"

#include "Private/OwnedDescriptor.h"

#include <poll.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <exception>
#include <filesystem>
#include <fstream>
#include <memory>
#include <new>

namespace mammoray
{
namespace
{
/// How a reader ended, the first bytes of its answer.
enum class Ending : std::uint64_t
{
  Died,
  Read,
  Refused,
  OutOfMemory
};

/// State of a reader's process.
bool IsReader = false;
bool IsUnguarded = false;
std::uint64_t AddressesAtStart = 0;
std::uint64_t MemoryAllowed = 0;
double SecondsAllowed = 0;

[[noreturn]] void RefuseToAsk(const std::string& what, const char* needed)
{
  throw Error(
    what + ": expected " + needed + " for its reader, found none (" + std::strerror(errno) + ")");
}

/// Sets a soft limit, at most the hard one.
void Limit(__rlimit_resource resource, std::uint64_t most)
{
  rlimit limit{};
  getrlimit(resource, &limit);
  limit.rlim_cur = std::min<rlim_t>(most, limit.rlim_max);
  setrlimit(resource, &limit);
}

/// Sets the limits that have been allowed.
void SetLimits()
{
  // A sanitizer reserves more addresses than any limit allows.
  if (AddressesAtStart < std::uint64_t{ 1 } << 42)
  {
    Limit(RLIMIT_AS, AddressesAtStart + MemoryAllowed);
  }
  if (std::isfinite(SecondsAllowed))
  {
    Limit(RLIMIT_CPU, static_cast<std::uint64_t>(std::ceil(SecondsAllowed)));
  }
}

void SetUpReader(const ReadLimits& limits)
{
  IsReader = true;
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  // Handlers of the asking process would save its work.
  for (const int death : { SIGSEGV, SIGABRT, SIGFPE, SIGBUS, SIGILL, SIGTERM, SIGXCPU })
  {
    std::signal(death, SIG_DFL);
  }
  // Ctrl-C reaches all processes of a terminal; the asking one decides.
  std::signal(SIGINT, SIG_IGN);
  Limit(RLIMIT_CORE, 0);
  std::ifstream("/proc/self/statm") >> AddressesAtStart;
  AddressesAtStart *= static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
  MemoryAllowed = limits.MemoryBytes;
  SecondsAllowed = limits.Seconds;
  SetLimits();
  const int said = memfd_create("mammoray-said", MFD_CLOEXEC);
  dup2(said, STDOUT_FILENO);
  dup2(said, STDERR_FILENO);
}

/// Writes the answer of a reader and its ending into the file, and ends the process.
[[noreturn]] void Answer(int file, const std::function<void(Parcel&)>& put) noexcept
{
  Ending ending = Ending::Read;
  std::string reason;
  try
  {
    Parcel parcel(file);
    put(parcel);
    parcel.Flush();
  }
  catch (const std::bad_alloc&)
  {
    ending = Ending::OutOfMemory;
  }
  catch (const std::exception& error)
  {
    ending = Ending::Refused;
    reason = error.what();
  }
  catch (...)
  {
    ending = Ending::Died;
  }
  if (ending == Ending::Refused && ftruncate(file, sizeof ending) == 0 &&
    lseek(file, sizeof ending, SEEK_SET) >= 0)
  {
    try
    {
      Parcel message(file);
      message(reason);
      message.Flush();
    }
    catch (...)
    {
      ending = Ending::Died;
    }
  }
  pwrite(file, &ending, sizeof ending, 0);
  _exit(0);
}

/// Sends a text to the asking process and waits for its reply.
void Tell(int socket, const std::string& text)
{
  const std::string message = '>' + text; // a message of no bytes would be the end
  if (send(socket, message.data(), message.size(), MSG_NOSIGNAL) < 0)
  {
    throw Error(std::string("a message cannot be sent (") + std::strerror(errno) + ")");
  }
  char reply = 0;
  while (recv(socket, &reply, 1, 0) < 0 && errno == EINTR)
  {
  }
}

/// Passes on and replies to what has been told, or passes on an empty text.
void Hear(int socket, const TellCallback& heard)
{
  if (!heard)
  {
    return;
  }
  std::string text(100'001, '\0');
  ssize_t count = recv(socket, text.data(), text.size(), MSG_DONTWAIT);
  if (count <= 0)
  {
    heard("");
  }
  for (; count > 0; count = recv(socket, text.data(), text.size(), MSG_DONTWAIT))
  {
    heard(text.substr(1, static_cast<std::size_t>(count) - 1));
    send(socket, "<", 1, MSG_NOSIGNAL);
  }
}

/// Waits for the reader's end, at most `seconds`, and returns its status (waitpid); 0 if the system
/// keeps none (SIGCHLD ignored), and that of a kill if it took longer or `heard` has thrown.
int WaitFor(pid_t reader, int socket, double seconds, const TellCallback& heard)
{
  int status = 0;
  bool hasEnded = false;
  const auto look = [&](int options)
  {
    const pid_t found = waitpid(reader, &status, options);
    hasEnded = found == reader || (found < 0 && errno != EINTR);
    return hasEnded;
  };
  const auto killReader = [&]
  {
    while (!hasEnded)
    {
      kill(reader, SIGKILL);
      look(0);
    }
  };
  try
  {
    const auto start = std::chrono::steady_clock::now();
    while (!look(WNOHANG))
    {
      pollfd event{ socket, POLLIN, 0 };
      poll(&event, 1, 200);
      usleep((event.revents & POLLHUP) != 0 ? 100 : 0); // closed, but not dead yet
      Hear(socket, heard);
      const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - start;
      if (passed.count() > seconds)
      {
        killReader();
        return SIGXCPU;
      }
    }
    Hear(socket, heard);
    return status;
  }
  catch (...)
  {
    killReader();
    throw;
  }
}

/// Runs `put` in a fork, which writes its ending and its answer into the file; returns its status.
int RunReader(int file, const std::string& what, const ReadLimits& limits,
  const std::function<void(Parcel&, const TellCallback& tell)>& put, const TellCallback& heard)
{
  int ends[2];
  if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends) != 0)
  {
    RefuseToAsk(what, "a pair of sockets");
  }
  const OwnedDescriptor ours(ends[0]);
  std::optional<OwnedDescriptor> theirs(ends[1]);
  const pid_t reader = fork();
  if (reader < 0)
  {
    RefuseToAsk(what, "a process of its own");
  }
  if (reader == 0)
  {
    SetUpReader(limits);
    const TellCallback tell = [&](const std::string& text) { Tell(theirs->Get(), text); };
    Answer(file, [&](Parcel& parcel) { put(parcel, tell); });
  }
  theirs.reset(); // now the sockets are closed when the reader ends
  return WaitFor(reader, ours.Get(), 10 * limits.Seconds + 60, heard);
}

/// Returns what a reader's end says of its file; empty if it has read or refused it.
std::string Finding(Ending ending, int status, const ReadLimits& limits)
{
  const int signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
  if (ending == Ending::Read || ending == Ending::Refused)
  {
    return "";
  }
  if (signal == SIGXCPU)
  {
    return "data that takes longer to read than a file of this size may (" +
      std::to_string(static_cast<long>(limits.Seconds)) + " s)";
  }
  if (ending == Ending::OutOfMemory)
  {
    return std::string("data that asks for more memory than ") +
      (std::isfinite(limits.Seconds) ? "a file of this size" : "it") + " may (" +
      std::to_string(limits.MemoryBytes >> 20) + " MiB)";
  }
  return "damaged data, at which its reader ended" +
    (signal != 0 ? std::string(" with '") + strsignal(signal) + "'" : "");
}
}

void Parcel::Flush()
{
  this->Write(this->Kept.data(), this->Kept.size());
  this->Kept.clear();
}

void Parcel::Write(const char* bytes, std::uint64_t count) const
{
  while (count > 0)
  {
    const ssize_t written = write(this->File, bytes, count);
    if (written < 0 && errno == EFBIG)
    {
      throw InputError("expected a limit of file sizes (ulimit -f) that holds what is read, in "
                       "memory, too; found a smaller one");
    }
    if (written == 0 || (written < 0 && errno != EINTR))
    {
      throw std::bad_alloc();
    }
    bytes += std::max<ssize_t>(written, 0);
    count -= static_cast<std::uint64_t>(std::max<ssize_t>(written, 0));
  }
}

void Parcel::Bytes(void* bytes, std::uint64_t count)
{
  constexpr std::uint64_t Small = 1 << 12;
  auto* const first = static_cast<char*>(bytes);
  if (this->Takes())
  {
    if (count > this->Left)
    {
      throw InputError(
        this->What + ": expected a whole answer of its reader, found one that is cut short");
    }
    std::copy_n(this->Next, count, first);
    this->Next += count;
    this->Left -= count;
    return;
  }
  if (count > Small || this->Kept.size() > 16 * Small)
  {
    this->Flush();
  }
  if (count > Small)
  {
    this->Write(first, count);
    return;
  }
  this->Kept.insert(this->Kept.end(), first, first + count);
}

std::uint64_t Parcel::Count(std::uint64_t count, std::uint64_t bytes)
{
  this->Bytes(&count, sizeof count);
  if (this->Takes() && count > this->Left / bytes)
  {
    this->Left = 0; // before memory is taken for values that are not there
    this->Bytes(&count, 1);
  }
  return count;
}

ReadLimits ReadLimits::Of(const std::vector<std::string>& files)
{
  std::uint64_t bytes = 0;
  for (const std::string& file : files)
  {
    std::error_code problem;
    const std::uint64_t size = std::filesystem::file_size(file, problem);
    bytes += problem ? 0 : size;
  }
  return { (std::uint64_t{ 512 } << 20) + 64 * bytes, 10 + 1e-6 * static_cast<double>(bytes) };
}

void ReadWithoutGuard()
{
  IsUnguarded = true;
}

std::string SaidByLibraries()
{
  if (!IsReader)
  {
    return {};
  }
  std::fflush(stdout);
  char text[200];
  const ssize_t count = pread(STDERR_FILENO, text, sizeof text, 0);
  const std::string said(text, static_cast<std::size_t>(std::max<ssize_t>(count, 0)));
  return said.substr(0, said.find('\n'));
}

void AllowMemory(std::uint64_t bytes)
{
  if (IsReader)
  {
    MemoryAllowed = std::max(MemoryAllowed, bytes);
    SecondsAllowed += static_cast<double>(bytes) / 20e6;
    SetLimits();
  }
}

void RunGuarded(const std::string& what, const std::string& content, const ReadLimits& limits,
  const std::function<void(Parcel&, const TellCallback& tell)>& put,
  const std::function<void(Parcel&)>& take, const TellCallback& heard)
{
  const OwnedDescriptor file(memfd_create("mammoray-read", MFD_CLOEXEC));
  Ending ending = Ending::Died;
  if (write(file.Get(), &ending, sizeof ending) != sizeof ending)
  {
    RefuseToAsk(what, "a file in memory");
  }
  if (IsReader || IsUnguarded)
  {
    Parcel parcel(file.Get());
    put(parcel, heard);
    parcel.Flush();
  }
  else
  {
    const int status = RunReader(file.Get(), what, limits, put, heard);
    pread(file.Get(), &ending, sizeof ending, 0);
    if (const std::string finding = Finding(ending, status, limits); !finding.empty())
    {
      throw InputError(what + ": expected " + content + ", found " + finding);
    }
  }
  const auto size = static_cast<std::uint64_t>(lseek(file.Get(), 0, SEEK_END));
  void* const start = mmap(nullptr, size, PROT_READ, MAP_PRIVATE, file.Get(), 0);
  if (start == MAP_FAILED)
  {
    throw std::bad_alloc();
  }
  const std::unique_ptr<void, std::function<void(void*)>> mapping(start,
    [size](void* bytes) { munmap(bytes, size); });
  Parcel parcel(static_cast<const unsigned char*>(start) + sizeof ending, size - sizeof ending,
    what);
  if (ending == Ending::Refused)
  {
    std::string reason;
    parcel(reason);
    throw InputError(reason);
  }
  take(parcel);
}
}
