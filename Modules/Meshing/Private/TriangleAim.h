// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_TriangleAim_h
#define mammoray_TriangleAim_h

#include "mammoray/Foundation/LabelVolume.h"
#include "mammoray/Meshing/MeshingOptions.h"
#include "mammorayMeshingModule.h"

#include <cstddef>
#include <string>

namespace mammoray
{
/// Throws InputError, of `what`, in the plural, where so many bytes are more than MemoryLimitBytes.
MAMMORAYMESHING_EXPORT void CheckMemory(const std::string& what, double bytes);

/// Throws InputError where even the largest cells and triangles that keep to the sizes are more
/// than fit in the memory.
MAMMORAYMESHING_EXPORT void CheckSizes(const LabelVolume& volume, const MeshingOptions& options);

/// Finds the sizes that give a number of triangles, MeshingOptions::Triangles, coming from coarser
/// ones.
class MAMMORAYMESHING_EXPORT TriangleAim
{
public:
  /// Throws InputError where voxels or memory do not do for so many triangles. The options must
  /// outlive it.
  TriangleAim(const LabelVolume& volume, const MeshingOptions& options);

  /// Facets with the scale of the next attempt; cells inside need not be finer than asked for.
  MeshingOptions Sizes() const;

  enum class Verdict
  {
    Met,
    /// Refine what is there.
    TooFew,
    /// Begin again, coarser.
    TooMany
  };

  /// Judges the mesh made with Sizes(), which are then those of the next attempt. Throws
  /// ConvergenceError after ten attempts.
  Verdict Judge(std::size_t triangles);

private:
  double Wanted;
  const MeshingOptions& Start;
  double Scale = 1;
  int Attempts = 0;
  double LastTriangles = 0;
  double LastScale = 1;
};
}

#endif
