// SPDX-License-Identifier: Apache-2.0
#include "Private/DicomVolume.h"

#include "Private/DicomElements.h"
#include "Private/DicomStructure.h"
#include "Private/QuietGdcm.h"
#include "Private/VolumeFile.h"
#include "mammoray/Foundation/Error.h"

#include <gdcmImageReader.h>
#include <gdcmReader.h>
#include <gdcmSequenceOfItems.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <map>
#include <sstream>

namespace mammoray
{
namespace
{
namespace fs = std::filesystem;
using gdcm::Tag;

/// One slice of a series, or of one segment.
struct Slice
{
  std::string Name; // for messages
  int Columns = 0;
  int Rows = 0;
  Vector3 Position{ 0, 0, 0 };
  Vector3 AlongRow{ 1, 0, 0 };
  Vector3 AlongColumn{ 0, 1, 0 };
  /// Distance of rows, then of columns, mm, as DICOM has it.
  double RowSpacing = 0;
  double ColumnSpacing = 0;
  /// Distance of slices that the file tells, mm; 0 where it does not.
  double SliceSpacing = 0;
  /// Labels or intensities, along rows first.
  std::vector<float> Values;
};

/// Decimal strings; empty unless there are `count` finite ones.
std::vector<double> Numbers(const gdcm::DataSet& data, const Tag& tag, std::size_t count)
{
  std::istringstream stream(DicomText(data, tag));
  std::vector<double> numbers;
  std::string word;
  while (std::getline(stream, word, '\\'))
  {
    char* end = nullptr;
    const double value = std::strtod(word.c_str(), &end);
    if (end == word.c_str() || !std::isfinite(value))
    {
      return {};
    }
    numbers.push_back(value);
  }
  return numbers.size() == count ? numbers : std::vector<double>{};
}

/// Unsigned short, little endian; -1 where there is none.
int Short(const gdcm::DataSet& data, const Tag& tag)
{
  const gdcm::ByteValue* bytes =
    data.FindDataElement(tag) ? data.GetDataElement(tag).GetByteValue() : nullptr;
  if (!bytes || bytes->GetLength() < 2)
  {
    return -1;
  }
  std::uint16_t value = 0;
  std::memcpy(&value, bytes->GetPointer(), 2);
  return value;
}

gdcm::SmartPointer<gdcm::SequenceOfItems> Sequence(const gdcm::DataSet& data, const Tag& tag)
{
  return data.FindDataElement(tag) ? data.GetDataElement(tag).GetValueAsSQ() : nullptr;
}

/// First item of a sequence in the groups of a frame, or in those that all frames share.
const gdcm::DataSet* Group(const gdcm::DataSet* frame, const gdcm::DataSet* shared, const Tag& tag,
  std::vector<gdcm::SmartPointer<gdcm::SequenceOfItems>>& keep)
{
  for (const gdcm::DataSet* groups : { frame, shared })
  {
    if (groups)
    {
      const auto sequence = Sequence(*groups, tag);
      if (sequence && sequence->GetNumberOfItems() > 0)
      {
        keep.push_back(sequence);
        return &keep.back()->GetItem(1).GetNestedDataSet();
      }
    }
  }
  return nullptr;
}

void SetGeometry(Slice& slice, const gdcm::DataSet& position, const gdcm::DataSet& orientation,
  const gdcm::DataSet& measures)
{
  const std::vector<double> at = Numbers(position, Tag(0x0020, 0x0032), 3);
  const std::vector<double> axes = Numbers(orientation, Tag(0x0020, 0x0037), 6);
  const std::vector<double> spacing = Numbers(measures, Tag(0x0028, 0x0030), 2);
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
      DicomText(orientation, Tag(0x0020, 0x0037)) + "'");
  }
  for (const Tag& tag : { Tag(0x0018, 0x0088), Tag(0x0018, 0x0050) })
  {
    const std::vector<double> distance = Numbers(measures, tag, 1);
    if (!distance.empty() && distance[0] > 0)
    {
      slice.SliceSpacing = distance[0];
      return;
    }
  }
}

void CheckStructure(const std::string& path)
{
  const std::string damage = FindDicomDamage(path);
  if (!damage.empty())
  {
    throw InputError(path + ": expected DICOM, " + damage);
  }
}

[[noreturn]] void RefuseSegmentation(const std::string& path, const std::string& expected)
{
  throw InputError(path + ": expected " + expected);
}

