// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_MeshIO_h
#define mammoray_MeshIO_h

#include "mammorayIOModule.h"

#include "vtkSmartPointer.h"

#include <string>

class vtkPointSet;
class vtkPolyData;
class vtkUnstructuredGrid;

namespace mammoray
{
/**
 * Writes by extension: a vtkUnstructuredGrid as .vtu (compressed, appended), a vtkPolyData as .vtp,
 * .stl, .ply or .obj (the last three without arrays, triangles only for .stl and .ply). Throws
 * InputError on another extension, naming the known ones, and when the file cannot be written.
 */
MAMMORAYIO_EXPORT void WriteMesh(vtkPointSet* mesh, const std::string& path);

/// Reads .vtu, or an unstructured grid in VTK's legacy .vtk. Throws InputError on a missing,
/// damaged or empty file.
MAMMORAYIO_EXPORT vtkSmartPointer<vtkUnstructuredGrid> ReadMesh(const std::string& path);

/// Reads .vtp, .stl, .ply, .obj, or all parts of the scene of a .glb or .gltf (glTF 2.0; its metres
/// become mm). Throws InputError on a missing, damaged or empty file, and on what of glTF cannot be
/// shown as it is (Private/GltfReader.h).
MAMMORAYIO_EXPORT vtkSmartPointer<vtkPolyData> ReadSurface(const std::string& path);

/// The unit that ReadSurface takes the numbers of a file of this name to be in, mm.
MAMMORAYIO_EXPORT double NativeUnitMm(const std::string& path);
}

#endif
