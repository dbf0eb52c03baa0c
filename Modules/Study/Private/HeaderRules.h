// SPDX-License-Identifier: Apache-2.0
// The steps by which ReadStudy turns headers into series and mammograms, in their order.
#ifndef mammoray_Private_HeaderRules_h
#define mammoray_Private_HeaderRules_h

#include "mammoray/Dicom/DicomHeader.h"
#include "mammoray/Study/Intake.h"
#include "mammorayStudyModule.h"

#include <optional>
#include <string>
#include <vector>

namespace mammoray
{
/// StudyMammogram::LeftOut where nothing else is wrong.
inline constexpr const char* NamesNoView = "its header names no view";

/// A breast is 100 to 200 mm high and its slices are 1 to 4 mm apart.
inline constexpr std::size_t FewestSlicesOfBreast = 12;

/// First part of the classes of screenshots and scanned films.
inline constexpr const char* SecondaryCaptureClass = "1.2.840.10008.5.1.4.1.1.7";

/// Whether a header is that of an X-ray of the breast, from the unit or computed.
MAMMORAYSTUDY_EXPORT bool IsMammogram(const DicomHeader& header);

/**
 * Throws InputError, one line, if the images are of two patients: if identifiers, names, dates of
 * birth or sexes contradict each other. Returns a warning if two identifiers or two names are taken
 * for one patient's, because the other one and the date of birth agree. Texts show no identity:
 * they tell patients apart by a hash, numbers of images and the folder of the first one.
 */
MAMMORAYSTUDY_EXPORT std::vector<std::string> CheckOnePatient(
  const std::vector<DicomHeader>& images, const std::string& folder);

/// Why a mammogram does not show a whole breast that plates press onto the receptor:
/// "magnification view". Empty if the header gives no such reason.
MAMMORAYSTUDY_EXPORT std::string WhyNotWholeBreast(const DicomHeader& header);

MAMMORAYSTUDY_EXPORT StudyMammogram DescribeMammogram(const DicomHeader& header);

/**
 * Splits slices into volumes: by series, and within a series by what makes slices unlike (kind of
 * image, orientation, size, spacing, echo time). If several slices lie at one place, they are
 * phases, split by temporal position, acquisition, trigger, time, or else by their order. Fills in
 * header, slices, grid, phases and, for localizers, LeftOut.
 */
MAMMORAYSTUDY_EXPORT std::vector<StudySeries> SplitIntoVolumes(
  const std::vector<DicomHeader>& slices);

/// The volume of a number, from 1. Throws InputError if there is none or if it has no grid.
StudySeries& VolumeOfNumber(Study& study, int number);

/// What speaks against a volume that was asked for: "'t1_sub' is taken as asked for, although:
/// subtraction". Empty if nothing does.
std::string AgainstVolume(const StudySeries& series);

/// The first damaged file with its cause, and the number of more. Empty if there are none.
std::string DamagedText(const Study& study);

/// "; 1: 't1 tra' (60 slices of 320 x 320), 2: ..." for messages, the first 20.
std::string VolumesText(const Study& study);

/// Fills in what follows from the series' own header and grid, LeftOut included.
MAMMORAYSTUDY_EXPORT void DescribeSeries(StudySeries& series);

/// Time of a slice, a text that sorts: date and time of acquisition, else of the series. Empty if
/// unknown.
MAMMORAYSTUDY_EXPORT std::string MomentOf(const DicomHeader& header);

/// Fills in what follows from comparing series, which are in order of time: contrast phases, and
/// the absence of fat suppression that scan options name in other series only.
MAMMORAYSTUDY_EXPORT void CompareSeries(std::vector<StudySeries>& all);

/**
 * Chooses the mammogram of a side and view: a single exposure rather than one computed from
 * tomosynthesis, then the newest, then of one exposure's two forms that For Processing. Fills in
 * the Reason of all mammograms of that side and view. Returns an index, or nothing if there is
 * none.
 */
MAMMORAYSTUDY_EXPORT std::optional<std::size_t> ChooseMammogram(
  std::vector<StudyMammogram>& mammograms, char side, const std::string& view);
}

#endif