/// Slices of a segmentation, each with the number of its segment.
std::vector<Slice> ReadSegmentation(const std::string& path)
{
  CheckStructure(path);
  gdcm::Reader reader;
  reader.SetFileName(path.c_str());
  if (!reader.Read())
  {
    RefuseSegmentation(path, "a DICOM segmentation, found data that cannot be read");
  }
  const gdcm::DataSet& data = reader.GetFile().GetDataSet();
  if (DicomText(data, Tag(0x0008, 0x0060)) != "SEG")
  {
    RefuseSegmentation(path,
      "a DICOM segmentation (modality SEG), found modality '" +
        DicomText(data, Tag(0x0008, 0x0060)) +
        "'; a series of label slices is read from its folder");
  }
  const int rows = Short(data, Tag(0x0028, 0x0010));
  const int columns = Short(data, Tag(0x0028, 0x0011));
  const int bits = Short(data, Tag(0x0028, 0x0100));
  const auto frames = Sequence(data, Tag(0x5200, 0x9230));
  const auto sharedSequence = Sequence(data, Tag(0x5200, 0x9229));
  if (rows < 1 || columns < 1 || (bits != 1 && bits != 8) || !frames)
  {
    RefuseSegmentation(path,
      "rows, columns, 1 or 8 bits per pixel and functional groups per "
      "frame, found some of them missing");
  }
  const gdcm::DataSet* shared = sharedSequence && sharedSequence->GetNumberOfItems() > 0
    ? &sharedSequence->GetItem(1).GetNestedDataSet()
    : nullptr;
  const gdcm::ByteValue* pixels = data.FindDataElement(Tag(0x7fe0, 0x0010))
    ? data.GetDataElement(Tag(0x7fe0, 0x0010)).GetByteValue()
    : nullptr;
  const std::size_t frameCount = frames->GetNumberOfItems();
  const std::size_t framePixels =
    static_cast<std::size_t>(rows) * static_cast<std::size_t>(columns);
  const std::size_t bytes = (frameCount * framePixels * static_cast<std::size_t>(bits) + 7) / 8;
  if (!pixels || pixels->GetLength() < bytes)
  {
    RefuseSegmentation(path,
      std::to_string(bytes) + " bytes of uncompressed pixels, found " +
        (pixels ? std::to_string(pixels->GetLength()) : std::string("none")));
  }
  const int most = Short(data, Tag(0x0062, 0x000e));
  const int half = bits == 1 || most < 1 ? 1 : (most + 1) / 2;
  const auto* stored = reinterpret_cast<const unsigned char*>(pixels->GetPointer());
  std::vector<Slice> slices;
  for (std::size_t frame = 0; frame < frameCount; ++frame)
  {
    Slice slice;
    slice.Name = path + ": frame " + std::to_string(frame + 1);
    slice.Columns = columns;
    slice.Rows = rows;
    const gdcm::DataSet* own = &frames->GetItem(frame + 1).GetNestedDataSet();
    std::vector<gdcm::SmartPointer<gdcm::SequenceOfItems>> keep;
    keep.reserve(4);
    const gdcm::DataSet* position = Group(own, shared, Tag(0x0020, 0x9113), keep);
    const gdcm::DataSet* orientation = Group(own, shared, Tag(0x0020, 0x9116), keep);
    const gdcm::DataSet* measures = Group(own, shared, Tag(0x0028, 0x9110), keep);
    const gdcm::DataSet* segment = Group(own, shared, Tag(0x0062, 0x000a), keep);
    const int number = segment ? Short(*segment, Tag(0x0062, 0x000b)) : -1;
    if (!position && !orientation && !measures)
    {
      RefuseSegmentation(path,
        "segments of slices, found segments without places in the patient, as on a projection");
    }
    if (!position || !orientation || !measures || number < 1)
    {
      RefuseSegmentation(slice.Name,
        "plane position, orientation, pixel measures and a segment number of at least 1, found "
        "some of them missing");
    }
    SetGeometry(slice, *position, *orientation, *measures);
    slice.Values.resize(framePixels);
    for (std::size_t pixel = 0; pixel < framePixels; ++pixel)
    {
      // PS3.5 section 8.1.1: bits fill bytes from the lowest, frames follow without a gap.
      const std::size_t at = frame * framePixels + pixel;
      const int value = bits == 1 ? stored[at / 8] >> (at % 8) & 1 : stored[at];
      slice.Values[pixel] = static_cast<float>(value >= half ? number : 0);
    }
    slices.push_back(std::move(slice));
  }
  return slices;
}

