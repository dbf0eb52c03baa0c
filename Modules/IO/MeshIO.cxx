// SPDX-License-Identifier: Apache-2.0
#include "mammoray/IO/MeshIO.h"

#include "Private/GltfReader.h"
#include "Private/InputFile.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/Numbers.h"
#include "mammoray/IO/AtomicFile.h"
#include "mammoray/IO/GuardedRead.h"
#include "mammoray/IO/MeshConversion.h"

#include "vtkCellData.h"
#include "vtkCellType.h"
#include "vtkCharArray.h"
#include "vtkCommand.h"
#include "vtkExecutive.h"
#include "vtkFieldData.h"
#include "vtkIdList.h"
#include "vtkNew.h"
#include "vtkOBJReader.h"
#include "vtkOBJWriter.h"
#include "vtkObject.h"
#include "vtkPLYReader.h"
#include "vtkPLYWriter.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"
#include "vtkSTLReader.h"
#include "vtkSTLWriter.h"
#include "vtkTriangleFilter.h"
#include "vtkUnstructuredGrid.h"
#include "vtkUnstructuredGridReader.h"
#include "vtkUnstructuredGridWriter.h"
#include "vtkXMLPolyDataReader.h"
#include "vtkXMLPolyDataWriter.h"
#include "vtkXMLUnstructuredGridReader.h"
#include "vtkXMLUnstructuredGridWriter.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>
#include <type_traits>

