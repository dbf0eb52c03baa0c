// SPDX-License-Identifier: Apache-2.0
// Files that commands read and write: checked before the work begins, and written
// completely or not at all.
#ifndef mammoray_OutputFiles_h
#define mammoray_OutputFiles_h

#include <functional>
#include <string>

namespace mammoray
{
/// The path itself when the file exists and can be read; throws InputError otherwise.
const std::string& CheckInputFile(const std::string& path);

/// CheckInputFile where a file is named; an empty path passes.
void CheckInputFileIfAny(const std::string& path);

/**
 * Throws InputError unless `path` can become an output file: its folder exists and is writable, and
 * nothing is there yet unless `overwrite`. Call it before the work begins.
 */
void CheckOutputFile(const std::string& path, bool overwrite);

/**
 * CheckOutputFile, and throws InputError unless the path ends in `extension` (with its dot), which
 * files of this `kind` ("a picture") have.
 */
void CheckOutputFile(const std::string& path, bool overwrite, const std::string& extension,
  const std::string& kind);

/// CheckOutputFile for a picture (.png) where one is asked for: an empty path passes.
void CheckPictureFile(const std::string& path, bool overwrite);

/**
 * Calls `write` with a temporary name of the same extension in the same folder and renames the file
 * to `path` when it returns; removes it when it throws. An existing file is replaced.
 */
void WriteComplete(const std::string& path,
  const std::function<void(const std::string& temporary)>& write);

/// Writes text as a complete file. Throws InputError when it cannot be written.
void WriteTextFile(const std::string& path, const std::string& text);
}

#endif
