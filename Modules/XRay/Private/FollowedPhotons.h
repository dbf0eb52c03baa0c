// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_FollowedPhotons_h
#define mammoray_FollowedPhotons_h

#include "mammoray/Foundation/Progress.h"
#include "mammoray/XRay/Scene.h"

#include <vector>

namespace mammoray
{
/// The scattered signal of each pixel by Monte Carlo, Rows * Columns values, relative to the
/// primary signal without an object. Photons are gathered in pixels of 4 mm, within which scatter
/// changes little, and interpolated.
std::vector<double> FollowScatter(const Scene& scene, const ProgressCallback& progress);
}

#endif
