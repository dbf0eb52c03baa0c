// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_GuardedRead_h
#define mammoray_GuardedRead_h

#include "mammoray/Foundation/Error.h"
#include "mammorayIOModule.h"

#include <array>
#include <concepts>
#include <cstdint>
#include <cstring>
#include <functional>
#include <optional>
#include <string>
#include <type_traits>
#include <vector>

namespace mammoray
{
/// What is sent as the bytes that it has in memory.
template <typename T>
struct IsPlain : std::bool_constant<std::is_arithmetic_v<T> || std::is_enum_v<T>>
{
};
template <typename T, std::size_t N>
struct IsPlain<std::array<T, N>> : IsPlain<T>
{
};

/**
 * Values on their way from a reader's process to the one that asked. A function that lists a
 * struct's members once, `exchange(a, b, ...)`, serves both ends: ParcelWriter puts them in,
 * ParcelReader takes them out. Numbers, enumerations, std::array of them, std::string,
 * std::optional, and std::vector of plain values or of texts.
 */
class MAMMORAYIO_EXPORT ParcelWriter
{
public:
  /// An open file, which stays the caller's.
  explicit ParcelWriter(int file)
    : File(file)
  {
  }
  ParcelWriter(const ParcelWriter&) = delete;
  ParcelWriter& operator=(const ParcelWriter&) = delete;
  /// What is kept back is lost unless Flush was called.
  ~ParcelWriter() = default;

  template <typename... Values>
  void operator()(const Values&... values)
  {
    (this->Put(values), ...);
  }
  /// `bytes` may be many and are not copied in between. Throws InputError where they have no place.
  void Block(const void* bytes, std::uint64_t count);
  void Flush();

private:
  template <typename T>
  requires IsPlain<T>::value void Put(const T& value) { this->Block(&value, sizeof value); }
  void Put(const std::string& text)
  {
    this->Put(std::uint64_t{ text.size() });
    this->Block(text.data(), text.size());
  }
  template <typename T>
  void Put(const std::optional<T>& value)
  {
    this->Put(value.has_value());
    if (value)
    {
      this->Put(*value);
    }
  }
  template <typename T>
  void Put(const std::vector<T>& values)
  {
    this->Put(std::uint64_t{ values.size() });
    if constexpr (IsPlain<T>::value)
    {
      this->Block(values.data(), values.size() * sizeof(T));
    }
    else
    {
      for (const T& value : values)
      {
        this->Put(value);
      }
    }
  }
  void WriteAll(const void* bytes, std::uint64_t count) const;

  int File;
  std::vector<char> Kept;
};

/// The other end. Throws InputError where a parcel holds less than is asked of it: a reader that
/// damaged data led astray may have written anything.
class ParcelReader
{
public:
  /// `bytes` must outlive this; `what` was read, for messages.
  ParcelReader(const unsigned char* bytes, std::uint64_t count, const std::string& what)
    : Next(bytes)
    , Left(count)
    , What(what)
  {
  }

  template <typename... Values>
  void operator()(Values&... values)
  {
    (this->Take(values), ...);
  }
  /// The next bytes, where they lie.
  const unsigned char* Block(std::uint64_t count)
  {
    if (count > this->Left)
    {
      throw InputError(
        this->What + ": expected a whole answer of its reader, found one that is cut short");
    }
    const unsigned char* const bytes = this->Next;
    this->Next += count;
    this->Left -= count;
    return bytes;
  }

private:
  template <typename T>
  requires IsPlain<T>::value void Take(T& value)
  {
    if constexpr (std::same_as<T, bool>)
    {
      value = *this->Block(1) != 0;
    }
    else
    {
      std::memcpy(&value, this->Block(sizeof value), sizeof value);
    }
  }
  void Take(std::string& text)
  {
    const std::uint64_t count = this->Count(1);
    text.assign(reinterpret_cast<const char*>(this->Block(count)), count);
  }
  template <typename T>
  void Take(std::optional<T>& value)
  {
    bool given = false;
    this->Take(given);
    value.reset();
    if (given)
    {
      this->Take(value.emplace());
    }
  }
  template <typename T>
  void Take(std::vector<T>& values)
  {
    if constexpr (IsPlain<T>::value)
    {
      const std::uint64_t count = this->Count(sizeof(T));
      values.resize(count);
      if (count > 0)
      {
        std::memcpy(values.data(), this->Block(count * sizeof(T)), count * sizeof(T));
      }
    }
    else
    {
      // Each takes eight bytes at least, its length.
      values.resize(this->Count(sizeof(std::uint64_t)));
      for (T& value : values)
      {
        this->Take(value);
      }
    }
  }
  /// A number of things of at least `bytes` each that are there.
  std::uint64_t Count(std::uint64_t bytes)
  {
    std::uint64_t count = 0;
    this->Take(count);
    if (count > this->Left / bytes)
    {
      this->Block(this->Left + 1);
    }
    return count;
  }

