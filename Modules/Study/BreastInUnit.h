// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_BreastInUnit_h
#define mammoray_BreastInUnit_h

#include "mammoray/Foundation/Mammogram.h"
#include "mammoray/Foundation/MammographyGeometry.h"
#include "mammoray/Study/ResultFile.h"
#include "mammorayStudyModule.h"

#include "vtkSmartPointer.h"

#include <string>
#include <vector>

class vtkUnstructuredGrid;

namespace mammoray
{
/// The point arrays of uncompressed.vtu that hold the derivatives of the compressed positions, seen
/// from the unit, are called this and the parameter's name; mm per mm or degree.
inline constexpr const char* SensitivityArrayPrefix = "Sensitivity_";

/// A breast at rest and compressed, and the unit that images it.
struct BreastInUnit
{
  /// The same linear tetrahedra in both, volume frame, mm, with the cell array "Material". The
  /// uncompressed one may have point arrays called SensitivityArrayPrefix and a parameter.
  vtkSmartPointer<vtkUnstructuredGrid> Uncompressed;
  vtkSmartPointer<vtkUnstructuredGrid> Compressed;
  VolumeFromGantry Placed;
  MammographyUnit Unit;
  /// The mammogram's pixels.
  ReceptorGrid Grid;
  /// The parameters of a registration in its order, and the covariance of what is free and of what
  /// is fixed with a prior, row by row, which is empty where it is not known.
  std::vector<std::string> Parameters;
  std::vector<double> Covariance;
};

/// Fills all but the meshes from what a result says.
MAMMORAYSTUDY_EXPORT void DescribeUnit(const ResultFile& result, BreastInUnit& breast);

/// Takes what a result says of it and reads the meshes from the result's folder. Throws InputError
/// that names the file, also where the two are not one mesh, displaced as the uncompressed one's
/// point array "Displacement" (mm) says, or are placed elsewhere than the result says.
MAMMORAYSTUDY_EXPORT BreastInUnit ReadBreastInUnit(const ResultFile& result);
}

#endif
