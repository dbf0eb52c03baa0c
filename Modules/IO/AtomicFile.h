// SPDX-License-Identifier: Apache-2.0
// Atomic files and folders: written aside, synchronised, then renamed into place.
#ifndef mammoray_AtomicFile_h
#define mammoray_AtomicFile_h

#include "mammorayIOModule.h"

#include <functional>
#include <string>
#include <string_view>

namespace mammoray
{
/**
 * Reserves the place of an output file, from before the work until the file is written or the
 * process ends. The reservation is a lock on PATH.partial, into which the file is written; one that
 * a killed process left behind is taken over. Symbolic links are followed. Returns false if this
 * process holds the reservation already. Throws InputError if another process holds it or if a file
 * cannot be put there.
 */
MAMMORAYIO_EXPORT bool ReserveFile(const std::string& path);

/**
 * Reserves the place of an output folder in the same way. An existing folder will be replaced as a
 * whole. If that is impossible (a mount point, another owner's folder in a sticky directory) the
 * folder must be empty, and its new contents are moved into it.
 */
MAMMORAYIO_EXPORT bool ReserveFolder(const std::string& path);

/// Gives up all reservations that this process holds; for one that ends without destructors.
MAMMORAYIO_EXPORT void GiveUpReservations();

/// Returns true if the path is a folder that can be read and holds nothing, or only the partial
/// folder by which ReserveFolder reserves a mount point.
MAMMORAYIO_EXPORT bool IsEmptyFolder(const std::string& path);

/// Reserves a folder that does not exist or is empty; throws InputError if it holds files.
MAMMORAYIO_EXPORT void ReserveEmptyFolder(const std::string& path);

/**
 * Writes a file atomically: after an error or a kill, the path holds what it held before, and
 * otherwise all of `bytes`. Uses the reservation if there is one. Throws InputError if the file
 * cannot be written.
 */
MAMMORAYIO_EXPORT void WriteAtomicFile(const std::string& path, std::string_view bytes);

/**
 * Writes atomically what `write` writes to `staged`, a file in memory that has the file name of
 * `path`. It serves libraries that do not report a full disk. Exceptions of `write` are passed on.
 */
MAMMORAYIO_EXPORT void WriteAtomicFile(const std::string& path,
  const std::function<void(const std::string& staged)>& write);

/**
 * Writes a folder atomically. `write` fills the folder that it is given by the functions above. An
 * existing folder, with everything in it, is exchanged for the new one and then removed.
 */
MAMMORAYIO_EXPORT void WriteAtomicFolder(const std::string& path,
  const std::function<void(const std::string& folder)>& write);
}

#endif
