// SPDX-License-Identifier: Apache-2.0
// Path lengths by Embree, Intel's ray tracing kernels for CPUs: an independent peer for tests, and
// the yardstick of the benchmarks.
#ifndef mammoray_Testing_EmbreePathLengths_h
#define mammoray_Testing_EmbreePathLengths_h

#include "mammoray/XRay/PathLengthProjector.h"

#include <embree3/rtcore.h>

#include <memory>
#include <type_traits>
#include <vector>

namespace mammoray::test
{
/// Where a hit's distance comes from.
enum class HitDistance
{
  /// Embree's own, in single precision; the fastest.
  Single,
  /// The plane of the triangle that Embree hit, in double precision: only which triangles are hit
  /// is Embree's.
  Double
};

/**
 * Sums path lengths in a filter function that lets every ray of a packet of eight go on, so that
 * hits are neither sorted nor stored; all cores. Source and detector must lie outside the body.
 */
class EmbreePathLengths
{
public:
  /// Builds Embree's acceleration structure; keeps a reference to the mesh. Up to 16 materials.
  explicit EmbreePathLengths(const SurfaceMesh& mesh);
  /// A ray whose crossings do not cancel (Embree may hit both triangles of an edge, or neither) is
  /// marked in Inconsistent and has no meaning.
  PathLengthImage Project(const XRaySource& source, const XRayDetector& detector,
    HitDistance distance) const;

private:
  struct Release
  {
    void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
    void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
  };
  const SurfaceMesh& Mesh;
  std::unique_ptr<std::remove_pointer_t<RTCDevice>, Release> Device;
  std::unique_ptr<std::remove_pointer_t<RTCScene>, Release> Scene;
};
}

#endif
