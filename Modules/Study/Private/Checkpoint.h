// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Checkpoint_h
#define mammoray_Checkpoint_h

#include "mammoray/Study/RegistrationCase.h"
#include "mammoray/Study/ResultFile.h"

#include <string>
#include <vector>

namespace mammoray
{
/// Where a search of one mammogram was, and of which files.
struct SearchPoint
{
  std::vector<ResultInput> Inputs;
  std::vector<ResultParameter> Parameters;
};

std::vector<ResultParameter> ParametersOf(const ViewResult& found);

std::vector<ResultInput> HashedInputs(const RegistrationCase& input, const std::string& mammogram);

/// Of all mammograms, into one file, JSON. Throws InputError when it cannot be written.
void WriteCheckpoint(const std::vector<SearchPoint>& points, const std::string& path);

/// Of a checkpoint, of the one that a folder has (CheckpointPath), or of the result in the folder.
/// Throws InputError as ReadResultFile.
MAMMORAYSTUDY_EXPORT std::vector<SearchPoint> ReadSearchPoints(const std::string& path);
}

#endif
