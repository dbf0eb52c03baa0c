// SPDX-License-Identifier: Apache-2.0
#include "mammoray/IO/GuardedRead.h"

#include "Private/OwnedDescriptor.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
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
#include <limits>
#include <memory>
#include <new>
#include <optional>
#include <utility>

namespace mammoray
{
namespace
{
/// A sanitizer reserves more addresses than any limit allows.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool LimitsAddresses = false;
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
constexpr bool LimitsAddresses = false;
#else
constexpr bool LimitsAddresses = true;
#endif
#else
constexpr bool LimitsAddresses = true;
#endif

/// How the reader's process ends on its own; not as one that a library ends by exit().
enum Ending : int
{
  Unknown = 1,
  Done = 70,
  Refused = 71,
  OutOfMemory = 72
};

/// True in a reader's process, and where guarded reads are to read where they are.
bool IsReader = false;
bool IsUnguarded = false;
/// Addresses that the reader had when it began, and could have had without limits of ours, bytes.
std::uint64_t AddressesAtStart = 0;
rlim_t MostAddresses = RLIM_INFINITY;
double SecondsAllowed = 0;

/// A file's bytes in memory.
class Mapping
{
public:
  Mapping(int file, std::uint64_t bytes)
    : Bytes(bytes)
    , Start(bytes > 0 ? mmap(nullptr, bytes, PROT_READ, MAP_PRIVATE, file, 0) : nullptr)
  {
    if (this->Start == MAP_FAILED)
    {
      throw std::bad_alloc();
    }
  }
  ~Mapping()
  {
    if (this->Start)
    {
      munmap(this->Start, this->Bytes);
    }
  }
  Mapping(const Mapping&) = delete;
  Mapping& operator=(const Mapping&) = delete;
  ParcelReader Reader(const std::string& what) const
  {
    return { static_cast<const unsigned char*>(this->Start), this->Bytes, what };
  }

private:
  const std::uint64_t Bytes;
  void* const Start;
};

std::uint64_t AddressesInUse()
{
  std::uint64_t pages = 0;
  std::ifstream("/proc/self/statm") >> pages;
  return pages * static_cast<std::uint64_t>(sysconf(_SC_PAGESIZE));
}

/// Limits what this process may take, of which the hard limit stays as it is.
void Limit(__rlimit_resource resource, std::uint64_t most)
{
  rlimit limit{};
  if (getrlimit(resource, &limit) == 0)
  {
    limit.rlim_cur = std::min<rlim_t>(most, limit.rlim_max);
    setrlimit(resource, &limit);
  }
}

std::uint64_t AddressesAllowed()
{
  rlimit limit{};
  return getrlimit(RLIMIT_AS, &limit) == 0 ? limit.rlim_cur : RLIM_INFINITY;
}

/// How a reader's process ended on its own, in memory that it shares with the one that asks: where
/// that one ignores SIGCHLD, as `trap '' CHLD` in a shell has all its programs do, no status is
/// kept.
class ToldEnding
{
public:
  ToldEnding()
    : Place(
        mmap(nullptr, sizeof(Ending), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0))
  {
    if (this->Place == MAP_FAILED)
    {
      throw std::bad_alloc();
    }
    this->Tell(Ending::Unknown);
  }
  ~ToldEnding() { munmap(this->Place, sizeof(Ending)); }
  ToldEnding(const ToldEnding&) = delete;
  ToldEnding& operator=(const ToldEnding&) = delete;
  void Tell(Ending ending) const { *static_cast<Ending*>(this->Place) = ending; }
  Ending Get() const { return *static_cast<const Ending*>(this->Place); }

private:
  void* const Place;
};

/// The rest of a reader's process.
[[noreturn]] void RunReader(int result, const ToldEnding& told, const ReadLimits& limits,
  const std::function<void(ParcelWriter&)>& read)
{
  IsReader = true;
  // Whoever asked may be killed.
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  // Handlers of the asking process would save its work here.
  for (const int death : { SIGSEGV, SIGABRT, SIGFPE, SIGBUS, SIGILL, SIGTERM, SIGXCPU })
  {
    std::signal(death, SIG_DFL);
  }
  // Ctrl-C reaches all of a terminal's processes; the asking one decides.
  std::signal(SIGINT, SIG_IGN);
  Limit(RLIMIT_CORE, 0);
  AddressesAtStart = AddressesInUse();
  MostAddresses = AddressesAllowed();
  if (LimitsAddresses)
  {
    Limit(RLIMIT_AS, std::min<rlim_t>(AddressesAtStart + limits.MemoryBytes, MostAddresses));
  }
  if (std::isfinite(limits.Seconds))
  {
    SecondsAllowed = std::ceil(limits.Seconds);
    Limit(RLIMIT_CPU, static_cast<std::uint64_t>(SecondsAllowed));
  }
  if (const int said = memfd_create("mammoray-said", MFD_CLOEXEC); said >= 0)
  {
    dup2(said, STDOUT_FILENO);
    dup2(said, STDERR_FILENO);
  }
  ParcelWriter parcel(result);
  Ending ending = Ending::Done;
  std::string why;
  try
  {
    read(parcel);
    parcel.Flush();
  }
  catch (const std::bad_alloc&)
  {
    ending = Ending::OutOfMemory;
  }
  catch (const std::exception& error)
  {
    ending = Ending::Refused;
    why = error.what();
  }
  if (ending == Ending::Refused)
  {
    // In place of what was written before.
    if (ftruncate(result, 0) == 0 && lseek(result, 0, SEEK_SET) == 0)
    {
      ParcelWriter message(result);
      message(why);
      message.Flush();
    }
  }
  told.Tell(ending);
  _exit(ending);
}

/// A reader's process, which does not outlive this.
class ReaderProcess
{
public:
  explicit ReaderProcess(pid_t number)
    : Number(number)
    , Ended(static_cast<int>(syscall(SYS_pidfd_open, number, 0)))
  {
  }
  ~ReaderProcess() { this->Kill(); }
  ReaderProcess(const ReaderProcess&) = delete;
  ReaderProcess& operator=(const ReaderProcess&) = delete;

