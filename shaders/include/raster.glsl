// SPDX-License-Identifier: Apache-2.0
// Triangles over pixels: an exact, watertight test and the sums of path lengths.
//
// In homogeneous pixel coordinates a, b of two corners, the edge's function over the pixels is linear,
// e(column, row) = (a x b) . (column, row, 1), zero where the pixel's line through the source meets the edge.
// It is evaluated such that the neighbour, who has the edge the other way round, finds exactly -e, and a ray
// through an edge or a corner counts as if it lay infinitesimally farther in columns, and infinitesimally
// less so in rows; so each ray meets a closed surface consistently. The line reaches behind the source, where w < 0.
//
// Sums are integers, exact and independent of the order of triangles: they may overflow on the way, since
// only the total has to fit.
#ifndef raster_glsl
#define raster_glsl

// Rounding of an edge function, relative to the sum of its terms, with room to spare.
#ifdef MAMMORAY_DOUBLE
#extension GL_EXT_shader_explicit_arithmetic_types_float64 : require
#define MAMMORAY_RASTER_SLACK 1e-14
#else
#define MAMMORAY_RASTER_SLACK 1e-6
#endif
#include "RasterParameters.h"

layout(local_size_x = MAMMORAY_RASTER_GROUP) in;

layout(set = 0, binding = MAMMORAY_RASTER_PARAMETERS, std430) readonly buffer ParameterBuffer
{
  RasterParameters parameters;
};
layout(set = 0, binding = MAMMORAY_RASTER_POSITIONS, std430) readonly buffer PositionBuffer
{
  Real positions[]; // x y z interleaved, mm, local frame
};
layout(set = 0, binding = MAMMORAY_RASTER_TRIANGLES, std430) readonly buffer TriangleBuffer
{
  uint triangles[]; // 3 vertex indices each
};
layout(set = 0, binding = MAMMORAY_RASTER_MATERIALS, std430) readonly buffer MaterialBuffer
{
  uint materials[]; // front in the lower, back in the upper 16 bits
};
// Per pixel of the rows in work: the balance of crossings, then the length in each material but air.
layout(set = 0, binding = MAMMORAY_RASTER_SUMS, std430) buffer SumBuffer
{
  uint sums[];
};
// Count, unused, then triangle and tile (column in the lower, row in the upper 16 bits) of each entry.
layout(set = 0, binding = MAMMORAY_RASTER_TILES, std430) buffer TileBuffer
{
  uint tiles[];
};

struct Triangle
{
  Real3 Points[3];
  // Edge functions: their factors of column, row and 1. Edge i lies opposite of point i.
  Real3 Edges[3];
  uint Front;
  uint Back;
};

Real3 pixelCoordinates(Real3 p)
{
  const Real4 c = parameters.ColumnOf;
  const Real4 r = parameters.RowOf;
  const Real4 w = parameters.WeightOf;
  precise Real3 result = Real3(c.x * p.x + c.y * p.y + c.z * p.z + c.w,
    r.x * p.x + r.y * p.y + r.z * p.z + r.w, w.x * p.x + w.y * p.y + w.z * p.z + w.w);
  return result;
}

// a x b, exactly -(b x a), with the rounding of the edge's length and not of the corners' coordinates.
Real3 edgeFunction(Real3 a, Real3 b)
{
  precise Real3 m = Real(0.5) * (a + b);
  precise Real3 d = b - a;
  precise Real3 result =
    Real3(m.y * d.z - m.z * d.y, m.z * d.x - m.x * d.z, m.x * d.y - m.y * d.x);
  return result;
}