/// The values of one image, after its rescaling.
Slice ReadSlice(const std::string& path, std::string& series)
{
  gdcm::ImageReader reader;
  reader.SetFileName(path.c_str());
  if (!reader.Read())
  {
    throw InputError(path + ": expected a slice, found an image that cannot be read");
  }
  const gdcm::Image& image = reader.GetImage();
  const gdcm::DataSet& data = reader.GetFile().GetDataSet();
  Slice slice;
  slice.Name = path;
  const gdcm::PixelFormat& format = image.GetPixelFormat();
  const bool wide = format.GetBitsAllocated() == 16;
  if (image.GetNumberOfDimensions() != 2 || format.GetSamplesPerPixel() != 1 ||
    (!wide && format.GetBitsAllocated() != 8))
  {
    throw InputError(path + ": expected one slice of 8 or 16 bits per pixel, found " +
      std::to_string(image.GetNumberOfDimensions()) + " dimensions of " +
      std::to_string(format.GetSamplesPerPixel()) + " x " +
      std::to_string(format.GetBitsAllocated()) + " bits");
  }
  slice.Columns = static_cast<int>(image.GetDimension(0));
  slice.Rows = static_cast<int>(image.GetDimension(1));
  SetGeometry(slice, data, data, data);
  series = DicomText(data, Tag(0x0020, 0x000e));
  const std::size_t pixelCount =
    static_cast<std::size_t>(slice.Columns) * static_cast<std::size_t>(slice.Rows);
  std::vector<char> buffer(image.GetBufferLength());
  if (buffer.size() < pixelCount * (wide ? 2 : 1) || !image.GetBuffer(buffer.data()))
  {
    throw InputError(path + ": expected a slice, found pixels that cannot be decoded");
  }
  const bool isSigned = format.GetPixelRepresentation() == 1;
  for (std::size_t pixel = 0; pixel < pixelCount; ++pixel)
  {
    std::uint16_t raw = static_cast<unsigned char>(buffer[pixel]);
    if (wide)
    {
      std::memcpy(&raw, &buffer[2 * pixel], 2);
    }
    const double stored = !isSigned ? raw
      : wide                        ? static_cast<std::int16_t>(raw)
                                    : static_cast<std::int8_t>(raw);
    const double value = image.GetSlope() * stored + image.GetIntercept();
    slice.Values.push_back(static_cast<float>(value));
  }
  return slice;
}

std::vector<Slice> ReadSeries(const std::string& folder)
{
  std::vector<std::string> paths;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder))
  {
    if (entry.is_regular_file() && FindDicomDamage(entry.path()) != "found no DICOM header")
    {
      paths.push_back(entry.path());
    }
  }
  std::sort(paths.begin(), paths.end());
  if (paths.empty())
  {
    throw InputError(folder + ": expected a folder of DICOM slices, found none");
  }
  std::vector<Slice> slices;
  std::string first;
  for (const std::string& path : paths)
  {
    CheckStructure(path);
    std::string series;
    slices.push_back(ReadSlice(path, series));
    first = slices.size() == 1 ? series : first;
    if (series != first)
    {
      throw InputError(folder + ": expected the slices of one series, found " + path +
        " of another than " + paths.front());
    }
  }
  return slices;
}