namespace mammoray
{
namespace
{
/// Keeps the first error or warning of a VTK object, in place of printing it.
class Listener : public vtkCommand
{
public:
  static Listener* New() { return new Listener; }
  void Execute(vtkObject*, unsigned long, void* text) override
  {
    if (this->Message.empty())
    {
      this->Message = text ? static_cast<const char*>(text) : "error";
      // The last line of VTK's text is the message itself; the others say where in VTK's sources.
      while (
        !this->Message.empty() && std::isspace(static_cast<unsigned char>(this->Message.back())))
      {
        this->Message.pop_back();
      }
      const auto line = this->Message.find_last_of('\n');
      this->Message = line == std::string::npos ? this->Message : this->Message.substr(line + 1);
    }
  }
  std::string Message;
};

template <typename Algorithm>
void Run(Algorithm* algorithm, const std::string& path, const char* what)
{
  vtkNew<Listener> listener;
  algorithm->AddObserver(vtkCommand::ErrorEvent, listener);
  algorithm->AddObserver(vtkCommand::WarningEvent, listener);
  algorithm->GetExecutive()->AddObserver(vtkCommand::ErrorEvent, listener);
  // Parsers and other helpers inside VTK have no observer of ours.
  const int shown = vtkObject::GetGlobalWarningDisplay();
  vtkObject::GlobalWarningDisplayOff();
  if constexpr (requires { algorithm->Write(); })
  {
    algorithm->Write();
  }
  else
  {
    algorithm->Update();
  }
  vtkObject::SetGlobalWarningDisplay(shown);
  if (algorithm->GetErrorCode() != 0 || !listener->Message.empty())
  {
    throw InputError(path + ": " + what +
      (listener->Message.empty() ? std::string() : " (" + listener->Message + ")"));
  }
}

bool IsGltf(const std::string& path)
{
  const std::string extension = ExtensionOf(path);
  return extension == ".glb" || extension == ".gltf";
}

[[noreturn]] void RefuseExtension(const std::string& path, const char* what, const char* known)
{
  throw InputError(path + ": expected the extension " + known + " for " + what + ", found '" +
    ExtensionOf(path) + "'");
}

/// Throws InputError unless the coordinates are below 1e9 mm.
void CheckCoordinates(const std::string& path, std::size_t point, const double* at)
{
  // Single precision is what the X-rays use; beyond it lies nothing that has a size.
  if (!std::all_of(at, at + 3, [](double value) { return std::abs(value) < 1e9; }))
  {
    throw InputError(path + ": point " + std::to_string(point) +
      ": expected coordinates below 1e9 mm, found " + std::to_string(at[0]) + " " +
      std::to_string(at[1]) + " " + std::to_string(at[2]));
  }
}

template <typename Writer>
void Write(vtkPointSet* mesh, const std::string& path)
{
  vtkNew<Writer> writer;
  writer->SetInputData(mesh);
  if constexpr (requires { writer->SetDataModeToBinary(); })
  {
    // Well-formed XML: raw appended bytes are not, and ParaView 5.11 opens none of them since
    // expat's update of 2025 (2.5.0-1+deb12u2).
    writer->SetDataModeToBinary();
    writer->SetCompressorTypeToZLib();
    writer->SetCompressionLevel(1);  // most of a file is coordinates, which hardly get smaller
    writer->WriteToOutputStringOn(); // VTK 9.1 crashes on a file that it cannot write
    Run(writer.Get(), path, "cannot be written");
    WriteAtomicFile(path, writer->GetOutputString());
  }
  else
  {
    if constexpr (requires { writer->SetFileTypeToBinary(); })
    {
      writer->SetFileTypeToBinary();
    }
    WriteAtomicFile(path,
      [&](const std::string& staged)
      {
        writer->SetFileName(staged.c_str());
        Run(writer.Get(), path, "cannot be written");
      });
  }
}

/// VTK takes a vertex of an OBJ or STL file in text that it cannot read for 0 or for the one
/// before.
void CheckVertices(const std::string& path, const std::string& keyword)
{
  std::ifstream file(path);
  std::string line;
  for (std::size_t number = 1; std::getline(file, line); ++number)
  {
    std::istringstream words(line);
    std::string word;
    if (!(words >> word) || word != keyword)
    {
      continue;
    }
    for (int axis = 0; axis < 3; ++axis)
    {
      double value = 0;
      if (!(words >> word) || !ToNumber(word.substr(word.starts_with('+') ? 1 : 0), value) ||
        !std::isfinite(value))
      {
        throw InputError(LineName(path, number) + ": expected three numbers for a vertex, found '" +
          line.substr(0, 60) + "'");
      }
    }
  }
}

template <typename Reader>
auto Decode(const std::string& path)
{
  if constexpr (std::is_same_v<Reader, vtkOBJReader>)
  {
    CheckVertices(path, "v");
  }
  if constexpr (std::is_same_v<Reader, vtkSTLReader>)
  {
    CheckVertices(path, "vertex");
  }
  vtkNew<Reader> reader;
  reader->SetFileName(path.c_str());
  Run(reader.Get(), path, "expected a mesh, found data that cannot be read");
  vtkSmartPointer mesh = reader->GetOutput();
  if (!mesh || mesh->GetNumberOfPoints() == 0 || mesh->GetNumberOfCells() == 0)
  {
    throw InputError(path + ": expected a mesh, found no points or no cells");
  }
  return mesh;
}

/// Throws InputError, which names the place, on cells whose points do not exist, and as
/// CheckCoordinates.
void CheckGrid(vtkUnstructuredGrid* grid, const std::string& path)
{
  if (grid->GetFaces())
  {
    throw InputError(path + ": expected cells given by their points, found lists of faces");
  }
  const vtkIdType pointCount = grid->GetNumberOfPoints();
  for (vtkIdType point = 0; point < pointCount; ++point)
  {
    CheckCoordinates(path, static_cast<std::size_t>(point), grid->GetPoint(point));
  }
  vtkNew<vtkIdList> corners;
  for (vtkIdType cell = 0; cell < grid->GetNumberOfCells(); ++cell)
  {
    const auto refuse = [&](const std::string& reason)
    { throw InputError(path + ": cell " + std::to_string(cell) + ": " + reason); };
    grid->GetCellPoints(cell, corners);
    if (grid->GetCellType(cell) == VTK_TETRA && corners->GetNumberOfIds() != 4)
    {
      refuse("expected the four points of a tetrahedron, found " +
        std::to_string(corners->GetNumberOfIds()));
    }
    for (const vtkIdType corner : *corners)
    {
      if (corner < 0 || corner >= pointCount)
      {
        refuse("expected points 0 to " + std::to_string(pointCount - 1) + ", found " +
          std::to_string(corner));
      }
    }
  }
}

/// Makes no array the active one. Throws InputError on an array of another length than `tuples`.
void TrimAttributes(vtkDataSetAttributes* data, vtkIdType tuples, const std::string& path)
{
  for (int type = 0; type < vtkDataSetAttributes::NUM_ATTRIBUTES; ++type)
  {
    data->SetActiveAttribute(-1, type);
  }
  for (int index = 0; index < data->GetNumberOfArrays(); ++index)
  {
    vtkAbstractArray* const array = data->GetAbstractArray(index);
    if (array->GetNumberOfTuples() != tuples)
    {
      throw InputError(path + ": array '" + (array->GetName() ? array->GetName() : "") +
        "': expected " + std::to_string(tuples) + " values, found " +
        std::to_string(array->GetNumberOfTuples()));
    }
  }
}

/// The grid as bytes of VTK's legacy format, which a reader's process sends.
std::string PackGrid(vtkUnstructuredGrid* grid, const std::string& path)
{
  CheckGrid(grid, path);
  TrimAttributes(grid->GetPointData(), grid->GetNumberOfPoints(), path);
  TrimAttributes(grid->GetCellData(), grid->GetNumberOfCells(), path);
  vtkNew<vtkUnstructuredGridWriter> writer;
  writer->SetInputData(grid);
  writer->SetFileTypeToBinary();
  writer->WriteToOutputStringOn();
  Run(writer.Get(), path, "expected a mesh, found one that cannot be passed on");
  return writer->GetOutputStdString();
}

vtkSmartPointer<vtkUnstructuredGrid> UnpackGrid(const std::string& bytes, const std::string& path)
{
  vtkNew<vtkCharArray> input;
  input->SetArray(const_cast<char*>(bytes.data()), static_cast<vtkIdType>(bytes.size()), 1);
  vtkNew<vtkUnstructuredGridReader> reader;
  reader->ReadFromInputStringOn();
  reader->SetInputArray(input);
  Run(reader.Get(), path, "expected a mesh, found one that cannot be passed on");
  return reader->GetOutput();
}

using GridDecoder = vtkSmartPointer<vtkUnstructuredGrid> (*)(const std::string& path);
using SurfaceDecoder = vtkSmartPointer<vtkPolyData> (*)(const std::string& path);

SurfaceDecoder FindSurfaceDecoder(const std::string& path)
{
  const std::string extension = ExtensionOf(path);
  return extension == ".vtp" ? Decode<vtkXMLPolyDataReader>
    : extension == ".stl"    ? Decode<vtkSTLReader>
    : extension == ".ply"    ? Decode<vtkPLYReader>
    : extension == ".obj"    ? Decode<vtkOBJReader>
    : IsGltf(path)           ? SurfaceDecoder(ReadGltf)
                             : nullptr;
}

/// A surface as it comes from its reader's process.
struct NamedSurface
{
  SurfaceMesh Mesh;
  std::vector<std::string> MaterialNames;
};

void Exchange(Parcel& parcel, NamedSurface& surface)
{
  parcel(surface.Mesh.Points, surface.Mesh.Triangles, surface.Mesh.FrontMaterials,
    surface.Mesh.BackMaterials, surface.MaterialNames);
}

NamedSurface DecodeSurface(const std::string& path, SurfaceDecoder decode)
{
  const auto decoded = decode(path);
  for (vtkIdType point = 0; point < decoded->GetNumberOfPoints(); ++point)
  {
    CheckCoordinates(path, static_cast<std::size_t>(point), decoded->GetPoint(point));
  }
  try
  {
    NamedSurface surface;
    surface.Mesh = FromPolyData(decoded, &surface.MaterialNames);
    return surface;
  }
  catch (const InputError& error)
  {
    throw InputError(path + ": " + error.what());
  }
}
}

void WriteMesh(vtkPointSet* mesh, const std::string& path)
{
  const std::string extension = ExtensionOf(path);
  if (vtkUnstructuredGrid::SafeDownCast(mesh))
  {
    if (extension != ".vtu")
    {
      RefuseExtension(path, "a volume mesh", ".vtu");
    }
    Write<vtkXMLUnstructuredGridWriter>(mesh, path);
    return;
  }
  auto* surface = vtkPolyData::SafeDownCast(mesh);
  if (!surface)
  {
    throw InputError(path + ": expected a volume mesh or a surface to write");
  }
  if (extension == ".vtp")
  {
    Write<vtkXMLPolyDataWriter>(surface, path);
    return;
  }
  vtkNew<vtkTriangleFilter> triangles;
  triangles->SetInputData(surface);
  triangles->PassLinesOff();
  triangles->PassVertsOff();
  triangles->Update();
  if (extension == ".stl")
  {
    Write<vtkSTLWriter>(triangles->GetOutput(), path);
  }
  else if (extension == ".ply")
  {
    Write<vtkPLYWriter>(triangles->GetOutput(), path);
  }
  else if (extension == ".obj")
  {
    // VTK 9.1 takes names of materials for its own textures, and dies of them.
    triangles->GetOutput()->GetFieldData()->Initialize();
    Write<vtkOBJWriter>(triangles->GetOutput(), path);
  }
  else
  {
    RefuseExtension(path, "a surface", ".vtp, .stl, .ply or .obj");
  }
}

vtkSmartPointer<vtkUnstructuredGrid> ReadMesh(const std::string& path)
{
  CheckReadable(path, "a mesh");
  const std::string extension = ExtensionOf(path);
  const GridDecoder decode = extension == ".vtu" ? Decode<vtkXMLUnstructuredGridReader>
    : extension == ".vtk"                        ? Decode<vtkUnstructuredGridReader>
                                                 : nullptr;
  if (!decode)
  {
    RefuseExtension(path, "a volume mesh", ".vtu or .vtk");
  }
  return UnpackGrid(ReadGuarded(path, "a mesh", ReadLimits::Of({ path }),
                      [&] { return PackGrid(decode(path), path); }),
    path);
}

SurfaceMesh ReadSurface(const std::string& path, std::vector<std::string>* materialNames)
{
  CheckReadable(path, "a mesh");
  const SurfaceDecoder decode = FindSurfaceDecoder(path);
  if (!decode)
  {
    RefuseExtension(path, "a surface", ".vtp, .stl, .ply, .obj, .glb or .gltf");
  }
  NamedSurface read = ReadGuarded(path, "a mesh", ReadLimits::Of({ path }),
    [&] { return DecodeSurface(path, decode); });
  read.Mesh.Validate(path);
  for (std::size_t point = 0; point < read.Mesh.NumberOfPoints(); ++point)
  {
    CheckCoordinates(path, point, &read.Mesh.Points[3 * point]);
  }
  if (materialNames)
  {
    *materialNames = std::move(read.MaterialNames);
  }
  return std::move(read.Mesh);
}

double NativeUnitMm(const std::string& path)
{
  return IsGltf(path) ? GltfUnitMm : 1;
}
}
