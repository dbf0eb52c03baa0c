// SPDX-License-Identifier: Apache-2.0
// What the host hands to the path length shaders; read by GLSL and by C++. Lengths in mm, in the local
// frame: the mesh's axes, the origin at the middle of the mesh, so that coordinates are small.
#ifndef PathLengthParameters_h
#define PathLengthParameters_h

#define MAMMORAY_BINDING_SCENE 0
#define MAMMORAY_BINDING_PARAMETERS 1
#define MAMMORAY_BINDING_POSITIONS 2
#define MAMMORAY_BINDING_TRIANGLES 3
#define MAMMORAY_BINDING_MATERIALS 4
#define MAMMORAY_BINDING_LENGTHS 5
#define MAMMORAY_BINDING_FAILURES 6
#define MAMMORAY_BINDING_VELOCITIES 7
#define MAMMORAY_BINDING_RATES 8
#define MAMMORAY_BINDING_COUNT 9

// Eight invocations next to each other trace a tile of pixels, so that rays which run together on a CPU's
// vector units lie close together.
#define MAMMORAY_TILE_COLUMNS 4
#define MAMMORAY_TILE_ROWS 2

#ifdef __cplusplus
#include <cstdint>
namespace mammoray
{
#define MAMMORAY_REAL4(name) Real name[4]
#define MAMMORAY_UINT(name) std::uint32_t name
template <typename Real>
struct PathLengthParameters
#else
#ifdef MAMMORAY_DOUBLE
#define Real double
#define Real3 dvec3
#define Real4 dvec4
#else
#define Real float
#define Real3 vec3
#define Real4 vec4
#endif
#define MAMMORAY_REAL4(name) Real4 name
#define MAMMORAY_UINT(name) uint name
struct PathLengthParameters
#endif
{
  // Point source: its position, 1. Parallel beam: the direction of travel, 0.
  MAMMORAY_REAL4(Source);
  // Centre of pixel (0, 0); steps to the next column and the next row; fourth components unused.
  MAMMORAY_REAL4(DetectorOrigin);
  MAMMORAY_REAL4(ColumnStep);
  MAMMORAY_REAL4(RowStep);
  // Corners of a box that holds the mesh with room to spare.
  MAMMORAY_REAL4(BoxLow);
  MAMMORAY_REAL4(BoxHigh);
  MAMMORAY_UINT(Columns);
  MAMMORAY_UINT(Rows);
  // Samples x Samples rays per pixel.
  MAMMORAY_UINT(Samples);
  // Number of materials, air included; at most the specialisation constant Capacity.
  MAMMORAY_UINT(Materials);
  // How often a ray may be traced, at least 1.
  MAMMORAY_UINT(Attempts);
  MAMMORAY_UINT(Padding0);
  MAMMORAY_UINT(Padding1);
  MAMMORAY_UINT(Padding2);
};

#ifdef __cplusplus
static_assert(sizeof(PathLengthParameters<float>) == 6 * 16 + 32);
static_assert(sizeof(PathLengthParameters<double>) == 6 * 32 + 32);
}
#endif
#endif
