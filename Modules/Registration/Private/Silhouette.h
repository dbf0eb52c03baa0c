// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Silhouette_h
#define mammoray_Silhouette_h

#include "mammoray/Foundation/Mammogram.h"
#include "mammoray/Foundation/Meshes.h"
#include "mammorayRegistrationModule.h"

#include <array>
#include <cstdint>
#include <vector>

namespace mammoray
{
/// Edges of a surface between skin and air, each once, as pairs of point indices.
MAMMORAYREGISTRATION_EXPORT std::vector<std::array<std::uint32_t, 2>> OuterEdges(
  const SurfaceMesh& surface);

/**
 * The outer silhouette seen from `centre`: for each unit direction the distance, mm, of the
 * farthest crossing of a projected edge with the ray from `centre`; 0 where none crosses. Exact for
 * the polygons the edges draw, hence continuous when their points move. `crossed`, if given,
 * receives the number of the edge of each crossing; -1 where there is none.
 */
MAMMORAYREGISTRATION_EXPORT std::vector<double> SilhouetteRadii(
  const std::vector<ReceptorPoint>& projected,
  const std::vector<std::array<std::uint32_t, 2>>& edges, const ReceptorPoint& centre,
  const std::vector<ReceptorPoint>& directions, std::vector<std::int32_t>* crossed = nullptr);

/**
 * Derivatives of those distances when the projected points move (`velocities`, mm per unit of a
 * parameter) while the same edges are crossed; mm per unit.
 */
MAMMORAYREGISTRATION_EXPORT std::vector<double> SilhouetteDerivatives(
  const std::vector<ReceptorPoint>& projected, const std::vector<ReceptorPoint>& velocities,
  const std::vector<std::array<std::uint32_t, 2>>& edges, const ReceptorPoint& centre,
  const std::vector<ReceptorPoint>& directions, const std::vector<std::int32_t>& crossed);

/// `count` unit directions, equally spaced in angle strictly between +x and -x through +y.
MAMMORAYREGISTRATION_EXPORT std::vector<ReceptorPoint> HalfCircleDirections(int count);
}

#endif
