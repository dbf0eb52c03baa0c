// SPDX-License-Identifier: Apache-2.0
// How files and folders are written: whole, or not at all.
#ifndef mammoray_WholeOutput_h
#define mammoray_WholeOutput_h

#include "mammorayIOModule.h"

#include <functional>
#include <string>
#include <string_view>

namespace mammoray
{
/**
 * Holds the place of a file that is to be written, from before the work until it is written or the
 * process ends. It grows beside its place, as PATH.partial, on which there is a lock as long as
 * its process lives; what a dead one left there is taken over. A symbolic link is followed. False
 * where this process holds the place already. Throws InputError where another process does, and
 * where the file could not be put there: no such folder, not writable, full, a mount point, another
 * owner's file in a folder like /tmp, something that is no file.
 */
MAMMORAYIO_EXPORT bool ClaimFile(const std::string& path);

/**
 * ClaimFile of a folder. One that is there is to be replaced as a whole; where its parent does not
 * allow that (a mount point, another owner's) it must be empty, and is filled. Throws InputError
 * otherwise, and where files in it could not be removed.
 */
MAMMORAYIO_EXPORT bool ClaimFolder(const std::string& path);

/// ClaimFolder of one that is not there or empty; throws InputError where files are in it.
MAMMORAYIO_EXPORT void ClaimEmptyFolder(const std::string& path);

/**
 * Writes a file of these bytes: on the disk, checked and synchronised, before it gets its name. One
 * that is there is replaced. Claims it where that has not been done. Throws InputError where it
 * cannot be written; what was there stays, and nothing else.
 */
MAMMORAYIO_EXPORT void WriteWholeFile(const std::string& path, std::string_view bytes);

/**
 * The same of what `write` writes to a name it is given, which has the file name of `path` and is
 * of a file in memory: libraries do not tell of a full disk. What it throws is passed on.
 */
MAMMORAYIO_EXPORT void WriteWholeFile(const std::string& path,
  const std::function<void(const std::string& staged)>& write);

/**
 * The same of a folder, whose files `write` writes by the above into the folder it is given. One
 * that is there, with everything in it, is exchanged for it and then removed.
 */
MAMMORAYIO_EXPORT void WriteWholeFolder(const std::string& path,
  const std::function<void(const std::string& folder)>& write);
}

#endif
