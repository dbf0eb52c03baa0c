// SPDX-License-Identifier: Apache-2.0
// The frames of a segmentation are read from the data set: DCMTK's dcmseg requires attributes that
// reading labels does not need.
#include "mammoray/Dicom/DicomReader.h"

#include "Private/DicomFile.h"
#include "Private/DicomFrames.h"
#include "Private/DicomPixels.h"
#include "Private/SliceStack.h"
#include "mammoray/Dicom/DicomHeader.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/GuardedRead.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <map>
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
  /// Values are the numbers of segments (LABELMAP), not what is inside one.
  bool IsMap = false;
  /// Values from this one on are inside.
  int Half = 1;
  const unsigned char* Bytes = nullptr;

  std::size_t PerFrame() const
  {
    return static_cast<std::size_t>(this->Rows) * static_cast<std::size_t>(this->Columns);
  }
  int Value(std::size_t at) const
  {
    // PS3.5 section 8.1.1: bits fill bytes from the lowest, frames follow without a gap.
    return this->Bits == 1 ? this->Bytes[at / 8] >> (at % 8) & 1
      : this->Bits == 8    ? this->Bytes[at]
                           : this->Bytes[2 * at] | this->Bytes[2 * at + 1] << 8;
  }
  /// The label of a pixel in a frame of a segment.
  int Label(std::size_t frame, std::size_t pixel, int segment) const
  {
    const int value = this->Value(frame * this->PerFrame() + pixel);
    return this->IsMap ? value : value >= this->Half ? segment : 0;
  }
};

/// The value from which on a fraction counts as inside; of `largest`, the largest one that there
/// is.
int HalfOfFractions(DcmDataset& data, int largest, const std::string& path)
{
  const int most = DicomShort(data, DCM_MaximumFractionalValue).value_or(0);
  // Some writers store the bits of a binary segmentation as bytes.
  if (most == 0 && largest <= 1)
  {
    return 1;
  }
  if (most == 0 || largest > most)
  {
    throw InputError(path + ": expected Maximum Fractional Value (0062,000E) of fractions up to " +
      std::to_string(largest) + ", found " + (most == 0 ? "none" : std::to_string(most)) +
      ": what is inside is not known");
  }
  if (largest > 0 && largest < (most + 1) / 2)
  {
    const std::string found = "no fraction reaches half of the Maximum Fractional Value " +
      std::to_string(most) + ", the largest is " + std::to_string(largest) +
      " (flags in place of fractions?): nothing is inside";
    if (largest > 1)
    {
      throw InputError(path + ": expected fractions of segments, but " + found);
    }
    Note({ path, found });
  }
  return (most + 1) / 2;
}