  /// Waits for its end, and calls `heard` at each message at `messages` (if any) and five times a
  /// second; false where it took longer than `seconds` and was killed.
  bool WaitFor(double seconds, int messages, const std::function<void()>& heard)
  {
    using Clock = std::chrono::steady_clock;
    const Clock::time_point start = Clock::now();
    bool inTime = true;
    while (inTime && this->Number > 0)
    {
      const double left = seconds - std::chrono::duration<double>(Clock::now() - start).count();
      pollfd events[] = { { this->Ended.Get(), POLLIN, 0 }, { messages, POLLIN, 0 } };
      // Without the descriptor (Linux before 5.3) the end is asked for every 5 ms; poll passes over
      // descriptors below 0.
      const double most = this->Ended.Get() < 0 ? 5 : heard ? 200 : 1000;
      poll(events, 2, static_cast<int>(std::clamp(1e3 * left, 0.0, most)));
      this->Wait(WNOHANG);
      if (heard)
      {
        heard(); // also what was told just before the end
      }
      inTime = left > 0 || this->Number == 0;
    }
    this->Kill();
    return inTime;
  }
  /// After its end, as waitpid gives it; nothing where the system has thrown it away.
  std::optional<int> Status() const { return this->StatusAtEnd; }

private:
  /// Sees whether it has ended.
  void Wait(int options)
  {
    int status = 0;
    const pid_t found = waitpid(this->Number, &status, options);
    if (found == this->Number)
    {
      this->StatusAtEnd = status;
    }
    if (found == this->Number || (found < 0 && errno != EINTR))
    {
      this->Number = 0;
    }
  }
  void Kill()
  {
    if (this->Number > 0)
    {
      kill(this->Number, SIGKILL);
    }
    while (this->Number > 0)
    {
      this->Wait(0);
    }
  }