/// Throws where a value is no label.
void CheckLabels(const std::vector<Slice>& slices)
{
  for (const Slice& slice : slices)
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

/// Throws unless the slices lie in parallel on one grid.
void CheckParallel(const std::vector<Slice>& slices, const Vector3& normal)
{
  const Slice& first = slices.front();
  for (const Slice& slice : slices)
  {
    // 1e-4 of lengths and directions: what decimal strings of a scanner differ by.
    const bool same = slice.Columns == first.Columns && slice.Rows == first.Rows &&
      std::abs(slice.RowSpacing - first.RowSpacing) <= 1e-4 * first.RowSpacing &&
      std::abs(slice.ColumnSpacing - first.ColumnSpacing) <= 1e-4 * first.ColumnSpacing &&
      Norm(slice.AlongRow - first.AlongRow) <= 1e-4 &&
      Norm(slice.AlongColumn - first.AlongColumn) <= 1e-4;
    const Vector3 offset = slice.Position - first.Position;
    const Vector3 aside = offset - Dot(offset, normal) * normal;
    if (!same || Norm(aside) > 0.1 * std::min(first.RowSpacing, first.ColumnSpacing))
    {
      throw InputError(slice.Name + ": expected the size, spacing and orientation of " +
        first.Name + " and a place straight above or below it, found others");
    }
  }
}

/**
 * The distance of neighbouring slices. Where some may be left out it is the one that the file
 * tells, or, where slices do not lie on it, the largest fraction of the smallest gap that they do
 * lie on.
 */
double FindSliceSpacing(const std::vector<Slice>& slices, const std::vector<double>& heights,
  bool gapsAllowed)
{
  double smallest = 0;
  for (std::size_t n = 1; n < heights.size(); ++n)
  {
    const double gap = heights[n] - heights[n - 1];
    smallest = smallest == 0 ? gap : std::min(smallest, gap);
  }
  const double told = slices.front().SliceSpacing;
  std::vector<double> candidates{ smallest };
  if (smallest == 0 || gapsAllowed)
  {
    candidates.insert(candidates.begin(), told);
    for (int parts = 2; parts <= 20; ++parts)
    {
      candidates.push_back(smallest / parts);
    }
  }
  for (const double spacing : candidates)
  {
    // A twentieth of a step: a grid is still told from none, and no label is moved farther.
    const bool fits = spacing > 0 &&
      std::all_of(heights.begin(), heights.end(),
        [&](double height)
        {
          const double steps = (height - heights.front()) / spacing;
          return std::abs(steps - std::round(steps)) <= 0.05 &&
            (gapsAllowed || steps < static_cast<double>(heights.size()) - 0.5);
        });
    if (fits)
    {
      return spacing;
    }
  }
  throw InputError(slices.front().Name +
    (smallest == 0
        ? ": expected several slices or a slice thickness, found neither"
        : ": expected slices at even distances, found a missing one or other distances"));
}

/**
 * Slices of large segments first, so that what lies within them is painted over: a lesion in a
 * gland in a breast. Slices of a series lie beside each other, and their order means nothing.
 */
std::vector<const Slice*> PaintingOrder(const std::vector<Slice>& slices)
{
  const auto labelOf = [](const Slice& slice)
  { return *std::max_element(slice.Values.begin(), slice.Values.end()); };
  std::map<float, std::size_t> sizes;
  std::vector<std::pair<const Slice*, float>> order;
  for (const Slice& slice : slices)
  {
    order.push_back({ &slice, labelOf(slice) });
    sizes[order.back().second] += static_cast<std::size_t>(std::count_if(slice.Values.begin(),
      slice.Values.end(), [](float label) { return label != 0; }));
  }
  std::stable_sort(order.begin(), order.end(),
    [&sizes](const auto& a, const auto& b) { return sizes[a.second] > sizes[b.second]; });
  std::vector<const Slice*> sorted;
  for (const auto& [slice, label] : order)
  {
    sorted.push_back(slice);
  }
  return sorted;
}

/// The slices on their grid, 0 where there is none.
IntensityVolume Assemble(const std::vector<Slice>& slices, bool gapsAllowed)
{
  const Slice& first = slices.front();
  const Vector3 normal = Cross(first.AlongRow, first.AlongColumn);
  CheckParallel(slices, normal);
  std::vector<double> heights;
  for (const Slice& slice : slices)
  {
    heights.push_back(Dot(slice.Position - first.Position, normal));
  }
  std::sort(heights.begin(), heights.end());
  const std::size_t count = heights.size();
  // A micrometre: frames of several segments share a place.
  heights.erase(
    std::unique(heights.begin(), heights.end(), [](double a, double b) { return b - a < 1e-3; }),
    heights.end());
  if (!gapsAllowed && heights.size() != count)
  {
    throw InputError(first.Name + ": expected slices at places of their own, found two at one");
  }
  const double spacing = FindSliceSpacing(slices, heights, gapsAllowed);
  const auto depth = std::lround((heights.back() - heights.front()) / spacing) + 1;
  if (depth > 65536)
  {
    throw InputError(
      first.Name + ": expected slices near each other, found a stack of " + std::to_string(depth));
  }
  IntensityVolume volume;
  volume.Size = { first.Columns, first.Rows, static_cast<int>(depth) };
  volume.Spacing = { first.ColumnSpacing, first.RowSpacing, spacing };
  volume.Origin = first.Position + heights.front() * normal;
  volume.Direction = { first.AlongRow, first.AlongColumn, normal };
  for (Vector3& axis : volume.Direction)
  {
    axis = (1 / Norm(axis)) * axis;
  }
  const std::size_t area = first.Values.size();
  volume.Voxels.assign(area * static_cast<std::size_t>(depth), 0);
  for (const Slice* slice : PaintingOrder(slices))
  {
    const double height = Dot(slice->Position - first.Position, normal) - heights.front();
    const auto layer = static_cast<std::size_t>(std::lround(height / spacing));
    for (std::size_t pixel = 0; pixel < area; ++pixel)
    {
      float& voxel = volume.Voxels[layer * area + pixel];
      voxel = slice->Values[pixel] != 0 ? slice->Values[pixel] : voxel;
    }
  }
  volume.Validate(first.Name);
  return volume;
}
}

LabelVolume ReadDicomLabels(const std::string& path)
{
  const QuietGdcm quiet;
  const bool isFolder = fs::is_directory(path);
  const std::vector<Slice> slices = isFolder ? ReadSeries(path) : ReadSegmentation(path);
  CheckLabels(slices);
  const IntensityVolume values = Assemble(slices, !isFolder);
  LabelVolume labels;
  static_cast<VolumeGrid&>(labels) = values;
  labels.Voxels.assign(values.Voxels.begin(), values.Voxels.end());
  return labels;
}

IntensityVolume ReadDicomIntensities(const std::string& path)
{
  const QuietGdcm quiet;
  if (!fs::is_directory(path))
  {
    throw InputError(path + ": expected the folder of a DICOM series, found a single file");
  }
  return Assemble(ReadSeries(path), false);
}
}
