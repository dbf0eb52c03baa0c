// SPDX-License-Identifier: Apache-2.0
// Files that commands read and write: checked before the work begins.
#ifndef mammoray_OutputFiles_h
#define mammoray_OutputFiles_h

#include <string>

namespace CLI
{
class App;
}

namespace mammoray
{
/// The path itself when the file exists and can be read; throws InputError otherwise.
const std::string& CheckInputFile(const std::string& path);

/// CheckInputFile where a file is named; an empty path passes.
void CheckInputFileIfAny(const std::string& path);

/// Keeps what the command's options were given, among which an output may not be twice.
void NoteGiven(const CLI::App& command);

/**
 * Throws InputError unless `path` can become an output file: its folder exists and is writable,
 * nothing is there yet unless `overwrite`, and it is no input, nor a file of the result or the
 * DICOM folder that is read. Call it before the work begins.
 */
void CheckOutputPlace(const std::string& path, bool overwrite);

/// CheckOutputPlace, and claims the file (ClaimFile). Throws InputError where it is another output.
void CheckOutputFile(const std::string& path, bool overwrite);

/// The same of a file that no option names, as it lies beside an output: every one that is named is
/// an input.
void CheckOutputBeside(const std::string& path, bool overwrite);

/**
 * CheckOutputFile, and throws InputError unless the path ends in `extension` (with its dot), which
 * files of this `kind` ("a picture") have.
 */
void CheckOutputFile(const std::string& path, bool overwrite, const std::string& extension,
  const std::string& kind);

/// CheckOutputFile for a picture (.png) where one is asked for: an empty path passes.
void CheckPictureFile(const std::string& path, bool overwrite);

/// Throws InputError unless `path` can become a folder of its own: it is not there yet, or empty.
/// Claims it (ClaimFolder).
void CheckNewFolder(const std::string& path);

/// Throws InputError where something that the options were given is in the folder, which is to be
/// replaced.
void CheckNoInputWithin(const std::string& folder);

/// "scan_low.mha" of "scan.mha" and "_low": an output beside another.
std::string BesideOutput(const std::string& output, const std::string& suffix);
}

#endif
