#version 460
// SPDX-License-Identifier: Apache-2.0
// One invocation per pixel of the detector that is looked at, columns by rows: mm from the sums, and the mean of
// the samples that can be trusted.
#extension GL_GOOGLE_include_directive : require
#include "raster.glsl"

// mm; [material * PixelCount + pixel].
layout(set = 0, binding = MAMMORAY_RASTER_LENGTHS, std430) writeonly buffer LengthBuffer
{
  float lengths[];
};
// Rates per pixel, in units of their sums; [(field * Materials + material) * PixelCount + pixel].
layout(set = 0, binding = MAMMORAY_RASTER_RATES, std430) writeonly buffer RateBuffer
{
  float rates[];
};

// The first pair of a pixel of the fine grid, counted from the first row in work.
uint sumsOf(uint column, uint row)
{
  return (row * parameters.Columns + column) * (parameters.Materials - 1u) * pairsPerMaterial();
}

void main()
{
  const uint samples = parameters.Samples;
  const uint left = parameters.Left + gl_GlobalInvocationID.x * samples;
  const uint top = parameters.Top - parameters.FirstRow + gl_GlobalInvocationID.y * samples;
  if (left > parameters.Right)
  {
    return;
  }
  const uint pixel =
    parameters.FirstPixel + top / samples * parameters.PixelColumns + left / samples;
  uint failed = 0u;
  for (uint row = top; row < top + samples; ++row)
  {
    for (uint column = left; column < left + samples; ++column)
    {
      failed += isSound(sumsOf(column, row)) ? 0u : 1u;
    }
  }
  failures[pixel] = failed;
  if (failed > 0u)
  {
    atomicAdd(failures[parameters.PixelCount], 1u);
  }
  const uint good = samples * samples - failed;
  const Real share = good > 0u ? 1 / Real(good) : Real(0);
  const Real depthShare = share / parameters.DepthOf.w;
  const uint fields = WithRates ? parameters.Fields : 0u;
  for (uint material = 1u; material < parameters.Materials; ++material)
  {
    const uint offset = (material - 1u) * pairsPerMaterial();
    Real sum = 0;
    for (uint row = top; row < top + samples; ++row)
    {
      for (uint column = left; column < left + samples; ++column)
      {
        const uint base = sumsOf(column, row);
        if (failed == 0u || isSound(base))
        {
          const Real3 ray = rayOf(column, parameters.FirstRow + row);
          sum += sqrt(dot(ray, ray)) * Real(max(loadPair(base + offset).x, 0));
        }
      }
    }
    lengths[material * parameters.PixelCount + pixel] = float(sum * depthShare);
    [[dont_unroll]] for (uint field = 0u; field < fields; field += 2u)
    {
      vec2 rate = vec2(0);
      for (uint row = top; row < top + samples; ++row)
      {
        for (uint column = left; column < left + samples; ++column)
        {
          const uint base = sumsOf(column, row);
          if (failed == 0u || isSound(base))
          {
            rate += vec2(loadPair(base + offset + 1u + field / 2u));
          }
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
