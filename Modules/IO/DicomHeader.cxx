// SPDX-License-Identifier: Apache-2.0
#include "mammoray/IO/DicomHeader.h"

#include "Private/DicomFile.h"
#include "Private/MammogramViews.h"
#include "Private/SliceStack.h"
#include "mammoray/Foundation/Error.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

namespace mammoray
{
namespace
{
std::vector<std::string> Values(DcmItem& data, const DcmTagKey& tag)
{
  std::vector<std::string> values;
  DcmElement* element = nullptr;
  const unsigned long count =
    data.findAndGetElement(tag, element).good() && element ? element->getVM() : 0;
  for (unsigned long index = 0; index < count; ++index)
  {
    values.push_back(Printable(DicomText(data, tag, index)));
  }
  return values;
}

int Whole(DcmItem& data, const DcmTagKey& tag, int otherwise)
{
  const double value = DicomNumber(data, tag).value_or(otherwise);
  return value > 0 && value < 1e6 ? static_cast<int>(value) : otherwise;
}

void ReadImage(DcmItem& data, DicomHeader& header)
{
  header.SopClassUid = DicomText(data, DCM_SOPClassUID);
  header.SopInstanceUid = DicomText(data, DCM_SOPInstanceUID);
  header.SeriesInstanceUid = DicomText(data, DCM_SeriesInstanceUID);
  header.FrameOfReferenceUid = DicomText(data, DCM_FrameOfReferenceUID);
  header.Identity = ReadIdentity(data);
  header.Modality = Printable(DicomText(data, DCM_Modality));
  header.Manufacturer = Printable(DicomTexts(data, DCM_Manufacturer));
  header.ImageType = Values(data, DCM_ImageType);
  header.SeriesDescription = Printable(DicomTexts(data, DCM_SeriesDescription));
  header.ProtocolName = Printable(DicomTexts(data, DCM_ProtocolName));
  header.SeriesNumber = DicomNumber(data, DCM_SeriesNumber);
  header.InstanceNumber = DicomNumber(data, DCM_InstanceNumber);
  header.AcquisitionNumber = DicomNumber(data, DCM_AcquisitionNumber);
  header.SeriesDate = Printable(DicomText(data, DCM_SeriesDate));
  header.SeriesTime = Printable(DicomText(data, DCM_SeriesTime));
  header.AcquisitionDate = Printable(DicomText(data, DCM_AcquisitionDate));
  header.AcquisitionTime = Printable(DicomText(data, DCM_AcquisitionTime));
  header.ContentTime = Printable(DicomText(data, DCM_ContentTime));
  header.Rows = DicomShort(data, DCM_Rows).value_or(0);
  header.Columns = DicomShort(data, DCM_Columns).value_or(0);
  header.Frames = Whole(data, DCM_NumberOfFrames, 1);
  header.SamplesPerPixel = DicomShort(data, DCM_SamplesPerPixel).value_or(1);
}

void ReadSlice(DcmItem& data, DicomHeader& header)
{
  const std::vector<double> at = DicomNumbers(data, DCM_ImagePositionPatient, 3);
  const std::vector<double> axes = DicomNumbers(data, DCM_ImageOrientationPatient, 6);
  const std::vector<double> spacing = DicomNumbers(data, DCM_PixelSpacing, 2);
  header.PatientPosition = Printable(DicomText(data, DCM_PatientPosition));
  if (at.empty() || axes.empty() || spacing.empty() || !(spacing[0] > 0) || !(spacing[1] > 0))
  {
    return;
  }
  header.Position = Vector3{ at[0], at[1], at[2] };
  header.AlongRow = { axes[0], axes[1], axes[2] };
  header.AlongColumn = { axes[3], axes[4], axes[5] };
  header.RowSpacingMm = spacing[0];
  header.ColumnSpacingMm = spacing[1];
  header.SliceSpacingMm = DicomSliceSpacing(data);
}

void ReadResonance(DcmItem& data, DicomHeader& header)
{
  header.ScanningSequence = Values(data, DCM_ScanningSequence);
  header.ScanOptions = Values(data, DCM_ScanOptions);
  header.HasScanOptions = data.tagExists(DCM_ScanOptions);
  header.SequenceName = Printable(DicomText(data, DCM_SequenceName));
  header.AcquisitionType = Printable(DicomText(data, DCM_MRAcquisitionType));
  header.RepetitionTimeMs = DicomNumber(data, DCM_RepetitionTime);
  header.EchoTimeMs = DicomNumber(data, DCM_EchoTime);
  header.InversionTimeMs = DicomNumber(data, DCM_InversionTime);
  header.FlipAngleDeg = DicomNumber(data, DCM_FlipAngle);
  Float64 diffusion = 0;
  if (data.findAndGetFloat64(DCM_DiffusionBValue, diffusion).good() && std::isfinite(diffusion))
  {
    header.DiffusionBValue = diffusion;
  }
  header.ContrastAgent = Printable(DicomTexts(data, DCM_ContrastBolusAgent));
  header.TemporalPosition = DicomNumber(data, DCM_TemporalPositionIdentifier);
  header.TriggerTimeMs = DicomNumber(data, DCM_TriggerTime);
}

void ReadMammography(DcmItem& data, DicomHeader& header)
{
  header.View = MammogramViewOf(data);
  header.ViewModifiers = MammogramViewModifiers(data);
  header.Laterality = MammogramLaterality(data);
  header.PresentationIntent = MammogramIntent(data);
  header.BodyPartThicknessMm = DicomNumber(data, DCM_BodyPartThickness);
  header.PositionerPrimaryAngleDeg = DicomNumber(data, DCM_PositionerPrimaryAngle);
  header.Magnification = DicomNumber(data, DCM_EstimatedRadiographicMagnificationFactor);
  header.PaddleDescription = Printable(DicomTexts(data, DCM_PaddleDescription));
  header.PartialView = DicomText(data, DCM_PartialView) == "YES";
  header.ImplantPresent = DicomText(data, DCM_BreastImplantPresent) == "YES";
}

/// Whether the file is too short for the pixels that its header promises; of compressed ones that
/// cannot be told.
bool LacksPixels(const DicomFile& file, const DicomHeader& header)
{
  const DcmXfer syntax(file.Data().getOriginalXfer());
  const double bits = DicomShort(file.Data(), DCM_BitsAllocated).value_or(0);
  if (syntax.isEncapsulated() || syntax.getStreamCompression() != ESC_none)
  {
    return false;
  }
  const double bytes = static_cast<double>(header.Rows) * header.Columns * header.Frames *
    header.SamplesPerPixel * bits / 8;
  // Half-resolved colours (YBR_FULL_422) take two thirds.
  const double least = header.SamplesPerPixel > 1 ? bytes / 2 : bytes;
  std::error_code problem;
  const auto size = std::filesystem::file_size(header.Path, problem);
  // 132: the preamble.
  return !problem && static_cast<double>(size) < 132 + least;
}
}

std::optional<DicomHeader> ReadDicomHeader(const std::string& path)
{
  if (!HasDicomHeader(path))
  {
    return std::nullopt;
  }
  const DicomFile file(path, "DICOM", DicomExtent::Header);
  DicomHeader header;
  header.Path = path;
  ReadImage(file.Data(), header);
  if (header.SopClassUid.empty())
  {
    // A DICOMDIR has it in its meta information only.
    header.SopClassUid = file.StorageClass();
  }
  ReadSlice(file.Data(), header);
  ReadResonance(file.Data(), header);
  ReadMammography(file.Data(), header);
  if (LacksPixels(file, header))
  {
    throw InputError(path + ": expected DICOM, found a file that is cut short");
  }
  return header;
}

SliceOrder FindSliceOrder(const std::vector<DicomHeader>& slices)
{
  std::vector<VolumeSlice> places;
  for (const DicomHeader& header : slices)
  {
    if (!header.Position)
    {
      throw InputError(header.Path +
        ": expected image position, orientation and a positive pixel spacing, found some of them "
        "missing");
    }
    places.push_back({ header.Path, header.Columns, header.Rows, *header.Position, header.AlongRow,
      header.AlongColumn, header.RowSpacingMm, header.ColumnSpacingMm, header.SliceSpacingMm, {} });
  }
  SliceOrder result{ FindSliceGrid(places, false), std::vector<std::size_t>(slices.size()) };
  for (std::size_t slice = 0; slice < slices.size(); ++slice)
  {
    const double layer = result.Grid.ContinuousIndex(*slices[slice].Position)[2];
    result.Order[static_cast<std::size_t>(std::lround(layer))] = slice;
  }
  return result;
}
}
