// SPDX-License-Identifier: Apache-2.0
// Read by GLSL and by C++.
#ifndef Grazing_h
#define Grazing_h

// Least cosine between a ray and a triangle's normal that a derivative divides by; see PathLengthDerivatives.
#define MAMMORAY_GRAZING_COSINE 0.00390625

#endif
