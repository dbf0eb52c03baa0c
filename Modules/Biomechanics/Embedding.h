// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Embedding_h
#define mammoray_Embedding_h

#include "mammorayBiomechanicsModule.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace mammoray
{
class CompressionSimulation;

/// Points that move with a simulation: x = sum_i N_i(xi) x_i, with the shape functions N_i of the
/// cell that contains the point in the undeformed mesh or is nearest to it.
class MAMMORAYBIOMECHANICS_EXPORT Embedding
{
public:
  /// `points` are 3 x pointCount coordinates in the simulation's mesh as it was given, mm, in its
  /// frame. Throws InputError if they are not finite.
  Embedding(const CompressionSimulation& simulation, const std::vector<double>& points);
  /// Interpolates node positions or node velocities of the simulation (3 x nodeCount) at the
  /// points; the result is 3 x pointCount. After Unload, some cells of the given mesh are slightly
  /// curved: displacements from ImagePositions are then more accurate than positions.
  std::vector<double> Map(const std::vector<double>& nodeValues) const;
  /// Interpolates into `pointValues`, 3 x pointCount.
  void Map(std::span<const double> nodeValues, std::span<double> pointValues) const;
  /// The transpose of Map: values at the points, 3 x pointCount, summed at `nodeCount` nodes.
  std::vector<double> Gather(const std::vector<double>& pointValues, std::size_t nodeCount) const;
  std::size_t NumberOfPoints() const { return this->CellIndices.size(); }
  /// Index of the cell that contains or is nearest to each point.
  const std::vector<std::int32_t>& Cells() const { return this->CellIndices; }

private:
  int NodesPerPoint;
  /// Node indices and weights, NodesPerPoint per point.
  std::vector<std::int32_t> Nodes;
  std::vector<double> Weights;
  std::vector<std::int32_t> CellIndices;
};
}

#endif
