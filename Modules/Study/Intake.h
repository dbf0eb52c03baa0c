// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Intake_h
#define mammoray_Intake_h

#include "mammoray/Biomechanics/PlacedPlates.h"
#include "mammoray/Dicom/DicomReader.h"
#include "mammoray/Foundation/Mammogram.h"
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
  Unknown, ///< no header tells; the histogram must
  Absent,  ///< fat is bright
  Present  ///< fat is dark
};

enum class ContrastPhase
{
  Unknown, ///< no header tells of a contrast agent
  Before,
  After
};

/// One volume of an MRI: a series, or one of several phases, echoes or kinds of image in it.
struct StudySeries
{
  /// Of the series, as the header has it, and its number, where it has one.
  std::string Description;
  std::optional<int> Number;
  std::string SeriesInstanceUid;
  std::string StudyInstanceUid;
  std::string FrameOfReferenceUid;
  /// YYYYMMDD; empty where the header says none.
  std::string Date;
  /// In the order of the grid's layers where there is a grid. What ReadIntensitySlices reads.
  std::vector<DicomSlice> Slices;
  /// Those that hold them, each once, in their order.
  std::vector<std::string> Files;
  /// DICOM LPS, mm; nothing where the slices make no regular volume.
  std::optional<VolumeGrid> Grid;
  /// "axial", "sagittal", "coronal", "oblique"; empty where the header does not say.
  std::string Plane;
  /// "HFP" and the like, and what it means for gravity; nothing on a side or where it is not said.
  std::string PositionCode;
  std::optional<PatientPosition> Position;
  /// "T1 gradient echo 3D, TR 4.3 TE 1.73 ms", for the reader.
  std::string Sequence;
  FatSuppression Fat = FatSuppression::Unknown;
  ContrastPhase Contrast = ContrastPhase::Unknown;
  /// What told of fat suppression and of contrast; empty where nothing did.
  std::string FatEvidence;
  std::string ContrastEvidence;
  /// Which of how many volumes at one place in the series, from 1.
  int Phase = 1;
  int Phases = 1;
  /// The patient's breast that the field of view holds: 'L', 'R', or 'B' for both; '?' where it
  /// cannot be told.
  char Side = '?';
  /// Distance of the slices, before a volume is made of them, mm; 0: unknown.
  double SliceSpacingMm = 0;
  /// Why it cannot show the tissue: "subtraction (ImageType SUB)"; empty where it can.
  std::string LeftOut;
};

struct StudyMammogram
{
  std::string File;
  /// "CC", "MLO", ...; empty where the header does not say.
  std::string View;
  /// 'L', 'R' or '?'.
  char Laterality = '?';
  Mammogram::Intent Intent = Mammogram::Intent::ForPresentation;
  /// Made of a tomosynthesis, not of one exposure.
  bool Synthetic = false;
  std::optional<double> ThicknessMm;
  std::optional<double> AngleDeg;
  int Columns = 0;
  int Rows = 0;
  /// YYYYMMDD and HHMMSS; empty where the header says none.
  std::string Date;
  std::string Time;
  /// Why it cannot be registered: "magnification"; empty where it can.
  std::string LeftOut;
};

/// What a clinic's export holds, of one patient.
struct Study
{
  std::string Folder;
  /// By time of acquisition as far as it is told.
  std::vector<StudySeries> Series;
  std::vector<StudyMammogram> Mammograms;
  /// Numbers of files: DICOM that is neither MRI nor mammogram (reports, segmentations), copies of
  /// an image that is there, directories (DICOMDIR), and what is no DICOM.
  std::size_t OtherObjects = 0;
  std::size_t Copies = 0;
  std::size_t Directories = 0;
  std::size_t NotDicom = 0;
  /// One line each, with the file: DICOM that is cut short or damaged.
  std::vector<std::string> Damaged;
  /// Of the patient's identity, such as a name that is spelled in two ways.
  std::vector<std::string> Warnings;
};

/**
 * Reads the headers of all files below a folder, whatever their names. Throws InputError, one line,
 * where there is no such folder, no DICOM in it, or images of two patients (told apart by
 * a number made of their identity, which is not shown); Interrupted.
 */
MAMMORAYSTUDY_EXPORT Study ReadStudy(const std::string& folder,
  const ProgressCallback& progress = {});

/// What a registration takes of a study, and why.
struct StudyChoice
{
  /// T1-weighted volumes of one position of the patient: without and with fat suppression; both
  /// where there are both. Undetermined, alone, where no header tells of fat suppression.
  std::optional<StudySeries> Plain;
  std::optional<StudySeries> FatSuppressed;
  std::optional<StudySeries> Undetermined;
  /// How the patient lay in them; nothing where no header says.
  std::optional<PatientPosition> Position;
  /// 'L' or 'R': asked for, or that of all mammograms; '?' where neither settles it.
  char Laterality = '?';
  std::optional<StudyMammogram> Cc;
  std::optional<StudyMammogram> Mlo;
  /// One line each.
  std::vector<std::string> Warnings;
  /// Why nothing can be registered, one line; empty where something can.
  std::string Refusal;
  /// Of Study::Series and Study::Mammograms, one line each: "taken: ..." or "left out: ...".
  std::vector<std::string> SeriesReasons;
  std::vector<std::string> MammogramReasons;

  /// Throws InputError with the refusal, if there is one.
  MAMMORAYSTUDY_EXPORT void Require() const;
};

/**
 * Chooses. Tissue: T1 before contrast first, then what holds the breast in the finest slices; of
 * the newest examination that has any. Mammograms: CC and MLO of the side, the newest exposure, of
 * its two forms For Processing; one view will do. `laterality`: 'L' or 'R', the patient's own, also
 * of mammograms that name no side where none of them does; nothing: the side of all mammograms,
 * refused where they show both.
 */
MAMMORAYSTUDY_EXPORT StudyChoice ChooseForRegistration(const Study& study,
  std::optional<char> laterality = {});

/// What was found and what is taken of it.
struct StudyIntake
{
  Study Found;
  StudyChoice Choice;
};

/// Tables of series and mammograms, each with what is made of it, for the terminal.
MAMMORAYSTUDY_EXPORT std::string StudyListing(const Study& study, const StudyChoice& choice);

/// The same as JSON, with the files; nothing that identifies the patient but what folders are
/// called.
MAMMORAYSTUDY_EXPORT std::string StudyJson(const Study& study, const StudyChoice& choice);
}

#endif
