// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Embedding_h
#define mammoray_Embedding_h

#include "mammorayBiomechanicsModule.h"

#include <cstdint>
#include <vector>

namespace mammoray
{
class CompressionSimulation;

/**
 * Points that move with a simulation: x = sum_i N_i(xi) x_i of the cell that holds (or is nearest
 * to) each of them at rest.
 */
class MAMMORAYBIOMECHANICS_EXPORT Embedding
{
public:
  /// `points`: 3 x pointCount in the simulation's mesh as it was given, mm, its frame.
  Embedding(const CompressionSimulation& simulation, const std::vector<double>& points);
  /// Moves the points with node positions (or velocities) of the simulation; 3 x pointCount. After
  /// Unload, where cells of the given mesh are curved a little, displacements from ImagePositions
  /// are exacter.
  std::vector<double> Map(const std::vector<double>& nodeValues) const;
  /// Largest distance of a point outside its cell, mm.
  double LargestDistanceMm() const { return this->Distance; }
  /// The cell that holds or is nearest to each point.
  const std::vector<std::int32_t>& Cells() const { return this->CellIndices; }

private:
  int NodesPerPoint;
  /// Node indices and weights, NodesPerPoint for each point.
  std::vector<std::int32_t> Nodes;
  std::vector<double> Weights;
  std::vector<std::int32_t> CellIndices;
  double Distance = 0;
};
}

#endif
