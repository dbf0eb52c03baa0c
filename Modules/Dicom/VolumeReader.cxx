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
#include <filesystem>
#include <memory>
#include <numeric>
#include <utility>

namespace mammoray
{
/// Passes a slice between a reader's process and this one.
static void Exchange(Parcel& parcel, VolumeSlice& slice)
{
  parcel(static_cast<SlicePlace&>(slice), slice.Name, slice.Columns, slice.Rows, slice.Values);
}

namespace
{
namespace fs = std::filesystem;

/// The pixels of a segmentation, one frame after the other.
struct SegmentPixels
{
  int Rows = 0;
  int Columns = 0;
  int Bits = 0;
  /// Values from this one on are inside.
  int Half = 1;
  const unsigned char* Bytes = nullptr;

  std::size_t PerFrame() const
  {
    return static_cast<std::size_t>(this->Rows) * static_cast<std::size_t>(this->Columns);
  }
  bool Inside(std::size_t frame, std::size_t pixel) const
  {
    // PS3.5 section 8.1.1: bits fill bytes from the lowest, frames follow without a gap.
    const std::size_t at = frame * this->PerFrame() + pixel;
    const int value = this->Bits == 1 ? this->Bytes[at / 8] >> (at % 8) & 1 : this->Bytes[at];
    return value >= this->Half;
  }
};

SegmentPixels FindSegmentPixels(DcmDataset& data, std::size_t frames, const std::string& path)
{
  SegmentPixels pixels;
  pixels.Rows = DicomShort(data, DCM_Rows).value_or(0);
  pixels.Columns = DicomShort(data, DCM_Columns).value_or(0);
  pixels.Bits = DicomShort(data, DCM_BitsAllocated).value_or(0);
  if (pixels.Rows < 1 || pixels.Columns < 1 || (pixels.Bits != 1 && pixels.Bits != 8))
  {
    throw InputError(
      path + ": expected rows, columns and 1 or 8 bits per pixel, found some of them missing");
  }
  if (const int most = DicomShort(data, DCM_MaximumFractionalValue).value_or(0);
      pixels.Bits == 8 && most > 0)
  {
    pixels.Half = (most + 1) / 2;
  }
  const std::size_t needed =
    (frames * pixels.PerFrame() * static_cast<std::size_t>(pixels.Bits) + 7) / 8;
  unsigned long found = 0;
  const Uint16* words = nullptr;
  if (data.findAndGetUint8Array(DCM_PixelData, pixels.Bytes, &found).bad() &&
    data.findAndGetUint16Array(DCM_PixelData, words, &found).good())
  {
    pixels.Bytes = reinterpret_cast<const unsigned char*>(words);
    found *= sizeof *words;
  }
  // One more fills an odd number up.
  if (!pixels.Bytes || found < needed || found > needed + 1)
  {
    throw InputError(path + ": expected " + std::to_string(needed) +
      " bytes of uncompressed pixels, found " +
      (pixels.Bytes ? std::to_string(found) : std::string("none")));
  }
  return pixels;
}

/// The frames of a segmentation, each with the number of its segment as its label.
std::vector<VolumeSlice> ReadSegmentation(const std::string& path)
{
  const DicomFile file(path, "a DICOM segmentation");
  if (const std::string modality = DicomText(file.Data(), DCM_Modality); modality != "SEG")
  {
    throw InputError(path + ": expected a DICOM segmentation (modality SEG), found modality '" +
      modality + "'; a series of label slices is read from its folder");
  }
  const DicomFrames frames(file.Data(), path);
  const SegmentPixels pixels = FindSegmentPixels(file.Data(), frames.Count(), path);
  std::vector<VolumeSlice> slices;
  for (std::size_t frame = 0; frame < frames.Count(); ++frame)
  {
    const std::unique_ptr<DcmItem> header = frames.Flat(frame);
    VolumeSlice slice{ ReadSlicePlace(*header), path + ": frame " + std::to_string(frame + 1),
      pixels.Columns, pixels.Rows, std::vector<float>(pixels.PerFrame()) };
    if (!header->tagExists(DCM_ImagePositionPatient) && !header->tagExists(DCM_PixelSpacing))
    {
      throw InputError(path +
        ": expected segments of slices, found segments without places in the patient, as on a "
        "projection");
    }
    const int number = DicomShort(*header, DCM_ReferencedSegmentNumber).value_or(0);
    if (number < 1)
    {
      throw InputError(slice.Name + ": expected a segment number of at least 1, found none");
    }
    for (std::size_t pixel = 0; pixel < slice.Values.size(); ++pixel)
    {
      slice.Values[pixel] = static_cast<float>(pixels.Inside(frame, pixel) ? number : 0);
    }
    slices.push_back(std::move(slice));
  }
  return slices;
}

/// Size, place and values of a frame, from 0. `header` is that of the frame.
VolumeSlice ReadSlice(const std::string& name, DcmItem& header, const DicomPixels& pixels,
  std::size_t frame)
{
  const double slope = DicomNumber(header, DCM_RescaleSlope).value_or(1);
  // Some writers store 0 for a slope of 1.
  return { ReadSlicePlace(header), name, pixels.Columns(), pixels.Rows(),
    pixels.Values(frame, slope == 0 ? 1 : slope,
      DicomNumber(header, DCM_RescaleIntercept).value_or(0)) };
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
  const auto require = [&path](bool holds, const std::string& text)
  {
    if (!holds)
    {
      throw InputError(path + ": expected " + text);
    }
  };
  const std::unique_ptr<DicomFile> file = DicomFile::OpenIfDicom(path, DicomExtent::Whole);
  require(file || wanted.MayBeOther, "DICOM, found none");
  if (!file)
  {
    return {};
  }
  series = DicomText(file->Data(), DCM_SeriesInstanceUID);
  if (!HasResonanceFrames(file->Data()))
  {
    require(!wanted.IsVolume,
      "the folder of a DICOM series or a multi-frame MR object, found a single image");
    require(wanted.Frames.empty(), "an MR object of frames, found none");
    const DicomPixels pixels(*file);
    require(pixels.Frames() == 1,
      "one slice or an MR object of frames, found " + std::to_string(pixels.Frames()) +
        " frames of another object");
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
    require(number >= 1 && static_cast<std::size_t>(number) <= frames.Count(),
      "frames 1 to " + std::to_string(frames.Count()) + ", found number " + std::to_string(number));
    const auto frame = static_cast<std::size_t>(number) - 1;
    slices.push_back(
      ReadSlice(path + ": frame " + std::to_string(number), *frames.Flat(frame), pixels, frame));
  }
  return slices;
}

/// Slices of one series, and its UID if there are any.
struct SeriesPart
{
  std::string Series;
  std::vector<VolumeSlice> Slices;
};

void Exchange(Parcel& parcel, SeriesPart& part)
{
  parcel(part.Series, part.Slices);
}

/// Appends the slices of files, read in a process of their own. `first` is the series' first file.
void AppendFiles(const std::vector<SliceFile>& files, const std::string& first, SeriesPart& all)
{
  std::vector<std::string> paths;
  paths.reserve(files.size());
  for (const SliceFile& file : files)
  {
    paths.push_back(file.Path);
  }
  const auto read = [&]
  {
    SeriesPart part{ all.Series, {} };
    for (const SliceFile& file : files)
    {
      std::string series;
      std::vector<VolumeSlice> slices = ReadSliceFile(file, series);
      if (slices.empty())
      {
        continue;
      }
      if (series != part.Series && all.Slices.size() + part.Slices.size() > 0)
      {
        throw InputError(
          file.Path + ": expected the slices of one series, found one of another than " + first);
      }
      part.Series = series;
      std::move(slices.begin(), slices.end(), std::back_inserter(part.Slices));
    }
    return part;
  };
  SeriesPart part =
    ReadGuarded(paths.size() == 1 ? paths.front() : fs::path(paths.front()).parent_path().string(),
      "slices", ReadLimits::Of(paths), read);
  all.Series = part.Series;
  std::move(part.Slices.begin(), part.Slices.end(), std::back_inserter(all.Slices));
}

std::vector<VolumeSlice> ReadFiles(const std::vector<SliceFile>& files,
  const ProgressCallback& progress = {})
{
  // With a process for each file, starting them would take a tenth of the time.
  constexpr std::ptrdiff_t together = 16;
  SeriesPart all;
  for (auto from = files.begin(); from != files.end();)
  {
    ReportProgress(progress,
      static_cast<double>(from - files.begin()) / static_cast<double>(files.size()),
      "reading slices");
    const std::vector<SliceFile> some(from, from + std::min(together, files.end() - from));
    from += static_cast<std::ptrdiff_t>(some.size());
    try
    {
      AppendFiles(some, files.front().Path, all);
    }
    catch (const ReaderEnded&)
    {
      // Reading them one by one finds the file that ended the reader.
      for (const SliceFile& file : some)
      {
        AppendFiles({ file }, files.front().Path, all);
      }
    }
  }
  return std::move(all.Slices);
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
  std::vector<VolumeSlice> slices = ReadFiles(files);
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
    // Each bit of a segmentation becomes a number of four bytes.
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
