// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_TriangleAim_h
#define mammoray_TriangleAim_h

#include "mammoray/Meshing/LabelMesher.h"
#include "mammorayMeshingModule.h"

#include <cstddef>
#include <string>

namespace mammoray
{
/// Throws InputError about `what` (plural) if it needs more memory than the machine has.
MAMMORAYMESHING_EXPORT void CheckMemory(const std::string& what, double bytes);

/// Throws InputError if even the largest cells and triangles within the sizes do not fit in memory.
MAMMORAYMESHING_EXPORT void CheckSizes(const LabelVolume& volume, const MeshingOptions& options);

/// Finds the sizes that produce MeshingOptions::Triangles, starting from coarser ones.
class MAMMORAYMESHING_EXPORT TriangleAim
{
public:
  /// Throws InputError if the voxels or the memory do not suffice for that many triangles. The
  /// options must outlive this object.
  TriangleAim(const LabelVolume& volume, const MeshingOptions& options);

  /// Options for the next attempt: facets are scaled, and inner cells need not be finer than
  /// requested.
  MeshingOptions Sizes() const;

  enum class Verdict
  {
    Met,
    /// Refine the present mesh.
    TooFew,
    /// Start again with coarser sizes.
    TooMany
  };

  /// Judges the mesh that Sizes() produced and updates Sizes() for the next attempt. Throws
  /// ConvergenceError after ten attempts.
  Verdict Judge(std::size_t triangles);

private:
  double TargetCount;
  const MeshingOptions& Start;
  double Scale = 1;
  int Attempts = 0;
  double LastTriangles = 0;
  double LastScale = 1;
};
}

#endif
