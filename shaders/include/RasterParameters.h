// SPDX-License-Identifier: Apache-2.0
// What the host hands to the rasterisation shaders; read by GLSL and by C++. Lengths in mm, in the local
// frame: the mesh's axes, the origin at the middle of the mesh. Pixels are those of the fine grid, Samples x
// Samples for each pixel of the detector.
#ifndef RasterParameters_h
#define RasterParameters_h

#define MAMMORAY_RASTER_PARAMETERS 0
#define MAMMORAY_RASTER_POSITIONS 1
#define MAMMORAY_RASTER_TRIANGLES 2
#define MAMMORAY_RASTER_MATERIALS 3
#define MAMMORAY_RASTER_SUMS 4
#define MAMMORAY_RASTER_TILES 5
#define MAMMORAY_RASTER_LENGTHS 6
#define MAMMORAY_RASTER_FAILURES 7
#define MAMMORAY_RASTER_VELOCITIES 8
#define MAMMORAY_RASTER_RATES 9
#define MAMMORAY_RASTER_MARKS 10
#define MAMMORAY_RASTER_BINDING_COUNT 11

// Invocations per workgroup of each of the shaders.
#define MAMMORAY_RASTER_GROUP 64
// Side of a tile of pixels; that many invocations share one, a column of pixels each.
#define MAMMORAY_RASTER_TILE 8
// Triangles whose bounding box holds at most so many pixels are not handed on to tiles.
#define MAMMORAY_RASTER_SMALL 128
// Rays that are traced again, in several attempts, stay this near to where the first of these has them, pixels
// of the detector: its list of tiles serves them all.
#define MAMMORAY_RASTER_DRIFT 0.25

// Velocity fields in one pass, at most.
#define MAMMORAY_RASTER_FIELDS 8
// Units of a rate's sum per largest speed of its field; sums of the rates of 16 hits at the guard's angle fit.
#define MAMMORAY_RASTER_RATE_UNITS 524288

#ifdef __cplusplus
#include <cstdint>
namespace mammoray
{
#define MAMMORAY_RASTER_REAL4(name) Real name[4]
#define MAMMORAY_RASTER_UINT(name) std::uint32_t name
template <typename Real>
struct RasterParameters
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
#define MAMMORAY_RASTER_REAL4(name) Real4 name
#define MAMMORAY_RASTER_UINT(name) uint name
struct RasterParameters
#endif
{
  // Homogeneous pixel coordinates of a point p: (column w, row w, w) = rows . (p, 1).
  MAMMORAY_RASTER_REAL4(ColumnOf);
  MAMMORAY_RASTER_REAL4(RowOf);
  MAMMORAY_RASTER_REAL4(WeightOf);
  // How far a point p lies from the local origin towards the detector: DepthOf . p, in mm along the rays of a
  // parallel beam, in shares of the way from source to detector along any ray of a point source. Fourth: units
  // of the sums per depth.
  MAMMORAY_RASTER_REAL4(DepthOf);
  // Point source: its position, 1. Parallel beam: the direction of travel, 0.
  MAMMORAY_RASTER_REAL4(Source);
  // Centre of pixel (0, 0); fourth: the most negative sum that rounding explains, 1e-3 mm. Then the steps to the
  // next column and the next row, fourth components unused.
  MAMMORAY_RASTER_REAL4(DetectorOrigin);
  MAMMORAY_RASTER_REAL4(ColumnStep);
  MAMMORAY_RASTER_REAL4(RowStep);
  // x: sign of the pixel coordinates' determinant, +1 or -1. y and z: least and largest depth of a hit that
  // counts, between source and detector, as far as the mesh reaches. w: room around a bounding box for rounding,
  // pixels.
  MAMMORAY_RASTER_REAL4(Scales);
  MAMMORAY_RASTER_UINT(Columns);
  // The rows of the fine grid in work: those from FirstRow on, as many as RowCount.
  MAMMORAY_RASTER_UINT(FirstRow);
  MAMMORAY_RASTER_UINT(RowCount);
  MAMMORAY_RASTER_UINT(Samples);
  // Pixels of the whole detector, not of the fine grid.
  MAMMORAY_RASTER_UINT(PixelCount);
  // Number of materials, air included.
  MAMMORAY_RASTER_UINT(Materials);
  MAMMORAY_RASTER_UINT(Triangles);
  // Entries there is room for in the list of tiles.
  MAMMORAY_RASTER_UINT(TileCapacity);
  // Velocity fields whose derivatives are summed; in reverse mode not 0 where rays have marks.
  MAMMORAY_RASTER_UINT(Fields);
  // First and last column and row that are looked at, whole pixels of the detector.
  MAMMORAY_RASTER_UINT(Left);
  MAMMORAY_RASTER_UINT(Right);
  MAMMORAY_RASTER_UINT(Top);
  MAMMORAY_RASTER_UINT(Bottom);
  // The attempt, from 0 on: later ones trace the rays that they mark only, a little beside.
  MAMMORAY_RASTER_UINT(Again);
  // Columns of the detector, and its first pixel in work.
  MAMMORAY_RASTER_UINT(PixelColumns);
  MAMMORAY_RASTER_UINT(FirstPixel);
};

#ifdef __cplusplus
static_assert(sizeof(RasterParameters<float>) == 9 * 16 + 64);
static_assert(sizeof(RasterParameters<double>) == 9 * 32 + 64);
}
#endif
#endif
