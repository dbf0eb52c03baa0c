// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_ReportPictures_h
#define mammoray_ReportPictures_h

#include "mammoray/Study/RegistrationReport.h"

#include <array>
#include <string>

namespace mammoray
{
/// The pictures of one mammogram.
struct ReportPictures
{
  /// Without outlines, which lie over them as lines.
  LayeredPicture Real;
  LayeredPicture Synthetic;
  LayeredPicture Overlay;
  LayeredPicture Difference;
  /// The real one with what was asked for; none where nothing was.
  LayeredPicture Answer;
  /// Bytes of PNG files with the outlines in them, for the folder, in the order above.
  std::array<std::string, 4> Files;
  /// Whether they are as wide as high or wider, so that two stand side by side better than four.
  bool Wide = false;
  /// Patient directions at the left, right, upper and lower side.
  std::array<std::string, 4> Letters;
  /// Whether gantry x grows upwards (+1) or downwards in them.
  double Up = 1;
};

ReportPictures DrawPictures(const RegistrationReport& report);
}

#endif
