// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Private_GmshFile_h
#define mammoray_Private_GmshFile_h

#include "mammorayIOModule.h"

#include "vtkSmartPointer.h"

#include <string>

class vtkUnstructuredGrid;

namespace mammoray
{
/**
 * Reads all elements of a gmsh file (.msh of version 2 or 4.1, text or binary) as cells of VTK. The
 * physical groups of volumes are materials, numbered from 1 in the order of their tags, with their
 * names; without any, all volumes are material 1. Volumes of a group called air are left out. The
 * cell array "Material" is 0 of other elements. Throws InputError, which names the line or the
 * element, on another version, an unknown type of element, nodes that do not exist, volumes in no
 * group or in several, and on a file that is cut off.
 */
MAMMORAYIO_EXPORT vtkSmartPointer<vtkUnstructuredGrid> ReadGmsh(const std::string& path);
}

#endif
