// SPDX-License-Identifier: Apache-2.0
#include "mammoray/IO/MeshIO.h"

#include "Private/GltfReader.h"
#include "Private/GmshFile.h"
#include "Private/InputFile.h"
#include "Private/SurfaceFiles.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/Numbers.h"
#include "mammoray/IO/AtomicFile.h"
#include "mammoray/IO/GuardedRead.h"
#include "mammoray/IO/MeshConversion.h"

#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkCellType.h"
#include "vtkCharArray.h"
#include "vtkCommand.h"
#include "vtkExecutive.h"
#include "vtkFieldData.h"
#include "vtkGenericCell.h"
#include "vtkIdList.h"
#include "vtkNew.h"
#include "vtkOBJWriter.h"
#include "vtkObject.h"
#include "vtkPLYWriter.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
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
#include <limits>
#include <map>

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

template <typename Reader>
auto Decode(const std::string& path)
{
  vtkNew<Reader> reader;
  reader->SetFileName(path.c_str());
  Run(reader.Get(), path, "expected a mesh, found data that cannot be read");
  return vtkSmartPointer(reader->GetOutput());
}

vtkSmartPointer<vtkUnstructuredGrid> DecodeLegacyGrid(const std::string& path)
{
  vtkNew<vtkUnstructuredGridReader> kind;
  kind->SetFileName(path.c_str());
  if (kind->IsFilePolyData())
  {
    throw InputError(path +
      ": expected a volume mesh (UNSTRUCTURED_GRID), found a surface (POLYDATA), which a .vtp file "
      "may hold");
  }
  return Decode<vtkUnstructuredGridReader>(path);
}