// `corners` receives the pixel coordinates of the three points.
Triangle loadTriangle(uint index, out Real3 corners[3])
{
  Triangle triangle;
  for (uint corner = 0u; corner < 3u; ++corner)
  {
    const uint first = 3u * triangles[3u * index + corner];
    triangle.Points[corner] =
      Real3(positions[first], positions[first + 1u], positions[first + 2u]);
    corners[corner] = pixelCoordinates(triangle.Points[corner]);
  }
  triangle.Edges[0] = edgeFunction(corners[1], corners[2]);
  triangle.Edges[1] = edgeFunction(corners[2], corners[0]);
  triangle.Edges[2] = edgeFunction(corners[0], corners[1]);
  const uint sides = materials[index];
  triangle.Front = sides & 0xffffu;
  triangle.Back = sides >> 16u;
  return triangle;
}

Real edgeValue(Real3 edge, Real column, Real row)
{
  precise Real value = edge.x * column + edge.y * row + edge.z;
  return value;
}

// Which side of an edge a pixel lies on: 1, -1, or 0 for an edge that is seen as a point.
int side(Real value, Real3 edge)
{
  const Real decisive = value != 0 ? value : edge.x != 0 ? edge.x : edge.y;
  return decisive > 0 ? 1 : decisive < 0 ? -1 : 0;
}

// Weights whose signed sums do not vanish unless every material's count does (Weyl sequence, mixed).
uint weight(uint material)
{
  uint word = material * 2654435769u + 1013904223u;
  word = (word ^ (word >> 16u)) * 2246822519u;
  return word ^ (word >> 13u);
}

// Adds the crossing of a triangle by the ray of a pixel, if there is one, to the pixel's sums.
void addCrossing(in Triangle triangle, int columnIndex, int rowIndex)
{
  const Real column = Real(columnIndex);
  const Real row = Real(rowIndex);
  const Real3 values = Real3(edgeValue(triangle.Edges[0], column, row),
    edgeValue(triangle.Edges[1], column, row), edgeValue(triangle.Edges[2], column, row));
  const int total = side(values.x, triangle.Edges[0]) + side(values.y, triangle.Edges[1]) +
    side(values.z, triangle.Edges[2]);
  if (abs(total) != 3)
  {
    return;
  }

  const Real3 pixel = parameters.DetectorOrigin.xyz + column * parameters.ColumnStep.xyz +
    row * parameters.RowStep.xyz;
  const bool isPoint = parameters.Source.w != 0;
  const Real3 along = isPoint ? pixel - parameters.Source.xyz : parameters.Source.xyz;
  const Real3 direction = along * (1 / sqrt(dot(along, along)));

  // The edges' values are the barycentric coordinates of the hit, all of one sign: t cannot leave the
  // interval that the corners span, however steep the triangle. t is measured from the ray's point nearest to the
  // local origin.
  const Real3 t3 = Real3(dot(triangle.Points[0], direction), dot(triangle.Points[1], direction),
    dot(triangle.Points[2], direction));
  const Real whole = values.x + values.y + values.z;
  Real t = whole != 0 ? dot(values, t3) / whole : t3.x;
  // Beyond source and pixel nothing counts; hits there must still cancel.
  t = min(t, dot(pixel, direction));
  t = isPoint ? max(t, min(dot(parameters.Source.xyz, direction), dot(pixel, direction))) : t;
  t = clamp(t, -parameters.Scales.y, parameters.Scales.y);
  const uint units = uint(int(floor(t * parameters.Scales.z + Real(0.5))));

  const bool facesSource = (total > 0) == (parameters.Scales.x < 0);
  const uint left = facesSource ? triangle.Front : triangle.Back;
  const uint entered = facesSource ? triangle.Back : triangle.Front;
  const uint first =
    (uint(rowIndex) - parameters.FirstRow) * parameters.Columns + uint(columnIndex);
  const uint base = first * parameters.Materials;
  atomicAdd(sums[base], weight(entered) - weight(left));
  if (left != 0u)
  {
    atomicAdd(sums[base + left], units);
  }
  if (entered != 0u)
  {
    atomicAdd(sums[base + entered], 0u - units);
  }
}

#endif
