// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_SlabScatter_h
#define mammoray_SlabScatter_h

#include "mammoray/XRay/Scatter/PhotonMaterial.h"
#include "mammoray/XRay/Scatter/ScatterKernels.h"

#include <array>
#include <cstdint>
#include <vector>

namespace mammoray
{
/**
 * Follows photons from one point at right angles into a slab and adds what of their energy would
 * meet rings and angles of `axes` at each of its gaps, relative to what comes through unscattered,
 * to sums[(gap * rings + ring) * angles + angle]; numbers `begin` to `end` of the seed. Returns
 * what of all that leaves the slab's back, relative to the same, has collided more than once, and
 * all.
 */
std::array<double, 2> FollowThroughSlab(const PhotonMaterial& tissue, double energyKeV,
  double thicknessMm, const ScatterKernels& axes, std::uint64_t seed, std::uint64_t begin,
  std::uint64_t end, std::vector<double>& sums);
}

#endif
