// SPDX-License-Identifier: Apache-2.0
#include "mammoray/IO/MammogramIO.h"

#include "Private/DicomStructure.h"
#include "Private/MammogramViews.h"
#include "Private/QuietGdcm.h"
#include "mammoray/Foundation/Error.h"

#include "vtkDataArray.h"
#include "vtkImageData.h"
#include "vtkImageReader2.h"
#include "vtkJPEGReader.h"
#include "vtkMetaImageReader.h"
#include "vtkPNGReader.h"
#include "vtkPointData.h"
#include "vtkSmartPointer.h"

#include <gdcmAttribute.h>
#include <gdcmImageReader.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <sstream>

namespace mammoray
{
namespace
{
[[noreturn]] void Refuse(const std::string& path, const std::string& why)
{
  throw InputError(path + ": " + why);
}

/// Text values of an element without the padding; empty when it is absent or has none.
std::vector<std::string> Texts(const gdcm::DataSet& data, const gdcm::Tag& tag)
{
  std::vector<std::string> values;
  if (!data.FindDataElement(tag))
  {
    return values;
  }
  const gdcm::ByteValue* bytes = data.GetDataElement(tag).GetByteValue();
  if (!bytes || bytes->GetLength() == 0)
  {
    return values;
  }
  std::istringstream stream(std::string(bytes->GetPointer(), bytes->GetLength()));
  for (std::string value; std::getline(stream, value, '\\');)
  {
    const auto blank = [](char c) { return c == ' ' || c == '\0'; };
    value.erase(std::find_if_not(value.rbegin(), value.rend(), blank).base(), value.end());
    value.erase(value.begin(), std::find_if_not(value.begin(), value.end(), blank));
    values.push_back(value);
  }
  return values;
}

std::string Text(const gdcm::DataSet& data, const gdcm::Tag& tag, std::size_t index = 0)
{
  const std::vector<std::string> values = Texts(data, tag);
  return index < values.size() ? values[index] : std::string();
}

/// A decimal string (VR DS or IS); nothing when absent, empty, malformed or not finite.
std::optional<double> Number(const gdcm::DataSet& data, const gdcm::Tag& tag, std::size_t index = 0)
{
  std::istringstream stream(Text(data, tag, index));
  stream.imbue(std::locale::classic());
  double value = 0;
  if (!(stream >> value) || !std::isfinite(value) || !(stream >> std::ws).eof())
  {
    return std::nullopt;
  }
  return value;
}

std::optional<double> PositiveNumber(const gdcm::DataSet& data, const gdcm::Tag& tag,
  std::size_t index = 0)
{
  const std::optional<double> value = Number(data, tag, index);
  return value && *value > 0 ? value : std::nullopt;
}

/// A 16 bit value (VR US or SS) as stored.
std::optional<std::uint16_t> Short(const gdcm::File& file, const gdcm::Tag& tag)
{
  const gdcm::DataSet& data = file.GetDataSet();
  const gdcm::ByteValue* bytes =
    data.FindDataElement(tag) ? data.GetDataElement(tag).GetByteValue() : nullptr;
  if (!bytes || bytes->GetLength() < 2)
  {
    return std::nullopt;
  }
  // The reader has brought binary values of known type into the machine's byte order.
  std::uint16_t value = 0;
  std::memcpy(&value, bytes->GetPointer(), 2);
  return value;
}

/// The view by its code (DICOM context group 4014, SNOMED CT or SNOMED RT), where View Position is
/// empty.
std::string ViewOf(const gdcm::DataSet& data)
{
  const std::string position = Text(data, gdcm::Tag(0x0018, 0x5101));
  const gdcm::Tag sequenceTag(0x0054, 0x0220);
  if (!position.empty() || !data.FindDataElement(sequenceTag))
  {
    return position;
  }
  const auto sequence = data.GetDataElement(sequenceTag).GetValueAsSQ();
  if (!sequence || sequence->GetNumberOfItems() == 0)
  {
    return position;
  }
  const gdcm::DataSet& item = sequence->GetItem(1).GetNestedDataSet();
  const std::string code = Text(item, gdcm::Tag(0x0008, 0x0100));
  for (const MammogramView& view : MammogramViews)
  {
    if (code == view.SnomedCt || code == view.SnomedRt)
    {
      return view.Name;
    }
  }
  return Text(item, gdcm::Tag(0x0008, 0x0104));
}

void ReadGeometry(const gdcm::DataSet& data, const std::string& path, Mammogram& mammogram)
{
  const gdcm::Tag imagerSpacing(0x0018, 0x1164);
  const gdcm::Tag patientSpacing(0x0028, 0x0030);
  double scale = 1;
  gdcm::Tag tag = imagerSpacing;
  if (!PositiveNumber(data, imagerSpacing, 0))
  {
    const std::optional<double> magnification = PositiveNumber(data, gdcm::Tag(0x0018, 0x1114));
    if (!PositiveNumber(data, patientSpacing, 0) || !magnification)
    {
      Refuse(path,
        "expected Imager Pixel Spacing (0018,1164), or Pixel Spacing with Estimated Radiographic "
        "Magnification Factor, found neither: the size of a pixel is not known");
    }
    tag = patientSpacing;
    scale = *magnification;
  }
  // Row spacing comes first in DICOM.
  const std::optional<double> row = PositiveNumber(data, tag, 0);
  const std::optional<double> column = PositiveNumber(data, tag, 1);
  if (!row || !column)
  {
    Refuse(path, "expected two positive numbers as pixel spacing, found one");
  }
  mammogram.RowSpacingMm = scale * *row;
  mammogram.ColumnSpacingMm = scale * *column;

  mammogram.View = ViewOf(data);
  for (const gdcm::Tag& laterality : { gdcm::Tag(0x0020, 0x0062), gdcm::Tag(0x0020, 0x0060) })
  {
    const std::string value = Text(data, laterality);
    if (value == "L" || value == "R")
    {
      mammogram.Laterality = value[0];
      break;
    }
  }
  mammogram.RowDirection = Text(data, gdcm::Tag(0x0020, 0x0020), 0);
  mammogram.ColumnDirection = Text(data, gdcm::Tag(0x0020, 0x0020), 1);
  mammogram.BodyPartThicknessMm = PositiveNumber(data, gdcm::Tag(0x0018, 0x11a0));
  mammogram.PositionerPrimaryAngleDeg = Number(data, gdcm::Tag(0x0018, 0x1510));
  mammogram.SourceToDetectorMm = PositiveNumber(data, gdcm::Tag(0x0018, 0x1110));
  mammogram.SourceToPatientMm = PositiveNumber(data, gdcm::Tag(0x0018, 0x1111));
  mammogram.PeakKilovoltage = PositiveNumber(data, gdcm::Tag(0x0018, 0x0060));
  mammogram.AnodeMaterial = Text(data, gdcm::Tag(0x0018, 0x1191));
  mammogram.FilterMaterial = Text(data, gdcm::Tag(0x0018, 0x7050));
}

void ReadIntensityScale(const gdcm::File& file, const std::string& path, Mammogram& mammogram)
{
  const gdcm::DataSet& data = file.GetDataSet();
  const std::string sopClass = Text(data, gdcm::Tag(0x0008, 0x0016));
  const std::string intent = Text(data, gdcm::Tag(0x0008, 0x0068));
  const bool processing =
    intent.empty() ? sopClass == "1.2.840.10008.5.1.4.1.1.1.2.1" : intent == "FOR PROCESSING";
  mammogram.PresentationIntent =
    processing ? Mammogram::Intent::ForProcessing : Mammogram::Intent::ForPresentation;

  const std::string photometric = Text(data, gdcm::Tag(0x0028, 0x0004));
  if (photometric != "MONOCHROME1" && photometric != "MONOCHROME2")
  {
    Refuse(path, "expected a grey image (MONOCHROME1 or MONOCHROME2), found '" + photometric + "'");
  }
  mammogram.InvertedForDisplay = photometric == "MONOCHROME1";

  const std::string relationship = Text(data, gdcm::Tag(0x0028, 0x1040));
  mammogram.IntensityRelationship = relationship == "LIN" ? Mammogram::Relationship::Linear
    : relationship == "LOG"                               ? Mammogram::Relationship::Logarithmic
                                                          : Mammogram::Relationship::Unknown;
  if (const auto sign = Short(file, gdcm::Tag(0x0028, 0x1041)))
  {
    mammogram.IntensitySign = *sign == 1 ? 1 : *sign == 0xffff ? -1 : 0;
  }
  if (data.FindDataElement(gdcm::Tag(0x0028, 0x3000)))
  {
    Refuse(path, "expected a linear modality rescale, found a Modality LUT Sequence (0028,3000)");
  }
}

/// One frame of `Stored` to floats: unused bits cleared, sign extended, rescaled, padding to NaN.
template <typename Stored>
void Convert(const std::vector<char>& buffer, const gdcm::File& file,
  const gdcm::PixelFormat& format, std::vector<float>& pixels)
{
  const gdcm::DataSet& data = file.GetDataSet();
  const double slope = Number(data, gdcm::Tag(0x0028, 0x1053)).value_or(1);
  const double intercept = Number(data, gdcm::Tag(0x0028, 0x1052)).value_or(0);
  const int bits = format.GetBitsStored();
  const int shift = std::max(0, format.GetHighBit() + 1 - bits);
  const bool isSigned = format.GetPixelRepresentation() == 1;
  const auto value = [&](std::uint64_t raw) -> std::int64_t
  {
    std::int64_t v = static_cast<std::int64_t>((raw >> shift) & ((std::uint64_t{ 1 } << bits) - 1));
    if (isSigned && (v >> (bits - 1)) != 0)
    {
      v -= std::int64_t{ 1 } << bits;
    }
    return v;
  };
  std::int64_t paddingLow = 1;
  std::int64_t paddingHigh = 0;
  if (const auto padding = Short(file, gdcm::Tag(0x0028, 0x0120)))
  {
    const auto limit = Short(file, gdcm::Tag(0x0028, 0x0121)).value_or(*padding);
    const auto typed = [&](std::uint16_t v) -> std::int64_t
    { return isSigned ? static_cast<std::int16_t>(v) : static_cast<std::int64_t>(v); };
    paddingLow = std::min(typed(*padding), typed(limit));
    paddingHigh = std::max(typed(*padding), typed(limit));
  }
  for (std::size_t pixel = 0; pixel < pixels.size(); ++pixel)
  {
    Stored raw{};
    std::memcpy(&raw, buffer.data() + pixel * sizeof(Stored), sizeof(Stored));
    const std::int64_t stored = value(raw);
    pixels[pixel] = stored >= paddingLow && stored <= paddingHigh
      ? std::numeric_limits<float>::quiet_NaN()
      : static_cast<float>(slope * static_cast<double>(stored) + intercept);
  }
}
}

Mammogram ReadMammogram(const std::string& path)
{
  const QuietGdcm quiet;
  std::error_code code;
  if (!std::filesystem::is_regular_file(path, code) || !std::ifstream(path))
  {
    Refuse(path, "expected a DICOM mammogram, found no file that can be read");
  }
  if (const std::string damage = FindDicomDamage(path); !damage.empty())
  {
    Refuse(path, "expected a DICOM mammogram, " + damage);
  }
  // The data set first: what is no mammogram is refused before its pixels are looked at.
  gdcm::Reader header;
  header.SetFileName(path.c_str());
  if (!header.Read())
  {
    Refuse(path, "expected a DICOM mammogram, found a header that cannot be read");
  }
  const gdcm::DataSet& data = header.GetFile().GetDataSet();
  const std::string modality = Text(data, gdcm::Tag(0x0008, 0x0060));
  if (modality != "MG")
  {
    Refuse(path,
      "expected a mammogram (modality MG), found modality '" +
        (modality.empty() ? std::string("none") : modality) + "'");
  }
  const double frames = Number(data, gdcm::Tag(0x0028, 0x0008)).value_or(1);
  if (frames > 1 || Text(data, gdcm::Tag(0x0008, 0x0016)) == "1.2.840.10008.5.1.4.1.1.13.1.3")
  {
    Refuse(path,
      "expected one projection, found a tomosynthesis or multi-frame object of " +
        std::to_string(static_cast<long>(frames)) + " frame(s)");
  }
  Mammogram mammogram;
  ReadIntensityScale(header.GetFile(), path, mammogram);
  ReadGeometry(data, path, mammogram);

  gdcm::ImageReader reader;
  reader.SetFileName(path.c_str());
  if (!reader.Read())
  {
    Refuse(path, "expected pixel data that can be decoded, found none (cut short or damaged)");
  }
  const gdcm::Image& image = reader.GetImage();
  const gdcm::PixelFormat format = image.GetPixelFormat();
  if (format.GetSamplesPerPixel() != 1 || image.GetNumberOfDimensions() != 2)
  {
    Refuse(path,
      "expected one value per pixel and one frame, found " +
        std::to_string(format.GetSamplesPerPixel()) + " values and " +
        std::to_string(image.GetNumberOfDimensions()) + " dimensions");
  }
  mammogram.Columns = static_cast<int>(image.GetDimension(0));
  mammogram.Rows = static_cast<int>(image.GetDimension(1));
  mammogram.BitsStored = format.GetBitsStored();
  const std::size_t pixelCount =
    static_cast<std::size_t>(mammogram.Columns) * static_cast<std::size_t>(mammogram.Rows);
  const std::size_t pixelBytes = format.GetPixelSize();
  // Uncompressed data that ends early is read without complaint; its length tells.
  const gdcm::ByteValue* stored =
    reader.GetFile().GetDataSet().GetDataElement(gdcm::Tag(0x7fe0, 0x0010)).GetByteValue();
  if (pixelCount == 0 || image.GetBufferLength() != pixelCount * pixelBytes ||
    (stored && stored->GetLength() < pixelCount * format.GetBitsAllocated() / 8))
  {
    Refuse(path,
      "expected " + std::to_string(mammogram.Columns) + " x " + std::to_string(mammogram.Rows) +
        " pixels, found fewer (cut short)");
  }
  std::vector<char> buffer(image.GetBufferLength());
  if (!image.GetBuffer(buffer.data()))
  {
    Refuse(path,
      "expected pixel data that can be decoded, found transfer syntax " +
        std::string(reader.GetFile().GetHeader().GetDataSetTransferSyntax().GetString()) +
        " that could not (not supported, or damaged)");
  }
  mammogram.Pixels.resize(pixelCount);
  switch (pixelBytes)
  {
    case 1:
      Convert<std::uint8_t>(buffer, reader.GetFile(), format, mammogram.Pixels);
      break;
    case 2:
      Convert<std::uint16_t>(buffer, reader.GetFile(), format, mammogram.Pixels);
      break;
    case 4:
      Convert<std::uint32_t>(buffer, reader.GetFile(), format, mammogram.Pixels);
      break;
    default:
      Refuse(path,
        "expected 8, 16 or 32 bits per pixel, found " + std::to_string(format.GetBitsAllocated()));
  }
  return mammogram;
}

bool IsPicturePath(const std::string& path)
{
  const std::string extension = std::filesystem::path(path).extension().string();
  return extension == ".jpg" || extension == ".jpeg" || extension == ".png";
}

Mammogram ReadMammogramPicture(const std::string& path, const PictureDescription& description)
{
  std::string missing;
  const auto need = [&missing](bool given, const char* what)
  { missing += given ? "" : (missing.empty() ? "" : ", ") + std::string(what); };
  need(description.PixelSpacingMm.has_value(), "pixel spacing");
  need(!description.View.empty(), "view");
  need(description.Laterality == 'L' || description.Laterality == 'R', "laterality");
  if (!missing.empty())
  {
    Refuse(path, "a picture has no header: expected its " + missing + " to be given");
  }
  if (!(*description.PixelSpacingMm > 0))
  {
    Refuse(path,
      "expected a positive pixel spacing, found " + std::to_string(*description.PixelSpacingMm) +
        " mm");
  }
  vtkSmartPointer<vtkImageReader2> reader = vtkSmartPointer<vtkJPEGReader>::New();
  if (std::filesystem::path(path).extension() == ".png")
  {
    reader = vtkSmartPointer<vtkPNGReader>::New();
  }
  if (!std::filesystem::is_regular_file(path) || reader->CanReadFile(path.c_str()) == 0)
  {
    Refuse(path, "expected a picture that can be read");
  }
  reader->SetFileName(path.c_str());
  reader->Update();
  vtkImageData* image = reader->GetOutput();
  vtkDataArray* values = image->GetPointData()->GetScalars();
  if (!values || reader->GetErrorCode() != 0)
  {
    Refuse(path, "expected a picture that can be decoded");
  }
  Mammogram mammogram;
  mammogram.Columns = image->GetDimensions()[0];
  mammogram.Rows = image->GetDimensions()[1];
  mammogram.BitsStored = 8 * values->GetDataTypeSize();
  mammogram.ColumnSpacingMm = *description.PixelSpacingMm;
  mammogram.RowSpacingMm = mammogram.ColumnSpacingMm;
  mammogram.View = description.View;
  mammogram.Laterality = description.Laterality;
  const int colours = std::min(values->GetNumberOfComponents(), 3);
  // VTK has the last row first.
  for (int row = mammogram.Rows - 1; row >= 0; --row)
  {
    for (int column = 0; column < mammogram.Columns; ++column)
    {
      const vtkIdType id = static_cast<vtkIdType>(row) * mammogram.Columns + column;
      const double value = values->GetComponent(id, 0);
      for (int colour = 1; colour < colours; ++colour)
      {
        // Some encoders round the three channels of grey apart.
        if (std::abs(values->GetComponent(id, colour) - value) > 2)
        {
          Refuse(path, "expected a grey picture, found a coloured one");
        }
      }
      mammogram.Pixels.push_back(static_cast<float>(value));
    }
  }
  return mammogram;
}

std::vector<unsigned char> ReadMask(const std::string& path, int columns, int rows)
{
  if (!std::filesystem::is_regular_file(path))
  {
    throw InputError(path + ": no such file");
  }
  vtkSmartPointer<vtkImageReader2> reader;
  const std::string extension = std::filesystem::path(path).extension().string();
  if (extension == ".png")
  {
    reader = vtkSmartPointer<vtkPNGReader>::New();
  }
  else if (extension == ".mha" || extension == ".mhd")
  {
    reader = vtkSmartPointer<vtkMetaImageReader>::New();
  }
  if (!reader || reader->CanReadFile(path.c_str()) == 0)
  {
    throw InputError(path + ": expected a mask as .png, .mha or .mhd that can be read");
  }
  reader->SetFileName(path.c_str());
  reader->Update();
  vtkImageData* image = reader->GetOutput();
  vtkDataArray* values = image->GetPointData()->GetScalars();
  const int* size = image->GetDimensions();
  if (!values || size[0] != columns || size[1] != rows || size[2] != 1)
  {
    throw InputError(path + ": expected a mask of the mammogram's " + std::to_string(columns) +
      " x " + std::to_string(rows) + " pixels, found " + std::to_string(size[0]) + " x " +
      std::to_string(size[1]));
  }
  std::vector<unsigned char> mask(static_cast<std::size_t>(columns) * rows, 0);
  // VTK turns the rows of a PNG so that the first is at the bottom.
  const bool turned = extension == ".png";
  for (int row = 0; row < rows; ++row)
  {
    const int from = turned ? rows - 1 - row : row;
    for (int column = 0; column < columns; ++column)
    {
      const vtkIdType id = static_cast<vtkIdType>(from) * columns + column;
      mask[static_cast<std::size_t>(row) * columns + column] = values->GetComponent(id, 0) != 0;
    }
  }
  return mask;
}
}
