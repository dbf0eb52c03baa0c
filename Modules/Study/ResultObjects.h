// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_ResultObjects_h
#define mammoray_ResultObjects_h

#include "mammoray/Foundation/LabelVolume.h"
#include "mammoray/Foundation/Progress.h"
#include "mammoray/Study/RegisteredBreast.h"
#include "mammoray/Study/ResultFile.h"
#include "mammoray/XRay/PathLengthProjector.h"
#include "mammorayStudyModule.h"

#include <optional>
#include <string>
#include <vector>

namespace mammoray
{
/// What of a result is to be shown beside its mammogram.
struct ResultObjects
{
  /// The mammogram that was registered, DICOM MG.
  std::string Mammogram;
  /// Points of the volume frame, mm.
  std::vector<Vector3> Points;
  /// Lesions, a label each, in the frame of the registered label volume.
  std::optional<LabelVolume> Lesions;
  /// A folder with the slices of the MRI, DICOM, in whose frame the volume is; empty: none.
  std::string Mri;
  /// Voxels of the MRI in the compressed breast, and of the registration's field, mm.
  double MriSpacingMm = 1;
  double FieldSpacingMm = 3;
};

/**
 * Writes into `folder`, which is there, in the study of the mammogram:
 *
 * - of points and lesions, on the mammogram: lesions.dcm (segmentation of their shadows and of
 * where they may be), presentation.dcm (presentation state: ellipses, outlines, labels) and
 * report.dcm (measurement report);
 * - of an MRI: registration.dcm (deformable spatial registration, from the compressed breast's
 * frame of reference to the MRI's) and mri/ (a series in the former).
 *
 * Where a lesion may be is the ellipse of RegisteredBreast that holds 95 % of a normal
 * distribution, moved along its shadow. Throws InputError where mammogram or MRI are others than
 * the result's or of two patients, where a point is not in the breast or not on the mammogram,
 * DeviceError, Interrupted.
 */
MAMMORAYSTUDY_EXPORT void WriteResultObjects(const ResultFile& result,
  const RegisteredBreast& breast, const ResultObjects& objects, const ProjectorOptions& projector,
  const std::string& folder, const ProgressCallback& progress = {});
}

#endif
