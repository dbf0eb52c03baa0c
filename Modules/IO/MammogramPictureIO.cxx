// SPDX-License-Identifier: Apache-2.0
#include "mammoray/IO/MammogramPictureIO.h"

#include "Private/InputFile.h"
#include "mammoray/IO/GuardedRead.h"

#include "vtkDataArray.h"
#include "vtkImageData.h"
#include "vtkImageReader2.h"
#include "vtkJPEGReader.h"
#include "vtkMetaImageReader.h"
#include "vtkPNGReader.h"
#include "vtkPointData.h"
#include "vtkSmartPointer.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>

namespace mammoray
{
namespace
{
/// An image as its file has it, rows from the top.
struct DecodedImage
{
  int Columns = 0;
  int Rows = 0;
  int Bits = 0;
  bool IsFloat = false;
  /// Colours that are not grey.
  bool IsColoured = false;
  /// Values of the first channel, Rows * Columns.
  std::vector<float> Pixels;
};

void Exchange(Parcel& parcel, DecodedImage& image)
{
  parcel(image.Columns, image.Rows, image.Bits, image.IsFloat, image.IsColoured, image.Pixels);
}

/// Null for an unknown extension.
vtkSmartPointer<vtkImageReader2> ReaderOf(const std::string& extension)
{
  if (extension == ".png")
  {
    return vtkSmartPointer<vtkPNGReader>::New();
  }
  if (extension == ".mha" || extension == ".mhd")
  {
    return vtkSmartPointer<vtkMetaImageReader>::New();
  }
  if (extension == ".jpg" || extension == ".jpeg")
  {
    return vtkSmartPointer<vtkJPEGReader>::New();
  }
  return nullptr;
}

DecodedImage Decode(const std::string& path, const std::string& what)
{
  const std::string extension = ExtensionOf(path);
  const auto reader = ReaderOf(extension);
  if (!reader || reader->CanReadFile(path.c_str()) == 0)
  {
    throw InputError(path + ": expected " + what + " that can be read");
  }
  reader->SetFileName(path.c_str());
  reader->Update();
  vtkImageData* const output = reader->GetOutput();
  vtkDataArray* const values = output->GetPointData()->GetScalars();
  const int* const size = output->GetDimensions();
  if (!values || reader->GetErrorCode() != 0 || size[2] != 1)
  {
    throw InputError(path + ": expected " + what + " that can be decoded");
  }
  // libjpeg and libpng fill what they cannot decode with grey, and only print that they did.
  if (const std::string said = SaidByLibraries(); !said.empty())
  {
    throw InputError(path + ": expected " + what + ", found damaged data (" + said + ")");
  }
  DecodedImage image{ size[0], size[1], 8 * values->GetDataTypeSize(),
    values->GetDataType() == VTK_FLOAT };
  image.Pixels.reserve(static_cast<std::size_t>(values->GetNumberOfTuples()));
  // The second of two is the opacity.
  const int components = values->GetNumberOfComponents();
  const int colours = components == 2 ? 1 : std::min(components, 3);
  // VTK has the last row of PNG and JPEG first.
  const bool isTurned = !extension.starts_with(".mh");
  for (int row = 0; row < image.Rows; ++row)
  {
    const vtkIdType first =
      static_cast<vtkIdType>(isTurned ? image.Rows - 1 - row : row) * image.Columns;
    for (vtkIdType id = first; id < first + image.Columns; ++id)
    {
      const double value = values->GetComponent(id, 0);
      image.Pixels.push_back(static_cast<float>(value));
      for (int colour = 1; colour < colours; ++colour)
      {
        // Some encoders round the three channels of grey apart.
        image.IsColoured |= std::abs(values->GetComponent(id, colour) - value) > 2;
      }
    }
  }
  return image;
}

DecodedImage Read(const std::string& path, const std::string& what)
{
  CheckReadable(path, what);
  return ReadGuarded(path, what, ReadLimits::Of({ path }), [&] { return Decode(path, what); });
}

/// Throws unless the image has as many pixels as the mammogram.
void CheckSize(const std::string& path, const DecodedImage& image, int columns, int rows,
  const std::string& what)
{
  if (image.Columns != columns || image.Rows != rows)
  {
    throw InputError(path + ": expected " + what + "the mammogram's " + std::to_string(columns) +
      " x " + std::to_string(rows) + " pixels, found " + std::to_string(image.Columns) + " x " +
      std::to_string(image.Rows));
  }
}
}

bool IsPicturePath(const std::string& path)
{
  const std::string extension = ExtensionOf(path);
  return extension == ".jpg" || extension == ".jpeg" || extension == ".png";
}

Mammogram ReadMammogramPicture(const std::string& path, const PictureDescription& description)
{
  std::string missing;
  std::vector<std::string> fields;
  const auto need = [&](bool given, const char* what, const char* field)
  {
    if (!given)
    {
      missing += (missing.empty() ? "" : ", ") + std::string(what);
      fields.emplace_back(field);
    }
  };
  need(description.PixelSpacingMm.has_value(), "pixel spacing", "PixelSpacingMm");
  need(!description.View.empty(), "view", "View");
  need(description.Laterality == 'L' || description.Laterality == 'R', "laterality", "Laterality");
  if (!missing.empty())
  {
    const bool thick = description.ThicknessMm.has_value();
    if (!thick)
    {
      fields.emplace_back("ThicknessMm");
    }
    throw InputError(path + ": a picture has no header: expected its " + missing + " to be given" +
        (thick ? "" : ", and its thickness if it is known"),
      { fields.front(), "", fields, true });
  }
  if (!(*description.PixelSpacingMm > 0))
  {
    throw InputError(path + ": expected a positive pixel spacing, found " +
      std::to_string(*description.PixelSpacingMm) + " mm");
  }
  DecodedImage image = Read(path, "a picture");
  if (image.IsColoured)
  {
    throw InputError(path + ": expected a grey picture, found a coloured one");
  }
  Mammogram mammogram;
  mammogram.Columns = image.Columns;
  mammogram.Rows = image.Rows;
  mammogram.BitsStored = image.Bits;
  mammogram.Pixels = std::move(image.Pixels);
  mammogram.ColumnSpacingMm = *description.PixelSpacingMm;
  mammogram.RowSpacingMm = mammogram.ColumnSpacingMm;
  mammogram.View = description.View;
  mammogram.Laterality = description.Laterality;
  return mammogram;
}

std::vector<unsigned char> ReadMask(const std::string& path, int columns, int rows)
{
  const std::string what = "a mask (.png, .mha or .mhd)";
  if (ExtensionOf(path).starts_with(".jp")) // its compression changes zeros
  {
    throw InputError(path + ": expected " + what + ", found a JPEG");
  }
  const DecodedImage image = Read(path, what);
  CheckSize(path, image, columns, rows, "a mask of ");
  std::vector<unsigned char> mask(image.Pixels.size());
  std::transform(image.Pixels.begin(), image.Pixels.end(), mask.begin(),
    [](float value) { return static_cast<unsigned char>(value != 0 ? 1 : 0); });
  return mask;
}

std::vector<float> ReadFloatPicture(const std::string& path, int columns, int rows)
{
  DecodedImage image = Read(path, "an image of floats (.mha)");
  CheckSize(path, image, columns, rows, "");
  if (!image.IsFloat)
  {
    throw InputError(path + ": expected an image of floats, found other values");
  }
  return std::move(image.Pixels);
}
}
