// SPDX-License-Identifier: Apache-2.0
#include "Private/DicomElements.h"
#include "mammoray/Dicom/DicomWriter.h"
#include "mammoray/Foundation/Error.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>

namespace mammoray
{
namespace
{

constexpr const char* MrClass = "1.2.840.10008.5.1.4.1.1.4";

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

std::string Backslashed(std::initializer_list<double> values)
{
  std::string text;
  for (const double value : values)
  {
    text.append(text.empty() ? "" : "\\").append(DecimalString(value));
  }
  return text;
}

/// What all slices share.
DcmItem SeriesData(const IntensityVolume& volume, const DicomHeader& header)
{
  DcmItem data;
  AddCommon(data, MrClass, "MR", header.SeriesDescription, header.Identity);
  AddTexts(data,
    { { { 0x0008, 0x0008 }, EVR_CS, Backslashed(header.ImageType) },
      { { 0x0008, 0x0070 }, EVR_LO, header.Manufacturer },
      { { 0x0018, 0x0020 }, EVR_CS, Backslashed(header.ScanningSequence) },
      { { 0x0018, 0x0021 }, EVR_CS, "NONE" },
      { { 0x0018, 0x0023 }, EVR_CS, header.AcquisitionType },
      { { 0x0018, 0x0050 }, EVR_DS, DecimalString(volume.Spacing[2]) },
      { { 0x0018, 0x0088 }, EVR_DS, DecimalString(volume.Spacing[2]) },
      { { 0x0018, 0x0091 }, EVR_IS, "" }, // echo train length
      { { 0x0018, 0x1030 }, EVR_LO, header.ProtocolName },
      { { 0x0018, 0x5100 }, EVR_CS, header.PatientPosition },
      { { 0x0020, 0x000e }, EVR_UI,
        header.SeriesInstanceUid.empty() ? NewUid() : header.SeriesInstanceUid },
      { { 0x0020, 0x0052 }, EVR_UI,
        header.FrameOfReferenceUid.empty() ? NewUid() : header.FrameOfReferenceUid },
      { { 0x0020, 0x0060 }, EVR_CS, "" }, // both sides
      { { 0x0020, 0x1040 }, EVR_LO, "" } });
  const Vector3& row = volume.Direction[0];
  const Vector3& column = volume.Direction[1];
  AddTexts(data,
    { { { 0x0020, 0x0037 }, EVR_DS,
        Backslashed({ row[0], row[1], row[2], column[0], column[1], column[2] }) },
      { { 0x0028, 0x0004 }, EVR_CS, "MONOCHROME2" },
      { { 0x0028, 0x0030 }, EVR_DS, Backslashed({ volume.Spacing[1], volume.Spacing[0] }) } });
  if (header.HasScanOptions)
  {
    AddTexts(data, { { { 0x0018, 0x0022 }, EVR_CS, Backslashed(header.ScanOptions) } });
  }
  const auto text = [&data](const DcmTagKey& tag, DcmEVR type, const std::string& value)
  {
    if (!value.empty())
    {
      AddTexts(data, { { tag, type, value } });
    }
  };
  text({ 0x0008, 0x0021 }, EVR_DA, header.SeriesDate);
  text({ 0x0008, 0x0031 }, EVR_TM, header.SeriesTime);
  text({ 0x0008, 0x0022 }, EVR_DA, header.AcquisitionDate);
  text({ 0x0008, 0x0032 }, EVR_TM, header.AcquisitionTime);
  text({ 0x0018, 0x0010 }, EVR_LO, header.ContrastAgent);
  text({ 0x0018, 0x0024 }, EVR_SH, header.SequenceName);
  const auto number = [&](const DcmTagKey& tag, DcmEVR type, const std::optional<double>& value)
  { text(tag, type, value ? DecimalString(*value) : std::string()); };
  number({ 0x0018, 0x0080 }, EVR_DS, header.RepetitionTimeMs);
  number({ 0x0018, 0x0081 }, EVR_DS, header.EchoTimeMs);
  number({ 0x0018, 0x0082 }, EVR_DS, header.InversionTimeMs);
  number({ 0x0018, 0x1314 }, EVR_DS, header.FlipAngleDeg);
  number({ 0x0020, 0x0011 }, EVR_IS, header.SeriesNumber);
  number({ 0x0020, 0x0012 }, EVR_IS, header.AcquisitionNumber);
  number({ 0x0020, 0x0100 }, EVR_IS, header.TemporalPosition);
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
  AddShort(data, { 0x0028, 0x0002 }, 1); // samples per pixel
  AddShort(data, { 0x0028, 0x0010 }, static_cast<std::uint16_t>(volume.Size[1]));
  AddShort(data, { 0x0028, 0x0011 }, static_cast<std::uint16_t>(volume.Size[0]));
  AddShort(data, { 0x0028, 0x0100 }, 16);
  AddShort(data, { 0x0028, 0x0101 }, 16);
  AddShort(data, { 0x0028, 0x0102 }, 15);
  AddShort(data, { 0x0028, 0x0103 }, 0); // unsigned
  std::vector<std::uint16_t> stored(area);
  for (int layer = 0; layer < volume.Size[2]; ++layer)
  {
    const Vector3 at = volume.PointAt(0, 0, layer);
    AddTexts(data,
      { { { 0x0008, 0x0018 }, EVR_UI, NewUid() },
        { { 0x0020, 0x0013 }, EVR_IS, std::to_string(layer + 1) },
        { { 0x0020, 0x0032 }, EVR_DS, Backslashed({ at[0], at[1], at[2] }) } });
    const auto* values = volume.Voxels.data() + static_cast<std::size_t>(layer) * area;
    std::transform(values, values + area, stored.begin(),
      [](float value) { return static_cast<std::uint16_t>(std::lround(value)); });
    AddBytes(data, { 0x7fe0, 0x0010 }, EVR_OW, stored.data(), 2 * area);
    WriteDicom(data, paths[static_cast<std::size_t>(layer)]);
  }
}
}
