// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_DicomWriter_h
#define mammoray_DicomWriter_h

#include "mammoray/Dicom/DicomHeader.h"
#include "mammoray/Foundation/IntensityVolume.h"
#include "mammoray/Foundation/Mammogram.h"
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
  /// The mammogram that the image imitates; empty: the file refers to none.
  std::optional<DicomReference> Imitated;
  std::string SeriesDescription = "Synthetic mammogram";
  /// How the image was computed, a sentence or two, at most 1024 bytes.
  std::string Derivation;
};

/**
 * Writes a synthetic image as a DICOM mammogram (Digital Mammography X-Ray Image, PS3.3 section
 * A.26; For Presentation or For Processing as the mammogram says), marked as derived, 16 bits, not
 * compressed. ReadMammogram gives the same mammogram back. Its pixels must be whole numbers from 0
 * to 65535. A presentation's window reaches from 0 to FindWhite's value.
 *
 * The file holds nothing of the patient but what Identity says, and no private elements.
 *
 * Throws InputError when laterality, view or patient orientation is unknown (a mammogram must say
 * them), pixels or spacings are unusable, or the file cannot be written.
 */
MAMMORAYDICOM_EXPORT void WriteMammogram(const Mammogram& mammogram,
  const DicomMammogramOptions& options, const std::string& path);

/**
 * Writes the projections of one compression (tomosynthesis) as a Breast Projection X-Ray Image
 * (PS3.3 section A.74; For Presentation or For Processing as they say), a frame for each, 16 bits,
 * not compressed. ReadProjections gives the same back. All say the same but for their pixels,
 * SourceFootPixel and SourceToDetectorMm; what WriteMammogram asks of one is asked of each, and
 * SourceFootPixel. They are hung as DescribeProjection says, seen from the source.
 *
 * `axisHeightMm`: of the axis about which the source went, over the receptor, along the middle of
 * its pixels from the chest wall: the isocenter of the object lies where it leaves that edge.
 *
 * Throws InputError where WriteMammogram does, without projections and where they differ in what
 * they share.
 */
MAMMORAYDICOM_EXPORT void WriteProjections(const std::vector<Mammogram>& projections,
  const DicomMammogramOptions& options, double axisHeightMm, const std::string& path);

/// A lesion's shadow on an image.
struct DicomSegment
{
  /// Shown to the reader, at most 64 bytes.
  std::string Label;
  /// 1 inside, 0 outside; Rows * Columns values of the image, row by row.
  std::vector<unsigned char> Mask;
  /// Where the lesion may be, instead of where it was found.
  bool Uncertainty = false;
};

/**
 * Writes lesions on a projection image as a binary DICOM segmentation (PS3.3 section A.51), one
 * frame and segment each, numbered from 1, on the image's own pixels. Projections have no place in
 * space: each frame refers to the image as its source, locations preserved, and so lies over it.
 * `identity` says patient and study; the image's study for viewers to find both together.
 *
 * Throws InputError without segments, on a mask of another size, an unusable label, and when the
 * file cannot be written.
 */
MAMMORAYDICOM_EXPORT void WriteSegmentation(const std::vector<DicomSegment>& segments,
  const DicomReference& image, const DicomIdentity& identity, const std::string& path);

/// A unique identifier that no other object, series or study has.
MAMMORAYDICOM_EXPORT std::string NewDicomUid();

/**
 * Writes a volume (DICOM LPS) as a series of MR images (PS3.3 section A.4), one for each layer of
 * its grid, 16 bits, not compressed, numbered from 1. What the header says of patient, series and
 * sequence is written as it is, what it says of places and sizes comes from the volume; an empty
 * UID is made anew. ReadDicomHeader and ReadIntensitySeries give both back. Throws InputError
 * unless there is a path for each layer, on values that do not round to 0 to 65535, and when a file
 * cannot be written.
 */
MAMMORAYDICOM_EXPORT void WriteMrSeries(const IntensityVolume& volume, const DicomHeader& header,
  const std::vector<std::string>& paths);

/// A place of the MRI that was found on a mammogram. Pixels: continuous column and row, from 0 at
/// the centre of the first pixel.
struct DicomFinding
{
  using Pixel = std::array<double, 2>;
  /// Two ends of the major and two of the minor axis of an ellipse, as both standards of drawing
  /// want them.
  struct Ellipse
  {
    std::array<Pixel, 4> Ends{};
    /// One standard deviation along the axes, mm on the receptor, whatever the ellipse holds.
    double MajorSigmaMm = 0;
    double MinorSigmaMm = 0;
  };
  /// At most 64 bytes.
  std::string Label;
  Pixel Centre{ 0, 0 };
  /// In the MRI, DICOM LPS, mm.
  Vector3 VolumePoint{ 0, 0, 0 };
  std::optional<Ellipse> Uncertainty;
  /// Closed polygons around a lesion's shadow.
  std::vector<std::vector<Pixel>> Outlines;
};

/**
 * Writes a Grayscale Softcopy Presentation State (PS3.3 section A.33.1): the mammogram in the file
 * `mammogram` as its own header shows it (window or table of values, polarity), with each finding's
 * outlines and ellipse and, beside its centre, its text (`texts`, as many as findings). Patient and
 * study are the mammogram's, as the standard wants. Throws InputError where the mammogram cannot be
 * read or the file not be written.
 */
MAMMORAYDICOM_EXPORT void WritePresentationState(const std::vector<DicomFinding>& findings,
  const std::vector<std::string>& texts, const std::string& mammogram, const std::string& path);

/// What a report says beside its findings.
struct DicomReportContext
{
  /// 'L' or 'R'.
  char Laterality = 'L';
  /// The frame of reference of the findings' points in the MRI; empty: they are left out.
  std::string VolumeFrameUid;
  /// "good", "doubtful" or "none", and why not better.
  std::string Trust;
  std::vector<std::string> Reasons;
};

/**
 * Writes the findings as a measurement report (TID 1500 of PS3.16) in a Comprehensive 3D SR (PS3.3
 * section A.35.13), a measurement group (TID 1501) each: its point in the MRI, its point and
 * ellipse on the mammogram, standard deviations along the ellipse's axes, and how far the
 * registration is to be trusted; the observer is this software. In the mammogram's study. Throws
 * InputError without findings and when the file cannot be written.
 */
MAMMORAYDICOM_EXPORT void WriteMeasurementReport(const std::vector<DicomFinding>& findings,
  const DicomReportContext& context, const DicomReference& mammogram, const std::string& path);

/**
 * Writes a Deformable Spatial Registration (PS3.3 section A.39.2): `field` leads from points of the
 * frame of reference `registeredUid`, in which its grid lies, to those of `sourceUid` (DICOM LPS,
 * mm), so that what lies in the latter can be shown in the former. Throws InputError on a field
 * that is none and when the file cannot be written.
 */
MAMMORAYDICOM_EXPORT void WriteSpatialRegistration(const DisplacementField& field,
  const std::string& registeredUid, const std::string& sourceUid, const DicomIdentity& identity,
  const std::string& path);
}

#endif
