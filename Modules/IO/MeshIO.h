// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_MeshIO_h
#define mammoray_MeshIO_h

#include "mammoray/Foundation/Meshes.h"
#include "mammorayIOModule.h"

#include "vtkSmartPointer.h"

#include <optional>
#include <string>
#include <vector>

class vtkPointSet;
class vtkUnstructuredGrid;

namespace mammoray
{
/**
 * Writes a mesh by extension: a vtkUnstructuredGrid as .vtu (compressed, appended), a vtkPolyData
 * as .vtp, .stl, .ply or .obj (the last three without arrays, triangles only for .stl and .ply).
 * Throws InputError on another extension, naming the known ones, and when the file cannot be
 * written.
 */
MAMMORAYIO_EXPORT void WriteMesh(vtkPointSet* mesh, const std::string& path);

/**
 * Reads the tetrahedra of a .vtu, of an unstructured grid in VTK's legacy .vtk, or of gmsh's .msh
 * (2.2 and 4.1), whose physical groups are materials. Cells of fewer dimensions are left out, of
 * quadratic tetrahedra the corners are kept; Note gets a line of each. Throws InputError
 * on other cells of three dimensions and on a missing, damaged or empty file.
 */
MAMMORAYIO_EXPORT vtkSmartPointer<vtkUnstructuredGrid> ReadMesh(const std::string& path);

/**
 * Reads polygons, cut into triangles, from .vtp, .stl, .ply, .obj, .msh, or from all parts of the
 * scene of a .glb or .gltf (glTF 2.0; its metres become mm). Their materials, and `materialNames`,
 * are as FromPolyData has them. Note gets a line where the file's floats have rounded
 * its coordinates by more than a millionth of the part. Throws InputError on a missing, damaged or
 * empty file, and on contents of glTF that would be shown differently elsewhere (skins, morph
 * targets, required extensions). What each format may hold: docs/reference/file-formats.md.
 */
MAMMORAYIO_EXPORT SurfaceMesh ReadSurface(const std::string& path,
  std::vector<std::string>* materialNames = nullptr);

/// A mesh's file: what ReadMesh or ReadSurface makes of it.
struct MeshOrSurface
{
  /// Null if the file holds a surface.
  vtkSmartPointer<vtkUnstructuredGrid> Volume;
  SurfaceMesh Surface;
  /// Names of the surface's materials.
  std::vector<std::string> MaterialNames;
};

/// Reads a file by ReadMesh or ReadSurface, by its name, a .msh by its cells; throws as these do.
MAMMORAYIO_EXPORT MeshOrSurface ReadMeshOrSurface(const std::string& path);

/// Turns what ReadSurface made of a file into mm, where the file's numbers have another unit than
/// its format says. Throws InputError, which begins with `who`, on a surface that reaches farther
/// than a kilometre.
MAMMORAYIO_EXPORT void ScaleSurface(const std::string& path, const std::optional<double>& unitMm,
  const std::string& who, SurfaceMesh& surface);
}

#endif
