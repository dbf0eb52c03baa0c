// SPDX-License-Identifier: Apache-2.0
#include "Private/DicomElements.h"
#include "mammoray/Dicom/DicomWriter.h"
#include "mammoray/Foundation/Error.h"

#include <algorithm>
#include <cmath>

namespace mammoray
{
namespace
{
void CheckSeries(const IntensityVolume& volume, const std::vector<std::string>& paths)
{
  volume.Validate("MR series");
  if (paths.size() != static_cast<std::size_t>(volume.Size[2]) || volume.Size[0] > 65535 ||
    volume.Size[1] > 65535)
  {
    throw InputError("MR series: expected a path for each of " + std::to_string(volume.Size[2]) +
      " layers of at most 65535 rows and columns, found " + std::to_string(paths.size()) +
      " paths for layers of " + std::to_string(volume.Size[0]) + " x " +
      std::to_string(volume.Size[1]));
  }
  const auto bad = std::find_if_not(volume.Voxels.begin(), volume.Voxels.end(),
    [](float value) { return value >= 0 && std::round(value) <= 65535; });
  if (bad != volume.Voxels.end())
  {
    throw InputError("MR series: expected values from 0 to 65535, found " + std::to_string(*bad));
  }
}

std::string Backslashed(const std::vector<std::string>& values)
{
  std::string text;
  for (const std::string& value : values)
  {
    text.append(text.empty() ? "" : "\\").append(value);
  }
  return text;
}

/// The elements that all slices share.
DcmItem SeriesData(const IntensityVolume& volume, const DicomHeader& header)
{
  const Vector3& row = volume.Direction[0];
  const Vector3& column = volume.Direction[1];
  const auto uid = [](const std::string& given) { return given.empty() ? NewUid() : given; };
  DcmItem data;
  AddCommon(data, UID_MRImageStorage, "MR", header.SeriesDescription, header.Identity);
  AddPixelDescription(data, volume.Size[0], volume.Size[1], 16);
  Add(data,
    { { DCM_ImageType, Backslashed(header.ImageType) }, { DCM_Manufacturer, header.Manufacturer },
      { DCM_ScanningSequence, Backslashed(header.ScanningSequence) },
      { DCM_SequenceVariant, "NONE" }, { DCM_MRAcquisitionType, header.AcquisitionType },
      { DCM_SliceThickness, volume.Spacing[2] }, { DCM_SpacingBetweenSlices, volume.Spacing[2] },
      { DCM_EchoTrainLength, "" }, { DCM_ProtocolName, header.ProtocolName },
      { DCM_PatientPosition, header.PatientPosition },
      { DCM_SeriesInstanceUID, uid(header.SeriesInstanceUid) },
      { DCM_FrameOfReferenceUID, uid(header.FrameOfReferenceUid) },
      { DCM_Laterality, "" }, // both sides
      { DCM_PositionReferenceIndicator, "" },
      { DCM_ImageOrientationPatient, { row[0], row[1], row[2], column[0], column[1], column[2] } },
      { DCM_PixelSpacing, { volume.Spacing[1], volume.Spacing[0] } },
      { DCM_SeriesDate, IfAny(header.SeriesDate) }, { DCM_SeriesTime, IfAny(header.SeriesTime) },
      { DCM_AcquisitionDate, IfAny(header.AcquisitionDate) },
      { DCM_AcquisitionTime, IfAny(header.AcquisitionTime) },
      { DCM_ContrastBolusAgent, IfAny(header.ContrastAgent) },
      { DCM_SequenceName, IfAny(header.SequenceName) },
      { DCM_RepetitionTime, header.RepetitionTimeMs }, { DCM_EchoTime, header.EchoTimeMs },
      { DCM_InversionTime, header.InversionTimeMs }, { DCM_FlipAngle, header.FlipAngleDeg },
      { DCM_SeriesNumber, header.SeriesNumber },
      { DCM_AcquisitionNumber, header.AcquisitionNumber },
      { DCM_TemporalPositionIdentifier, header.TemporalPosition } });
  if (header.HasScanOptions)
  {
    Add(data, { { DCM_ScanOptions, Backslashed(header.ScanOptions) } });
  }
  return data;
}
}

std::string NewDicomUid()
{
  return NewUid();
}

void WriteMrSeries(const IntensityVolume& volume, const DicomHeader& header,
  const std::vector<std::string>& paths)
{
  CheckSeries(volume, paths);
  DcmItem data = SeriesData(volume, header);
  const std::size_t area =
    static_cast<std::size_t>(volume.Size[0]) * static_cast<std::size_t>(volume.Size[1]);
  std::vector<std::uint16_t> stored(area);
  for (int layer = 0; layer < volume.Size[2]; ++layer)
  {
    Add(data,
      { { DCM_SOPInstanceUID, NewUid() }, { DCM_InstanceNumber, layer + 1 },
        { DCM_ImagePositionPatient, volume.PointAt(0, 0, layer) } });
    const auto* values = volume.Voxels.data() + static_cast<std::size_t>(layer) * area;
    std::transform(values, values + area, stored.begin(),
      [](float value) { return static_cast<std::uint16_t>(std::lround(value)); });
    AddBulk(data, DCM_PixelData, stored);
    WriteDicom(data, paths[static_cast<std::size_t>(layer)]);
  }
}
}
