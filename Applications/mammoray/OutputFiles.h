// SPDX-License-Identifier: Apache-2.0
// Checks of the files that commands read and write, before the work begins.
#ifndef mammoray_OutputFiles_h
#define mammoray_OutputFiles_h

#include <string>

namespace CLI
{
class App;
}

namespace mammoray
{
/// Throws InputError unless the file exists and can be read.
void CheckInputFile(const std::string& path);

/// Keeps the files and folders that options of the command name as inputs, from their types
/// (FileTypeName, InputTypeName): an output must not be an input as well.
void NoteInputs(const CLI::App& command);

/**
 * Throws InputError unless `path` can become an output file: its folder exists, nothing is there
 * yet or --overwrite is given, and it is neither an input nor a file of the result or DICOM folder
 * that is read.
 */
void CheckOutputPlace(const std::string& path);

/**
 * CheckOutputPlace, and reserves the file (ReserveFile). Throws InputError if another option names
 * it as an output, or if an `extension` (with its dot) is given that files of this `kind` ("a
 * picture") have and the path has not.
 */
void CheckOutputFile(const std::string& path, const std::string& extension = "",
  const std::string& kind = "");

/// CheckOutputFile for a picture (.png) unless the path is empty.
void CheckPictureFile(const std::string& path);

/// Throws InputError if the folder, which will be replaced, holds an input.
void CheckNoInputWithin(const std::string& folder);

/// Returns "scan_low.mha" for "scan.mha" and "_low", the path of an output beside another.
std::string BesideOutput(const std::string& output, const std::string& suffix);
}

#endif
