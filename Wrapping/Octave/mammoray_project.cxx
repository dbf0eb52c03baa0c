// SPDX-License-Identifier: Apache-2.0
// The projector as a function of Octave and MATLAB; mammoray_project.m is its manual.
#include "mammoray/Foundation/Error.h"
#include "mammoray/XRay/Beam.h"
#include "mammoray/XRay/DeviceError.h"
#include "mammoray/XRay/Exposure.h"
#include "mammoray/XRay/PathLengthProjector.h"

#include <mex.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <string>
#include <vector>

namespace
{
using namespace mammoray;

/// A real matrix of doubles, columns first.
struct Matrix
{
  const double* Values = nullptr;
  std::size_t Rows = 0;
  std::size_t Columns = 0;

  double At(std::size_t row, std::size_t column) const
  {
    return this->Values[column * this->Rows + row];
  }
};

std::string SizeOf(const Matrix& matrix)
{
  return std::to_string(matrix.Rows) + " x " + std::to_string(matrix.Columns);
}

Matrix ToMatrix(const mxArray* array, const std::string& name)
{
  if (!array || !mxIsDouble(array) || mxIsComplex(array) || mxIsSparse(array) ||
    mxGetNumberOfDimensions(array) != 2)
  {
    throw InputError(name + ": expected a full real matrix of doubles, found " +
      (array ? mxGetClassName(array) : "nothing"));
  }
  return { mxGetPr(array), mxGetM(array), mxGetN(array) };
}

Vector3 ToVector(const mxArray* array, const std::string& name)
{
  const Matrix matrix = ToMatrix(array, name);
  if (matrix.Rows * matrix.Columns != 3)
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
  if (matrix.Rows * matrix.Columns != 1)
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
  if (vertices.Columns != 3 || faces.Columns != 3)
  {
    throw InputError("expected n x 3 vertices and m x 3 faces, found " + SizeOf(vertices) +
      " and " + SizeOf(faces));
  }
  if (regions.Rows != faces.Rows || (regions.Columns != 1 && regions.Columns != 2))
  {
    throw InputError(
      "regions: expected " + std::to_string(faces.Rows) + " x 2 or x 1, found " + SizeOf(regions));
  }
  const auto vertexCount = static_cast<int>(std::min<std::size_t>(vertices.Rows, 2147483647));
  SurfaceMesh surface;
  for (std::size_t vertex = 0; vertex < vertices.Rows; ++vertex)
  {
    for (std::size_t axis = 0; axis < 3; ++axis)
    {
      surface.Points.push_back(vertices.At(vertex, axis));
    }
  }
  for (std::size_t face = 0; face < faces.Rows; ++face)
  {
    for (std::size_t corner = 0; corner < 3; ++corner)
    {
      surface.Triangles.push_back(static_cast<std::uint32_t>(
        ToWhole(faces.At(face, corner), 1, vertexCount, "faces", face + 1) - 1));
    }
    const std::size_t back = regions.Columns - 1;
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
  if (!mxIsStruct(array) || mxGetNumberOfElements(array) != 1)
  {
    throw InputError(std::string("detector: expected a struct, found ") + mxGetClassName(array));
  }
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

/// The energies have no values here, only an order: 1, 2, ... keV stand for them.
Beam ToBeam(const Matrix& attenuation, const mxArray* weightArray)
{
  Spectrum spectrum;
  for (std::size_t energy = 0; energy < attenuation.Columns; ++energy)
  {
    spectrum.EnergiesKeV.push_back(static_cast<double>(energy + 1));
  }
  spectrum.Weights.assign(attenuation.Columns, 1.0);
  if (weightArray)
  {
    const Matrix weights = ToMatrix(weightArray, "weights");
    if (weights.Rows * weights.Columns != attenuation.Columns)
    {
      throw InputError("weights: expected one for each of the " +
        std::to_string(attenuation.Columns) + " energies, found " + SizeOf(weights));
    }
    spectrum.Weights.assign(weights.Values, weights.Values + attenuation.Columns);
  }
  std::vector<AttenuationTable> tables(attenuation.Rows + 1);
  std::vector<const AttenuationTable*> pointers{ nullptr };
  for (std::size_t region = 1; region <= attenuation.Rows; ++region)
  {
    AttenuationTable& table = tables[region];
    table.Name = "region " + std::to_string(region);
    table.EnergiesKeV = spectrum.EnergiesKeV;
    for (std::size_t energy = 0; energy < attenuation.Columns; ++energy)
    {
      table.MuPerMm.push_back(attenuation.At(region - 1, energy));
    }
    pointers.push_back(&table);
  }
  return { spectrum, DetectorResponse::PhotonCounting, pointers,
    std::vector<double>(tables.size(), 1.0) };
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

void Project(int outputCount, mxArray* outputs[], int inputCount, const mxArray* inputs[])
{
  if (inputCount < 6 || inputCount > 7 || outputCount > 2)
  {
    throw InputError("expected 6 or 7 arguments and at most 2 results, found " +
      std::to_string(inputCount) + " and " + std::to_string(outputCount) +
      "; see 'help mammoray_project'");
  }
  const Matrix attenuation = ToMatrix(inputs[3], "attenuation");
  if (attenuation.Rows < 1 || attenuation.Rows > 65535 || attenuation.Columns < 1)
  {
    throw InputError("attenuation: expected regions x energies, found " + SizeOf(attenuation));
  }
  const SurfaceMesh surface =
    ToSurface(inputs[0], inputs[1], inputs[2], static_cast<int>(attenuation.Rows));
  const XRaySource source = ToSource(inputs[4]);
  const XRayDetector detector = ToDetector(inputs[5]);
  const Beam beam = ToBeam(attenuation, inputCount > 6 ? inputs[6] : nullptr);
  const auto projector = MakeProjector();
  projector->SetSurface(surface);
  const Exposure exposure = Expose(*projector, source, detector, beam);
  const auto rows = static_cast<std::size_t>(detector.Rows);
  const auto columns = static_cast<std::size_t>(detector.Columns);
  outputs[0] = mxCreateDoubleMatrix(rows, columns, mxREAL);
  Transpose(exposure.Transmission.data(), rows, columns, mxGetPr(outputs[0]));
  if (outputCount > 1)
  {
    const mwSize size[3] = { static_cast<mwSize>(rows), static_cast<mwSize>(columns),
      static_cast<mwSize>(attenuation.Rows) };
    outputs[1] = mxCreateNumericArray(3, size, mxDOUBLE_CLASS, mxREAL);
    // The surface may use fewer regions than the table has; the others stay 0.
    for (int region = 1; region < exposure.Lengths.Materials; ++region)
    {
      Transpose(exposure.Lengths.Material(region), rows, columns,
        mxGetPr(outputs[1]) + static_cast<std::size_t>(region - 1) * rows * columns);
    }
  }
  if (const std::string warning = exposure.Lengths.InconsistencyWarning(); !warning.empty())
  {
    mexWarnMsgIdAndTxt("mammoray:open", "%s", warning.c_str());
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
