// SPDX-License-Identifier: Apache-2.0
#include "mammoray/IO/AtomicFile.h"

#include "Private/LinuxCalls.h"
#include "Private/OwnedDescriptor.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/ScratchFolder.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <map>
#include <memory>
#include <mutex>
#include <system_error>

namespace mammoray
{
namespace
{
namespace fs = std::filesystem;

/// The end of a partial file's name, and the name of a partial folder in a place that is fixed.
constexpr const char* PartialName = ".partial";

/// Throws std::system_error with the reason in errno unless a system call succeeded.
void Require(bool succeeded)
{
  if (!succeeded)
  {
    throw std::system_error(errno, std::generic_category());
  }
}

/// Calls `action` and turns errors of the system into an InputError that names the path.
template <typename Action>
auto Checked(const std::string& path, const Action& action)
{
  try
  {
    return action();
  }
  catch (const std::system_error& error)
  {
    throw InputError(path + ": cannot be written (" + error.code().message() + ")");
  }
}

/// Makes the names in a folder durable. Some file systems cannot, which is no error.
void Synchronise(const fs::path& folder)
{
  fsync(OwnedDescriptor(open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)).Get());
}

/// The absolute path, without a trailing slash, that symbolic links lead to.
fs::path ResolvedPlace(const std::string& path)
{
  fs::path place = fs::absolute(path);
  // weakly_canonical does not follow a link to a file that is still to be written.
  for (int links = 0; fs::is_symlink(place) && links < 40; ++links)
  {
    place = place.parent_path() / fs::read_symlink(place);
  }
  return (fs::weakly_canonical(place) / "").parent_path();
}

/// True if the folder cannot be replaced by a rename but can be filled, as a mount point.
bool IsFixed(const fs::path& folder)
{
  return fs::is_directory(folder) &&
    (access(folder.parent_path().c_str(), W_OK | X_OK) != 0 || linuxCalls::IsMountPoint(folder));
}

/// The locked partial file or folder of an output; removed unless it is renamed into its place.
class Reservation
{
public:
  Reservation(const std::string& path, bool isFolder)
    : Place(ResolvedPlace(path))
    , IsWithin(isFolder && IsFixed(this->Place))
    , Partial(this->Place.string() + (this->IsWithin ? "/" : "") + PartialName)
    , Locked(this->Open(path, isFolder))
  {
    // File systems without locks report other errors. Who held the lock may have renamed the file.
    const bool isTaken = flock(this->Locked.Get(), LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK;
    const fs::path opened = linuxCalls::PathOf(this->Locked.Get());
    if (isTaken || !fs::equivalent(opened, this->Partial))
    {
      throw InputError(
        "output " + path + ": " + this->Partial.string() + ": another run is writing it");
    }
    // A killed process may have left something.
    if (!isFolder)
    {
      Require(ftruncate(this->Locked.Get(), 0) == 0);
      return;
    }
    for (const fs::directory_entry& entry : fs::directory_iterator(this->Partial))
    {
      fs::remove_all(entry.path());
    }
  }
  Reservation(const Reservation&) = delete;
  Reservation& operator=(const Reservation&) = delete;
  ~Reservation()
  {
    std::error_code ignored;
    if (!this->IsRenamed)
    {
      fs::remove_all(this->Partial, ignored);
    }
  }

  std::string PartialPath() const { return this->Partial.string(); }

  void WriteFile(std::string_view bytes)
  {
    while (!bytes.empty())
    {
      const ssize_t count = write(this->Locked.Get(), bytes.data(), bytes.size());
      Require(count >= 0);
      bytes.remove_prefix(static_cast<std::size_t>(count));
    }
    Require(fsync(this->Locked.Get()) == 0);
    this->Rename();
  }

  /// Puts the folder, whose files are durable, into its place.
  void CommitFolder()
  {
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(this->Partial))
    {
      if (entry.is_directory())
      {
        Synchronise(entry.path());
      }
    }
    Synchronise(this->Partial);
    if (this->IsWithin)
    {
      for (const fs::directory_entry& entry : fs::directory_iterator(this->Partial))
      {
        fs::rename(entry.path(), this->Place / entry.path().filename());
      }
      Synchronise(this->Place);
    }
    else if (!fs::exists(this->Place))
    {
      this->Rename();
    }
    else
    {
      this->Exchange();
    }
  }

private:
  /// Opens the partial file or folder, which it makes if there is none.
  int Open(const std::string& path, bool isFolder) const
  {
    const auto require = [&](bool condition, const std::string& otherwise)
    {
      if (!condition)
      {
        throw InputError("output " + path + ": " + otherwise);
      }
    };
    require(!fs::exists(this->Place) ||
        (isFolder ? fs::is_directory(this->Place) : fs::is_regular_file(this->Place)),
      std::string("expected a ") + (isFolder ? "folder" : "file") +
        " to replace, found something else");
    require(!this->IsWithin || IsEmptyFolder(this->Place.string()),
      "is a mount point or in a folder that is not writable: expected it to be empty");
    Require(!isFolder || mkdir(this->Partial.c_str(), 0777) == 0 || errno == EEXIST);
    const int flags = isFolder ? O_RDONLY | O_DIRECTORY : O_WRONLY | O_CREAT;
    const int opened = open(this->Partial.c_str(), flags | O_NOFOLLOW | O_CLOEXEC, 0666);
    Require(opened >= 0);
    return opened;
  }

