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
// only the total has to fit. They come in pairs, which devices with 64-bit atomics add at once: the lower number
// may carry into the upper, which is undone when the pair is read.
#ifndef raster_glsl
#define raster_glsl

// Rounding of an edge function, relative to the sum of its terms, with room to spare.
#ifdef MAMMORAY_DOUBLE
#extension GL_EXT_shader_explicit_arithmetic_types_float64 : require
#define MAMMORAY_RASTER_SLACK 1e-14
#else
#define MAMMORAY_RASTER_SLACK 1e-6
#endif
#ifdef MAMMORAY_INT64
#extension GL_EXT_shader_explicit_arithmetic_types_int64 : require
#extension GL_EXT_shader_atomic_int64 : require
#endif
#extension GL_EXT_control_flow_attributes : require
#include "Grazing.h"
#include "RasterParameters.h"
#define MAMMORAY_GRADIENT_BINDING MAMMORAY_RASTER_RATES
#include "gradient.glsl"

// Whether derivatives are summed.
layout(constant_id = 0) const bool WithRates = false;
// Whether the sums are those of the rays already, and the loss's gradient is added up (reverse mode).
layout(constant_id = 1) const bool Reverse = false;

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
// [(pixel of the rows in work * (Materials - 1) + material - 1) * pairsPerMaterial() + pair]
layout(set = 0, binding = MAMMORAY_RASTER_SUMS, std430) buffer SumBuffer
{
#ifdef MAMMORAY_INT64
  uint64_t sums[];
#else
  uvec2 sums[];
#endif
};
// Count, unused, then triangle and tile (column in the lower, row in the upper 16 bits) of each entry.
layout(set = 0, binding = MAMMORAY_RASTER_TILES, std430) buffer TileBuffer
{
  uint tiles[];
};

// value[(point * parameters.Fields + field) * 3 + axis], in units of MAMMORAY_RASTER_RATE_UNITS.
layout(set = 0, binding = MAMMORAY_RASTER_VELOCITIES, std430) readonly buffer VelocityBuffer
{
  float velocities[];
};

// In reverse mode, derivatives of the loss with respect to the length of a pixel, in units of the gradient's
// sums; [material * PixelCount + pixel].
layout(set = 0, binding = MAMMORAY_RASTER_VELOCITIES, std430) readonly buffer LossBuffer
{
  float losses[];
};

// Number of samples per pixel whose crossings do not cancel; then the number of pixels in work that have any.
layout(set = 0, binding = MAMMORAY_RASTER_FAILURES, std430) buffer FailureBuffer
{
  uint failures[];
};

// Pairs per material: its length and its count of crossings, then the rates of two fields each.
uint pairsPerMaterial()
{
  return WithRates ? 1u + (parameters.Fields + 1u) / 2u : 1u;
}

// For pixels of the rows in work: the last attempt with their rays, 0 for the first one.
layout(set = 0, binding = MAMMORAY_RASTER_MARKS, std430) buffer MarkBuffer
{
  uint marks[];
};

struct Triangle
{
  // Of the corners, as parameters.DepthOf measures it.
  Real3 Depths;
  // With derivatives only: the unit normal, 0 where the triangle has no area, and how fast the corners move
  // along it, by field (loadSpeeds). In reverse mode, the gradient with respect to the corners along it.
  vec3 Normal;
  Real3 Gradient;
  vec3 Speeds[MAMMORAY_RASTER_FIELDS];
  // Edge functions: their factors of column, row and 1. Edge i lies opposite of point i.
  Real3 Edges[3];
  uint Front;
  uint Back;
};
void addPair(uint index, int low, int high)
{
#ifdef MAMMORAY_INT64
  atomicAdd(sums[index], packUint2x32(uvec2(uint(low), uint(high + (low >> 31)))));
#else
  atomicAdd(sums[index].x, uint(low));
  atomicAdd(sums[index].y, uint(high));
#endif
}

ivec2 loadPair(uint index)
{
#ifdef MAMMORAY_INT64
  const ivec2 pair = ivec2(unpackUint2x32(sums[index]));
  return ivec2(pair.x, pair.y - (pair.x >> 31));
#else
  return ivec2(sums[index]);
#endif
}

