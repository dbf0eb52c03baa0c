// SPDX-License-Identifier: Apache-2.0
#include "mammoray/IO/ProjectionImage.h"

#include "Private/InputFile.h"
#include "Private/VolumeFile.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/Numbers.h"
#include "mammoray/IO/AtomicFile.h"

#include "vtkFloatArray.h"
#include "vtkImageData.h"
#include "vtkMatrix3x3.h"
#include "vtkNew.h"
#include "vtkPNGWriter.h"
#include "vtkPointData.h"
#include "vtkTIFFWriter.h"
#include "vtkUnsignedCharArray.h"
#include "vtkUnsignedShortArray.h"
#include "vtkXMLImageDataWriter.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

namespace mammoray
{
namespace
{
constexpr const char* PathLengthPrefix = "PathLength_";

vtkSmartPointer<vtkFloatArray> FloatArray(const std::string& name, const float* values,
  std::size_t count)
{
  auto array = vtkSmartPointer<vtkFloatArray>::New();
  array->SetName(name.c_str());
  array->SetNumberOfValues(static_cast<vtkIdType>(count));
  std::copy(values, values + count, array->GetPointer(0));
  return array;
}

/// The float arrays that become the channels of a file.
std::vector<vtkFloatArray*> Channels(vtkImageData* image, bool pathLengths)
{
  std::vector<vtkFloatArray*> channels;
  vtkPointData* data = image->GetPointData();
  for (int index = 0; index < data->GetNumberOfArrays(); ++index)
  {
    auto* array = vtkFloatArray::SafeDownCast(data->GetArray(index));
    const bool isLength = array && std::string(array->GetName()).rfind(PathLengthPrefix, 0) == 0;
    if (array && (pathLengths ? isLength : array == data->GetScalars()))
    {
      channels.push_back(array);
    }
  }
  if (channels.empty())
  {
    throw InputError("projection: expected arrays to write, found none");
  }
  return channels;
}

/// The channels, interleaved, with the detector's pose.
void WriteFloats(vtkImageData* image, const std::string& path, bool pathLengths)
{
  const std::vector<vtkFloatArray*> channels = Channels(image, pathLengths);
  std::vector<float> values;
  const vtkIdType count = image->GetNumberOfPoints();
  unsigned components = 0;
  for (vtkFloatArray* channel : channels)
  {
    components += static_cast<unsigned>(channel->GetNumberOfComponents());
  }
  values.reserve(static_cast<std::size_t>(count) * components);
  for (vtkIdType pixel = 0; pixel < count; ++pixel)
  {
    for (vtkFloatArray* channel : channels)
    {
      const vtkIdType width = channel->GetNumberOfComponents();
      const float* first = channel->GetPointer(pixel * width);
      values.insert(values.end(), first, first + width);
    }
  }
  VolumeGrid grid;
  const double* matrix = image->GetDirectionMatrix()->GetData(); // columns are the axes
  for (std::size_t axis = 0; axis < 3; ++axis)
  {
    grid.Size[axis] = image->GetDimensions()[axis];
    grid.Origin[axis] = image->GetOrigin()[axis];
    grid.Spacing[axis] = image->GetSpacing()[axis];
    grid.Direction[axis] = { matrix[axis], matrix[3 + axis], matrix[6 + axis] };
  }
  WriteVolumeFile(path, grid, values.data(), components, false);
}

/// `values` from 0 to `white` as 16-bit grey, row 0 on top.
void WritePng(vtkImageData* image, vtkFloatArray* values, float white, const std::string& path)
{
  int size[3];
  image->GetDimensions(size);
  vtkNew<vtkUnsignedShortArray> grey;
  grey->SetName(values->GetName());
  grey->SetNumberOfValues(values->GetNumberOfValues());
  for (int row = 0; row < size[1]; ++row)
  {
    for (int column = 0; column < size[0]; ++column)
    {
      // VTK's writer puts the last row on top.
      const float value =
        values->GetValue(static_cast<vtkIdType>(size[1] - 1 - row) * size[0] + column) / white;
      grey->SetValue(static_cast<vtkIdType>(row) * size[0] + column,
        static_cast<unsigned short>(std::lround(65535 * std::clamp(value, 0.0f, 1.0f))));
    }
  }
  vtkNew<vtkImageData> picture;
  picture->SetDimensions(size);
  picture->GetPointData()->SetScalars(grey);
  WritePicture(picture, path);
}

bool IsTiff(const std::string& path)
{
  const std::string extension = ExtensionOf(path);
  return extension == ".tif" || extension == ".tiff";
}

void WriteTiff(const ProjectionStack& stack, const std::string& path)
{
  const auto columns = static_cast<std::ptrdiff_t>(stack.Columns);
  const std::ptrdiff_t size = columns * stack.Rows;
  vtkNew<vtkFloatArray> values;
  values->SetNumberOfValues(static_cast<vtkIdType>(stack.Values.size()));
  // VTK's writer puts the last row on top.
  for (std::ptrdiff_t page = 0; page < stack.Number; ++page)
  {
    for (std::ptrdiff_t row = 0; row < stack.Rows; ++row)
    {
      const float* from = stack.Values.data() + page * size + row * columns;
      std::copy(from, from + columns,
        values->GetPointer(page * size + (stack.Rows - 1 - row) * columns));
    }
  }
  vtkNew<vtkImageData> image;
  image->SetDimensions(stack.Columns, stack.Rows, stack.Number);
  image->SetSpacing(stack.ColumnSpacingMm, stack.RowSpacingMm, 1);
  image->GetPointData()->SetScalars(values);
  WriteAtomicFile(path,
    [&](const std::string& staged)
    {
      vtkNew<vtkTIFFWriter> writer;
      writer->SetInputData(image);
      writer->SetFileName(staged.c_str());
      writer->SetFileDimensionality(3);
      writer->SetCompressionToNoCompression();
      writer->Write();
      if (writer->GetErrorCode() != 0)
      {
        throw InputError(path + ": cannot be written");
      }
    });
}
}

void WritePicture(vtkImageData* image, const std::string& path)
{
  vtkNew<vtkPNGWriter> writer;
  writer->SetInputData(image);
  writer->WriteToMemoryOn();
  writer->Write();
  vtkUnsignedCharArray* bytes = writer->GetResult();
  if (writer->GetErrorCode() != 0 || !bytes)
  {
    throw InputError(path + ": cannot be written");
  }
  WriteAtomicFile(path,
    { reinterpret_cast<const char*>(bytes->GetPointer(0)),
      static_cast<std::size_t>(bytes->GetNumberOfValues()) });
}

vtkSmartPointer<vtkImageData> MakeDetectorImage(const XRayDetector& detector)
{
  const double width = Norm(detector.ColumnStep);
  const double height = Norm(detector.RowStep);
  // 1e-6: directions computed in float.
  if (!(width > 0 && height > 0) ||
    std::abs(Dot(detector.ColumnStep, detector.RowStep)) > 1e-6 * width * height)
  {
    throw InputError("detector: expected columns and rows at right angles");
  }
  const Vector3 u = (1 / width) * detector.ColumnStep;
  const Vector3 v = (1 / height) * detector.RowStep;
  const Vector3 n = Cross(u, v);
  auto image = vtkSmartPointer<vtkImageData>::New();
  image->SetDimensions(detector.Columns, detector.Rows, 1);
  image->SetSpacing(width, height, 1.0);
  image->SetOrigin(detector.Origin.data());
  image->SetDirectionMatrix(u[0], v[0], n[0], u[1], v[1], n[1], u[2], v[2], n[2]);
  return image;
}

vtkSmartPointer<vtkImageData> ToImage(const Exposure& exposure, const XRayDetector& detector,
  const std::vector<std::string>& materialNames)
{
  const PathLengthImage& lengths = *exposure.Lengths;
  auto image = MakeDetectorImage(detector);
  vtkPointData* data = image->GetPointData();
  const std::size_t pixelCount = lengths.NumberOfPixels();
  data->SetScalars(FloatArray("Transmission", exposure.Transmission.data(), pixelCount));
  data->AddArray(FloatArray(LogAttenuationArrayName, exposure.LogAttenuation.data(), pixelCount));
  for (int material = 1; material < lengths.Materials; ++material)
  {
    const auto index = static_cast<std::size_t>(material);
    const std::string name = index < materialNames.size() && !materialNames[index].empty()
      ? materialNames[index]
      : std::to_string(material);
    data->AddArray(FloatArray(PathLengthPrefix + name, lengths.Material(material), pixelCount));
  }
  vtkNew<vtkUnsignedCharArray> consistency;
  consistency->SetName("Consistency");
  consistency->SetNumberOfValues(static_cast<vtkIdType>(pixelCount));
  std::transform(lengths.Inconsistent.begin(), lengths.Inconsistent.end(),
    consistency->GetPointer(0),
    [](unsigned char inconsistent) { return static_cast<unsigned char>(1 - inconsistent); });
  data->AddArray(consistency);
  return image;
}

vtkSmartPointer<vtkImageData> ToImage(const std::vector<float>& values, const std::string& name,
  const XRayDetector& detector)
{
  auto image = MakeDetectorImage(detector);
  if (values.size() != static_cast<std::size_t>(image->GetNumberOfPoints()))
  {
    throw InputError(name + ": expected " + std::to_string(image->GetNumberOfPoints()) +
      " values, found " + std::to_string(values.size()));
  }
  image->GetPointData()->SetScalars(FloatArray(name, values.data(), values.size()));
  return image;
}

vtkSmartPointer<vtkImageData> ToDeflectionImage(const Exposure& exposure,
  const XRayDetector& detector)
{
  auto image = MakeDetectorImage(detector);
  const std::size_t pixelCount = exposure.Transmission.size();
  vtkNew<vtkFloatArray> deflection;
  deflection->SetName("Deflection");
  deflection->SetNumberOfComponents(2);
  deflection->SetNumberOfTuples(static_cast<vtkIdType>(pixelCount));
  for (std::size_t pixel = 0; pixel < pixelCount; ++pixel)
  {
    float* target = deflection->GetPointer(2 * static_cast<vtkIdType>(pixel));
    target[0] = exposure.Deflection[pixel];
    target[1] = exposure.Deflection[pixelCount + pixel];
  }
  image->GetPointData()->SetScalars(deflection);
  return image;
}

float FindWhite(const float* values, std::size_t count)
{
  const float white = QuantileElement(std::vector<float>(values, values + count), 0.999);
  return white > 0 ? white : 1.0f;
}

void WriteRadiograph(vtkImageData* image, const std::string& path, const std::string& arrayName)
{
  auto* array = vtkFloatArray::SafeDownCast(image->GetPointData()->GetArray(arrayName.c_str()));
  if (!array || array->GetNumberOfValues() == 0)
  {
    throw InputError("projection: expected the array " + arrayName + ", found none");
  }
  if (std::filesystem::path(path).extension() != ".png")
  {
    throw InputError(path + ": expected the extension .png");
  }
  const auto count = static_cast<std::size_t>(array->GetNumberOfValues());
  WritePng(image, array, FindWhite(array->GetPointer(0), count), path);
}

void CheckProjectionExtension(const std::string& path, bool pathLengths)
{
  const std::string extension = std::filesystem::path(path).extension().string();
  if (extension != ".vti" && extension != ".mha" && extension != ".nrrd" &&
    ((extension != ".png" && extension != ".tif") || pathLengths))
  {
    throw InputError(path + ": expected the extension .vti, .mha" +
      (pathLengths ? " or .nrrd" : ", .nrrd, .tif or .png"));
  }
}

void WriteProjection(vtkImageData* image, const std::string& path, bool pathLengths)
{
  CheckProjectionExtension(path, pathLengths);
  const std::string extension = std::filesystem::path(path).extension().string();
  if (extension == ".vti")
  {
    vtkNew<vtkXMLImageDataWriter> writer;
    writer->SetInputData(image);
    WriteAtomicFile(path,
      [&](const std::string& staged)
      {
        writer->SetFileName(staged.c_str());
        if (writer->Write() == 0 || writer->GetErrorCode() != 0)
        {
          throw InputError(path + ": cannot be written");
        }
      });
  }
  else if (extension == ".mha" || extension == ".nrrd")
  {
    WriteFloats(image, path, pathLengths);
  }
  else if (extension == ".tif")
  {
    vtkFloatArray* values = Channels(image, false).front();
    const double* spacing = image->GetSpacing();
    const float* begin = values->GetPointer(0);
    WriteProjectionStack({ image->GetDimensions()[0], image->GetDimensions()[1], 1, spacing[0],
                           spacing[1], { begin, begin + values->GetNumberOfValues() } },
      path);
  }
  else
  {
    WritePng(image, Channels(image, false).front(), 1.0f, path);
  }
}

void CheckStackExtension(const std::string& path)
{
  const std::string extension = ExtensionOf(path);
  if (!IsTiff(path) && extension != ".mha" && extension != ".nrrd")
  {
    throw InputError(
      "output " + path + ": expected .tif, .mha or .nrrd for a series of projections");
  }
}

void WriteProjectionStack(const ProjectionStack& stack, const std::string& path)
{
  CheckStackExtension(path);
  const std::size_t expected =
    static_cast<std::size_t>(stack.Columns) * stack.Rows * static_cast<std::size_t>(stack.Number);
  if (expected == 0 || stack.Values.size() != expected)
  {
    throw InputError("projections: expected " + std::to_string(expected) + " values, found " +
      std::to_string(stack.Values.size()));
  }
  if (IsTiff(path))
  {
    WriteTiff(stack, path);
    return;
  }
  VolumeGrid grid;
  grid.Size = { stack.Columns, stack.Rows, stack.Number };
  grid.Spacing = { stack.ColumnSpacingMm, stack.RowSpacingMm, 1 };
  WriteVolumeFile(path, grid, stack.Values.data(), 1, false);
}
}
