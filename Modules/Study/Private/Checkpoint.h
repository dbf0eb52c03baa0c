// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Checkpoint_h
#define mammoray_Checkpoint_h

#include "mammoray/Study/RegistrationCase.h"
#include "mammoray/Study/ResultFile.h"

#include <string>
#include <vector>

namespace mammoray
{
/// State of the search for one mammogram, and the files that it is about.
struct SearchPoint
{
  std::vector<ResultInput> Inputs;
  std::vector<ResultParameter> Parameters;
};

std::vector<ResultParameter> ParametersOf(const ViewResult& found);

/// The inputs of a case with one of its mammograms. Throws InputError if one cannot be read.
MAMMORAYSTUDY_EXPORT std::vector<ResultInput> InputsOf(const RegistrationCase& input,
  const std::string& mammogram);

/// Writes the state of all mammograms into one JSON file. Throws InputError if it cannot be
/// written.
void WriteCheckpoint(const std::vector<SearchPoint>& points, const std::string& path);

/// Reads a checkpoint. `path` may be a folder: then its checkpoint (CheckpointPath) is read, or its
/// result if there is none. Throws as ReadResultFile.
MAMMORAYSTUDY_EXPORT std::vector<SearchPoint> ReadSearchPoints(const std::string& path);
}

#endif
