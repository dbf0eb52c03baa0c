// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Private_GuardedRead_h
#define mammoray_Private_GuardedRead_h

#include "Private/Parcel.h"
#include "mammorayIOModule.h"

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

namespace mammoray
{
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
}

#endif
