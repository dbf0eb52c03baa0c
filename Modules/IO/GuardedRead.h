// SPDX-License-Identifier: Apache-2.0
// Reads foreign bytes in a process of its own.
#ifndef mammoray_GuardedRead_h
#define mammoray_GuardedRead_h

#include "mammoray/Foundation/Error.h"
#include "mammorayIOModule.h"

#include <cstdint>
#include <cstdio>
#include <functional>
#include <string>
#include <type_traits>
#include <vector>

namespace mammoray
{
/// The reader of a file ended without an answer, or met a limit.
class ReaderEnded : public InputError
{
public:
  using InputError::InputError;
};

/**
 * Values on their way from a reader's process to the one that asked. `parcel(a, b, ...)` writes the
 * values in the one and reads them in the other. It carries trivially copyable types, texts,
 * std::vector, and every type T with a function Exchange(Parcel&, T&), which passes the members of
 * T to the parcel.
 */
class MAMMORAYIO_EXPORT Parcel
{
public:
  /// Writes to the open file, or reads from it where it stands. The file stays the caller's; `what`
  /// names the origin of the values in messages.
  Parcel(std::FILE* file, bool writes, const std::string& what)
    : File(file)
    , Writes(writes)
    , What(what)
  {
  }

  /// Throws ReaderEnded if the file has fewer bytes than the values need.
  template <typename... Values>
  void operator()(Values&... values)
  {
    (this->Pass(values), ...);
  }

private:
  template <typename T>
  void Pass(T& value)
  {
    if constexpr (std::is_trivially_copyable_v<T>)
    {
      this->Bytes(&value, sizeof value);
    }
    else
    {
      Exchange(*this, value);
    }
  }
  void Pass(std::string& text)
  {
    text.resize(this->Count(text.size(), 1));
    this->Bytes(text.data(), text.size());
  }
  template <typename T>
  void Pass(std::vector<T>& values)
  {
    constexpr bool isPlain = std::is_trivially_copyable_v<T>;
    values.resize(this->Count(values.size(), isPlain ? sizeof(T) : 1));
    if constexpr (isPlain)
    {
      this->Bytes(values.data(), values.size() * sizeof(T));
    }
    else
    {
      for (T& value : values)
      {
        this->Pass(value);
      }
    }
  }

  /// Passes a number of values of at least `bytes` each.
  std::size_t Count(std::size_t count, std::size_t bytes);
  void Bytes(void* bytes, std::size_t count);
  [[noreturn]] void RefuseCut() const;

  std::FILE* const File;
  const bool Writes;
  const std::string What;
};

/// Memory and time that a reader may use before it is stopped.
struct MAMMORAYIO_EXPORT ReadLimits
{
  /// Memory beyond that of the process when it begins, bytes.
  std::uint64_t MemoryBytes = 0;
  /// Time of the processor, s; ten times as much and a minute on the clock. May be infinite.
  double Seconds = 0;

  /// Limits in proportion to the files: 512 MiB and 64 times their size (text and compressed meshes
  /// grow less), 10 s and 1 s for each MB. Files that do not exist count nothing.
  static ReadLimits Of(const std::vector<std::string>& files);
};

/// Passes a text of at most 100,000 bytes to the process that asked, and returns when it was heard.
using TellCallback = std::function<void(const std::string& text)>;

/// False where guarded reads do not fork: in a reader's process, and after ReadWithoutGuard.
MAMMORAYIO_EXPORT bool IsReadingGuarded();

/// ReadGuarded without the types; `put` fills the parcel in the reader's process, `take` empties it
/// in this one.
MAMMORAYIO_EXPORT void RunGuarded(const std::string& what, const std::string& content,
  const ReadLimits& limits, const std::function<void(Parcel&, const TellCallback& tell)>& put,
  const std::function<void(Parcel&)>& take, const TellCallback& heard);

/**
 * Returns the value of `read`, called in a fork of this process: the libraries that read foreign
 * bytes (VTK, GDCM, ITK, DCMTK, tinygltf) crash on some damaged files, and on others never end or
 * ask for all memory. An InputError of `read` arrives as it was thrown, other exceptions as an
 * InputError of their text, and what it notes (Note) is noted here. The death of the reader, and a
 * limit that it meets, are a ReaderEnded of one line: "what: expected content, found ...". What
 * libraries print there reaches nobody but SaidByLibraries.
 *
 * Long work may take a TellCallback as its argument, and report its progress by it. `heard` is
 * called in this process with each text, and with an empty one every 200 ms; its exceptions end the
 * work at once and are passed on.
 *
 * A fork has only the thread that asks: `read` must not wait for another thread, nor use a device.
 * It costs two to five milliseconds and copying the value. Calls within `read` do not fork again.
 */
template <typename Read>
auto ReadGuarded(const std::string& what, const std::string& content, const ReadLimits& limits,
  const Read& read, const TellCallback& heard = {})
{
  const auto call = [&read](const TellCallback& tell)
  {
    if constexpr (std::is_invocable_v<Read, const TellCallback&>)
    {
      return read(tell);
    }
    else
    {
      return read();
    }
  };
  if (!IsReadingGuarded())
  {
    return call(heard);
  }
  decltype(call(heard)) value{};
  RunGuarded(
    what, content, limits,
    [&call](Parcel& parcel, const TellCallback& tell)
    {
      auto found = call(tell);
      parcel(found);
    },
    [&value](Parcel& parcel) { parcel(value); }, heard);
  return value;
}

/// Makes guarded reads of this process read in it from now on; for fuzzing, which looks for
/// crashes.
MAMMORAYIO_EXPORT void ReadWithoutGuard();

/// Returns the first line that libraries printed in this reader's process, at most 200 letters: for
/// some formats it is their only word of damage. Empty outside a reader's process.
MAMMORAYIO_EXPORT std::string SaidByLibraries();

/// Raises the limits of this reader's process, whose file is known to hold so much: memory to at
/// least `bytes`, time by 1 s for each 20 MB. Does nothing outside a reader's process.
MAMMORAYIO_EXPORT void AllowMemory(std::uint64_t bytes);
}

#endif