  const unsigned char* Next;
  std::uint64_t Left;
  std::string What;
};

/// What a reader may take before it is stopped.
struct MAMMORAYIO_EXPORT ReadLimits
{
  /// Memory beyond what the process has when it begins, bytes.
  std::uint64_t MemoryBytes = 0;
  /// Time of the processor, s. On the clock ten times as much and a minute.
  double Seconds = 0;

  /// In proportion to the files: 512 MiB and 64 times their size (text and compressed meshes grow
  /// less), 10 s and 1 s for each MB. Files that are not there count nothing.
  static ReadLimits Of(const std::vector<std::string>& files);
};

/**
 * Reads foreign bytes in a process of its own, a fork of this one, because the libraries that read
 * them (VTK, GDCM, ITK and what these use) end their process on some damaged files, and on others
 * never end or ask for all memory. `read` puts its result into the parcel; `unpack` gets it here.
 * An InputError of `read` arrives as it was thrown. Death of the reader, or one of `limits` met, is
 * an InputError of one line: "what: expected content, found ...". What libraries print there
 * reaches nobody but SaidByLibraries.
 *
 * A fork of a process with several threads has only the one that asks: `read` must not wait for
 * another, nor use a device. It costs two to five milliseconds and the copying of the result. Calls
 * of this function by `read` read where they are.
 */
MAMMORAYIO_EXPORT void ReadGuarded(const std::string& what, const std::string& content,
  const ReadLimits& limits, const std::function<void(ParcelWriter&)>& read,
  const std::function<void(ParcelReader&)>& unpack);

/// From now on guarded reads of this process read where they are, as in a reader's own. For
/// fuzzing, where the death of the process is what is looked for.
MAMMORAYIO_EXPORT void ReadWithoutGuard();

/// The first line that libraries have printed in this guarded read, at most 200 letters: of some
/// formats it is their only word of damage. Empty outside one.
MAMMORAYIO_EXPORT std::string SaidByLibraries();

/// For a reader that has seen that its file holds what needs so much: the limit on memory is at
/// least this from now on, and 1 s is added for each 20 MB. Does nothing outside a guarded read.
MAMMORAYIO_EXPORT void AllowMemory(std::uint64_t bytes);

/// Tells the asking process something while the work goes on; comes back when it has been heard.
/// At most 100,000 bytes.
using TellCallback = std::function<void(const std::string& text)>;

/**
 * Does long work on foreign bytes in a process of its own, a fork of this one, and gives its
 * answer. `heard` is called here, on the thread that asks, with each text that the work tells, and
 * with an empty one every 200 ms at least; what it throws ends the work at once and is thrown on.
 *
 * An InputError of `work` arrives as it was thrown, other exceptions as an InputError of their
 * text. The work's death, or more memory than `memoryBytes` beyond what this process has when it
 * begins, is an InputError of one line: "what: expected content, found ...". Time is not limited:
 * `heard` may end it. What libraries print there reaches nobody. `work` must not wait for another
 * thread, nor use a device: a fork has only the thread that asks.
 */
MAMMORAYIO_EXPORT std::vector<std::string> WorkGuarded(const std::string& what,
  const std::string& content, std::uint64_t memoryBytes,
  const std::function<std::vector<std::string>(const TellCallback& tell)>& work,
  const TellCallback& heard);
}

#endif
