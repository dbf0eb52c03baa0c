// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_ReportPictures_h
#define mammoray_ReportPictures_h

#include "mammoray/Report/RegistrationReport.h"

#include <string>

namespace mammoray
{
/// PNG files as bytes.
struct ReportPictures
{
  std::string Real;
  std::string Synthetic;
  std::string Overlay;
  std::string Difference;
  /// Whether they are as wide as high or wider, so that two stand side by side better than four.
  bool Wide = false;
};

ReportPictures DrawPictures(const RegistrationReport& report);
}

#endif