  void Rename()
  {
    fs::rename(this->Partial, this->Place);
    this->IsRenamed = true;
    Synchronise(this->Place.parent_path());
  }

  /// Exchanges the new folder for the old one, in one step if the file system can. The old one is
  /// then the partial folder, which is removed.
  void Exchange() const
  {
    if (!linuxCalls::Exchange(this->Partial, this->Place))
    {
      Require(errno == EINVAL || errno == ENOSYS);
      const fs::path replaced = this->Place.string() + ".replaced";
      fs::remove_all(replaced);
      fs::rename(this->Place, replaced);
      fs::rename(this->Partial, this->Place);
      fs::rename(replaced, this->Partial);
    }
    Synchronise(this->Place.parent_path());
  }

  const fs::path Place;
  const bool IsWithin; ///< The new contents are moved into the place.
  const fs::path Partial;
  const OwnedDescriptor Locked;
  bool IsRenamed = false;
};

/// All reservations of this process, by their places.
struct HeldReservations
{
  std::mutex Mutex;
  std::map<fs::path, std::unique_ptr<Reservation>> ByPlace;

  static HeldReservations& Instance()
  {
    static HeldReservations held;
    return held;
  }
};

/// Returns the reservation of the path, empty if this process has none.
std::unique_ptr<Reservation>& HeldReservation(const std::string& path)
{
  HeldReservations& held = HeldReservations::Instance();
  const std::lock_guard<std::mutex> guard(held.Mutex);
  return held.ByPlace[ResolvedPlace(path)];
}

bool Reserve(const std::string& path, bool isFolder)
{
  return Checked(path,
    [&]
    {
      std::unique_ptr<Reservation>& held = HeldReservation(path);
      const bool isNew = !held;
      held = isNew ? std::make_unique<Reservation>(path, isFolder) : std::move(held);
      return isNew;
    });
}

/// Calls `write` with the reservation of the path, made now if there is none, which then ends.
void UseReservation(const std::string& path, bool isFolder,
  const std::function<void(Reservation&)>& write)
{
  Reserve(path, isFolder);
  const std::unique_ptr<Reservation> reservation = std::move(HeldReservation(path));
  Checked(path, [&] { write(*reservation); });
}
}

bool ReserveFile(const std::string& path)
{
  return Reserve(path, false);
}

void GiveUpReservations()
{
  HeldReservations& held = HeldReservations::Instance();
  const std::lock_guard<std::mutex> guard(held.Mutex);
  held.ByPlace.clear();
}

bool ReserveFolder(const std::string& path)
{
  return Reserve(path, true);
}

bool IsEmptyFolder(const std::string& path)
{
  std::error_code problem; // as of a folder that cannot be read, whose files are unknown
  const fs::directory_iterator entries(path, problem);
  return !problem &&
    std::all_of(entries, fs::directory_iterator(),
      [](const fs::path& entry) { return entry.filename() == PartialName; });
}

void ReserveEmptyFolder(const std::string& path)
{
  std::error_code ignored;
  if (fs::exists(path, ignored) && !IsEmptyFolder(path))
  {
    throw InputError("output " + path +
      ": expected a new or an empty folder, found one with files, which is never replaced; remove "
      "it, or name another one");
  }
  ReserveFolder(path);
}

void WriteAtomicFile(const std::string& path, std::string_view bytes)
{
  UseReservation(path, false, [&](Reservation& reservation) { reservation.WriteFile(bytes); });
}

void WriteAtomicFile(const std::string& path,
  const std::function<void(const std::string& staged)>& write)
{
  const OwnedDescriptor memory(linuxCalls::OpenInMemory("mammoray"));
  const ScratchFolder scratch;
  const std::string staged = scratch.File(fs::path(path).filename().string());
  UseReservation(path, false,
    [&](Reservation& reservation)
    {
      fs::create_symlink(linuxCalls::PathOf(memory.Get()), staged);
      write(staged);
      const auto size = static_cast<std::size_t>(lseek(memory.Get(), 0, SEEK_END));
      rlimit limit = {};
      getrlimit(RLIMIT_FSIZE, &limit);
      errno = EFBIG; // the limit has cut what the library wrote
      Require(size < limit.rlim_cur);
      void* const start = mmap(nullptr, size, PROT_READ, MAP_PRIVATE, memory.Get(), 0);
      Require(start != MAP_FAILED); // fails for an empty file, too
      const std::unique_ptr<void, std::function<void(void*)>> bytes(start,
        [size](void* mapped) { munmap(mapped, size); });
      reservation.WriteFile({ static_cast<const char*>(start), size });
    });
}

void WriteAtomicFolder(const std::string& path,
  const std::function<void(const std::string& folder)>& write)
{
  UseReservation(path, true,
    [&](Reservation& reservation)
    {
      write(reservation.PartialPath());
      reservation.CommitFolder();
    });
}
}
