// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_DicomWriter_h
#define mammoray_DicomWriter_h

#include "mammoray/Dicom/DicomHeader.h"
#include "mammoray/Foundation/Mammogram.h"
#include "mammoray/Foundation/Volumes.h"
#include "mammoray/IO/LabelVolumeIO.h"
#include "mammorayDicomModule.h"

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace mammoray
{
struct DicomMammogramOptions
{
  DicomIdentity Identity;
  /// The mammogram that the image simulates. If absent, the file refers to no mammogram.
  std::optional<DicomHeader> Imitated;
  std::string SeriesDescription = "Synthetic mammogram";
  /// A sentence or two on how the image was computed, at most 1024 bytes.
  std::string Derivation;
};

/**
 * Writes a synthetic image as a DICOM mammogram (Digital Mammography X-Ray Image, PS3.3 A.26),
 * marked as derived, 16 bits, uncompressed, For Presentation or For Processing as the mammogram
 * states. ReadMammogram returns the same mammogram. Pixels must be whole numbers from 0 to 65535.
 * The window of a presentation reaches from 0 to the value of FindWhite.
 *
 * The file contains the patient data in Identity and no other, and no private elements.
 *
 * Throws InputError if laterality, view or patient orientation is unknown (DICOM requires them), if
 * pixels or spacings are invalid, or if the file cannot be written.
 */
MAMMORAYDICOM_EXPORT void WriteMammogram(const Mammogram& mammogram,
  const DicomMammogramOptions& options, const std::string& path);

/**
 * Writes the projections of one compression (tomosynthesis) as a Breast Projection X-Ray Image
 * (PS3.3 A.74) with one frame each, 16 bits, uncompressed. ReadProjections returns the same
 * projections. Each must be valid for WriteMammogram and have SourceFootPixel. They may differ only
 * in pixels, SourceFootPixel and SourceToDetectorMm. They are oriented as DescribeProjection
 * orients them, seen from the source.
 *
 * `axisHeightMm` is the height above the receptor of the axis about which the source moved. The
 * isocenter of the object is the point of that axis above the middle of the chest-wall edge.
 *
 * Throws InputError as WriteMammogram does, if there are no projections, and if they differ in what
 * they must share.
 */
MAMMORAYDICOM_EXPORT void WriteProjections(const std::vector<Mammogram>& projections,
  const DicomMammogramOptions& options, double axisHeightMm, const std::string& path);

/// A lesion's shadow on an image.
struct DicomSegment
{
  /// Displayed text, at most 64 bytes.
  std::string Label;
  /// 1 inside, 0 outside; Rows * Columns values, row by row.
  std::vector<unsigned char> Mask;
  /// True for the region where the lesion may be, false for its shadow.
  bool Uncertainty = false;
};

/**
 * Writes lesions on a projection image as a binary DICOM segmentation (PS3.3 A.51) on the pixels of
 * the image, with one frame and one segment each, numbered from 1. Projections have no position in
 * space: each frame refers to the image as its source, with locations preserved. `identity` is
 * patient and study; viewers find both objects together if it names the study of the image.
 *
 * Throws InputError without segments, if a mask has another size, if a label is invalid, and if the
 * file cannot be written.
 */
MAMMORAYDICOM_EXPORT void WriteSegmentation(const std::vector<DicomSegment>& segments,
  const DicomHeader& image, const DicomIdentity& identity, const std::string& path);

/// Generates a UID for an object, a series or a study.
MAMMORAYDICOM_EXPORT std::string NewDicomUid();

/**
 * Writes a volume (DICOM LPS) as a series of MR images (PS3.3 A.4), 16 bits, uncompressed, one per
 * layer of the grid, numbered from 1. `header` supplies patient, series and sequence; the volume
 * supplies positions and sizes. An empty UID is replaced by a new one. ReadDicomHeader and
 * ReadIntensitySeries return both. Throws InputError unless there is one path per layer, if a value
 * does not round to [0, 65535], and if a file cannot be written.
 */
MAMMORAYDICOM_EXPORT void WriteMrSeries(const IntensityVolume& volume, const DicomHeader& header,
  const std::vector<std::string>& paths);

/// A point of the MRI and its position on a mammogram. Pixel positions are continuous (column,
/// row); (0, 0) is the centre of the first pixel.
struct DicomFinding
{
  using Pixel = std::array<double, 2>;
  /// Two end points of the major axis, then two of the minor axis, as SR and GSPS store ellipses.
  struct Ellipse
  {
    std::array<Pixel, 4> Ends{};
    /// Standard deviations along the axes, mm on the receptor, independent of the ellipse's size.
    double MajorSigmaMm = 0;
    double MinorSigmaMm = 0;
  };
  /// At most 64 bytes.
  std::string Label;
  Pixel Centre{ 0, 0 };
  /// Point in the MRI, DICOM LPS, mm.
  Vector3 VolumePoint{ 0, 0, 0 };
  std::optional<Ellipse> Uncertainty;
  /// Closed polygons around the shadow of a lesion.
  std::vector<std::vector<Pixel>> Outlines;
};

/**
 * Writes a Grayscale Softcopy Presentation State (PS3.3 A.33.1). It displays the file `mammogram`
 * as its own header does (window or look-up table, polarity) and adds the outlines and ellipse of
 * each finding, with its text from `texts` beside its centre. Patient and study are those of the
 * mammogram, as DICOM requires. Throws InputError if the mammogram cannot be read or the file not
 * be written, and unless there is one text per finding.
 */
MAMMORAYDICOM_EXPORT void WritePresentationState(const std::vector<DicomFinding>& findings,
  const std::vector<std::string>& texts, const std::string& mammogram, const std::string& path);

/// Context of a report's findings.
struct DicomReportContext
{
  /// 'L' or 'R'.
  char Laterality = 'L';
  /// Frame of reference of DicomFinding::VolumePoint. If empty, these points are omitted.
  std::string VolumeFrameUid;
  /// "good", "doubtful" or "none", and the reasons against a better level.
  std::string Trust;
  std::vector<std::string> Reasons;
};

/**
 * Writes the findings as a measurement report (TID 1500 of PS3.16) in a Comprehensive 3D SR (PS3.3
 * A.35.13) of the mammogram's study. Each finding is a measurement group (TID 1501): its point in
 * the MRI, its point and ellipse on the mammogram, standard deviations along the axes of the
 * ellipse, and the trust in the registration. The observer is this software. Throws InputError
 * without findings and if the file cannot be written.
 */
MAMMORAYDICOM_EXPORT void WriteMeasurementReport(const std::vector<DicomFinding>& findings,
  const DicomReportContext& context, const DicomHeader& mammogram, const std::string& path);

/**
 * Writes a Deformable Spatial Registration (PS3.3 A.39.2). `field` maps points of the frame of
 * reference `registeredUid`, in which its grid is defined, to the frame `sourceUid` (DICOM LPS,
 * mm), so that images in the latter can be shown in the former. Throws InputError on an invalid
 * field and if the file cannot be written.
 */
MAMMORAYDICOM_EXPORT void WriteSpatialRegistration(const DisplacementField& field,
  const std::string& registeredUid, const std::string& sourceUid, const DicomIdentity& identity,
  const std::string& path);
}

#endif
