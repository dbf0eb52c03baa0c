// SPDX-License-Identifier: Apache-2.0
// The frames of a segmentation are read from the data set: DCMTK's dcmseg requires attributes that
// reading labels does not need.
#include "mammoray/Dicom/DicomReader.h"

#include "Private/DicomFile.h"
#include "Private/DicomFrames.h"
#include "Private/FramePixels.h"
#include "Private/SliceStack.h"
#include "mammoray/Dicom/DicomHeader.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/GuardedRead.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>

namespace mammoray
{
namespace
{
namespace fs = std::filesystem;

void SetGeometry(VolumeSlice& slice, DcmItem& position, DcmItem& orientation, DcmItem& measures)
{
  const std::vector<double> at = DicomNumbers(position, DCM_ImagePositionPatient, 3);
  const std::vector<double> axes = DicomNumbers(orientation, DCM_ImageOrientationPatient, 6);
  const std::vector<double> spacing = DicomNumbers(measures, DCM_PixelSpacing, 2);
  if (at.empty() || axes.empty() || spacing.empty() || !(spacing[0] > 0) || !(spacing[1] > 0))
  {
    throw InputError(slice.Name +
      ": expected image position, orientation and a positive pixel spacing, found some of them "
      "missing");
  }
  slice.Position = { at[0], at[1], at[2] };
  slice.AlongRow = { axes[0], axes[1], axes[2] };
  slice.AlongColumn = { axes[3], axes[4], axes[5] };
  slice.RowSpacing = spacing[0];
  slice.ColumnSpacing = spacing[1];
  // 1e-3: directions are written with five digits or so.
  if (std::abs(Norm(slice.AlongRow) - 1) > 1e-3 || std::abs(Norm(slice.AlongColumn) - 1) > 1e-3 ||
    std::abs(Dot(slice.AlongRow, slice.AlongColumn)) > 1e-3)
  {
    throw InputError(slice.Name +
      ": image orientation: expected two unit vectors at right angles, found '" +
      DicomTexts(orientation, DCM_ImageOrientationPatient) + "'");
  }
  slice.SliceSpacing = DicomSliceSpacing(measures);
}

/// The frames of a segmentation: how many, of which size, and their pixels one after the other.
struct SegmentFrames
{
  DcmSequenceOfItems* Groups = nullptr;
  DcmItem* SharedGroups = nullptr;
  int Rows = 0;
  int Columns = 0;
  int Bits = 0;
  /// Values from this one on are inside.
  int Half = 1;
  const unsigned char* Pixels = nullptr;

