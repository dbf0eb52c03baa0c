// SPDX-License-Identifier: Apache-2.0
#include "mammoray/IO/GuardedRead.h"

#include "Private/LinuxCalls.h"
#include "Private/OwnedDescriptor.h"

// vtkSMPTools.h of VTK 9.1 is no C++20.
#include "SMP/Common/vtkSMPToolsAPI.h"

#include <poll.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstring>
#include <exception>
#include <filesystem>
#include <memory>
#include <new>
#include <optional>

namespace mammoray
{
static void Exchange(Parcel& parcel, InputNote& note)
{
  parcel(note.File, note.Text, note.Names);
}

namespace
{
/// How a reader ended, the first byte of its answer.
enum class Ending : char
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
ReadLimits Allowed;

[[noreturn]] void RefuseToAsk(const std::string& what, const char* needed)
{
  throw Error(
    what + ": expected " + needed + " for its reader, found none (" + std::strerror(errno) + ")");
}

/// Sets a soft limit, at most the hard one.
void Limit(decltype(RLIMIT_AS) resource, std::uint64_t most)
{
  rlimit limit{};
  getrlimit(resource, &limit);
  limit.rlim_cur = std::min<rlim_t>(most, limit.rlim_max);
  setrlimit(resource, &limit);
}

/// Sets the limits that are allowed.
void SetLimits()
{
  // A sanitizer reserves more addresses than any limit allows.
  if (AddressesAtStart < std::uint64_t{ 1 } << 42)
  {
    Limit(RLIMIT_AS, AddressesAtStart + Allowed.MemoryBytes);
  }
  if (std::isfinite(Allowed.Seconds))
  {
    Limit(RLIMIT_CPU, static_cast<std::uint64_t>(std::ceil(Allowed.Seconds)));
  }
}

void SetUpReader(const ReadLimits& limits)
{
  IsReader = true;
  linuxCalls::EndWithParent();
  // Handlers of the asking process would save its work.
  for (const int death : { SIGSEGV, SIGABRT, SIGFPE, SIGBUS, SIGILL, SIGTERM, SIGXCPU })
  {
    std::signal(death, SIG_DFL);
  }
  // Ctrl-C reaches all processes of a terminal; the asking one decides.
  std::signal(SIGINT, SIG_IGN);
  Limit(RLIMIT_CORE, 0);
  // The threads of VTK's pool, for which it would wait, are the asking process's alone.
  vtk::detail::smp::vtkSMPToolsAPI::GetInstance().SetBackend("Sequential");
  AddressesAtStart = linuxCalls::AddressesInUse();
  Allowed = limits;
  SetLimits();
  const int said = linuxCalls::OpenInMemory("mammoray-said");
  dup2(said, STDOUT_FILENO);
  dup2(said, STDERR_FILENO);
}

/// Throws for a file in memory that could not be written.
[[noreturn]] void RefuseToWrite()
{
  if (errno == EFBIG)
  {
    throw InputError("expected a limit of file sizes (ulimit -f) that holds what is read, in "
                     "memory, too; found a smaller one");
  }
  throw std::bad_alloc();
}

/// Writes the answer of a reader behind its ending into the file, and ends the process. What is
/// thrown here ends it, too, and its parent says so.
// NOLINTNEXTLINE(bugprone-exception-escape)
[[noreturn]] void Answer(std::FILE* file, const std::function<void(Parcel&)>& put) noexcept
{
  Parcel parcel(file, true, "");
  Ending ending = Ending::Died;
  std::string reason;
  RefusedField field;
  try
  {
    parcel(ending);
    put(parcel);
    if (std::fflush(file) != 0)
    {
      RefuseToWrite();
    }
    ending = Ending::Read;
  }
  catch (const std::bad_alloc&)
  {
    ending = Ending::OutOfMemory;
  }
  catch (const InputError& error)
  {
    ending = Ending::Refused;
    reason = error.what();
    field = error.Field();
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
  // Drops the bytes that could not be written; rewinding would write them again.
  linuxCalls::Purge(file);
  std::rewind(file);
  std::fwrite(&ending, sizeof ending, 1, file);
  if (ending == Ending::Refused)
  {
    parcel(reason, field.Name, field.Value, field.Remedies, field.All);
  }
  std::fflush(file);
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

/// Passes on each text that the reader has sent and replies to it, or passes on an empty text.
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
/// keeps none (SIGCHLD ignored), SIGXCPU if it took longer. What `heard` throws ends the reader.
int WaitFor(pid_t reader, int socket, double seconds, const TellCallback& heard)
{
  int status = 0;
  const auto hasEnded = [&](int options)
  {
    const pid_t found = waitpid(reader, &status, options);
    return found == reader || (found < 0 && errno != EINTR);
  };
  const auto killReader = [&]
  {
    kill(reader, SIGKILL);
    while (!hasEnded(0))
    {
    }
  };
  const auto start = std::chrono::steady_clock::now();
  while (!hasEnded(WNOHANG))
  {
    pollfd event{ socket, POLLIN, 0 };
    poll(&event, 1, 200);
    usleep((event.revents & POLLHUP) != 0 ? 100 : 0); // closed, but not dead yet
    try
    {
      Hear(socket, heard);
    }
    catch (...)
    {
      killReader();
      throw;
    }
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

/// Runs `put` in a fork, which writes its ending and its answer into the file; returns its status.
int RunReader(std::FILE* file, const std::string& what, const ReadLimits& limits,
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

/// Describes the file by the end of a reader that has neither read nor refused it.
std::string Finding(Ending ending, int status, const ReadLimits& limits)
{
  const int signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
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

void Parcel::Bytes(void* bytes, std::size_t count)
{
  if (this->Writes && std::fwrite(bytes, 1, count, this->File) != count)
  {
    RefuseToWrite();
  }
  if (!this->Writes && std::fread(bytes, 1, count, this->File) != count)
  {
    this->RefuseCut();
  }
}

void Parcel::RefuseCut() const
{
  throw ReaderEnded(
    this->What + ": expected a whole answer of its reader, found one that is cut short");
}

std::size_t Parcel::Count(std::size_t count, std::size_t bytes)
{
  this->Bytes(&count, sizeof count);
  if (!this->Writes)
  {
    // Before memory is taken for values that are not there.
    struct stat found = {};
    fstat(fileno(this->File), &found);
    if (count > static_cast<std::size_t>(found.st_size - std::ftell(this->File)) / bytes)
    {
      this->RefuseCut();
    }
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

bool IsReadingGuarded()
{
  return !IsReader && !IsUnguarded;
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
    Allowed.MemoryBytes = std::max(Allowed.MemoryBytes, bytes);
    Allowed.Seconds += static_cast<double>(bytes) / 20e6;
    SetLimits();
  }
}

void RunGuarded(const std::string& what, const std::string& content, const ReadLimits& limits,
  const std::function<void(Parcel&, const TellCallback& tell)>& put,
  const std::function<void(Parcel&)>& take, const TellCallback& heard)
{
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(
    fdopen(linuxCalls::OpenInMemory("mammoray-read"), "w+b"), std::fclose);
  if (!file)
  {
    RefuseToAsk(what, "a file in memory");
  }
  const auto putAll = [&put](Parcel& parcel, const TellCallback& tell)
  {
    NoteKeeper notes;
    put(parcel, tell);
    parcel(notes.Notes);
  };
  const int status = RunReader(file.get(), what, limits, putAll, heard);
  std::rewind(file.get());
  Ending ending = Ending::Died;
  if (std::fread(&ending, sizeof ending, 1, file.get()) != 1 ||
    (ending != Ending::Read && ending != Ending::Refused))
  {
    throw ReaderEnded(
      what + ": expected " + content + ", found " + Finding(ending, status, limits));
  }
  Parcel parcel(file.get(), false, what);
  if (ending == Ending::Refused)
  {
    std::string reason;
    RefusedField field;
    parcel(reason, field.Name, field.Value, field.Remedies, field.All);
    throw InputError::Restored(reason, field);
  }
  take(parcel);
  std::vector<InputNote> notes;
  parcel(notes);
  std::for_each(notes.begin(), notes.end(), Note);
}
}