/// Throws InputError unless the mesh has points and cells.
template <typename Mesh>
void CheckSome(Mesh* mesh, const std::string& path)
{
  if (!mesh || mesh->GetNumberOfPoints() == 0 || mesh->GetNumberOfCells() == 0)
  {
    const vtkIdType points = mesh ? mesh->GetNumberOfPoints() : 0;
    throw InputError(path + ": expected a mesh, found " +
      (points > 0 ? std::to_string(points) + " points without cells" : std::string("no points")));
  }
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

/// How many dimensions a cell of that type has; 0 of an empty one.
int DimensionOf(int type)
{
  vtkNew<vtkGenericCell> cell;
  cell->SetCellType(type);
  return cell->GetCellDimension();
}

/// The linear tetrahedra of a grid, with their points and data. Cells of fewer dimensions are left
/// out, of quadratic tetrahedra the corners are kept, both with a note.
vtkSmartPointer<vtkUnstructuredGrid> TetrahedraOf(vtkUnstructuredGrid* grid,
  const std::string& path)
{
  const vtkIdType cellCount = grid->GetNumberOfCells();
  vtkIdType straightened = 0;
  vtkIdType tetrahedra = 0;
  std::map<int, vtkIdType> leftOut;
  for (vtkIdType cell = 0; cell < cellCount; ++cell)
  {
    const int type = grid->GetCellType(cell);
    straightened += type == VTK_QUADRATIC_TETRA ? 1 : 0;
    tetrahedra += type == VTK_TETRA ? 1 : 0;
    if (type == VTK_TETRA || type == VTK_QUADRATIC_TETRA)
    {
      continue;
    }
    if (DimensionOf(type) == 3)
    {
      throw InputError(path + ": cell " + std::to_string(cell) +
        ": expected a tetrahedron, found a " + NameOfCellType(type));
    }
    ++leftOut[type];
  }
  if (straightened == 0 && leftOut.empty())
  {
    return grid;
  }
  if (!leftOut.empty() && straightened + tetrahedra == 0)
  {
    throw InputError(path + ": expected tetrahedra, found cells that are no volumes (" +
      NameOfCellType(leftOut.begin()->first) + ")");
  }
  auto kept = vtkSmartPointer<vtkUnstructuredGrid>::New();
  vtkNew<vtkPoints> points;
  points->SetDataType(grid->GetPoints()->GetDataType());
  kept->SetPoints(points);
  kept->Allocate(cellCount);
  kept->GetFieldData()->ShallowCopy(grid->GetFieldData());
  kept->GetPointData()->CopyAllocate(grid->GetPointData());
  kept->GetCellData()->CopyAllocate(grid->GetCellData());
  std::vector<vtkIdType> idOf(static_cast<std::size_t>(grid->GetNumberOfPoints()), -1);
  vtkNew<vtkIdList> corners;
  for (vtkIdType cell = 0; cell < cellCount; ++cell)
  {
    if (leftOut.count(grid->GetCellType(cell)) > 0)
    {
      continue;
    }
    grid->GetCellPoints(cell, corners);
    vtkIdType ids[4];
    for (vtkIdType corner = 0; corner < 4; ++corner)
    {
      const vtkIdType from = corners->GetId(corner);
      vtkIdType& to = idOf[static_cast<std::size_t>(from)];
      if (to < 0)
      {
        to = points->InsertNextPoint(grid->GetPoint(from));
        kept->GetPointData()->CopyData(grid->GetPointData(), from, to);
      }
      ids[corner] = to;
    }
    kept->GetCellData()->CopyData(grid->GetCellData(), cell,
      kept->InsertNextCell(VTK_TETRA, 4, ids));
  }
  if (straightened > 0)
  {
    Note({ path,
      std::to_string(straightened) +
        " quadratic tetrahedra are taken with straight edges, by their corners" });
  }
  for (const auto& [type, count] : leftOut)
  {
    Note({ path,
      "left out " + std::to_string(count) + " cells that are no volumes (" + NameOfCellType(type) +
        ")" });
  }
  return kept;
}

/// The grid as bytes of VTK's legacy format, which a reader's process sends.
std::string PackGrid(vtkUnstructuredGrid* read, const std::string& path)
{
  CheckSome(read, path);
  CheckGrid(read, path);
  TrimAttributes(read->GetPointData(), read->GetNumberOfPoints(), path);
  TrimAttributes(read->GetCellData(), read->GetNumberOfCells(), path);
  const auto grid = TetrahedraOf(read, path);
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

/// The triangles and quads of a gmsh file without volumes.
vtkSmartPointer<vtkPolyData> SurfaceOf(vtkUnstructuredGrid* grid, const std::string& path)
{
  auto surface = vtkSmartPointer<vtkPolyData>::New();
  vtkNew<vtkCellArray> polygons;
  vtkNew<vtkIdList> corners;
  for (vtkIdType cell = 0; cell < grid->GetNumberOfCells(); ++cell)
  {
    const int type = grid->GetCellType(cell);
    if (DimensionOf(type) == 3)
    {
      throw InputError(
        path + ": expected a surface, found a mesh of volumes (" + NameOfCellType(type) + ")");
    }
    if (type != VTK_TRIANGLE && type != VTK_QUAD && DimensionOf(type) == 2)
    {
      throw InputError(path + ": expected triangles or quads, found a " + NameOfCellType(type));
    }
    if (DimensionOf(type) == 2)
    {
      grid->GetCellPoints(cell, corners);
      polygons->InsertNextCell(corners);
    }
  }
  surface->SetPoints(grid->GetPoints());
  surface->SetPolys(polygons);
  return surface;
}

vtkSmartPointer<vtkPolyData> ReadGmshSurface(const std::string& path)
{
  return SurfaceOf(ReadGmsh(path), path);
}

SurfaceDecoder FindSurfaceDecoder(const std::string& path)
{
  const std::string extension = ExtensionOf(path);
  return extension == ".vtp" ? Decode<vtkXMLPolyDataReader>
    : extension == ".stl"    ? ReadStl
    : extension == ".ply"    ? ReadPly
    : extension == ".obj"    ? ReadObj
    : extension == ".msh"    ? ReadGmshSurface
    : IsGltf(path)           ? SurfaceDecoder(ReadGltf)
                             : nullptr;
}

/// A surface as it comes from its reader's process, or tetrahedra (PackGrid).
struct PackedMesh
{
  SurfaceMesh Surface;
  std::vector<std::string> MaterialNames;
  std::string Volume;
};

void Exchange(Parcel& parcel, PackedMesh& mesh)
{
  parcel(mesh.Surface.Points, mesh.Surface.Triangles, mesh.Surface.FrontMaterials,
    mesh.Surface.BackMaterials, mesh.MaterialNames, mesh.Volume);
}

/// Notes how far floats that were written lie from what they stand for, where that is more than a
/// micrometre for a metre of the part.
void NoteRounding(vtkPolyData* surface, const std::string& path)
{
  if (surface->GetPoints()->GetDataType() != VTK_FLOAT)
  {
    return;
  }
  double bounds[6];
  surface->GetBounds(bounds);
  double far = 0;
  double wide = 0;
  for (int axis = 0; axis < 3; ++axis)
  {
    far = std::max({ far, std::abs(bounds[2 * axis]), std::abs(bounds[2 * axis + 1]) });
    wide = std::max(wide, bounds[2 * axis + 1] - bounds[2 * axis]);
  }
  const double rounded = far * std::numeric_limits<float>::epsilon() / 2;
  if (rounded > 1e-6 * wide)
  {
    Note({ path,
      "its coordinates are floats up to " + NumberText(far) +
        " from the origin, rounded by up to " + NumberText(rounded) + ", of a part " +
        NumberText(wide) + " wide; a part nearer to the origin keeps its shape" });
  }
}

PackedMesh PackSurface(vtkPolyData* decoded, const std::string& path)
{
  CheckSome(decoded, path);
  for (vtkIdType point = 0; point < decoded->GetNumberOfPoints(); ++point)
  {
    CheckCoordinates(path, static_cast<std::size_t>(point), decoded->GetPoint(point));
  }
  try
  {
    PackedMesh packed;
    packed.Surface = FromPolyData(decoded, &packed.MaterialNames);
    NoteRounding(decoded, path);
    return packed;
  }
  catch (const InputError& error)
  {
    throw InputError(path + ": " + error.what());
  }
}

/// Packs a gmsh file's cells as a volume mesh, or as a surface if there are no volumes.
PackedMesh PackEither(vtkUnstructuredGrid* grid, const std::string& path)
{
  bool holdsVolumes = false;
  for (vtkIdType cell = 0; cell < grid->GetNumberOfCells() && !holdsVolumes; ++cell)
  {
    holdsVolumes = DimensionOf(grid->GetCellType(cell)) == 3;
  }
  return holdsVolumes ? PackedMesh{ {}, {}, PackGrid(grid, path) }
                      : PackSurface(SurfaceOf(grid, path), path);
}

/// Reads a mesh file in a separate process and validates what that process sends.
template <typename Pack>
PackedMesh ReadPacked(const std::string& path, const Pack& pack)
{
  PackedMesh read = ReadGuarded(path, "a mesh", ReadLimits::Of({ path }), pack);
  if (read.Volume.empty())
  {
    read.Surface.Validate(path);
  }
  for (std::size_t point = 0; point < read.Surface.NumberOfPoints(); ++point)
  {
    CheckCoordinates(path, point, &read.Surface.Points[3 * point]);
  }
  return read;
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
    : extension == ".vtk"                        ? DecodeLegacyGrid
    : extension == ".msh"                        ? GridDecoder(ReadGmsh)
                                                 : nullptr;
  if (!decode)
  {
    RefuseExtension(path, "a volume mesh", ".vtu, .vtk or .msh");
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
    RefuseExtension(path, "a surface", ".vtp, .stl, .ply, .obj, .msh, .glb or .gltf");
  }
  PackedMesh read = ReadPacked(path, [&] { return PackSurface(decode(path), path); });
  if (materialNames)
  {
    *materialNames = std::move(read.MaterialNames);
  }
  return std::move(read.Surface);
}

MeshOrSurface ReadMeshOrSurface(const std::string& path)
{
  MeshOrSurface read;
  const std::string extension = ExtensionOf(path);
  if (extension == ".vtu" || extension == ".vtk")
  {
    read.Volume = ReadMesh(path);
  }
  else if (extension != ".msh")
  {
    read.Surface = ReadSurface(path, &read.MaterialNames);
  }
  else
  {
    CheckReadable(path, "a mesh");
    PackedMesh packed = ReadPacked(path, [&] { return PackEither(ReadGmsh(path), path); });
    read.Surface = std::move(packed.Surface);
    read.MaterialNames = std::move(packed.MaterialNames);
    read.Volume = packed.Volume.empty() ? nullptr : UnpackGrid(packed.Volume, path);
  }
  return read;
}

void ScaleSurface(const std::string& path, const std::optional<double>& unitMm,
  const std::string& who, SurfaceMesh& surface)
{
  const double scale = unitMm ? *unitMm / (IsGltf(path) ? GltfUnitMm : 1) : 1;
  constexpr double mostMm = 1e6;
  for (double& coordinate : surface.Points)
  {
    coordinate *= scale;
    if (!(std::abs(coordinate) <= mostMm))
    {
      throw InputError(who + ": expected a surface within " + NumberText(mostMm) +
        " mm of the origin, found a coordinate of " + NumberText(coordinate) +
        " mm; is the file's unit right?");
    }
  }
}
}
