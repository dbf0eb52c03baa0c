// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Testing_ShippedPhantom_h
#define mammoray_Testing_ShippedPhantom_h

#include "Files.h"

#include <string>

namespace mammoray::test
{
/// The project's Data folder and, in it, the inputs of a registration of the phantom.
inline const std::string Data = DataFolder();
inline const std::string Labels = Data + "/victre-phantom-1/labels.nrrd";
inline const std::string Materials = Data + "/materials/victre.json";
inline const std::string MammogramFile = Data + "/victre-phantom-1/victre1_lcc_processing.dcm";
}

#endif