  /// 0 after its end.
  pid_t Number;
  const OwnedDescriptor Ended;
  std::optional<int> StatusAtEnd;
};

/// What the reader's end says of the file; nothing where it has read it.
std::string Finding(int status, bool inTime, const ReadLimits& limits)
{
  const std::string taken = " (" + std::to_string(limits.MemoryBytes >> 20) + " MiB)";
  // Long work has a limit of its own.
  const char* const limited = std::isfinite(limits.Seconds) ? "a file of this size" : "it";
  if (!inTime || (WIFSIGNALED(status) && WTERMSIG(status) == SIGXCPU))
  {
    return "data that takes longer to read than a file of this size may (" +
      std::to_string(static_cast<long>(limits.Seconds)) + " s)";
  }
  if (WIFSIGNALED(status))
  {
    return std::string("damaged data, at which its reader ended with '") +
      strsignal(WTERMSIG(status)) + "'";
  }
  if (WEXITSTATUS(status) == Ending::OutOfMemory)
  {
    return std::string("data that asks for more memory than ") + limited + " may" + taken;
  }
  return WEXITSTATUS(status) == Ending::Done ? "" : "damaged data, at which its reader ended";
}
}

void ParcelWriter::Block(const void* bytes, std::uint64_t count)
{
  constexpr std::uint64_t Small = 1 << 12;
  if (count > Small)
  {
    this->Flush();
    this->WriteAll(bytes, count);
    return;
  }
  const auto* const first = static_cast<const char*>(bytes);
  this->Kept.insert(this->Kept.end(), first, first + count);
  if (this->Kept.size() > 16 * Small)
  {
    this->Flush();
  }
}

void ParcelWriter::Flush()
{
  this->WriteAll(this->Kept.data(), this->Kept.size());
  this->Kept.clear();
}

void ParcelWriter::WriteAll(const void* bytes, std::uint64_t count) const
{
  const char* next = static_cast<const char*>(bytes);
  while (count > 0)
  {
    const ssize_t written = write(this->File, next, count);
    if (written < 0 && errno == EINTR)
    {
      continue;
    }
    if (written < 0 && errno == EFBIG)
    {
      throw InputError("expected a limit of file sizes (ulimit -f) that holds what is read, in "
                       "memory, too; found a smaller one");
    }
    if (written <= 0)
    {
      throw std::bad_alloc();
    }
    next += written;
    count -= static_cast<std::uint64_t>(written);
  }
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
  if (!IsReader)
  {
    return;
  }
  Limit(RLIMIT_CPU,
    static_cast<std::uint64_t>(SecondsAllowed + std::ceil(static_cast<double>(bytes) / 20e6)));
  const rlim_t most = std::min<rlim_t>(AddressesAtStart + bytes, MostAddresses);
  if (LimitsAddresses && AddressesAllowed() < most)
  {
    Limit(RLIMIT_AS, most);
  }
}

namespace
{
/// ReadGuarded; `heard` at each message at `messages`.
void ReadElsewhere(const std::string& what, const std::string& content, const ReadLimits& limits,
  const std::function<void(ParcelWriter&)>& read, const std::function<void(ParcelReader&)>& unpack,
  int messages, const std::function<void()>& heard)
{
  const OwnedDescriptor result(memfd_create("mammoray-read", MFD_CLOEXEC));
  if (result.Get() < 0)
  {
    throw Error(what + ": expected a file in memory, found none (" + std::strerror(errno) + ")");
  }
  // Where this is a reader's process already, the one that asks is guarded.
  int status = Ending::Done << 8;
  bool inTime = true;
  if (IsReader || IsUnguarded)
  {
    ParcelWriter parcel(result.Get());
    read(parcel);
    parcel.Flush();
  }
  else
  {
    const ToldEnding told;
    const pid_t number = fork();
    if (number < 0)
    {
      throw Error(what + ": expected a process of its own for its reader, found none (" +
        std::strerror(errno) + ")");
    }
    if (number == 0)
    {
      RunReader(result.Get(), told, limits, read);
    }
    ReaderProcess reader(number);
    inTime = reader.WaitFor(10 * limits.Seconds + 60, messages, heard);
    status = reader.Status().value_or(told.Get() << 8);
  }
  struct stat found
  {
  };
  fstat(result.Get(), &found);
  const bool refused = inTime && WIFEXITED(status) && WEXITSTATUS(status) == Ending::Refused;
  const std::string finding = refused ? "" : Finding(status, inTime, limits);
  if (!finding.empty())
  {
    throw InputError(what + ": expected " + content + ", found " + finding);
  }
  const Mapping bytes(result.Get(), static_cast<std::uint64_t>(found.st_size));
  ParcelReader parcel = bytes.Reader(what);
  if (refused)
  {
    std::string why;
    parcel(why);
    throw InputError(why);
  }
  unpack(parcel);
}

/// A way for texts from a reader's process and for the word that each has been heard.
class Messages
{
public:
  explicit Messages(const std::string& what)
  {
    int ends[2];
    if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends) != 0)
    {
      throw Error(what + ": expected a pair of sockets, found none (" + std::strerror(errno) + ")");
    }
    this->Ours = std::make_unique<OwnedDescriptor>(ends[0]);
    this->Theirs = std::make_unique<OwnedDescriptor>(ends[1]);
  }
  int AskersEnd() const { return this->Ours->Get(); }

