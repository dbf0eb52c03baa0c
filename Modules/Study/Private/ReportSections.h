// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_ReportSections_h
#define mammoray_ReportSections_h

#include "Private/ReportPictures.h"
#include "mammoray/Study/RegistrationReport.h"

#include <string>
#include <vector>

namespace mammoray
{
/// "Left breast" and the like.
std::string BreastText(const Mammogram& mammogram);

/// The heading of one mammogram's sections on a page of several.
std::string MammogramHeading(const std::string& title);

/// All that a report tells of one mammogram, as sections of a page; `plot` is an SVG element.
std::string MammogramHtml(const RegistrationReport& report, const ReportPictures& pictures,
  const std::string& plot);

/// Further sections.
std::string SectionsHtml(const std::vector<ReportSection>& sections);

/// What mammograms that were registered together have in common.
std::string SharedHtml(const std::vector<SharedParameter>& shared);
}

#endif
