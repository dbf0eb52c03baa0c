// SPDX-License-Identifier: Apache-2.0
// The payload of a path length ray.
#ifndef pathLengthRay_glsl
#define pathLengthRay_glsl

#ifdef MAMMORAY_DOUBLE
#extension GL_EXT_shader_explicit_arithmetic_types_float64 : require
#endif
#include "PathLengthParameters.h"

// Number of materials there is room for, air included.
layout(constant_id = 0) const uint Capacity = 4;
// Velocity fields whose derivatives are summed.
layout(constant_id = 1) const uint Fields = 0;
// Whether the loss's gradient is added up (reverse mode); there are no fields then.
layout(constant_id = 2) const bool Reverse = false;
const uint RateRoom = Reverse ? Capacity : Fields == 0u ? 1u : Capacity * Fields;

struct PathLengthRay
{
  // Local frame, mm. Direction has unit length. Origin is the ray's point nearest to the local origin,
  // so the parameters t of hits are small and sums of +-t lose few digits in single precision.
  Real3 Origin;
  Real3 Direction;
  // Parameters of source and pixel: hits beyond them count as if they lay there, so that a body which
  // holds the source or the pixel contributes what lies between the two.
  Real Begin;
  Real End;
  // Zero when the crossings of every material cancel, up to one chance in 2^32.
  uint Balance;
  // Not zero when a hit lay too near to a triangle's edge to be sure that it is seen exactly once.
  uint Doubtful;
  // Sum of t (front - back) per material, facing the source; mm.
  Real Lengths[Capacity];
  // In reverse mode, not zero when this ray's hits are added to the gradient.
  uint Reversed;
  // Sums of dt/dp in the same way; [material * Fields + field]. In reverse mode, the loss's derivative with respect
  // to the length in each material, in units of the gradient's sums.
  float Rates[RateRoom];
};

#endif