  std::size_t PixelsPerFrame() const
  {
    return static_cast<std::size_t>(this->Rows) * static_cast<std::size_t>(this->Columns);
  }
  bool Inside(std::size_t frame, std::size_t pixel) const
  {
    // PS3.5 section 8.1.1: bits fill bytes from the lowest, frames follow without a gap.
    const std::size_t at = frame * this->PixelsPerFrame() + pixel;
    const int value = this->Bits == 1 ? this->Pixels[at / 8] >> (at % 8) & 1 : this->Pixels[at];
    return value >= this->Half;
  }
};

SegmentFrames FindFrames(DcmDataset& data, const std::string& path)
{
  if (const std::string modality = DicomText(data, DCM_Modality); modality != "SEG")
  {
    throw InputError(path + ": expected a DICOM segmentation (modality SEG), found modality '" +
      modality + "'; a series of label slices is read from its folder");
  }
  SegmentFrames frames;
  frames.Rows = DicomShort(data, DCM_Rows).value_or(0);
  frames.Columns = DicomShort(data, DCM_Columns).value_or(0);
  frames.Bits = DicomShort(data, DCM_BitsAllocated).value_or(0);
  data.findAndGetSequence(DCM_PerFrameFunctionalGroupsSequence, frames.Groups);
  frames.SharedGroups = DicomFirstItem(data, DCM_SharedFunctionalGroupsSequence);
  if (frames.Rows < 1 || frames.Columns < 1 || (frames.Bits != 1 && frames.Bits != 8) ||
    !frames.Groups)
  {
    throw InputError(path +
      ": expected rows, columns, 1 or 8 bits per pixel and functional groups per frame, found some "
      "of them missing");
  }
  if (const int most = DicomShort(data, DCM_MaximumFractionalValue).value_or(0);
      frames.Bits == 8 && most > 0)
  {
    frames.Half = (most + 1) / 2;
  }
  const double said =
    DicomNumber(data, DCM_NumberOfFrames).value_or(static_cast<double>(frames.Groups->card()));
  if (said != static_cast<double>(frames.Groups->card()))
  {
    throw InputError(path + ": expected functional groups for each of " +
      std::to_string(static_cast<long>(said)) + " frames, found " +
      std::to_string(frames.Groups->card()));
  }
  const std::size_t needed =
    (frames.Groups->card() * frames.PixelsPerFrame() * static_cast<std::size_t>(frames.Bits) + 7) /
    8;
  unsigned long found = 0;
  const Uint16* words = nullptr;
  if (data.findAndGetUint8Array(DCM_PixelData, frames.Pixels, &found).bad() &&
    data.findAndGetUint16Array(DCM_PixelData, words, &found).good())
  {
    frames.Pixels = reinterpret_cast<const unsigned char*>(words);
    found *= sizeof *words;
  }
  // One more fills an odd number up.
  if (!frames.Pixels || found < needed || found > needed + 1)
  {
    throw InputError(path + ": expected " + std::to_string(needed) +
      " bytes of uncompressed pixels, found " +
      (frames.Pixels ? std::to_string(found) : std::string("none")));
  }
  return frames;
}

/// A functional group of a frame, or the one that all frames share; null where there is none.
DcmItem* FindGroup(DcmItem* frame, DcmItem* shared, const DcmTagKey& tag)
{
  DcmItem* group = frame ? DicomFirstItem(*frame, tag) : nullptr;
  return !group && shared ? DicomFirstItem(*shared, tag) : group;
}

/// The frames of a segmentation, each with the number of its segment as its label.
std::vector<VolumeSlice> ReadSegmentation(const std::string& path)
{
  const DicomFile file(path, "a DICOM segmentation");
  const SegmentFrames frames = FindFrames(file.Data(), path);
  std::vector<VolumeSlice> slices;
  for (unsigned long frame = 0; frame < frames.Groups->card(); ++frame)
  {
    VolumeSlice slice;
    slice.Name = path + ": frame " + std::to_string(frame + 1);
    slice.Columns = frames.Columns;
    slice.Rows = frames.Rows;
    DcmItem* own = frames.Groups->getItem(frame);
    DcmItem* position = FindGroup(own, frames.SharedGroups, DCM_PlanePositionSequence);
    DcmItem* orientation = FindGroup(own, frames.SharedGroups, DCM_PlaneOrientationSequence);
    DcmItem* measures = FindGroup(own, frames.SharedGroups, DCM_PixelMeasuresSequence);
    DcmItem* segment = FindGroup(own, frames.SharedGroups, DCM_SegmentIdentificationSequence);
    const int number = segment ? DicomShort(*segment, DCM_ReferencedSegmentNumber).value_or(0) : 0;
    if (!position && !orientation && !measures)
    {
      throw InputError(path +
        ": expected segments of slices, found segments without places in the patient, as on a "
        "projection");
    }
    if (!position || !orientation || !measures || number < 1)
    {
      throw InputError(slice.Name +
        ": expected plane position, orientation, pixel measures and a segment number of at least "
        "1, found some of them missing");
    }
    SetGeometry(slice, *position, *orientation, *measures);
    slice.Values.resize(frames.PixelsPerFrame());
    for (std::size_t pixel = 0; pixel < slice.Values.size(); ++pixel)
    {
      slice.Values[pixel] = static_cast<float>(frames.Inside(frame, pixel) ? number : 0);
    }
    slices.push_back(std::move(slice));
  }
  return slices;
}

/// Some writers store 0 for a slope of 1.
double SlopeOf(DcmItem& data)
{
  const double slope = DicomNumber(data, DCM_RescaleSlope).value_or(1);
  return slope == 0 ? 1 : slope;
}

/// The rescaled values of one image.
VolumeSlice ReadSlice(const std::string& path, std::string& series)
{
  const DicomFile file(path, "DICOM");
  DcmDataset& data = file.Data();
  VolumeSlice slice;
  slice.Name = path;
  slice.Rows = DicomShort(data, DCM_Rows).value_or(0);
  slice.Columns = DicomShort(data, DCM_Columns).value_or(0);
  if (slice.Rows < 1 || slice.Columns < 1)
  {
    throw InputError(path + ": expected a slice, found no rows and columns");
  }
  SetGeometry(slice, data, data, data);
  series = DicomText(data, DCM_SeriesInstanceUID);
  const FramePixels stored(path, 1, static_cast<std::size_t>(slice.Rows) * slice.Columns);
  slice.Values =
    stored.Values(0, SlopeOf(data), DicomNumber(data, DCM_RescaleIntercept).value_or(0));
  return slice;
}

/// Both ways between processes.
template <typename Parcel, typename Slice>
void ExchangeSlice(Parcel& parcel, Slice& slice)
{
  parcel(slice.Name, slice.Columns, slice.Rows, slice.Position, slice.AlongRow, slice.AlongColumn,
    slice.RowSpacing, slice.ColumnSpacing, slice.SliceSpacing, slice.Values);
}

/// Frames of one multi-frame object, each after its own rescaling.
std::vector<VolumeSlice> ReadFrames(const std::vector<DicomSlice>& wanted, std::string& series)
{
  const std::string& path = wanted.front().Path;
  const DicomFile file(path, "DICOM");
  series = DicomText(file.Data(), DCM_SeriesInstanceUID);
  if (!HasResonanceFrames(file.Data()))
  {
    throw InputError(path + ": expected an MR object of frames, found none");
  }
  const DicomFrames frames(file.Data(), path);
  const std::size_t pixels =
    static_cast<std::size_t>(DicomShort(file.Data(), DCM_Rows).value_or(0)) *
    DicomShort(file.Data(), DCM_Columns).value_or(0);
  const FramePixels stored(path, frames.Count(), pixels);
  std::vector<VolumeSlice> slices;
  for (const DicomSlice& each : wanted)
  {
    if (each.Frame < 1 || static_cast<std::size_t>(each.Frame) > frames.Count())
    {
      throw InputError(path + ": expected frames 1 to " + std::to_string(frames.Count()) +
        ", found number " + std::to_string(each.Frame));
    }
    const auto number = static_cast<std::size_t>(each.Frame) - 1;
    const std::unique_ptr<DcmItem> data = frames.Flat(number);
    VolumeSlice& slice = slices.emplace_back();
    slice.Name = path + ": frame " + std::to_string(each.Frame);
    slice.Rows = DicomShort(file.Data(), DCM_Rows).value_or(0);
    slice.Columns = DicomShort(file.Data(), DCM_Columns).value_or(0);
    SetGeometry(slice, *data, *data, *data);
    slice.Values =
      stored.Values(number, SlopeOf(*data), DicomNumber(*data, DCM_RescaleIntercept).value_or(0));
  }
  return slices;
}

/// Slices of one series, of which `series` is the name; taken from the first where it has none.
/// Frames are all of one object.
void ReadSomeSlices(const std::vector<DicomSlice>& some, const std::string& first,
  std::optional<std::string>& series, std::vector<VolumeSlice>& slices)
{
  const std::string& path = some.front().Path;
  std::vector<std::string> paths;
  for (const DicomSlice& slice : some)
  {
    if (paths.empty() || paths.back() != slice.Path)
    {
      paths.push_back(slice.Path);
    }
  }
  const auto check = [&](const std::string& own, const std::string& name)
  {
    if (own != series.value_or(own))
    {
      throw InputError(
        name + ": expected the slices of one series, found one of another than " + first);
    }
    series = own;
  };
  ReadGuarded(
    paths.size() == 1 ? path : fs::path(path).parent_path().string(), "slices",
    ReadLimits::Of(paths),
    [&](ParcelWriter& parcel)
    {
      std::string own;
      if (some.front().Frame > 0)
      {
        for (const VolumeSlice& slice : ReadFrames(some, own))
        {
          ExchangeSlice(parcel, slice);
        }
        check(own, path);
      }
      else
      {
        for (const DicomSlice& each : some)
        {
          const VolumeSlice slice = ReadSlice(each.Path, own);
          check(own, each.Path);
          ExchangeSlice(parcel, slice);
        }
      }
      parcel(*series);
    },
    [&](ParcelReader& parcel)
    {
      for (std::size_t slice = 0; slice < some.size(); ++slice)
      {
        ExchangeSlice(parcel, slices.emplace_back());
      }
      parcel(series.emplace());
    });
}

/// As many slices as are read together, from one on.
std::size_t NumberTogether(const std::vector<DicomSlice>& slices, std::size_t from)
{
  // A process for each slice would be a tenth of the time; an object is opened once.
  constexpr std::size_t together = 16;
  std::size_t end = from + 1;
  const bool isFrame = slices[from].Frame > 0;
  while (end < slices.size() && (slices[end].Frame > 0) == isFrame &&
    (isFrame ? slices[end].Path == slices[from].Path : end < from + together))
  {
    ++end;
  }
  return end - from;
}

std::vector<VolumeSlice> ReadSlices(std::vector<DicomSlice> wanted,
  const ProgressCallback& progress = {})
{
  std::stable_sort(wanted.begin(), wanted.end(),
    [](const DicomSlice& a, const DicomSlice& b)
    { return a.Frame > 0 && b.Frame > 0 ? a.Path < b.Path : a.Frame == 0 && b.Frame > 0; });
  std::vector<VolumeSlice> slices;
  std::optional<std::string> series;
  const std::string first = wanted.front().Path;
  for (std::size_t done = 0; done < wanted.size();)
  {
    ReportProgress(progress, static_cast<double>(done) / static_cast<double>(wanted.size()),
      "reading slices");
    const auto from = wanted.begin() + static_cast<std::ptrdiff_t>(done);
    const std::size_t count = NumberTogether(wanted, done);
    const std::vector<DicomSlice> some(from, from + static_cast<std::ptrdiff_t>(count));
    try
    {
      ReadSomeSlices(some, first, series, slices);
    }
    catch (const InputError&)
    {
      if (some.front().Frame > 0)
      {
        throw;
      }
      // One by one: where a reader dies, only then is it known at which.
      slices.resize(done);
      for (const DicomSlice& slice : some)
      {
        ReadSomeSlices({ slice }, first, series, slices);
      }
    }
    done += count;
  }
  return slices;
}

/// The file as a slice, or the frames that it holds.
void AddSlicesOf(const std::string& path, std::vector<DicomSlice>& slices)
{
  for (const DicomHeader& header : ReadDicomHeaders(path))
  {
    slices.push_back({ path, header.Frame });
  }
}

std::vector<VolumeSlice> ReadSeries(const std::string& folder)
{
  std::vector<std::string> paths;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder))
  {
    if (entry.is_regular_file() && HasDicomHeader(entry.path()))
    {
      paths.push_back(entry.path());
    }
  }
  std::sort(paths.begin(), paths.end());
  std::vector<DicomSlice> slices;
  for (const std::string& path : paths)
  {
    AddSlicesOf(path, slices);
  }
  if (slices.empty())
  {
    throw InputError(folder + ": expected a folder of DICOM slices, found none");
  }
  return ReadSlices(slices);
}

