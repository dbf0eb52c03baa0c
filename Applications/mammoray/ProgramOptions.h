// SPDX-License-Identifier: Apache-2.0
// The options of every command.
#ifndef mammoray_ProgramOptions_h
#define mammoray_ProgramOptions_h

#include "mammoray/Study/LabelSource.h"
#include "mammoray/XRay/PathLengthProjector.h"

#include <string>

namespace mammoray
{
class Command;

struct ProgramOptions
{
  /// Whether outputs may replace what is there.
  bool Overwrite = false;
  /// Take the axes of volumes' headers as they are, without conversion to LPS.
  bool AxesAsGiven = false;
  /// Accept values outside their ValidRange.
  bool AcceptUnusual = false;
  ProjectorOptions Projector;

  /// Passes on what concerns a label volume.
  void ApplyTo(LabelSource& labels) const;
};

/// What was given on the command line and in the case file. Commands run one at a time.
ProgramOptions& Program();

/**
 * Adds the options above, --config FILE.json, which reads a case file, and --print-config, which
 * writes one. Keys of the file are the option names without dashes, and "$schema"; an option on the
 * command line wins over the file. Inputs (OptionList::File, Input) are looked for beside the file
 * first, so that a folder with its case file can be moved, then in the working folder. Call it
 * after the command's own options are added.
 */
void AddProgramOptions(Command& command);

/// What --print-config prints.
std::string PrintedConfiguration(const Command& command);
}

#endif
