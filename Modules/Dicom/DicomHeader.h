// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_DicomHeader_h
#define mammoray_DicomHeader_h

#include "mammoray/Foundation/Mammogram.h"
#include "mammoray/Foundation/Vector3.h"
#include "mammoray/Foundation/Volumes.h"
#include "mammorayDicomModule.h"

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace mammoray
{
/**
 * Patient and study of a DICOM object. Empty members are written as empty elements, except
 * StudyInstanceUid, for which a new UID is generated. Texts are encoded in CharacterSet (DICOM
 * Specific Character Set).
 */
struct DicomIdentity
{
  std::string PatientName;
  std::string PatientId;
  std::string PatientBirthDate;
  std::string PatientSex;
  std::string StudyInstanceUid;
  std::string StudyDate;
  std::string StudyTime;
  std::string StudyId;
  std::string AccessionNumber;
  std::string ReferringPhysicianName;
  std::string CharacterSet = "ISO_IR 192"; // UTF-8
};

/// Throws InputError that names `what` unless the text is a valid DICOM name or identifier: at most
/// 64 bytes, without '\' and control characters.
MAMMORAYDICOM_EXPORT void CheckDicomText(const std::string& text, const std::string& what);

/// Where a slice lies in the patient.
struct SlicePlace
{
  /// Centre of the first pixel, mm, DICOM LPS. Absent unless the header has position, orientation
  /// and positive pixel spacings.
  std::optional<Vector3> Position;
  /// Unit vectors in the direction of increasing column and of increasing row.
  Vector3 AlongRow{ 1, 0, 0 };
  Vector3 AlongColumn{ 0, 1, 0 };
  /// Distances between neighbouring rows, columns and slices, mm. SliceSpacingMm is 0 if unknown.
  double RowSpacingMm = 0;
  double ColumnSpacingMm = 0;
  double SliceSpacingMm = 0;
};

/// Header of a DICOM file. Values are kept as the file has them. A missing text is empty and a
/// missing number is absent. Multi-valued texts are lists.
struct DicomHeader : SlicePlace
{
  std::string Path;
  /// Number of the frame of a multi-frame object, from 1. 0 for a whole file.
  int Frame = 0;
  std::string SopClassUid;
  std::string SopInstanceUid;
  std::string SeriesInstanceUid;
  std::string FrameOfReferenceUid;
  DicomIdentity Identity;
  std::string Modality;
  std::string Manufacturer;
  std::vector<std::string> ImageType;
  std::string SeriesDescription;
  std::string ProtocolName;
  std::optional<double> SeriesNumber;
  std::optional<double> InstanceNumber;
  std::optional<double> AcquisitionNumber;
  /// Dates are YYYYMMDD, times are HHMMSS.FFFFFF.
  std::string SeriesDate;
  std::string SeriesTime;
  std::string AcquisitionDate;
  std::string AcquisitionTime;
  std::string ContentTime;
  int Rows = 0;
  int Columns = 0;
  int Frames = 1;
  int SamplesPerPixel = 1;

  // Magnetic resonance.
  /// DICOM Patient Position, e.g. "HFP": head or feet first; prone, supine or on a side.
  std::string PatientPosition;
  std::vector<std::string> ScanningSequence;
  std::vector<std::string> ScanOptions;
  bool HasScanOptions = false; ///< The element exists, possibly empty.
  std::string SequenceName;
  std::string AcquisitionType; ///< "2D", "3D"
  std::optional<double> RepetitionTimeMs;
  std::optional<double> EchoTimeMs;
  std::optional<double> InversionTimeMs;
  std::optional<double> FlipAngleDeg;
  std::optional<double> DiffusionBValue; ///< s/mm^2
  std::string ContrastAgent;
  std::string ContrastStartTime; ///< HHMMSS.FFFFFF of the injection.
  /// Enhanced objects only: "FAT", "WATER", "NONE", ... and "T1", "T2", "DIFFUSION", ...
  std::string SpectralSuppression;
  std::string AcquisitionContrast;
  std::optional<double> TemporalPosition;
  std::optional<double> TriggerTimeMs;

  // Mammograms.
  std::string View;
  /// Meanings of the view modifier codes, e.g. "Magnification".
  std::vector<std::string> ViewModifiers;
  char Laterality = '?';
  /// Patient directions of rows and of columns in the form of the header ("A\R"). Empty if unknown.
  std::string PatientOrientation;
  Mammogram::Intent PresentationIntent = Mammogram::Intent::ForPresentation;
  std::optional<double> BodyPartThicknessMm;
  std::optional<double> PositionerPrimaryAngleDeg;
  std::optional<double> Magnification;
  /// Why the size of a pixel at the receptor is not known, a sentence. Empty if it is.
  std::string WhyNoPixelSize;
  std::string PaddleDescription;
  bool PartialView = false;
  bool ImplantPresent = false;
};

/// True if the file starts with a DICOM preamble (PS3.10), or like a little-endian data set or meta
/// information: older software wrote no preamble.
MAMMORAYDICOM_EXPORT bool HasDicomHeader(const std::string& path);

/**
 * Reads a DICOM file up to its pixels, which takes a fraction of a millisecond. Returns nothing if
 * the file does not start like a DICOM file: PS3.10, or a bare data set as older software stored
 * it. Throws InputError, one line that names the file, if the file cannot be read or is shorter
 * than its header and its uncompressed pixels require.
 */
MAMMORAYDICOM_EXPORT std::optional<DicomHeader> ReadDicomHeader(const std::string& path);

/**
 * Reads one header per image. An enhanced multi-frame MR object (Enhanced MR Image Storage, Legacy
 * Converted Enhanced MR) yields one per frame, in file order, with the frame's functional groups
 * merged in. Any other file yields the header of ReadDicomHeader. Empty if the file is no DICOM.
 */
MAMMORAYDICOM_EXPORT std::vector<DicomHeader> ReadDicomHeaders(const std::string& path);

/// Grid of a stack of slices. Order[k] is the index of the slice that lies on layer k.
struct SliceOrder
{
  VolumeGrid Grid;
  std::vector<std::size_t> Order;
};

/**
 * Sorts at least one slice of one series. Throws InputError, one line that names a file, unless the
 * slices are parallel, evenly spaced and at distinct positions, as ReadIntensitySlices requires.
 */
MAMMORAYDICOM_EXPORT SliceOrder FindSliceOrder(const std::vector<DicomHeader>& slices);

/// Reads the header of a mammogram that another DICOM object refers to. Throws InputError, one line
/// that names the file, unless it is a DICOM mammogram with UIDs and size.
MAMMORAYDICOM_EXPORT DicomHeader ReadMammogramHeader(const std::string& path);
}

#endif
