// SPDX-License-Identifier: Apache-2.0
// What the sub-commands share: configuration files, progress, output files. No algorithms here.
#ifndef mammoray_CommandLine_h
#define mammoray_CommandLine_h

#include "mammoray/Case/LabelSource.h"
#include "mammoray/Foundation/Progress.h"

#include <CLI/CLI.hpp>

#include <functional>
#include <string>

namespace mammoray
{
/**
 * Adds --config FILE.json and --print-config to a sub-command. Keys of the file are the long option
 * names without dashes; an option on the command line wins over the file. Call it after the options
 * are added.
 */
void AddConfigurationOptions(CLI::App& command);

/// Numbers from least to most; NaN is none.
CLI::Validator NumberFrom(double least, double most);

/// Finite numbers greater than 0.
CLI::Validator PositiveNumber();

/// Finite numbers not less than 0.
CLI::Validator NonNegativeNumber();

/// Adds --labels, --crop, --skin and --axes-as-given; gives the option --labels.
CLI::Option* AddLabelOptions(CLI::App& command, LabelSource& source);

/// Adds --materials: a file or a shipped table's name (see FindMaterialTable); gives the option.
CLI::Option* AddMaterialsOption(CLI::App& command, std::string& pathOrName);

/// Adds --projector auto|ray-tracing|rasterisation (see ProjectorOptions::Method); gives the
/// option.
CLI::Option* AddProjectorOption(CLI::App& command, std::string& method);

/**
 * A callback that draws a progress bar on stderr when that is a terminal, and asks to stop once
 * Ctrl-C was pressed.
 */
ProgressCallback MakeProgressBar();

/// True once Ctrl-C was pressed; installs the handler at the first call.
bool InterruptRequested();

/**
 * Throws InputError unless `path` can become an output file: its folder exists and is writable, and
 * nothing is there yet unless `overwrite`. Call it before the work begins.
 */
void CheckOutputFile(const std::string& path, bool overwrite);

/// CheckOutputFile for a picture, where one is asked for: a path that is not empty ends in .png.
void CheckPictureFile(const std::string& path, bool overwrite);

/**
 * Calls `write` with a temporary name of the same extension in the same folder and renames the file
 * to `path` when it returns; removes it when it throws. An existing file is replaced.
 */
void WriteComplete(const std::string& path,
  const std::function<void(const std::string& temporary)>& write);

/// The path itself when the file exists and can be read; throws InputError otherwise.
const std::string& CheckInputFile(const std::string& path);

/// Warns on stderr where the match in a registration's folder is not to be trusted.
void WarnOfDistrust(const std::string& folder);

// One per sub-command, each in its own file; evidence only with the Meshing module.
void AddCompressCommand(CLI::App& application);
void AddDevicesCommand(CLI::App& application);
void AddDicomCommand(CLI::App& application);
void AddEvaluateCommand(CLI::App& application);
void AddEvidenceCommand(CLI::App& application);
void AddExampleCommand(CLI::App& application);
void AddFuseCommand(CLI::App& application);
void AddLocateCommand(CLI::App& application);
void AddMeshCommand(CLI::App& application);
void AddProjectCommand(CLI::App& application);
void AddRegisterCommand(CLI::App& application);
void AddSegmentCommand(CLI::App& application);
void AddViewCommand(CLI::App& application);
}

#endif
