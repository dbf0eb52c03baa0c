// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_ResultObjects_h
#define mammoray_ResultObjects_h

#include "mammoray/Foundation/Progress.h"
#include "mammoray/Foundation/Volumes.h"
#include "mammoray/Study/RegisteredBreast.h"
#include "mammoray/Study/ResultFile.h"
#include "mammoray/XRay/PathLengthProjector.h"
#include "mammorayStudyModule.h"

#include <optional>
#include <string>
#include <vector>

namespace mammoray
{
/// Points, lesions and MRI that become DICOM objects of a result.
struct ResultObjects
{
  /// File of the registered mammogram (DICOM MG).
  std::string Mammogram;
  /// Points in the volume frame, mm.
  std::vector<Vector3> Points;
  /// Lesions, one label each, in the frame of the registered label volume.
  std::optional<LabelVolume> Lesions;
  /// Folder with the DICOM slices of the MRI, whose frame is the volume frame, and of several
  /// volumes the number (ReadMri); empty without MRI.
  std::string Mri;
  std::optional<int> MriSeries;
  /// Voxel sizes of the MRI in the compressed breast and of the displacement field, mm.
  double MriSpacingMm = 1;
  double FieldSpacingMm = 3;
};

/**
 * Writes DICOM objects of the mammogram's study into `folder`, which must exist:
 *
 * - for points and lesions: lesions.dcm (segmentation of shadows and of the regions where lesions
 *   may be), presentation.dcm (presentation state: ellipses, outlines, labels) and report.dcm
 *   (measurement report);
 * - for an MRI: registration.dcm (deformable spatial registration from the frame of reference of
 *   the compressed breast to that of the MRI) and mri/ (a series in the former).
 *
 * The region of a lesion is its shadow, widened by the 95 % ellipse of RegisteredBreast. Throws
 * InputError if mammogram or MRI are not those of the result or belong to two patients, or if a
 * point is outside the breast or the mammogram. Throws DeviceError without a device, and
 * Interrupted.
 */
MAMMORAYSTUDY_EXPORT void WriteResultObjects(const ResultFile& result,
  const RegisteredBreast& breast, const ResultObjects& objects, const ProjectorOptions& projector,
  const std::string& folder, const ProgressCallback& progress = {});
}

#endif
