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

// Rates per pixel, in units of their sums; [(field * Materials + material) * PixelCount + pixel].
layout(set = 0, binding = MAMMORAY_RASTER_RATES, std430) writeonly buffer RateBuffer
{
  float rates[];
};

// The first pair of a sample's first material.
uint sumsOf(uint corner, uint sampleIndex)
{
  const uint samples = parameters.Samples;
  const uint sampleRow = sampleIndex / samples;
  const uint place = corner + sampleRow * parameters.Columns + sampleIndex - sampleRow * samples;
  return place * (parameters.Materials - 1u) * pairsPerMaterial();
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
  const uint count = samples * samples;

  uint failed = 0u;
  for (uint sampleIndex = 0u; sampleIndex < count; ++sampleIndex)
  {
    failed += isSound(sumsOf(corner, sampleIndex)) ? 0u : 1u;
  }
  failures[pixel] = failed;
  const Real share = failed < count ? 1 / Real(count - failed) : Real(0);
  for (uint material = 1u; material < parameters.Materials; ++material)
  {
    const uint offset = (material - 1u) * pairsPerMaterial();
    Real sum = 0;
    for (uint sampleIndex = 0u; sampleIndex < count; ++sampleIndex)
    {
      const uint base = sumsOf(corner, sampleIndex);
      if (failed == 0u || isSound(base))
      {
        sum += Real(max(loadPair(base + offset).x, 0));
      }
    }
    lengths[material * parameters.PixelCount + pixel] = float(sum * share / parameters.Scales.z);
    const uint fields = WithRates ? parameters.Fields : 0u;
    [[dont_unroll]] for (uint field = 0u; field < fields; field += 2u)
    {
      vec2 rate = vec2(0);
      for (uint sampleIndex = 0u; sampleIndex < count; ++sampleIndex)
      {
        const uint base = sumsOf(corner, sampleIndex);
        if (failed == 0u || isSound(base))
        {
          rate += vec2(loadPair(base + offset + 1u + field / 2u));
        }
      }
      rate *= float(share);
      const uint place = (field * parameters.Materials + material) * parameters.PixelCount + pixel;
      rates[place] = rate.x;
      if (field + 1u < fields)
      {
        rates[place + parameters.Materials * parameters.PixelCount] = rate.y;
      }
    }
  }
}
