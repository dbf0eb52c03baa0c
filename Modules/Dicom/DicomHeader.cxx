// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Dicom/DicomHeader.h"

#include "Private/DicomFile.h"
#include "Private/DicomFrames.h"
#include "Private/MammogramViews.h"
#include "Private/SliceStack.h"
#include "mammoray/Foundation/Error.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <utility>

namespace mammoray
{
namespace
{
/// The text in a form that is safe to show, at most 256 bytes: searches for patterns need a stack
/// as deep as a text is long.
std::string Shown(const std::string& text)
{
  constexpr std::size_t most = 256;
  return EscapeControls(text.substr(0, most));
}

std::vector<std::string> Values(DcmItem& data, const DcmTagKey& tag)
{
  std::vector<std::string> values;
  DcmElement* element = nullptr;
  const unsigned long count =
    data.findAndGetElement(tag, element).good() && element ? element->getVM() : 0;
  for (unsigned long index = 0; index < std::min(count, 32UL); ++index)
  {
    values.push_back(Shown(DicomText(data, tag, index)));
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
  header.Modality = Shown(DicomText(data, DCM_Modality));
  header.Manufacturer = Shown(DicomTexts(data, DCM_Manufacturer));
  header.ImageType = Values(data, DCM_ImageType);
  header.SeriesDescription = Shown(DicomTexts(data, DCM_SeriesDescription));
  header.ProtocolName = Shown(DicomTexts(data, DCM_ProtocolName));
  header.SeriesNumber = DicomNumber(data, DCM_SeriesNumber);
  header.InstanceNumber = DicomNumber(data, DCM_InstanceNumber);
  header.AcquisitionNumber = DicomNumber(data, DCM_AcquisitionNumber);
  header.SeriesDate = Shown(DicomText(data, DCM_SeriesDate));
  header.SeriesTime = Shown(DicomText(data, DCM_SeriesTime));
  header.AcquisitionDate = Shown(DicomText(data, DCM_AcquisitionDate));
  header.AcquisitionTime = Shown(DicomText(data, DCM_AcquisitionTime));
  header.ContentTime = Shown(DicomText(data, DCM_ContentTime));
  header.Rows = DicomShort(data, DCM_Rows).value_or(0);
  header.Columns = DicomShort(data, DCM_Columns).value_or(0);
  header.Frames = Whole(data, DCM_NumberOfFrames, 1);
  header.SamplesPerPixel = DicomShort(data, DCM_SamplesPerPixel).value_or(1);
}

/// A double (FD), which most numbers of enhanced objects are.
std::optional<double> Double(DcmItem& data, const DcmTagKey& tag)
{
  Float64 value = 0;
  return data.findAndGetFloat64(tag, value).good() && std::isfinite(value) ? std::optional(value)
                                                                           : std::nullopt;
}

void ReadResonance(DcmItem& data, DicomHeader& header)
{
  header.ScanningSequence = Values(data, DCM_ScanningSequence);
  header.ScanOptions = Values(data, DCM_ScanOptions);
  header.HasScanOptions = data.tagExists(DCM_ScanOptions);
  header.SequenceName = Shown(DicomText(data, DCM_SequenceName));
  header.AcquisitionType = Shown(DicomText(data, DCM_MRAcquisitionType));
  header.RepetitionTimeMs = DicomNumber(data, DCM_RepetitionTime);
  header.EchoTimeMs = DicomNumber(data, DCM_EchoTime);
  header.InversionTimeMs = DicomNumber(data, DCM_InversionTime);
  header.FlipAngleDeg = DicomNumber(data, DCM_FlipAngle);
  header.DiffusionBValue = Double(data, DCM_DiffusionBValue);
  header.ContrastAgent = Shown(DicomTexts(data, DCM_ContrastBolusAgent));
  header.ContrastStartTime = Shown(DicomText(data, DCM_ContrastBolusStartTime));
  header.TemporalPosition = DicomNumber(data, DCM_TemporalPositionIdentifier);
  header.TriggerTimeMs = DicomNumber(data, DCM_TriggerTime);
}

bool SaysYes(DcmItem& data, const DcmTagKey& tag)
{
  return DicomText(data, tag) == "YES";
}

/// YYYYMMDD and HHMMSS.FFFFFF of a date and time (DT), as far as it goes.
void SplitMoment(const std::string& moment, std::string& date, std::string& time)
{
  if (moment.size() >= 14)
  {
    date = moment.substr(0, 8);
    time = moment.substr(8, moment.find_first_of("+-&") - 8);
  }
}

/// Reads elements that enhanced MR objects have in place of the older ones.
void ReadEnhanced(DcmItem& data, DicomHeader& header)
{
  header.SpectralSuppression = Shown(DicomText(data, DCM_SpectrallySelectedSuppression));
  header.AcquisitionContrast = Shown(DicomText(data, DCM_AcquisitionContrast));
  const auto set = [](std::optional<double>& number, const auto& value)
  { number = value ? std::optional<double>(*value) : number; };
  if (!header.EchoTimeMs)
  {
    header.EchoTimeMs = Double(data, DCM_EffectiveEchoTime);
  }
  if (!header.InversionTimeMs)
  {
    header.InversionTimeMs = Double(data, DCM_InversionTimes);
  }
  if (header.ScanningSequence.empty())
  {
    const std::string echo = DicomText(data, DCM_EchoPulseSequence);
    const auto add = [&header](bool said, const char* term)
    {
      if (said)
      {
        header.ScanningSequence.emplace_back(term);
      }
    };
    add(echo == "SPIN" || echo == "BOTH", "SE");
    add(echo == "GRADIENT" || echo == "BOTH", "GR");
    add(SaysYes(data, DCM_InversionRecovery), "IR");
    add(SaysYes(data, DCM_EchoPlanarPulseSequence), "EP");
  }
  if (header.SequenceName.empty())
  {
    header.SequenceName = Shown(DicomText(data, DCM_PulseSequenceName));
  }
  // The type of the frame counts before that of the object.
  if (const std::vector<std::string> type = Values(data, DCM_FrameType); !type.empty())
  {
    header.ImageType = type;
  }
  const std::string component = DicomText(data, DCM_ComplexImageComponent);
  if (component == "PHASE" || component == "REAL" || component == "IMAGINARY")
  {
    header.ImageType.push_back(component == "PHASE" ? "P" : component.substr(0, 1));
  }
  SplitMoment(DicomText(data, DCM_AcquisitionDateTime), header.AcquisitionDate,
    header.AcquisitionTime);
  SplitMoment(DicomText(data, DCM_FrameAcquisitionDateTime), header.AcquisitionDate,
    header.AcquisitionTime);
  set(header.TemporalPosition, DicomUnsigned(data, DCM_TemporalPositionIndex));
  set(header.AcquisitionNumber, DicomShort(data, DCM_FrameAcquisitionNumber));
  set(header.TriggerTimeMs, Double(data, DCM_NominalCardiacTriggerDelayTime));
  if (SaysYes(data, DCM_ContrastBolusAgentAdministered) && header.ContrastAgent.empty())
  {
    header.ContrastAgent = "administered";
  }
  const std::string side = DicomText(data, DCM_FrameLaterality);
  header.Laterality = side == "L" || side == "R" ? side[0] : header.Laterality;
}

void ReadMammography(DcmItem& data, DicomHeader& header)
{
  header.View = MammogramViewOf(data);
  header.ViewModifiers = MammogramViewModifiers(data);
  header.Laterality = MammogramLaterality(data);
  header.PatientOrientation = DicomTexts(data, DCM_PatientOrientation);
  header.PresentationIntent = MammogramIntent(data);
  header.BodyPartThicknessMm = DicomNumber(data, DCM_BodyPartThickness);
  header.PositionerPrimaryAngleDeg = DicomNumber(data, DCM_PositionerPrimaryAngle);
  header.Magnification = DicomNumber(data, DCM_EstimatedRadiographicMagnificationFactor);
  if (header.Modality != "MR")
  {
    ReceptorSpacingOf(data, header.WhyNoPixelSize);
    NoteContradictions(data, header.Path);
  }
  header.PaddleDescription = Shown(DicomTexts(data, DCM_PaddleDescription));
  header.PartialView = SaysYes(data, DCM_PartialView);
  header.ImplantPresent = SaysYes(data, DCM_BreastImplantPresent);
}

/// True if the file is too short for the pixels that its header promises; false for compressed
/// ones, whose size is unknown.
bool LacksPixels(const DicomFile& file, const DicomHeader& header)
{
  const DcmXfer syntax(file.Data().getOriginalXfer());
  const double bits = DicomShort(file.Data(), DCM_BitsAllocated).value_or(0);
  if (IsEncapsulated(syntax) || syntax.getStreamCompression() != ESC_none)
  {
    return false;
  }
  const double bytes = static_cast<double>(header.Rows) * header.Columns * header.Frames *
    header.SamplesPerPixel * bits / 8;
  // Half-resolved colours (YBR_FULL_422) take two thirds.
  const double least = header.SamplesPerPixel > 1 ? bytes / 2 : bytes;
  std::error_code problem;
  const auto size = std::filesystem::file_size(header.Path, problem);
  return !problem && static_cast<double>(size) < least;
}

DicomHeader ReadElements(DcmItem& data, const std::string& path)
{
  DicomHeader header;
  header.Path = path;
  ReadImage(data, header);
  static_cast<SlicePlace&>(header) = ReadSlicePlace(data);
  header.PatientPosition = Shown(DicomText(data, DCM_PatientPosition));
  ReadResonance(data, header);
  ReadMammography(data, header);
  ReadEnhanced(data, header);
  return header;
}

DicomHeader ReadObject(const DicomFile& file, const std::string& path)
{
  DicomHeader header = ReadElements(file.Data(), path);
  if (header.SopClassUid.empty())
  {
    // A DICOMDIR has it in its meta information only.
    header.SopClassUid = file.StorageClass();
  }
  if (LacksPixels(file, header))
  {
    throw InputError(path + ": expected DICOM, found a file that is cut short");
  }
  return header;
}
}

std::optional<DicomHeader> ReadDicomHeader(const std::string& path)
{
  const std::unique_ptr<DicomFile> file = DicomFile::OpenIfDicom(path, DicomExtent::Header);
  return file ? std::optional(ReadObject(*file, path)) : std::nullopt;
}

std::vector<DicomHeader> ReadDicomHeaders(const std::string& path)
{
  const std::unique_ptr<DicomFile> file = DicomFile::OpenIfDicom(path, DicomExtent::Header);
  if (!file)
  {
    return {};
  }
  const DicomHeader whole = ReadObject(*file, path);
  if (!HasResonanceFrames(file->Data()))
  {
    return { whole };
  }
  const DicomFrames frames(file->Data(), path);
  std::vector<DicomHeader> headers;
  headers.reserve(frames.Count());
  for (std::size_t frame = 0; frame < frames.Count(); ++frame)
  {
    const std::unique_ptr<DcmItem> data = frames.Flat(frame);
    DicomHeader header = ReadElements(*data, path);
    header.Frame = static_cast<int>(frame) + 1;
    headers.push_back(std::move(header));
  }
  return headers;
}

SliceOrder FindSliceOrder(const std::vector<DicomHeader>& slices)
{
  std::vector<VolumeSlice> places;
  places.reserve(slices.size());
  for (const DicomHeader& header : slices)
  {
    places.push_back({ header, header.Path, header.Columns, header.Rows, {} });
  }
  SliceOrder result{ FindSliceGrid(places, false), std::vector<std::size_t>(slices.size()) };
  for (std::size_t slice = 0; slice < slices.size(); ++slice)
  {
    const double layer = result.Grid.ContinuousIndex(*slices[slice].Position)[2];
    result.Order[static_cast<std::size_t>(std::lround(layer))] = slice;
  }
  return result;
}

DicomHeader ReadMammogramHeader(const std::string& path)
{
  const std::optional<DicomHeader> header = ReadDicomHeader(path);
  if (!header || header->Modality != "MG")
  {
    throw InputError(path + ": expected a DICOM mammogram (modality MG), found " +
      (header ? "modality '" + header->Modality + "'" : "no DICOM header"));
  }
  std::string missing;
  for (const auto& [isThere, name] :
    { std::pair{ !header->SopClassUid.empty(), "SOP Class UID (0008,0016)" },
      { !header->SopInstanceUid.empty(), "SOP Instance UID (0008,0018)" },
      { !header->Identity.StudyInstanceUid.empty(), "Study Instance UID (0020,000D)" },
      { !header->SeriesInstanceUid.empty(), "Series Instance UID (0020,000E)" },
      { header->Rows > 0, "Rows (0028,0010)" }, { header->Columns > 0, "Columns (0028,0011)" } })
  {
    missing += isThere ? "" : (missing.empty() ? "" : ", ") + std::string(name);
  }
  if (!missing.empty())
  {
    throw InputError(path +
      ": expected a mammogram that other objects can refer to, found none of its " + missing);
  }
  return *header;
}

void CheckDicomText(const std::string& text, const std::string& what)
{
  const bool bad = std::any_of(text.begin(), text.end(),
    [](char c) { return c == '\\' || static_cast<unsigned char>(c) < 0x20 || c == 0x7f; });
  if (bad || text.size() > 64)
  {
    throw InputError(what +
      ": expected at most 64 bytes without '\\' and control characters, found " +
      (bad ? "some" : std::to_string(text.size()) + " bytes"));
  }
}
}
