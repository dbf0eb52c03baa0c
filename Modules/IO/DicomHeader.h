// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_DicomHeader_h
#define mammoray_DicomHeader_h

#include "mammoray/Foundation/Mammogram.h"
#include "mammoray/Foundation/Vector3.h"
#include "mammoray/Foundation/VolumeGrid.h"
#include "mammoray/IO/DicomIdentity.h"
#include "mammorayIOModule.h"

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace mammoray
{
/// What the header of a DICOM file says, as it says it. Texts are empty and numbers absent where it
/// is silent; several values of a text stand in a list.
struct DicomHeader
{
  std::string Path;
  /// Of a multi-frame object, from 1; 0: of all its frames, or of a single one.
  int Frame = 0;
  std::string SopClassUid;
  std::string SopInstanceUid;
  std::string SeriesInstanceUid;
  std::string FrameOfReferenceUid;
  /// Of patient and study.
  DicomIdentity Identity;
  std::string Modality;
  std::string Manufacturer;
  std::vector<std::string> ImageType;
  std::string SeriesDescription;
  std::string ProtocolName;
  std::optional<double> SeriesNumber;
  std::optional<double> InstanceNumber;
  std::optional<double> AcquisitionNumber;
  /// YYYYMMDD and HHMMSS.FFFFFF.
  std::string SeriesDate;
  std::string SeriesTime;
  std::string AcquisitionDate;
  std::string AcquisitionTime;
  std::string ContentTime;
  int Rows = 0;
  int Columns = 0;
  int Frames = 1;
  int SamplesPerPixel = 1;

  // Of slices.
  /// Centre of the first pixel and unit vectors along a row and a column, mm, DICOM LPS; absent
  /// unless all is said, with the pixels' distances.
  std::optional<Vector3> Position;
  Vector3 AlongRow{ 1, 0, 0 };
  Vector3 AlongColumn{ 0, 1, 0 };
  /// Distance of rows, then of columns, and of slices (0 where it is not said), mm.
  double RowSpacingMm = 0;
  double ColumnSpacingMm = 0;
  double SliceSpacingMm = 0;
  /// "HFP": head or feet first; prone, supine or on a side.
  std::string PatientPosition;

  // Of magnetic resonance.
  std::vector<std::string> ScanningSequence;
  std::vector<std::string> ScanOptions;
  bool HasScanOptions = false; ///< The element is there, empty or not.
  std::string SequenceName;
  std::string AcquisitionType; ///< "2D", "3D"
  std::optional<double> RepetitionTimeMs;
  std::optional<double> EchoTimeMs;
  std::optional<double> InversionTimeMs;
  std::optional<double> FlipAngleDeg;
  std::optional<double> DiffusionBValue; ///< s/mm^2
  std::string ContrastAgent;
  /// Of enhanced objects: "FAT", "WATER", "NONE" and the like, and "T1", "T2", "DIFFUSION" ...
  std::string SpectralSuppression;
  std::string AcquisitionContrast;
  std::optional<double> TemporalPosition;
  std::optional<double> TriggerTimeMs;

  // Of mammograms.
  std::string View;
  /// Meanings of the view's modifier codes: "Magnification".
  std::vector<std::string> ViewModifiers;
  char Laterality = '?';
  Mammogram::Intent PresentationIntent = Mammogram::Intent::ForPresentation;
  std::optional<double> BodyPartThicknessMm;
  std::optional<double> PositionerPrimaryAngleDeg;
  std::optional<double> Magnification;
  std::string PaddleDescription;
  bool PartialView = false;
  bool ImplantPresent = false;
};

/**
 * Reads a DICOM file up to its pixels: a fraction of a millisecond. Nothing for a file that does
 * not begin as DICOM files do (PS3.10, or a data set alone, as older software stored it). Throws
 * InputError, one line with the file, where it cannot be read, or is shorter than its header or its
 * uncompressed pixels need.
 */
MAMMORAYIO_EXPORT std::optional<DicomHeader> ReadDicomHeader(const std::string& path);

/**
 * The same of each image in the file: of an enhanced multi-frame MR object (Enhanced MR Image
 * Storage, Legacy Converted Enhanced MR) one for each frame, in their order, with what its
 * functional groups say of it; of any other the one that ReadDicomHeader reads. Empty for a file
 * that is no DICOM.
 */
MAMMORAYIO_EXPORT std::vector<DicomHeader> ReadDicomHeaders(const std::string& path);

/// The grid that slices lie on, and which of them lies on its first layer, its second, ...
struct SliceOrder
{
  VolumeGrid Grid;
  std::vector<std::size_t> Order;
};

/**
 * The order of at least one slice of one kind. Throws InputError, one line with a file, unless they
 * lie in parallel at even distances, each at a place of its own, as ReadIntensitySeries wants them.
 */
MAMMORAYIO_EXPORT SliceOrder FindSliceOrder(const std::vector<DicomHeader>& slices);

/// While one of these lives, DCMTK's log says nothing: what users need is in our exceptions. For
/// any thread.
MAMMORAYIO_EXPORT std::shared_ptr<void> SilenceDcmtk();

/// Throws InputError, one line that names the file, unless all elements of a DICOM file can be
/// read, those after the pixels, too: DCMTK leaves its stack at sequences that lie in one another
/// thousandfold.
MAMMORAYIO_EXPORT void CheckDicomElements(const std::string& path);
}

#endif