/// Throws where a value is no label.
void CheckLabels(const std::vector<VolumeSlice>& slices)
{
  for (const VolumeSlice& slice : slices)
  {
    const auto bad = std::find_if_not(slice.Values.begin(), slice.Values.end(), IsLabel);
    if (bad != slice.Values.end())
    {
      const auto pixel = bad - slice.Values.begin();
      throw NoLabel(slice.Name + ": pixel (" + std::to_string(pixel % slice.Columns) + ", " +
          std::to_string(pixel / slice.Columns) + ")",
        *bad);
    }
  }
}

LabelVolume ReadDicomLabels(const std::string& path)
{
  const bool isFolder = fs::is_directory(path);
  std::vector<VolumeSlice> slices;
  if (isFolder)
  {
    slices = ReadSeries(path);
  }
  else
  {
    // Of a segmentation, one bit becomes a number of four bytes.
    ReadLimits limits = ReadLimits::Of({ path });
    limits.MemoryBytes *= 2;
    ReadGuarded(
      path, "a DICOM segmentation", limits,
      [&](ParcelWriter& parcel)
      {
        const std::vector<VolumeSlice> frames = ReadSegmentation(path);
        parcel(std::uint64_t{ frames.size() });
        for (const VolumeSlice& frame : frames)
        {
          ExchangeSlice(parcel, frame);
        }
      },
      [&](ParcelReader& parcel)
      {
        std::uint64_t count = 0;
        parcel(count);
        for (std::uint64_t frame = 0; frame < count; ++frame)
        {
          ExchangeSlice(parcel, slices.emplace_back());
        }
      });
  }
  CheckLabels(slices);
  const IntensityVolume values = StackSlices(slices, !isFolder);
  LabelVolume labels;
  static_cast<VolumeGrid&>(labels) = values;
  labels.Voxels.assign(values.Voxels.begin(), values.Voxels.end());
  return labels;
}