SegmentPixels FindSegmentPixels(DcmDataset& data, std::size_t frames, const std::string& path)
{
  SegmentPixels pixels;
  pixels.Rows = DicomShort(data, DCM_Rows).value_or(0);
  pixels.Columns = DicomShort(data, DCM_Columns).value_or(0);
  pixels.Bits = DicomShort(data, DCM_BitsAllocated).value_or(0);
  pixels.IsMap = DicomText(data, DCM_SegmentationType) == "LABELMAP";
  const bool isKnown = pixels.Bits == 8 || (pixels.IsMap ? pixels.Bits == 16 : pixels.Bits == 1);
  if (pixels.Rows < 1 || pixels.Columns < 1 || !isKnown)
  {
    throw InputError(path + ": expected rows, columns and " +
      (pixels.IsMap ? "8 or 16" : "1 or 8") + " bits per pixel, found " +
      std::to_string(pixels.Rows) + " x " + std::to_string(pixels.Columns) + " of " +
      std::to_string(pixels.Bits) + " bits");
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
  if (pixels.Bits == 8 && !pixels.IsMap)
  {
    const unsigned char* const end = pixels.Bytes + frames * pixels.PerFrame();
    pixels.Half = HalfOfFractions(data, *std::max_element(pixels.Bytes, end), path);
  }
  return pixels;
}

/// Slices of segments, and the names of these.
struct SegmentedSlices
{
  std::vector<VolumeSlice> Slices;
  std::vector<int> Numbers;
  std::vector<std::string> Names;
};

void Exchange(Parcel& parcel, SegmentedSlices& segments)
{
  parcel(segments.Slices, segments.Numbers, segments.Names);
}

void ReadSegmentNames(DcmDataset& data, SegmentedSlices& segments)
{
  DcmItem* segment = nullptr;
  for (long item = 0; data.findAndGetSequenceItem(DCM_SegmentSequence, segment, item).good();
       ++item)
  {
    const std::string name = DicomTexts(*segment, DCM_SegmentLabel);
    const int number = DicomShort(*segment, DCM_SegmentNumber).value_or(0);
    if (number > 0)
    {
      segments.Numbers.push_back(number);
      segments.Names.push_back(name);
    }
  }
}

/// Throws unless the file describes the segment of a number, if it describes any.
void CheckDescribed(const SegmentedSlices& segments, int number, const std::string& where)
{
  if (segments.Numbers.empty() ||
    std::find(segments.Numbers.begin(), segments.Numbers.end(), number) != segments.Numbers.end())
  {
    return;
  }
  std::string described;
  for (std::size_t index = 0; index < segments.Numbers.size(); ++index)
  {
    described += (described.empty() ? "" : ", ") + std::to_string(segments.Numbers[index]) + " '" +
      segments.Names[index] + "'";
  }
  throw InputError(where + ": expected a segment that the file describes (" + described +
    "), found number " + std::to_string(number));
}

/// Notes segments with fractions of which none counts as inside, where those of others do.
/// `largest`: the largest value of each segment.
void NoteFaintSegments(const std::map<int, int>& largest, const SegmentedSlices& segments, int half,
  int most, const std::string& path)
{
  const auto reaches = [half](const auto& segment) { return segment.second >= half; };
  if (!std::any_of(largest.begin(), largest.end(), reaches))
  {
    return; // HalfOfFractions has said it of all.
  }
  for (const auto& [number, value] : largest)
  {
    const auto named = std::find(segments.Numbers.begin(), segments.Numbers.end(), number);
    if (value > 0 && value < half)
    {
      Note({ path,
        "no fraction of segment " + std::to_string(number) + " reaches half of " +
          std::to_string(most) + ", the largest is " + std::to_string(value) +
          ": nothing is inside",
        named == segments.Numbers.end() ? ""
                                        : " (of '" +
            segments.Names[static_cast<std::size_t>(named - segments.Numbers.begin())] + "')" });
    }
  }
}

/// The frames of a segmentation, each with the number of its segment as its label.
SegmentedSlices ReadSegmentation(const std::string& path)
{
  const DicomFile file(path, "a DICOM segmentation");
  if (const std::string modality = DicomText(file.Data(), DCM_Modality); modality != "SEG")
  {
    throw InputError(path + ": expected a DICOM segmentation (modality SEG), found modality '" +
      modality + "'; a series of label slices is read from its folder");
  }
  const DicomFrames frames(file.Data(), path);
  const SegmentPixels pixels = FindSegmentPixels(file.Data(), frames.Count(), path);
  SegmentedSlices segments;
  ReadSegmentNames(file.Data(), segments);
  std::map<int, int> largest;
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
    if (number < 1 && !pixels.IsMap)
    {
      throw InputError(slice.Name + ": expected a segment number of at least 1, found none");
    }
    if (!pixels.IsMap)
    {
      CheckDescribed(segments, number, slice.Name);
    }
    for (std::size_t pixel = 0; pixel < slice.Values.size(); ++pixel)
    {
      slice.Values[pixel] = static_cast<float>(pixels.Label(frame, pixel, number));
      largest[number] = std::max(largest[number], pixels.Value(frame * pixels.PerFrame() + pixel));
    }
    segments.Slices.push_back(std::move(slice));
  }
  NoteFaintSegments(largest, segments, pixels.IsMap ? 0 : pixels.Half,
    DicomShort(file.Data(), DCM_MaximumFractionalValue).value_or(1), path);
  return segments;
}

/// Size, place and values of a frame, from 0. `header` is that of the frame.
VolumeSlice ReadSlice(const std::string& name, DcmItem& header, const DicomPixels& pixels,
  std::size_t frame)
{
  if (const std::string missing = MissingOfPlace(header); !missing.empty())
  {
    throw InputError(name + ": expected a slice with a place in the patient, found no " + missing);
  }
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
  SegmentedSlices segments;
  if (isFolder)
  {
    segments.Slices = ReadSeries(path);
  }
  else
  {
    // Each bit of a segmentation becomes a number of four bytes.
    ReadLimits limits = ReadLimits::Of({ path });
    limits.MemoryBytes *= 2;
    segments =
      ReadGuarded(path, "a DICOM segmentation", limits, [&] { return ReadSegmentation(path); });
  }
  CheckLabels(segments.Slices);
  const IntensityVolume values = StackSlices(segments.Slices, !isFolder);
  LabelVolume labels;
  static_cast<VolumeGrid&>(labels) = values;
  labels.Voxels.assign(values.Voxels.begin(), values.Voxels.end());
  for (std::size_t index = 0; index < segments.Names.size(); ++index)
  {
    if (!segments.Names[index].empty())
    {
      labels.Names.try_emplace(segments.Numbers[index], segments.Names[index]);
    }
  }
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
