// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_ReportPictures_h
#define mammoray_ReportPictures_h

#include "RegistrationReport.h"

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
};

ReportPictures DrawPictures(const RegistrationReport& report);
}

#endif