IntensityVolume ReadDicomIntensities(const std::string& path)
{
  if (fs::is_directory(path))
  {
    return StackSlices(ReadSeries(path), false);
  }
  std::vector<DicomSlice> slices;
  AddSlicesOf(path, slices);
  if (slices.empty() || slices.front().Frame == 0)
  {
    throw InputError(path +
      ": expected the folder of a DICOM series or a multi-frame MR object, found a single image");
  }
  return StackSlices(ReadSlices(slices), false);
}

/// Throws InputError if there is no such file or folder.
bool IsDicom(const std::string& path)
{
  std::error_code problem;
  if (!fs::exists(path, problem))
  {
    throw InputError(path + ": no such file");
  }
  std::string extension = fs::path(path).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
    [](unsigned char letter) { return static_cast<char>(std::tolower(letter)); });
  return fs::is_directory(path) || extension == ".dcm";
}
}

LabelVolume ReadLabelVolume(const std::string& path, VolumeAxes axes)
{
  return IsDicom(path) ? ReadDicomLabels(path) : ReadLabelFile(path, axes);
}

IntensityVolume ReadIntensityVolume(const std::string& path, VolumeAxes axes)
{
  return IsDicom(path) ? ReadDicomIntensities(path) : ReadIntensityFile(path, axes);
}

IntensityVolume ReadIntensitySlices(const std::vector<DicomSlice>& slices,
  const ProgressCallback& progress)
{
  if (slices.empty())
  {
    throw InputError("DICOM series: expected files of slices, found none");
  }
  return StackSlices(ReadSlices(slices, progress), false);
}

IntensityVolume ReadIntensitySeries(const std::vector<std::string>& files,
  const ProgressCallback& progress)
{
  std::vector<DicomSlice> slices;
  slices.reserve(files.size());
  for (const std::string& file : files)
  {
    slices.push_back({ file });
  }
  return ReadIntensitySlices(slices, progress);
}
}
