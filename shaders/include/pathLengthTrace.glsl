// SPDX-License-Identifier: Apache-2.0
// Tracing one ray, for the ray generation shaders.
#ifndef pathLengthTrace_glsl
#define pathLengthTrace_glsl

#include "pathLengthRay.glsl"

layout(set = 0, binding = MAMMORAY_BINDING_SCENE) uniform accelerationStructureEXT scene;
layout(set = 0, binding = MAMMORAY_BINDING_PARAMETERS, std430) readonly buffer ParameterBuffer
{
  PathLengthParameters parameters;
};
layout(location = 0) rayPayloadEXT PathLengthRay ray;

// Hash of a 32-bit number (PCG: M. E. O'Neill 2014; output function RXS-M-XS).
uint hash(uint value)
{
  uint state = value * 747796405u + 2891336453u;
  uint word = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u;
  return (word >> 22u) ^ word;
}

// Offset of an attempt in pixels: 0, then a random direction of growing length up to a tenth of a pixel.
vec2 attemptOffset(uint rayIndex, uint attempt)
{
  if (attempt == 0u)
  {
    return vec2(0.0);
  }
  float angle = 6.2831853 * float(hash(rayIndex * 8u + attempt) >> 8u) / 16777216.0;
  return 1e-4 * pow(10.0, float(min(attempt, 4u) - 1u)) * vec2(cos(angle), sin(angle));
}

// Parameters at which the line enters and leaves the box; empty (x > y) when it misses.
vec2 boxInterval(Real3 origin, Real3 direction)
{
  Real enter = -3e38;
  Real leave = 3e38;
  for (int axis = 0; axis < 3; ++axis)
  {
    Real low = parameters.BoxLow[axis] - origin[axis];
    Real high = parameters.BoxHigh[axis] - origin[axis];
    if (abs(direction[axis]) > 1e-20)
    {
      Real a = low / direction[axis];
      Real b = high / direction[axis];
      enter = max(enter, min(a, b));
      leave = min(leave, max(a, b));
    }
    else if (low > 0 || high < 0)
    {
      return vec2(1, 0);
    }
  }
  return vec2(enter, leave);
}

void clearSums()
{
  ray.Balance = 0u;
  ray.Doubtful = 0u;
  for (uint material = 0u; material < parameters.Materials; ++material)
  {
    ray.Lengths[material] = 0;
  }
  for (uint index = 0u; index < parameters.Materials * Fields; ++index)
  {
    ray.Rates[index] = 0.0;
  }
}

// True when the sums of a traced ray can be trusted. Negative lengths come from a surface whose labels are
// inside out; the tolerance (mm) is far above the rounding of hits that cancel.
bool sumsAreSound()
{
  bool sound = ray.Balance == 0u;
  for (uint material = 1u; material < parameters.Materials; ++material)
  {
    sound = sound && ray.Lengths[material] > -1e-3;
  }
  return sound;
}

// Sums what the whole line through a point meets inside the mesh's box.
void traceLine(Real3 point, Real3 direction)
{
  const Real3 nearest = point - dot(point, direction) * direction;
  const vec2 interval = boxInterval(nearest, direction);
  clearSums();
  if (interval.x <= interval.y)
  {
    // Starting at the box and not at the source keeps the float hit test exact to about 1e-5 mm.
    const vec3 start = vec3(nearest + Real(interval.x) * direction);
    traceRayEXT(scene, gl_RayFlagsSkipClosestHitShaderEXT, 0xff, 0, 0, 0, start, 0.0,
      vec3(direction), interval.y - interval.x, 0);
  }
}

// True when the traced ray needs no further attempt. The last one may be doubtful: its crossings cancel, which is
// all slivers can offer.
bool isDone(uint attempt)
{
  return sumsAreSound() && (ray.Doubtful == 0u || attempt + 1u == parameters.Attempts);
}

#endif