// Negative lengths come from a surface whose labels are inside out; the tolerance is far above the rounding of
// hits that cancel.
bool isSound(uint base)
{
  bool sound = true;
  for (uint material = 1u; material < parameters.Materials; ++material)
  {
    const ivec2 pair = loadPair(base + (material - 1u) * pairsPerMaterial());
    sound = sound && pair.y == 0 && float(pair.x) > float(parameters.DetectorOrigin.w);
  }
  return sound;
}

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
  Real3 points[3];
  for (uint corner = 0u; corner < 3u; ++corner)
  {
    const uint first = 3u * triangles[3u * index + corner];
    points[corner] = Real3(positions[first], positions[first + 1u], positions[first + 2u]);
    triangle.Depths[corner] = dot(parameters.DepthOf.xyz, points[corner]);
    corners[corner] = pixelCoordinates(points[corner]);
  }
  triangle.Edges[0] = edgeFunction(corners[1], corners[2]);
  triangle.Edges[1] = edgeFunction(corners[2], corners[0]);
  triangle.Edges[2] = edgeFunction(corners[0], corners[1]);
  const uint sides = materials[index];
  triangle.Front = sides & 0xffffu;
  triangle.Back = sides >> 16u;
  if (WithRates || Reverse)
  {
    triangle.Gradient = Real3(0);
    const Real3 normal = cross(points[1] - points[0], points[2] - points[0]);
    const Real size = sqrt(dot(normal, normal));
    triangle.Normal = size > 0 ? vec3(normal / size) : vec3(0);
  }
  return triangle;
}

Real edgeValue(Real3 edge, Real column, Real row)
{
  precise Real value = edge.x * column + edge.y * row + edge.z;
  return value;
}

Real3 edgeValues(in Triangle triangle, Real column, Real row)
{
  return Real3(edgeValue(triangle.Edges[0], column, row), edgeValue(triangle.Edges[1], column, row),
    edgeValue(triangle.Edges[2], column, row));
}

// An edge's value, or what has its sign an infinitesimal step beside; 0 for an edge that is seen as a point.
Real decisive(Real value, Real3 edge)
{
  return value != 0 ? value : edge.x != 0 ? edge.x : edge.y;
}

// 1 or -1, the orientation of the triangle, where the ray of a pixel crosses it, else 0.
int crossing(in Triangle triangle, Real column, Real row)
{
  const Real3 values = edgeValues(triangle, column, row);
  const Real3 sides = Real3(decisive(values.x, triangle.Edges[0]),
    decisive(values.y, triangle.Edges[1]), decisive(values.z, triangle.Edges[2]));
  return min(sides.x, min(sides.y, sides.z)) > 0 ? 1
                                                 : max(sides.x, max(sides.y, sides.z)) < 0 ? -1 : 0;
}

// Once for all crossings of a triangle: on CPUs each number is fetched by itself.
void loadSpeeds(uint index, inout Triangle triangle)
{
  for (uint corner = 0u; corner < 3u; ++corner)
  {
    const uint first = 3u * parameters.Fields * triangles[3u * index + corner];
    [[unroll]] for (uint field = 0u; field < MAMMORAY_RASTER_FIELDS; ++field)
    {
      if (field < parameters.Fields)
      {
        const uint place = first + 3u * field;
        triangle.Speeds[field][corner] = dot(triangle.Normal,
          vec3(velocities[place], velocities[place + 1u], velocities[place + 2u]));
      }
    }
  }
}

// To the nearest; for absolute values below 2^31.
int roundToInt(Real value)
{
#ifdef MAMMORAY_DOUBLE
  // At 1.5 x 2^52 a double's last bit is worth 1; on CPUs faster than a conversion, which is done one by one.
  precise double shifted = value + 6755399441055744.0;
  return int(unpackDouble2x32(shifted).x);
#else
  return int(floor(value + 0.5));
#endif
}

// Whether the ray of a pixel of the rows in work is traced: in this attempt, in reverse mode in no later one.
bool isTraced(uint column, uint row)
{
  return (parameters.Again == 0u && !(Reverse && parameters.Fields != 0u)) ||
    marks[(row - parameters.FirstRow) * parameters.Columns + column] == parameters.Again;
}

// From the source to the pixel, mm; of a parallel beam a unit vector: the ray's length per depth.
Real3 rayOf(uint column, uint row)
{
  const Real3 pixel = parameters.DetectorOrigin.xyz + Real(column) * parameters.ColumnStep.xyz +
    Real(row) * parameters.RowStep.xyz;
  return parameters.Source.w != 0 ? pixel - parameters.Source.xyz : parameters.Source.xyz;
}

// What a velocity of the corners along the normal, times these factors, adds to the length that the ray leaves:
// dt/dp = n . v / (n . d), v being the velocity where the ray hits.
vec3 rateFactors(
  in Triangle triangle, Real3 values, bool facesSource, uint columnIndex, uint rowIndex)
{
  const Real whole = values.x + values.y + values.z;
  const vec3 weights = whole != 0 ? vec3(values / whole) : vec3(1, 0, 0);
  const Real3 along = rayOf(columnIndex, rowIndex);
  const vec3 direction = vec3(along * (1 / sqrt(dot(along, along))));
  const float cosine = max(abs(dot(triangle.Normal, direction)), MAMMORAY_GRAZING_COSINE);
  return (facesSource ? -1.0 : 1.0) / cosine * weights;
}

