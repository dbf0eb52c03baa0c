// SPDX-License-Identifier: Apache-2.0
// The frames of a segmentation are read from the data set: DCMTK's dcmseg requires attributes that
// reading labels does not need.
#include "mammoray/Dicom/DicomReader.h"

#include "Private/DicomFile.h"
#include "Private/DicomFrames.h"
#include "Private/DicomPixels.h"
#include "Private/SliceStack.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/GuardedRead.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <memory>
#include <numeric>
#include <optional>

namespace mammoray
{
/// Passes a slice between a reader's process and this one.
static void Exchange(Parcel& parcel, VolumeSlice& slice)
{
  parcel(slice.Name, slice.Columns, slice.Rows, slice.Position, slice.AlongRow, slice.AlongColumn,
    slice.RowSpacing, slice.ColumnSpacing, slice.SliceSpacing, slice.Values);
}

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

/// Size, geometry and values of a frame, from 0. `header` is that of the frame.
VolumeSlice ReadSlice(const std::string& name, DcmItem& header, const DicomPixels& pixels,
  std::size_t frame)
{
  VolumeSlice slice;
  slice.Name = name;
  slice.Rows = pixels.Rows();
  slice.Columns = pixels.Columns();
  SetGeometry(slice, header, header, header);
  const double slope = DicomNumber(header, DCM_RescaleSlope).value_or(1);
  // Some writers store 0 for a slope of 1.
  slice.Values = pixels.Values(frame, slope == 0 ? 1 : slope,
    DicomNumber(header, DCM_RescaleIntercept).value_or(0));
  return slice;
}

/// The slices to read from one file. No frames: the file is a slice, or all its frames are read.
struct SliceFile
{
  std::string Path;
  std::vector<int> Frames;
  /// Nothing is read from a file that is no DICOM, instead of an error.
  bool MayBeOther = false;
  /// A single image is an error.
  bool IsVolume = false;
};

/// Parses a file once.
std::vector<VolumeSlice> ReadSliceFile(const SliceFile& wanted, std::string& series)
{
  const std::string& path = wanted.Path;
  const std::unique_ptr<DicomFile> file = DicomFile::OpenIfDicom(path, DicomExtent::Whole);
  if (!file && !wanted.MayBeOther)
  {
    throw InputError(path + ": expected DICOM, found none");
  }
  if (!file)
  {
    return {};
  }
  series = DicomText(file->Data(), DCM_SeriesInstanceUID);
  if (!HasResonanceFrames(file->Data()))
  {
    if (wanted.IsVolume)
    {
      throw InputError(path +
        ": expected the folder of a DICOM series or a multi-frame MR object, found a single image");
    }
    if (!wanted.Frames.empty())
    {
      throw InputError(path + ": expected an MR object of frames, found none");
    }
    const DicomPixels pixels(*file);
    if (pixels.Frames() > 1)
    {
      throw InputError(path + ": expected one slice or an MR object of frames, found " +
        std::to_string(pixels.Frames()) + " frames of another object");
    }
    return { ReadSlice(path, file->Data(), pixels, 0) };
  }
  const DicomFrames frames(file->Data(), path);
  const DicomPixels pixels(*file);
  std::vector<int> numbers = wanted.Frames;
  if (numbers.empty())
  {
    numbers.resize(frames.Count());
    std::iota(numbers.begin(), numbers.end(), 1);
  }
  std::vector<VolumeSlice> slices;
  for (const int number : numbers)
  {
    if (number < 1 || static_cast<std::size_t>(number) > frames.Count())
    {
      throw InputError(path + ": expected frames 1 to " + std::to_string(frames.Count()) +
        ", found number " + std::to_string(number));
    }
    const auto frame = static_cast<std::size_t>(number) - 1;
    slices.push_back(
      ReadSlice(path + ": frame " + std::to_string(number), *frames.Flat(frame), pixels, frame));
  }
  return slices;
}

/// Slices of one series, and its UID if there are any.
struct SeriesPart
{
  bool HasSeries = false;
  std::string Series;
  std::vector<VolumeSlice> Slices;
};

void Exchange(Parcel& parcel, SeriesPart& part)
{
  parcel(part.Series, part.Slices);
}

/// Reads files in a process of their own. They are slices of one series, whose UID `series` has or
/// gets; `first` is its first file.
void ReadSomeFiles(const std::vector<SliceFile>& files, const std::string& first,
  std::optional<std::string>& series, std::vector<VolumeSlice>& slices)
{
  std::vector<std::string> paths;
  paths.reserve(files.size());
  for (const SliceFile& file : files)
  {
    paths.push_back(file.Path);
  }
  SeriesPart part =
    ReadGuarded(paths.size() == 1 ? paths.front() : fs::path(paths.front()).parent_path().string(),
      "slices", ReadLimits::Of(paths),
      [&]
      {
        SeriesPart found{ series, {} };
        for (const SliceFile& file : files)
        {
          std::string own;
          std::vector<VolumeSlice> read = ReadSliceFile(file, own);
          if (!read.empty() && own != found.Series.value_or(own))
          {
            throw InputError(file.Path +
              ": expected the slices of one series, found one of another than " + first);
          }
          found.Series = read.empty() ? found.Series : own;
          std::move(read.begin(), read.end(), std::back_inserter(found.Slices));
        }
        return found;
      });
  series = std::move(part.Series);
  std::move(part.Slices.begin(), part.Slices.end(), std::back_inserter(slices));
}

std::vector<VolumeSlice> ReadFiles(const std::vector<SliceFile>& files,
  const ProgressCallback& progress = {})
{
  // A process for each file would be a tenth of the time.
  constexpr std::size_t together = 16;
  std::vector<VolumeSlice> slices;
  std::optional<std::string> series;
  const std::string& first = files.front().Path;
  for (std::size_t done = 0; done < files.size(); done += together)
  {
    ReportProgress(progress, static_cast<double>(done) / static_cast<double>(files.size()),
      "reading slices");
    const auto from = files.begin() + static_cast<std::ptrdiff_t>(done);
    const std::vector<SliceFile> some(from,
      from + static_cast<std::ptrdiff_t>(std::min(together, files.size() - done)));
    const std::size_t before = slices.size();
    try
    {
      ReadSomeFiles(some, first, series, slices);
    }
    catch (const InputError&)
    {
      if (some.size() == 1)
      {
        throw;
      }
      // If the reader's process has died, only reading one by one tells at which file.
      slices.resize(before);
      for (const SliceFile& file : some)
      {
        ReadSomeFiles({ file }, first, series, slices);
      }
    }
  }
  return slices;
}

/// A folder's files in the order of their names; those that are no DICOM are passed over.
std::vector<VolumeSlice> ReadSeries(const std::string& folder)
{
  std::vector<SliceFile> files;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder))
  {
    if (entry.is_regular_file() && HasDicomHeader(entry.path()))
    {
      files.push_back({ entry.path(), {}, true });
    }
  }
  std::sort(files.begin(), files.end(),
    [](const SliceFile& a, const SliceFile& b) { return a.Path < b.Path; });
  std::vector<VolumeSlice> slices;
  if (!files.empty())
  {
    slices = ReadFiles(files);
  }
  if (slices.empty())
  {
    throw InputError(folder + ": expected a folder of DICOM slices, found none");
  }
  return slices;
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
    slices =
      ReadGuarded(path, "a DICOM segmentation", limits, [&] { return ReadSegmentation(path); });
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
  return StackSlices(ReadFiles({ { path, {}, false, true } }), false);
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
  std::vector<DicomSlice> sorted = slices;
  std::stable_sort(sorted.begin(), sorted.end(),
    [](const DicomSlice& a, const DicomSlice& b)
    { return a.Frame > 0 && b.Frame > 0 ? a.Path < b.Path : a.Frame == 0 && b.Frame > 0; });
  std::vector<SliceFile> files;
  for (const DicomSlice& slice : sorted)
  {
    if (slice.Frame == 0 || files.empty() || files.back().Path != slice.Path ||
      files.back().Frames.empty())
    {
      files.push_back({ slice.Path, {} });
    }
    if (slice.Frame > 0)
    {
      files.back().Frames.push_back(slice.Frame);
    }
  }
  return StackSlices(ReadFiles(files, progress), false);
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
