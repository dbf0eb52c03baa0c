// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_CompressionGrids_h
#define mammoray_CompressionGrids_h

#include "mammoray/Biomechanics/CompressionSimulation.h"
#include "mammoray/Biomechanics/Embedding.h"
#include "mammoray/Foundation/Meshes.h"
#include "mammorayStudyModule.h"

#include "vtkSmartPointer.h"

#include <optional>
#include <string>
#include <vector>

class vtkUnstructuredGrid;

namespace mammoray
{
/**
 * Grids of a breast in the states of its compression: the arrays of the uncompressed one, and
 *
 * - points: "Displacement" (mm, from the grid given), "ContactPressureKPa" (of the plates; 0 where
 *   nothing touches);
 * - cells: "J" (deformed over undeformed volume), "VonMisesStressKPa" (of the Cauchy stress);
 * - field data: "PaddleForceN", "SupportForceN", "ThicknessMm", "LargestPenetrationMm",
 *   "LargestWallLiftMm", "LargestWallGlideMm", "SmallestJ", "LargestJ", "VolumeRatio",
 *   "RelativeResidual", "StiffnessFactor", and "InvertedCells" of a grid that is carried along.
 */
class MAMMORAYSTUDY_EXPORT CompressionGrids
{
public:
  /// The grid's cells are those of the simulation: J and stress are means over their quadrature
  /// points.
  CompressionGrids(vtkUnstructuredGrid* grid, CompressionSimulation& simulation);
  /**
   * A grid of these tetrahedra that the simulation carries along: J is of the volumes between the
   * corners, pressure and stress are those of the simulation's cells that hold the points and the
   * cells' middles, so that the pressure fades over one of them from the skin inwards.
   */
  CompressionGrids(vtkUnstructuredGrid* grid, const TetrahedralMesh& mesh,
    CompressionSimulation& simulation);

  /// `thicknessMm`: value of "ThicknessMm"; by default the distance of the plates.
  vtkSmartPointer<vtkUnstructuredGrid> At(const CompressionState& state,
    std::optional<double> thicknessMm = {}) const;

private:
  vtkSmartPointer<vtkUnstructuredGrid> Grid;
  CompressionSimulation& Simulation;
  /// Empty where the grid is the simulation's own.
  std::optional<TetrahedralMesh> Carried;
  std::optional<Embedding> Points;
  std::optional<Embedding> Middles;
};

/// Time of a step of a compression, evenly spaced from 0 (open) to 1 (closed); a single step is
/// closed.
MAMMORAYSTUDY_EXPORT double TimeOf(std::size_t step, std::size_t count);

/**
 * Writes the grids of a compression at TimeOf each step as a ParaView collection: `path` (.pvd) and
 * beside it one .vtu file each (SeriesFiles(path, count)). Throws InputError if a file cannot be
 * written; then none of them is left.
 */
MAMMORAYSTUDY_EXPORT void WriteSeries(const std::string& path,
  const std::vector<vtkSmartPointer<vtkUnstructuredGrid>>& grids);
MAMMORAYSTUDY_EXPORT std::vector<std::string> SeriesFiles(const std::string& path,
  std::size_t count);
}

#endif