// In reverse mode: adds a crossing of a ray that can be trusted to the gradient with respect to the corners.
void addToGradient(inout Triangle triangle, Real3 values, bool facesSource, uint left, uint entered,
  uint columnIndex, uint rowIndex)
{
  const uint samples = parameters.Samples;
  const uint pixel = samples == 1u
    ? rowIndex * parameters.PixelColumns + columnIndex
    : rowIndex / samples * parameters.PixelColumns + columnIndex / samples;
  const float loss = (left != 0u ? losses[left * parameters.PixelCount + pixel] : 0.0) -
    (entered != 0u ? losses[entered * parameters.PixelCount + pixel] : 0.0);
  if (loss == 0 || !isTraced(columnIndex, rowIndex))
  {
    return;
  }
  const uint failed = failures[pixel];
  const uint place = (rowIndex - parameters.FirstRow) * parameters.Columns + columnIndex;
  if (failed == 0u || isSound(place * (parameters.Materials - 1u)))
  {
    const vec3 factors = rateFactors(triangle, values, facesSource, columnIndex, rowIndex);
    triangle.Gradient += Real(loss / float(samples * samples - failed)) * Real3(factors);
  }
}

// Adds the triangle's gradient to that of its points, once for all of its crossings.
void storeGradient(uint index, in Triangle triangle)
{
  for (uint corner = 0u; corner < 3u; ++corner)
  {
    const uint first = 3u * triangles[3u * index + corner];
    for (uint axis = 0u; axis < 3u; ++axis)
    {
      addGradient(first + axis, triangle.Gradient[corner] * Real(triangle.Normal[axis]));
    }
  }
}

// Adds the crossing of a triangle by the ray of a pixel to the pixel's sums; there must be one.
void addCrossing(inout Triangle triangle, uint columnIndex, uint rowIndex)
{
  const Real column = Real(columnIndex);
  const Real row = Real(rowIndex);
  const Real3 values = edgeValues(triangle, column, row);
  const uint place = (rowIndex - parameters.FirstRow) * parameters.Columns + columnIndex;

  // The edges' values are the barycentric coordinates of the hit, all of one sign: its depth cannot leave the
  // interval that the corners span, however steep the triangle.
  const Real whole = values.x + values.y + values.z;
  const Real free = whole != 0 ? dot(values, triangle.Depths) / whole : triangle.Depths.x;
  // Beyond source and pixel nothing counts; hits there must still cancel.
  const Real depth = clamp(free, parameters.Scales.y, parameters.Scales.z);
  const bool isFree = depth == free;

  const bool isPositive = decisive(values.x, triangle.Edges[0]) > 0;
  const bool facesSource = isPositive == (parameters.Scales.x < 0);
  const uint left = facesSource ? triangle.Front : triangle.Back;
  const uint entered = facesSource ? triangle.Back : triangle.Front;
  if (Reverse)
  {
    if (isFree)
    {
      addToGradient(triangle, values, facesSource, left, entered, columnIndex, rowIndex);
    }
    return;
  }
  const int units = roundToInt(depth * parameters.DepthOf.w);
  const uint first = place * (parameters.Materials - 1u);
  const uint leftSums = (first + left - 1u) * pairsPerMaterial();
  const uint enteredSums = (first + entered - 1u) * pairsPerMaterial();
  if (left != 0u)
  {
    addPair(leftSums, units, 1);
  }
  if (entered != 0u)
  {
    addPair(enteredSums, -units, -1);
  }
  if (!WithRates || !isFree)
  {
    return;
  }

  const vec3 factors = rateFactors(triangle, values, facesSource, columnIndex, rowIndex);
  [[unroll]] for (uint field = 0u; field < MAMMORAY_RASTER_FIELDS; field += 2u)
  {
    if (field < parameters.Fields)
    {
      const int low = int(roundEven(dot(factors, triangle.Speeds[field])));
      const int high = field + 1u < parameters.Fields
        ? int(roundEven(dot(factors, triangle.Speeds[field + 1u])))
        : 0;
      if (left != 0u)
      {
        addPair(leftSums + 1u + field / 2u, low, high);
      }
      if (entered != 0u)
      {
        addPair(enteredSums + 1u + field / 2u, -low, -high);
      }
    }
  }
}

#endif
