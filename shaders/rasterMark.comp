#version 460
// SPDX-License-Identifier: Apache-2.0
// One invocation per pixel of the fine grid that is looked at: marks a ray whose crossings do not cancel with the
// attempt and clears its sums, such that it can be traced again. If the attempt runs a second time, so do its rays.
#extension GL_GOOGLE_include_directive : require
#include "raster.glsl"

void main()
{
  const uint column = parameters.Left + gl_GlobalInvocationID.x;
  if (column > parameters.Right)
  {
    return;
  }
  const uint row = parameters.Top - parameters.FirstRow + gl_GlobalInvocationID.y;
  const uint index = row * parameters.Columns + column;
  const uint pairs = (parameters.Materials - 1u) * pairsPerMaterial();
  if (marks[index] != parameters.Again && isSound(index * pairs))
  {
    return;
  }
  marks[index] = parameters.Again;
  for (uint pair = 0u; pair < pairs; ++pair)
  {
#ifdef MAMMORAY_INT64
    sums[index * pairs + pair] = 0ul;
#else
    sums[index * pairs + pair] = uvec2(0u);
#endif
  }
}
