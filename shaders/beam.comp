#version 460
// SPDX-License-Identifier: Apache-2.0
// One invocation per pixel: the Beer-Lambert law for a spectrum, on path lengths that are still on the device.
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_control_flow_attributes : require
#include "BeamParameters.h"

layout(local_size_x = MAMMORAY_BEAM_GROUP) in;

layout(push_constant) uniform Constants
{
  BeamParameters parameters;
};
// mm; [material * PixelCount + pixel], material 0 unused.
layout(set = 0, binding = MAMMORAY_BEAM_LENGTHS, std430) readonly buffer LengthBuffer
{
  float lengths[];
};
// Per energy its share of the unattenuated signal, then 1/mm of material 1, 2, ...
layout(set = 0, binding = MAMMORAY_BEAM_TABLE, std430) readonly buffer TableBuffer
{
  float table[];
};
layout(set = 0, binding = MAMMORAY_BEAM_TRANSMISSION, std430) writeonly buffer TransmissionBuffer
{
  float transmission[];
};

void main()
{
  const uint row = gl_NumWorkGroups.x * MAMMORAY_BEAM_GROUP;
  const uint pixel = gl_GlobalInvocationID.y * row + gl_GlobalInvocationID.x;
  if (pixel >= parameters.PixelCount)
  {
    return;
  }
  float sum = 0;
  uint energy = 0u;
  // Several energies for each reading of a length: reading is what takes the time, on CPUs most of all.
  for (; energy + MAMMORAY_BEAM_BLOCK <= parameters.Energies; energy += MAMMORAY_BEAM_BLOCK)
  {
    const uint first = energy * parameters.Materials;
    float exponents[MAMMORAY_BEAM_BLOCK];
    [[unroll]] for (uint k = 0u; k < MAMMORAY_BEAM_BLOCK; ++k)
    {
      exponents[k] = 0;
    }
    for (uint material = 1u; material < parameters.Materials; ++material)
    {
      const float crossed = lengths[material * parameters.PixelCount + pixel];
      [[unroll]] for (uint k = 0u; k < MAMMORAY_BEAM_BLOCK; ++k)
      {
        exponents[k] -= table[first + k * parameters.Materials + material] * crossed;
      }
    }
    [[unroll]] for (uint k = 0u; k < MAMMORAY_BEAM_BLOCK; ++k)
    {
      sum += table[first + k * parameters.Materials] * exp(exponents[k]);
    }
  }
  for (; energy < parameters.Energies; ++energy)
  {
    const uint first = energy * parameters.Materials;
    float exponent = 0;
    for (uint material = 1u; material < parameters.Materials; ++material)
    {
      exponent -= table[first + material] * lengths[material * parameters.PixelCount + pixel];
    }
    sum += table[first] * exp(exponent);
  }
  transmission[pixel] = sum;
}
