// SPDX-License-Identifier: Apache-2.0
// Sums of the gradient with respect to the points: 64-bit integers in the host's units, exact and independent of
// the order of hits. The including file states the set's binding as MAMMORAY_GRADIENT_BINDING.
#ifndef gradient_glsl
#define gradient_glsl

// [point * 3 + axis]; where there are no 64-bit atomics, each number is its lower and its upper word.
layout(set = 0, binding = MAMMORAY_GRADIENT_BINDING, std430) buffer GradientBuffer
{
#ifdef MAMMORAY_INT64
  uint64_t gradients[];
#else
  uint gradients[];
#endif
};

void addGradient(uint index, Real value)
{
  const Real word = Real(4294967296.0);
  const Real size = floor(abs(value) + Real(0.5));
  const Real upper = floor(size / word);
  uint low = uint(size - upper * word);
  uint high = uint(upper);
  if (value < 0)
  {
    low = ~low + 1u;
    high = low == 0u ? ~high + 1u : ~high;
  }
#ifdef MAMMORAY_INT64
  atomicAdd(gradients[index], packUint2x32(uvec2(low, high)));
#else
  const uint before = atomicAdd(gradients[2u * index], low);
  atomicAdd(gradients[2u * index + 1u], before + low < before ? high + 1u : high);
#endif
}

#endif