  /// In the reader's process; waits until it has been heard.
  void Tell(const std::string& text) const
  {
    // A message of no bytes could not be told from the end.
    const std::string message = '>' + text;
    char answer = 0;
    if (send(this->Theirs->Get(), message.data(), message.size(), MSG_NOSIGNAL) < 0)
    {
      throw Error(std::string("a message cannot be sent (") + std::strerror(errno) + ")");
    }
    while (recv(this->Theirs->Get(), &answer, 1, 0) < 0 && errno == EINTR)
    {
    }
  }
  /// In the asking process: what has been told, or an empty text.
  void Hear(const TellCallback& heard)
  {
    bool any = false;
    for (ssize_t count = 0;
         (count = recv(this->Ours->Get(), this->Text.data(), this->Text.size(), MSG_DONTWAIT)) > 0;
         any = true)
    {
      heard(this->Text.substr(1, static_cast<std::size_t>(count) - 1));
      send(this->Ours->Get(), "<", 1, MSG_NOSIGNAL);
    }
    if (!any)
    {
      heard("");
    }
  }

private:
  std::unique_ptr<OwnedDescriptor> Ours;
  std::unique_ptr<OwnedDescriptor> Theirs;
  std::string Text = std::string(100'001, '\0');
};
}

void ReadGuarded(const std::string& what, const std::string& content, const ReadLimits& limits,
  const std::function<void(ParcelWriter&)>& read, const std::function<void(ParcelReader&)>& unpack)
{
  ReadElsewhere(what, content, limits, read, unpack, -1, {});
}

std::vector<std::string> WorkGuarded(const std::string& what, const std::string& content,
  std::uint64_t memoryBytes,
  const std::function<std::vector<std::string>(const TellCallback& tell)>& work,
  const TellCallback& heard)
{
  Messages messages(what);
  TellCallback tell = heard;
  if (!IsReader && !IsUnguarded)
  {
    tell = [&messages](const std::string& text) { messages.Tell(text); };
  }
  std::vector<std::string> answer;
  ReadElsewhere(
    what, content, { memoryBytes, std::numeric_limits<double>::infinity() },
    [&](ParcelWriter& parcel) { parcel(work(tell)); },
    [&](ParcelReader& parcel) { parcel(answer); }, messages.AskersEnd(),
    [&] { messages.Hear(heard); });
  return answer;
}
}
