// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Intake_h
#define mammoray_Intake_h

#include "mammoray/Biomechanics/Plates.h"
#include "mammoray/Dicom/DicomHeader.h"
#include "mammoray/Dicom/DicomReader.h"
#include "mammoray/Foundation/Progress.h"
#include "mammoray/Foundation/Volumes.h"
#include "mammorayStudyModule.h"

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace mammoray
{
enum class FatSuppression
{
  Unknown, ///< No header tells it. The histogram must.
  Absent,  ///< Fat is bright.
  Present  ///< Fat is dark.
};

enum class ContrastPhase
{
  Unknown, ///< No header mentions a contrast agent.
  Before,
  After
};

/// One volume of an MRI: a series, or one of several phases, echoes or kinds of image in it.
struct StudySeries
{
  /// Header of the slice that was taken first.
  DicomHeader Header;
  /// Description of the series, or its protocol if there is none.
  std::string Description;
  /// YYYYMMDD. Empty if unknown.
  std::string Date;
  /// Input of ReadIntensitySlices, in the order of the grid's layers if there is a grid.
  std::vector<DicomSlice> Slices;
  /// The files of the slices in their order, each once.
  std::vector<std::string> Files;
  /// DICOM LPS, mm. Absent if the slices make no regular volume.
  std::optional<VolumeGrid> Grid;
  /// "axial", "sagittal", "coronal" or "oblique". Empty if unknown.
  std::string Plane;
  /// How the patient lay. Absent if she lay on a side or the header does not say it.
  std::optional<PatientPosition> Position;
  /// Summary for the reader: "T1 gradient echo 3D, TR 4.3 TE 1.73 ms".
  std::string Sequence;
  FatSuppression Fat = FatSuppression::Unknown;
  ContrastPhase Contrast = ContrastPhase::Unknown;
  /// The words or values of headers that showed fat suppression and contrast. Empty if none did.
  std::string FatEvidence;
  std::string ContrastEvidence;
  /// True if nothing but the order of the series shows that it was taken before contrast.
  bool ContrastByOrder = false;
  /// Number of this volume and number of volumes at one place in the series, from 1.
  int Phase = 1;
  int Phases = 1;
  /// The patient's breast in the field of view: 'L', 'R', 'B' for both, '?' if unknown.
  char Side = '?';
  /// Mean distance of the slices, mm. 0 if unknown.
  double SliceSpacingMm = 0;
  /// Why the slices make no grid: "missing slices (2, ...)". Empty if they do.
  std::string WhyNoGrid;
  /// For refusals: the first two files at one place (FindSliceOrder) if slices are doubled; else
  /// empty.
  std::string DoubledFiles;
  /// Why it cannot show the tissue: "subtraction (ImageType SUB)". Empty if it can.
  std::string LeftOut;
  /// Filled in by ChooseForRegistration: "taken: ..." or "left out: ...".
  std::string Reason;
};

struct StudyMammogram
{
  /// Its header, completed: the side from the description if no element names it, date and time
  /// from other elements if those of the acquisition are missing. A thickness is positive.
  DicomHeader Header;
  /// Computed from tomosynthesis, not exposed.
  bool Synthetic = false;
  /// Why it cannot be registered: "magnification view". Empty if it can.
  std::string LeftOut;
  /// Filled in by ChooseForRegistration: "taken: ..." or "left out: ...".
  std::string Reason;
};

/// Contents of a clinic's export of one patient.
struct Study
{
  std::string Folder;
  /// In order of acquisition as far as headers tell it.
  std::vector<StudySeries> Series;
  std::vector<StudyMammogram> Mammograms;
  /// Numbers of files: DICOM that is neither MRI nor mammogram (reports, segmentations), copies of
  /// another image, directories (DICOMDIR), and files that are no DICOM.
  std::size_t OtherObjects = 0;
  std::size_t Copies = 0;
  std::size_t Directories = 0;
  std::size_t NotDicom = 0;
  /// One line for each truncated or damaged DICOM file, with its name.
  std::vector<std::string> Damaged;
  /// About the patient's identity, such as a name that is spelled in two ways.
  std::vector<std::string> Warnings;
};

/**
 * Reads the headers of all files below a folder, whatever their names. Throws InputError, one line,
 * if there is no such folder, no DICOM in it, or images of two patients (told apart by a hash of
 * their identity, which is not shown); Interrupted.
 */
MAMMORAYSTUDY_EXPORT Study ReadStudy(const std::string& folder,
  const ProgressCallback& progress = {});

/// What a registration takes of a study.
struct StudyChoice
{
  /// What there is. Each series and mammogram has its Reason.
  Study Found;
  /// T1-weighted volumes of one position of the patient: without and with fat suppression, both if
  /// possible. Undetermined is set where no Plain is, if no header tells whether fat is suppressed
  /// in it; the histogram must.
  std::optional<StudySeries> Plain;
  std::optional<StudySeries> FatSuppressed;
  std::optional<StudySeries> Undetermined;
  /// How the patient lay in them. Absent if no header says it.
  std::optional<PatientPosition> Position;
  /// 'L' or 'R': the side asked for, or that of all mammograms. '?' if neither settles it.
  char Laterality = '?';
  std::optional<StudyMammogram> Cc;
  std::optional<StudyMammogram> Mlo;
  /// One line each.
  std::vector<std::string> Warnings;
  /// Why nothing can be registered, one line. Empty if something can.
  std::string Refusal;
  /// The field that settles it, "Laterality" or "ImagePosition". Empty if none does.
  std::string Remedy;

  /// The volume without fat suppression, or else the one that is taken.
  MAMMORAYSTUDY_EXPORT const std::optional<StudySeries>& Mri() const;
  /// Throws InputError with the refusal, if there is one.
  MAMMORAYSTUDY_EXPORT void Require() const;
};

/**
 * Chooses series and mammograms. Tissue: T1 before contrast first, then what shows the breast in
 * the finest slices, from the newest examination that has any. Mammograms: CC and MLO of one side,
 * the newest exposure, For Processing of its two forms. One view is enough. `laterality`: 'L' or
 * 'R', the patient's own; it is also the side of all mammograms if none of them names one. Nothing:
 * the side of all mammograms, with a refusal if they show both. `series`: numbers of the volumes to
 * take (their order in Study::Series, from 1), one without and one with fat suppression at most;
 * empty: those that are chosen. `position`: how the patient lay, in place of what the header says.
 * Throws InputError on other numbers, and on volumes without a grid.
 */
MAMMORAYSTUDY_EXPORT StudyChoice ChooseForRegistration(Study study,
  std::optional<char> laterality = {}, const std::vector<int>& series = {},
  std::optional<PatientPosition> position = {});

/// Tables of series, with their numbers, and of mammograms, with the reasons of both, for the
/// terminal.
MAMMORAYSTUDY_EXPORT std::string StudyListing(const StudyChoice& choice);

/**
 * Reads an MRI as ReadIntensityVolume does. `series`: of a folder, the volume of this number in the
 * listing of its study. Throws InputError, which lists the volumes of a folder that holds several
 * where none of them is asked for.
 */
MAMMORAYSTUDY_EXPORT IntensityVolume ReadMri(const std::string& path, VolumeAxes axes,
  std::optional<int> series = {}, const ProgressCallback& progress = {});

/// What the headers of an MRI tell of its fat, as ReadMri takes it; Unknown for other files.
MAMMORAYSTUDY_EXPORT FatSuppression FatOfMri(const std::string& path,
  std::optional<int> series = {});

/// The listing as JSON, with the files. Only names of files and folders may identify the patient.
MAMMORAYSTUDY_EXPORT std::string StudyJson(const StudyChoice& choice);
}

#endif
