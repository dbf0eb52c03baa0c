// SPDX-License-Identifier: Apache-2.0
#include "mammoray/IO/WholeOutput.h"

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
#include <utility>
#include <vector>

namespace mammoray
{
namespace
{
namespace fs = std::filesystem;

constexpr const char* PartialSuffix = ".partial";

/// "cannot be written", and why, by errno.
[[noreturn]] void RefuseToWrite(const std::string& told)
{
  throw InputError(told + ": cannot be written (" + std::generic_category().message(errno) + ")");
}

OwnedDescriptor OpenFolder(const fs::path& folder)
{
  return OwnedDescriptor(open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
}

/// So that names are on the disk, too. File systems that cannot do that with folders say so.
void Synchronise(const fs::path& folder)
{
  const OwnedDescriptor opened = OpenFolder(folder);
  if (opened.Get() >= 0)
  {
    fsync(opened.Get());
  }
}

/// Where the path leads to, with a name and a parent; links followed.
fs::path PlaceOf(const std::string& path)
{
  std::error_code none;
  fs::path place = fs::absolute(path);
  place = place.has_filename() ? place : place.parent_path();
  for (int links = 0; fs::is_symlink(place, none) && links < 40; ++links)
  {
    place = place.parent_path() / fs::read_symlink(place, none);
  }
  place = fs::weakly_canonical(place, none);
  return place.has_filename() ? place : place.parent_path();
}

bool IsMountPoint(const fs::path& place)
{
  struct statx found = {};
  return statx(AT_FDCWD, place.c_str(), 0, STATX_BASIC_STATS, &found) == 0 &&
    (found.stx_attributes & STATX_ATTR_MOUNT_ROOT) != 0;
}

/// Why what is there cannot be replaced by a rename; empty where it can, or nothing is there.
std::string WhyFixed(const fs::path& place)
{
  struct stat found = {};
  struct stat parent = {};
  if (stat(place.c_str(), &found) != 0 || stat(place.parent_path().c_str(), &parent) != 0)
  {
    return "";
  }
  if (IsMountPoint(place))
  {
    return "a mount point";
  }
  if (access(place.parent_path().c_str(), W_OK | X_OK) != 0)
  {
    return "in a folder that is not writable";
  }
  const uid_t user = geteuid();
  const bool ours = user == 0 || user == found.st_uid || user == parent.st_uid;
  return (parent.st_mode & S_ISVTX) != 0 && !ours ? "another owner's" : "";
}

/// Throws InputError unless all that is in the folder can be removed.
void CheckRemovable(const fs::path& folder, const std::string& told)
{
  std::vector<fs::path> folders{ folder };
  for (std::size_t next = 0; next < folders.size(); ++next)
  {
    const fs::path current = folders[next];
    if (access(current.c_str(), W_OK | X_OK) != 0)
    {
      throw InputError("output " + told +
        ": expected a folder whose files can be replaced, found " + current.string() +
        " not writable");
    }
    for (const fs::directory_entry& entry : fs::directory_iterator(current))
    {
      if (entry.is_directory() && !entry.is_symlink())
      {
        folders.push_back(entry.path());
      }
    }
  }
}

/// The place of an output that this process writes, and what it writes before that is put there;
/// removed again unless Put.
class Claim
{
public:
  Claim(fs::path place, std::string told, bool folder)
    : Place(std::move(place))
    , Told(std::move(told))
    , Folder(folder)
    , Partial(this->ChoosePartial())
    , Locked(this->Lock())
  {
  }
  Claim(const Claim&) = delete;
  Claim& operator=(const Claim&) = delete;
  ~Claim()
  {
    if (!this->IsPut)
    {
      std::error_code ignored;
      fs::remove_all(this->Partial, ignored);
    }
  }

  const fs::path& PartialPath() const { return this->Partial; }

  /// Without what a dead process left there.
  void Empty()
  {
    if (!this->Folder)
    {
      if (ftruncate(this->Locked.Get(), 0) != 0)
      {
        RefuseToWrite(this->Told);
      }
      return;
    }
    for (const fs::directory_entry& entry : fs::directory_iterator(this->Partial))
    {
      fs::remove_all(entry.path());
    }
  }

  /// At the end of the file.
  void Append(std::string_view bytes)
  {
    while (!bytes.empty())
    {
      const ssize_t count = write(this->Locked.Get(), bytes.data(), bytes.size());
      if (count < 0 && errno != EINTR)
      {
        RefuseToWrite(this->Told);
      }
      bytes.remove_prefix(static_cast<std::size_t>(std::max<ssize_t>(count, 0)));
    }
  }

  /// In its place, for good.
  void Put()
  {
    if (this->Folder)
    {
      this->PutFolder();
      return;
    }
    if (fsync(this->Locked.Get()) != 0 || rename(this->Partial.c_str(), this->Place.c_str()) != 0)
    {
      RefuseToWrite(this->Told);
    }
    this->IsPut = true;
    Synchronise(this->Place.parent_path());
  }

private:
  /// Where the old folder is while the new one gets its name on file systems that cannot exchange.
  fs::path Replaced() const { return this->Place.string() + PartialSuffix + "-replaced"; }

  /// Ends what a dead process began.
  void SettleExchange() const
  {
    if (!this->Folder || !fs::exists(this->Replaced()))
    {
      return;
    }
    if (fs::exists(this->Place))
    {
      fs::remove_all(this->Replaced());
    }
    else
    {
      fs::rename(this->Replaced(), this->Place);
    }
  }

  fs::path ChoosePartial() const
  {
    fs::path beside = this->Place.string() + PartialSuffix;
    this->SettleExchange();
    if (!fs::exists(this->Place))
    {
      return beside;
    }
    const std::string fixed = WhyFixed(this->Place);
    if (!this->Folder)
    {
      if (!fs::is_regular_file(this->Place))
      {
        throw InputError(this->Told + ": expected a file to replace, found something else");
      }
      if (!fixed.empty())
      {
        throw InputError(
          this->Told + ": expected a file that can be replaced, found one that is " + fixed);
      }
      return beside;
    }
    CheckRemovable(this->Place, this->Told);
    if (fixed.empty())
    {
      return beside;
    }
    fs::path within = this->Place / PartialSuffix;
    for (const fs::directory_entry& entry : fs::directory_iterator(this->Place))
    {
      if (entry.path() != within)
      {
        throw InputError("output " + this->Told + ": is " + fixed +
          ", so that it cannot be replaced as a whole: expected it to be empty, found " +
          entry.path().filename().string() + "; the name of a new folder in it is possible");
      }
    }
    return within;
  }

  OwnedDescriptor Lock() const
  {
    for (;;)
    {
      if (this->Folder && mkdir(this->Partial.c_str(), 0777) != 0 && errno != EEXIST)
      {
        RefuseToWrite(this->Told);
      }
      const int flags = this->Folder ? O_RDONLY | O_DIRECTORY : O_WRONLY | O_CREAT;
      OwnedDescriptor opened(open(this->Partial.c_str(), flags | O_NOFOLLOW | O_CLOEXEC, 0666));
      if (opened.Get() < 0 && this->Folder && errno == ENOENT)
      {
        continue; // its writer has just put it in its place
      }
      if (opened.Get() < 0)
      {
        RefuseToWrite(this->Told);
      }
      // A file system without locks has other errors.
      if (flock(opened.Get(), LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK)
      {
        throw InputError(
          "output " + this->Told + ": another run is writing it (" + this->Partial.string() + ")");
      }
      struct stat locked = {};
      struct stat named = {};
      if (fstat(opened.Get(), &locked) == 0 && stat(this->Partial.c_str(), &named) == 0 &&
        locked.st_ino == named.st_ino && locked.st_dev == named.st_dev)
      {
        return opened;
      }
    }
  }

  void PutFolder()
  {
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(this->Partial))
    {
      if (entry.is_directory())
      {
        Synchronise(entry.path());
      }
    }
    if (fsync(this->Locked.Get()) != 0 && errno != EINVAL)
    {
      RefuseToWrite(this->Told);
    }
    if (this->Partial.parent_path() == this->Place)
    {
      this->MoveOut();
      return;
    }
    if (fs::exists(this->Place))
    {
      this->Exchange();
    }
    else if (rename(this->Partial.c_str(), this->Place.c_str()) != 0)
    {
      RefuseToWrite(this->Told);
    }
    this->IsPut = true;
    Synchronise(this->Place.parent_path());
  }

  /// From within the folder that they are for.
  void MoveOut()
  {
    for (const fs::directory_entry& entry : fs::directory_iterator(this->Partial))
    {
      fs::rename(entry.path(), this->Place / entry.path().filename());
    }
    Synchronise(this->Place);
  }

  /// There is an old folder or the new one at every moment, or, where the file system cannot
  /// exchange, the old one beside its place.
  void Exchange()
  {
    // What was there becomes the partial folder, which is nobody's until it is removed.
    const OwnedDescriptor old = OpenFolder(this->Place);
    flock(old.Get(), LOCK_EX | LOCK_NB);
    fs::path aside = this->Partial;
    if (renameat2(AT_FDCWD, this->Partial.c_str(), AT_FDCWD, this->Place.c_str(),
          RENAME_EXCHANGE) != 0)
    {
      aside = this->Replaced();
      if ((errno != EINVAL && errno != ENOSYS) || rename(this->Place.c_str(), aside.c_str()) != 0)
      {
        RefuseToWrite(this->Told);
      }
      if (rename(this->Partial.c_str(), this->Place.c_str()) != 0)
      {
        const int why = errno;
        rename(aside.c_str(), this->Place.c_str());
        errno = why;
        RefuseToWrite(this->Told);
      }
    }
    this->IsPut = true;
    Synchronise(this->Place.parent_path());
    std::error_code left; // is swept by the next run
    fs::remove_all(aside, left);
  }

  fs::path Place;
  /// As the user called it.
  std::string Told;
  bool Folder;
  fs::path Partial;
  OwnedDescriptor Locked;
  bool IsPut = false;
};

/// What this process has claimed and not written yet.
class Claims
{
public:
  static Claims& All()
  {
    static Claims all;
    return all;
  }

  bool Add(const std::string& path, bool folder)
  {
    const std::lock_guard<std::mutex> guard(this->Mutex);
    std::unique_ptr<Claim>& held = this->Held[PlaceOf(path)];
    if (held)
    {
      return false;
    }
    held = Make(path, folder);
    return true;
  }

  /// The one that was added, or a new one.
  std::unique_ptr<Claim> Take(const std::string& path, bool folder)
  {
    const std::lock_guard<std::mutex> guard(this->Mutex);
    std::unique_ptr<Claim> held = std::move(this->Held[PlaceOf(path)]);
    return held ? std::move(held) : Make(path, folder);
  }

private:
  static std::unique_ptr<Claim> Make(const std::string& path, bool folder)
  {
    try
    {
      return std::make_unique<Claim>(PlaceOf(path), path, folder);
    }
    catch (const fs::filesystem_error& error)
    {
      throw InputError(path + ": cannot be written (" + error.code().message() + ")");
    }
  }

  std::mutex Mutex;
  std::map<fs::path, std::unique_ptr<Claim>> Held;
};

/// A file in memory under a name with an extension, which libraries go by.
class StagedFile
{
public:
  explicit StagedFile(const std::string& path)
    : Told(path)
    , Memory(memfd_create("mammoray", MFD_CLOEXEC))
  {
    const std::string memory = "/proc/self/fd/" + std::to_string(this->Memory.Get());
    if (this->Memory.Get() < 0 || symlink(memory.c_str(), this->Name().c_str()) != 0)
    {
      RefuseToWrite(path);
    }
  }

  std::string Name() const { return this->Folder.File(fs::path(this->Told).filename().string()); }

  /// Throws InputError where there is nothing, or the limit of file sizes has cut it.
  void CopyTo(Claim& claim) const
  {
    struct stat found = {};
    rlimit limit = {};
    if (fstat(this->Memory.Get(), &found) != 0 || found.st_size == 0)
    {
      throw InputError(this->Told + ": cannot be written");
    }
    const auto size = static_cast<rlim_t>(found.st_size);
    if (getrlimit(RLIMIT_FSIZE, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY &&
      size >= limit.rlim_cur)
    {
      errno = EFBIG;
      RefuseToWrite(this->Told);
    }
    std::vector<char> bytes(std::min<std::size_t>(size, std::size_t{ 1 } << 20));
    for (off_t offset = 0; offset < found.st_size;)
    {
      const ssize_t count = pread(this->Memory.Get(), bytes.data(), bytes.size(), offset);
      if (count <= 0)
      {
        RefuseToWrite(this->Told);
      }
      claim.Append({ bytes.data(), static_cast<std::size_t>(count) });
      offset += count;
    }
  }

private:
  std::string Told;
  OwnedDescriptor Memory;
  ScratchFolder Folder;
};
}

bool ClaimFile(const std::string& path)
{
  return Claims::All().Add(path, false);
}

bool ClaimFolder(const std::string& path)
{
  return Claims::All().Add(path, true);
}

void ClaimEmptyFolder(const std::string& path)
{
  std::error_code problem;
  if (fs::exists(path, problem) && !fs::is_empty(path, problem))
  {
    throw InputError(path + ": expected an empty folder, found files in it");
  }
  ClaimFolder(path);
}

void WriteWholeFile(const std::string& path, std::string_view bytes)
{
  const std::unique_ptr<Claim> claim = Claims::All().Take(path, false);
  claim->Empty();
  claim->Append(bytes);
  claim->Put();
}

void WriteWholeFile(const std::string& path,
  const std::function<void(const std::string& staged)>& write)
{
  const std::unique_ptr<Claim> claim = Claims::All().Take(path, false);
  const StagedFile staged(path);
  write(staged.Name());
  claim->Empty();
  staged.CopyTo(*claim);
  claim->Put();
}

void WriteWholeFolder(const std::string& path,
  const std::function<void(const std::string& folder)>& write)
{
  const std::unique_ptr<Claim> claim = Claims::All().Take(path, true);
  try
  {
    claim->Empty();
    write(claim->PartialPath().string());
    claim->Put();
  }
  catch (const fs::filesystem_error& error)
  {
    throw InputError(path + ": cannot be written (" + error.code().message() + ")");
  }
}
}
