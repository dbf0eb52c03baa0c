// SPDX-License-Identifier: Apache-2.0
#include "mammoray/IO/MammogramPictureIO.h"

#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/GuardedRead.h"

#include "vtkDataArray.h"
#include "vtkFloatArray.h"
#include "vtkImageData.h"
#include "vtkImageReader2.h"
#include "vtkJPEGReader.h"
#include "vtkMetaImageReader.h"
#include "vtkNew.h"
#include "vtkPNGReader.h"
#include "vtkPointData.h"
#include "vtkSmartPointer.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

namespace mammoray
{
namespace
{
[[noreturn]] void RefusePicture(const std::string& path, const std::string& why)
{
  throw InputError(path + ": " + why);
}

/// libjpeg and libpng fill what they cannot decode with grey, and only print that they did.
void RefuseDamaged(const std::string& path, const std::string& content)
{
  if (const std::string said = SaidByLibraries(); !said.empty())
  {
    throw InputError(path + ": expected " + content + ", found damaged data (" + said + ")");
  }
}

/// Size, bits and pixels.
Mammogram DecodePicture(const std::string& path)
{
  vtkSmartPointer<vtkImageReader2> reader = vtkSmartPointer<vtkJPEGReader>::New();
  if (std::filesystem::path(path).extension() == ".png")
  {
    reader = vtkSmartPointer<vtkPNGReader>::New();
  }
  if (!std::filesystem::is_regular_file(path) || reader->CanReadFile(path.c_str()) == 0)
  {
    RefusePicture(path, "expected a picture that can be read");
  }
  reader->SetFileName(path.c_str());
  reader->Update();
  vtkImageData* image = reader->GetOutput();
  vtkDataArray* values = image->GetPointData()->GetScalars();
  if (!values || reader->GetErrorCode() != 0)
  {
    RefusePicture(path, "expected a picture that can be decoded");
  }
  RefuseDamaged(path, "a picture");
  Mammogram mammogram;
  mammogram.Columns = image->GetDimensions()[0];
  mammogram.Rows = image->GetDimensions()[1];
  mammogram.BitsStored = 8 * values->GetDataTypeSize();
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
          RefusePicture(path, "expected a grey picture, found a coloured one");
        }
      }
      mammogram.Pixels.push_back(static_cast<float>(value));
    }
  }
  return mammogram;
}

std::vector<unsigned char> DecodeMask(const std::string& path, int columns, int rows)
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
  RefuseDamaged(path, "a mask");
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

std::vector<float> DecodeFloats(const std::string& path, int columns, int rows)
{
  vtkNew<vtkMetaImageReader> reader;
  if (!std::filesystem::is_regular_file(path) || reader->CanReadFile(path.c_str()) == 0)
  {
    throw InputError(path + ": expected an image of floats (.mha) that can be read");
  }
  reader->SetFileName(path.c_str());
  reader->Update();
  RefuseDamaged(path, "an image of floats");
  auto* values = vtkFloatArray::SafeDownCast(reader->GetOutput()->GetPointData()->GetScalars());
  const int* size = reader->GetOutput()->GetDimensions();
  if (!values || size[0] != columns || size[1] != rows || size[2] != 1)
  {
    throw InputError(path + ": expected the mammogram's " + std::to_string(columns) + " x " +
      std::to_string(rows) + " pixels, found " +
      (values ? std::to_string(size[0]) + " x " + std::to_string(size[1]) : "no floats") +
      "; is it the mammogram that was registered?");
  }
  const float* begin = values->GetPointer(0);
  return { begin, begin + values->GetNumberOfValues() };
}

/// A mammogram of pixels alone.
struct Picture
{
  Mammogram Pixels;
};

void Exchange(Parcel& parcel, Picture& picture)
{
  Mammogram& pixels = picture.Pixels;
  parcel(pixels.Columns, pixels.Rows, pixels.BitsStored, pixels.Pixels);
}
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
    RefusePicture(path, "a picture has no header: expected its " + missing + " to be given");
  }
  if (!(*description.PixelSpacingMm > 0))
  {
    RefusePicture(path,
      "expected a positive pixel spacing, found " + std::to_string(*description.PixelSpacingMm) +
        " mm");
  }
  Mammogram mammogram = ReadGuarded(path, "a picture", ReadLimits::Of({ path }),
    [&] {
      return Picture{ DecodePicture(path) };
    }).Pixels;
  mammogram.ColumnSpacingMm = *description.PixelSpacingMm;
  mammogram.RowSpacingMm = mammogram.ColumnSpacingMm;
  mammogram.View = description.View;
  mammogram.Laterality = description.Laterality;
  return mammogram;
}

std::vector<unsigned char> ReadMask(const std::string& path, int columns, int rows)
{
  return ReadGuarded(path, "a mask", ReadLimits::Of({ path }),
    [&] { return DecodeMask(path, columns, rows); });
}

std::vector<float> ReadFloatPicture(const std::string& path, int columns, int rows)
{
  return ReadGuarded(path, "an image of floats", ReadLimits::Of({ path }),
    [&] { return DecodeFloats(path, columns, rows); });
}
}
