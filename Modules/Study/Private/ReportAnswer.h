// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_ReportAnswer_h
#define mammoray_ReportAnswer_h

#include "Private/ReportPictures.h"
#include "mammoray/Study/RegistrationReport.h"

#include <string>
#include <vector>

namespace mammoray
{
/// A mammogram as the answer tells of it; the referenced objects must outlive it.
struct AnsweredMammogram
{
  /// "CC view".
  std::string Title;
  const RegistrationReport* Report = nullptr;
  const ReportPictures* Pictures = nullptr;
};

/// What a page begins with: where each mammogram shows what was asked for, with how much trust, in
/// words and pictures. Nothing where nothing was asked for.
std::string AnswerHtml(const std::vector<AskedPlace>& asked,
  const std::vector<AnsweredMammogram>& mammograms);
}

#endif
