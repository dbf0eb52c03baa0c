// SPDX-License-Identifier: Apache-2.0
// The projector as a function of Octave and MATLAB; mammoray_project.m is its manual.
#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/SpellingSuggestions.h"
#include "mammoray/IO/SceneIO.h"
#include "mammoray/XRay/Exposer.h"
#include "mammoray/XRay/PathLengthProjector.h"
#include "mammoray/XRay/Shadow.h"

#include <mex.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <initializer_list>
#include <memory>
#include <string>
#include <vector>

namespace
{
using namespace mammoray;

/// A real matrix, columns first; of more dimensions, the later ones count as columns.
struct Matrix
{
  std::vector<double> Values;
  std::vector<std::size_t> Size;

  std::size_t Rows() const { return this->Size[0]; }
  std::size_t Columns() const
  {
    return this->Values.size() / std::max<std::size_t>(this->Size[0], 1);
  }
  double At(std::size_t row, std::size_t column) const
  {
    return this->Values[column * this->Size[0] + row];
  }
};

std::string SizeOf(const Matrix& matrix)
{
  std::string text;
  for (const std::size_t length : matrix.Size)
  {
    text += (text.empty() ? "" : " x ") + std::to_string(length);
  }
  return text;
}

/// Of doubles, singles or whole numbers of any size.
std::vector<double> NumbersOf(const mxArray* array, const std::string& name)
{
  if (!mxIsNumeric(array))
  {
    throw InputError(name + ": expected a matrix of numbers, found " + mxGetClassName(array));
  }
  mxArray* input = mxDuplicateArray(array);
  mxArray* doubles = nullptr;
  if (mexCallMATLAB(1, &doubles, 1, &input, "double") != 0)
  {
    throw InputError(name + ": expected numbers that become double");
  }
  std::vector<double> numbers(mxGetPr(doubles), mxGetPr(doubles) + mxGetNumberOfElements(doubles));
  mxDestroyArray(input);
  mxDestroyArray(doubles);
  return numbers;
}

Matrix ToArray(const mxArray* array, const std::string& name, std::size_t mostDimensions)
{
  if (!array || mxIsComplex(array) || mxIsSparse(array) ||
    static_cast<std::size_t>(mxGetNumberOfDimensions(array)) > mostDimensions)
  {
    throw InputError(name + ": expected a full real matrix, found " +
      (!array                  ? std::string("nothing")
          : mxIsSparse(array)  ? "a sparse one"
          : mxIsComplex(array) ? "a complex one"
                               : std::to_string(mxGetNumberOfDimensions(array)) + " dimensions"));
  }
  const mwSize* size = mxGetDimensions(array);
  return { NumbersOf(array, name), { size, size + mxGetNumberOfDimensions(array) } };
}

Matrix ToMatrix(const mxArray* array, const std::string& name)
{
  return ToArray(array, name, 2);
}

/// Throws InputError where these are several structs or none, or, with what may have been meant,
/// where there are other fields.
void CheckFields(const mxArray* array, const std::string& name,
  const std::vector<std::string>& known)
{
  if (mxGetNumberOfElements(array) != 1)
  {
    throw InputError(
      name + ": expected one struct, found " + std::to_string(mxGetNumberOfElements(array)));
  }
  for (int field = 0; field < mxGetNumberOfFields(array); ++field)
  {
    const std::string found = mxGetFieldNameByNumber(array, field);
    if (std::find(known.begin(), known.end(), found) == known.end())
    {
      throw InputError(name + ": no field '" + found + "'; " + SpellingHint(found, known));
    }
  }
}

Vector3 ToVector(const mxArray* array, const std::string& name)
{
  const Matrix matrix = ToMatrix(array, name);
  if (matrix.Values.size() != 3)
  {
    throw InputError(name + ": expected three numbers, found " + SizeOf(matrix));
  }
  return { matrix.Values[0], matrix.Values[1], matrix.Values[2] };
}

/// A whole number from `least` to `most`; `row` is that of the matrix `name`, from 1, 0 for a
/// number.
int ToWhole(double value, int least, int most, const char* name, std::size_t row = 0)
{
  if (!(value >= least && value <= most) || value != std::floor(value))
  {
    const std::string place = row > 0 ? '(' + std::to_string(row) + ", :)" : std::string();
    char text[160];
    std::snprintf(text, sizeof text, "%s%s: expected a whole number from %d to %d, found %g", name,
      place.c_str(), least, most, value);
    throw InputError(text);
  }
  return static_cast<int>(value);
}

int ToCount(const mxArray* array, int most, const char* name)
{
  const Matrix matrix = ToMatrix(array, name);
  if (matrix.Values.size() != 1)
  {
    throw InputError(std::string(name) + ": expected one number, found " + SizeOf(matrix));
  }
  return ToWhole(matrix.Values[0], 1, most, name);
}

SurfaceMesh ToSurface(const mxArray* vertexArray, const mxArray* faceArray,
  const mxArray* regionArray, int regionCount)
{
  const Matrix vertices = ToMatrix(vertexArray, "vertices");
  const Matrix faces = ToMatrix(faceArray, "faces");
  const Matrix regions = ToMatrix(regionArray, "regions");
  if (vertices.Columns() != 3 || faces.Columns() != 3)
  {
    throw InputError("expected n x 3 vertices and m x 3 faces, found " + SizeOf(vertices) +
      " and " + SizeOf(faces));
  }
  if (regions.Rows() != faces.Rows() || (regions.Columns() != 1 && regions.Columns() != 2))
  {
    throw InputError("regions: expected " + std::to_string(faces.Rows()) + " x 2 or x 1, found " +
      SizeOf(regions));
  }
  const auto vertexCount = static_cast<int>(std::min<std::size_t>(vertices.Rows(), 2147483647));
  SurfaceMesh surface;
  for (std::size_t vertex = 0; vertex < vertices.Rows(); ++vertex)
  {
    for (std::size_t axis = 0; axis < 3; ++axis)
    {
      surface.Points.push_back(vertices.At(vertex, axis));
    }
  }
  for (std::size_t face = 0; face < faces.Rows(); ++face)
  {
    for (std::size_t corner = 0; corner < 3; ++corner)
    {
      surface.Triangles.push_back(static_cast<std::uint32_t>(
        ToWhole(faces.At(face, corner), 1, vertexCount, "faces", face + 1) - 1));
    }
    const std::size_t back = regions.Columns() - 1;
    const auto region = [&](std::size_t column)
    {
      return static_cast<std::uint16_t>(
        ToWhole(regions.At(face, column), 0, regionCount, "regions", face + 1));
    };
    surface.FrontMaterials.push_back(back == 0 ? 0 : region(0));
    surface.BackMaterials.push_back(region(back));
  }
  surface.Validate("mesh");
  return surface;
}

XRaySource ToSource(const mxArray* array)
{
  XRaySource source;
  if (mxIsStruct(array))
  {
    CheckFields(array, "source", { "direction" });
    source.Type = XRaySource::Kind::Parallel;
    source.Direction = ToVector(mxGetField(array, 0, "direction"), "source.direction");
  }
  else
  {
    source.Position = ToVector(array, "source");
  }
  return source;
}

XRayDetector ToDetector(const mxArray* array)
{
  if (!mxIsStruct(array))
  {
    throw InputError(std::string("detector: expected a struct, found ") + mxGetClassName(array));
  }
  CheckFields(array, "detector",
    { "origin", "column_step", "row_step", "columns", "rows", "samples" });
  const auto field = [&](const char* name) { return mxGetField(array, 0, name); };
  XRayDetector detector;
  detector.Origin = ToVector(field("origin"), "detector.origin");
  detector.ColumnStep = ToVector(field("column_step"), "detector.column_step");
  detector.RowStep = ToVector(field("row_step"), "detector.row_step");
  detector.Columns = ToCount(field("columns"), 65535, "detector.columns");
  detector.Rows = ToCount(field("rows"), 65535, "detector.rows");
  if (const mxArray* samples = field("samples"))
  {
    detector.Samples = ToCount(samples, 16, "detector.samples");
  }
  return detector;
}

/// Materials and spectrum. The energies have no values here, only an order: 1, 2, ... keV stand for
/// them.
void SetBeam(const Matrix& attenuation, const mxArray* weightArray, Scene& scene)
{
  Spectrum spectrum;
  for (std::size_t energy = 0; energy < attenuation.Columns(); ++energy)
  {
    spectrum.EnergiesKeV.push_back(static_cast<double>(energy + 1));
  }
  spectrum.Weights.assign(attenuation.Columns(), 1.0);
  if (weightArray && !mxIsEmpty(weightArray))
  {
    const Matrix weights = ToMatrix(weightArray, "weights");
    if (weights.Values.size() != attenuation.Columns())
    {
      throw InputError("weights: expected one for each of the " +
        std::to_string(attenuation.Columns()) + " energies, found " + SizeOf(weights));
    }
    spectrum.Weights = weights.Values;
  }
  scene.Response = DetectorResponse::PhotonCounting;
  scene.Materials.Materials.resize(attenuation.Rows() + 1);
  scene.Attenuations.resize(attenuation.Rows() + 1);
  for (std::size_t region = 1; region <= attenuation.Rows(); ++region)
  {
    AttenuationTable& table = scene.Attenuations[region];
    table.Name = "region " + std::to_string(region);
    table.EnergiesKeV = spectrum.EnergiesKeV;
    for (std::size_t energy = 0; energy < attenuation.Columns(); ++energy)
    {
      table.MuPerMm.push_back(attenuation.At(region - 1, energy));
    }
  }
  scene.XRays = std::move(spectrum);
}

/// Row by row to column by column.
void Transpose(const float* values, std::size_t rows, std::size_t columns, double* result)
{
  for (std::size_t row = 0; row < rows; ++row)
  {
    for (std::size_t column = 0; column < columns; ++column)
    {
      result[column * rows + row] = values[row * columns + column];
    }
  }
}

/// Pictures, one after the other, as an array of this size.
mxArray* ToPictures(const std::vector<float>& values, const std::vector<mwSize>& size)
{
  mxArray* array =
    mxCreateNumericArray(static_cast<mwSize>(size.size()), size.data(), mxDOUBLE_CLASS, mxREAL);
  const auto rows = static_cast<std::size_t>(size[0]);
  const auto columns = static_cast<std::size_t>(size[1]);
  for (std::size_t begin = 0; begin < values.size(); begin += rows * columns)
  {
    Transpose(values.data() + begin, rows, columns, mxGetPr(array) + begin);
  }
  return array;
}

/// Of all pictures of an image's materials those of regions 1 to `regions`; the surface may use
/// fewer, of which the others are 0. `fields`: how often all materials follow each other.
std::vector<float> OfRegions(const std::vector<float>& pictures, std::size_t pixels,
  std::size_t materials, std::size_t regions, std::size_t fields = 1)
{
  std::vector<float> chosen(fields * regions * pixels, 0.0F);
  for (std::size_t field = 0; field < fields; ++field)
  {
    std::copy_n(pictures.begin() + static_cast<std::ptrdiff_t>((field * materials + 1) * pixels),
      (materials - 1) * pixels,
      chosen.begin() + static_cast<std::ptrdiff_t>(field * regions * pixels));
  }
  return chosen;
}

/// Velocities of a surface's points, field by field; n x 3 x fields in Octave.
VectorFields ToVelocities(const mxArray* array, std::size_t points)
{
  const Matrix matrix = ToArray(array, "velocities", 3);
  if (matrix.Size[0] != points || matrix.Size[1] != 3 || matrix.Values.empty())
  {
    throw InputError("velocities: expected " + std::to_string(points) +
      " x 3 x parameters, found " + SizeOf(matrix));
  }
  VectorFields velocities;
  velocities.Length = 3 * points;
  velocities.Values.reserve(matrix.Values.size());
  for (std::size_t field = 0; field < matrix.Columns() / 3; ++field)
  {
    for (std::size_t point = 0; point < points; ++point)
    {
      for (std::size_t axis = 0; axis < 3; ++axis)
      {
        velocities.Values.push_back(matrix.At(point, 3 * field + axis));
      }
    }
  }
  return velocities;
}

/// The size of pictures of the scene, and of further dimensions.
std::vector<mwSize> SizeOf(const Scene& scene, std::initializer_list<std::size_t> further = {})
{
  std::vector<mwSize> size{ static_cast<mwSize>(scene.Detector.Rows),
    static_cast<mwSize>(scene.Detector.Columns) };
  size.insert(size.end(), further.begin(), further.end());
  return size;
}

/// The fourth and fifth result: the derivatives of path lengths and image with each parameter.
void AddDerivatives(const Scene& scene, Exposer& exposer, const VectorFields& velocities,
  int outputCount, mxArray* outputs[])
{
  const Exposer::Derivatives derivatives = exposer.Differentiate(scene, velocities);
  const PathLengthImage& image = derivatives.Image;
  const std::vector<float>& rates = derivatives.Lengths.Lengths;
  const std::size_t regions = scene.Attenuations.size() - 1;
  const std::size_t pixels = image.NumberOfPixels();
  const auto materials = static_cast<std::size_t>(image.Materials);
  const std::size_t count = velocities.Count();
  outputs[3] = ToPictures(OfRegions(rates, pixels, materials, regions, count),
    SizeOf(scene, { regions, count }));
  if (outputCount < 5)
  {
    return;
  }
  // I = exp(-A): dI = -I sum_m dA/dL_m dL_m.
  const std::vector<float> transmission = MakeBeam(scene).Transmission(image);
  const std::vector<float>& attenuation = derivatives.MeanAttenuation;
  std::vector<float> change(count * pixels, 0.0F);
  for (std::size_t field = 0; field < count; ++field)
  {
    for (std::size_t material = 1; material < materials; ++material)
    {
      for (std::size_t pixel = 0; pixel < pixels; ++pixel)
      {
        change[field * pixels + pixel] -= transmission[pixel] *
          attenuation[material * pixels + pixel] *
          rates[(field * materials + material) * pixels + pixel];
      }
    }
  }
  outputs[4] = ToPictures(change, SizeOf(scene, { count }));
}

mxArray* ToConsistency(const PathLengthImage& image)
{
  mxArray* array =
    mxCreateLogicalMatrix(static_cast<mwSize>(image.Rows), static_cast<mwSize>(image.Columns));
  const auto rows = static_cast<std::size_t>(image.Rows);
  const auto columns = static_cast<std::size_t>(image.Columns);
  for (std::size_t pixel = 0; pixel < rows * columns; ++pixel)
  {
    mxGetLogicals(array)[pixel % columns * rows + pixel / columns] = image.Inconsistent[pixel] == 0;
  }
  return array;
}

void CheckCounts(int outputCount, int inputCount)
{
  if ((inputCount != 1 && inputCount < 6) || inputCount > 8 || outputCount > 5)
  {
    throw InputError("expected 1 or 6 to 8 arguments and at most 5 results, found " +
      std::to_string(inputCount) + " and " + std::to_string(outputCount) +
      "; see 'help mammoray_project'");
  }
  if (outputCount > 3 && inputCount < 8)
  {
    throw InputError("velocities: expected them as argument 8 for more than 3 results");
  }
}

/// The scene of a file.
Scene ReadSceneFile(const mxArray* path)
{
  char* const text = mxIsChar(path) ? mxArrayToString(path) : nullptr;
  if (!text)
  {
    throw InputError("expected the path of a scene as the only argument");
  }
  const std::string file = text;
  mxFree(text);
  return LoadScene(file);
}

/// The scene of arguments 1 to 7.
Scene MakeScene(int inputCount, const mxArray* inputs[])
{
  const Matrix attenuation = ToMatrix(inputs[3], "attenuation");
  if (attenuation.Rows() < 1 || attenuation.Rows() > 65535 || attenuation.Columns() < 1)
  {
    throw InputError("attenuation: expected regions x energies, found " + SizeOf(attenuation));
  }
  Scene scene;
  scene.Samples = { { std::make_shared<const SurfaceMesh>(
    ToSurface(inputs[0], inputs[1], inputs[2], static_cast<int>(attenuation.Rows()))) } };
  scene.Source = ToSource(inputs[4]);
  scene.Detector = ToDetector(inputs[5]);
  SetBeam(attenuation, inputCount > 6 ? inputs[6] : nullptr, scene);
  return scene;
}

void Project(int outputCount, mxArray* outputs[], int inputCount, const mxArray* inputs[])
{
  CheckCounts(outputCount, inputCount);
  const Scene scene = inputCount == 1 ? ReadSceneFile(inputs[0]) : MakeScene(inputCount, inputs);
  const VectorFields velocities = inputCount > 7
    ? ToVelocities(inputs[7], scene.Samples.front().Surface->NumberOfPoints())
    : VectorFields();
  Exposer exposer;
  const Exposure exposure = exposer.Expose(scene);
  const PathLengthImage& lengths = *exposure.Lengths;
  const std::size_t regions = scene.Attenuations.size() - 1;
  outputs[0] = ToPictures(exposure.Transmission, SizeOf(scene));
  if (outputCount > 1)
  {
    outputs[1] = ToPictures(OfRegions(lengths.Lengths, lengths.NumberOfPixels(),
                              static_cast<std::size_t>(lengths.Materials), regions),
      SizeOf(scene, { regions }));
  }
  if (outputCount > 2)
  {
    outputs[2] = ToConsistency(lengths);
  }
  if (outputCount > 3)
  {
    AddDerivatives(scene, exposer, velocities, outputCount, outputs);
  }
  if (const std::string warning = lengths.InconsistencyWarning(); !warning.empty())
  {
    mexWarnMsgIdAndTxt("mammoray:open", "%s", warning.c_str());
  }
  else if (const std::string empty = ShadowWarning(scene, exposure); !empty.empty())
  {
    mexWarnMsgIdAndTxt("mammoray:empty", "%s", empty.c_str());
  }
}
}

// mexErrMsgIdAndTxt never returns, perhaps by a jump over destructors: nothing that has one is
// alive then.
extern "C" void mexFunction(int outputCount, mxArray* outputs[], int inputCount,
  const mxArray* inputs[])
{
  const char* kind = nullptr;
  char message[1000] = "";
  const auto keep = [&](const char* identifier, const char* text)
  {
    kind = identifier;
    std::snprintf(message, sizeof message, "%s", text);
  };
  try
  {
    Project(outputCount, outputs, inputCount, inputs);
  }
  catch (const InputError& error)
  {
    keep("mammoray:input", error.what());
  }
  catch (const DeviceError& error)
  {
    keep("mammoray:device", error.what());
  }
  catch (const std::bad_alloc&)
  {
    keep("mammoray:memory", "not enough memory");
  }
  if (kind)
  {
    mexErrMsgIdAndTxt(kind, "%s", message);
  }
}
