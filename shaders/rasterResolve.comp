#version 460
// SPDX-License-Identifier: Apache-2.0
// One invocation per pixel of the detector: mm from the sums, and the mean of the samples that can be
// trusted.
#extension GL_GOOGLE_include_directive : require
#include "raster.glsl"

// mm; [material * PixelCount + pixel].
layout(set = 0, binding = MAMMORAY_RASTER_LENGTHS, std430) writeonly buffer LengthBuffer
{
  float lengths[];
};
// Number of samples per pixel whose crossings do not cancel.
layout(set = 0, binding = MAMMORAY_RASTER_FAILURES, std430) writeonly buffer FailureBuffer
{
  uint failures[];
};

// Negative lengths come from a surface whose labels are inside out; the tolerance (mm) is far above the
// rounding of hits that cancel.
bool isSound(uint base)
{
  bool sound = sums[base] == 0u;
  for (uint material = 1u; material < parameters.Materials; ++material)
  {
    sound = sound && Real(int(sums[base + material])) > Real(-1e-3) * parameters.Scales.z;
  }
  return sound;
}

void main()
{
  const uint samples = parameters.Samples;
  const uint columns = parameters.Columns / samples;
  const uint rows = parameters.RowCount / samples;
  const uint index = gl_GlobalInvocationID.y * gl_NumWorkGroups.x * MAMMORAY_RASTER_GROUP +
    gl_GlobalInvocationID.x;
  if (index >= columns * rows)
  {
    return;
  }
  const uint row = index / columns;
  const uint column = index - row * columns;
  const uint pixel = (parameters.FirstRow / samples) * columns + index;
  const uint corner = row * samples * parameters.Columns + column * samples;

  uint failed = 0u;
  for (uint sampleIndex = 0u; sampleIndex < samples * samples; ++sampleIndex)
  {
    const uint place =
      corner + sampleIndex / samples * parameters.Columns + sampleIndex % samples;
    failed += isSound(place * parameters.Materials) ? 0u : 1u;
  }
  failures[pixel] = failed;
  const uint good = samples * samples - failed;
  for (uint material = 1u; material < parameters.Materials; ++material)
  {
    Real sum = 0;
    for (uint sampleIndex = 0u; sampleIndex < samples * samples; ++sampleIndex)
    {
      const uint base =
        (corner + sampleIndex / samples * parameters.Columns + sampleIndex % samples) *
        parameters.Materials;
      if (failed == 0u || isSound(base))
      {
        sum += Real(max(int(sums[base + material]), 0));
      }
    }
    lengths[material * parameters.PixelCount + pixel] =
      good > 0u ? float(sum / (Real(good) * parameters.Scales.z)) : 0.0;
  }
}
