#version 460
// SPDX-License-Identifier: Apache-2.0
// One invocation per triangle. One that covers few pixels is done here; the tiles of a larger one go to a
// list for rasterTiles.comp. Where rays are traced again, so do those of all triangles that they may cross.
#extension GL_GOOGLE_include_directive : require
#include "raster.glsl"

// Least and largest value of an edge function in a tile.
void edgeRange(Real3 edge, Real column, Real row, out Real low, out Real high)
{
  const Real last = Real(MAMMORAY_RASTER_TILE - 1);
  const Real value = edgeValue(edge, column, row);
  low = value + min(edge.x, Real(0)) * last + min(edge.y, Real(0)) * last;
  high = value + max(edge.x, Real(0)) * last + max(edge.y, Real(0)) * last;
}

// First the cheap search, up to 32 pixels in a row, then the work where there is a crossing: invocations that
// run together wait for the one with most crossings, not for the one with most pixels.
void addCrossings(uint triangleIndex, inout Triangle triangle, uvec2 low, uvec2 extent)
{
  bool hasSpeeds = !WithRates;
  const uint count = extent.x * extent.y;
  // index * inverse >> 16 is index / extent.x for boxes of so few pixels: CPUs divide one by one.
  const uint inverse = 65535u / extent.x + 1u;
  for (uint first = 0u; first < count; first += 32u)
  {
    uint crossed = 0u;
    for (uint index = first; index < min(first + 32u, count); ++index)
    {
      const uint row = index * inverse >> 16u;
      if (crossing(triangle, Real(low.x + index - row * extent.x), Real(low.y + row)) != 0)
      {
        crossed |= 1u << (index - first);
      }
    }
    if (crossed != 0u && !hasSpeeds)
    {
      loadSpeeds(triangleIndex, triangle);
      hasSpeeds = true;
    }
    while (crossed != 0u)
    {
      const uint index = first + uint(findLSB(crossed));
      crossed &= crossed - 1u;
      const uint row = index * inverse >> 16u;
      addCrossing(triangle, low.x + index - row * extent.x, low.y + row);
    }
  }
}

bool anyTraced(ivec2 low, ivec2 high)
{
  for (int row = low.y; row <= high.y; ++row)
  {
    for (int column = low.x; column <= high.x; ++column)
    {
      if (isTraced(uint(column), uint(row)))
      {
        return true;
      }
    }
  }
  return false;
}

void main()
{
  const uint index = gl_GlobalInvocationID.y * gl_NumWorkGroups.x * MAMMORAY_RASTER_GROUP +
    gl_GlobalInvocationID.x;
  if (index >= parameters.Triangles)
  {
    return;
  }
  Real3 corners[3];
  Triangle triangle = loadTriangle(index, corners);

  const Real drift = parameters.Again == 0u
    ? Real(0)
    : Real(MAMMORAY_RASTER_DRIFT) * Real(parameters.Samples);

  // Pixels that may be covered. A triangle through the source's plane may cover any.
  Real left = Real(parameters.Left);
  Real right = Real(parameters.Right);
  Real top = Real(parameters.Top);
  Real bottom = Real(parameters.Bottom);
  const Real leastWeight = min(corners[0].z, min(corners[1].z, corners[2].z));
  const Real mostWeight = max(corners[0].z, max(corners[1].z, corners[2].z));
  const Real limit = Real(1e-3);
  if (leastWeight > limit || mostWeight < -limit)
  {
    const Real3 inverse = 1 / Real3(corners[0].z, corners[1].z, corners[2].z);
    const Real3 columns = inverse * Real3(corners[0].x, corners[1].x, corners[2].x);
    const Real3 rows = inverse * Real3(corners[0].y, corners[1].y, corners[2].y);
    // The nearer to the source's plane, the more rounding is magnified.
    const Real room = drift + parameters.Scales.w *
      (1 + 1 / min(abs(leastWeight), abs(mostWeight)));
    left = max(left, ceil(min(columns.x, min(columns.y, columns.z)) - room));
    right = min(right, floor(max(columns.x, max(columns.y, columns.z)) + room));
    top = max(top, ceil(min(rows.x, min(rows.y, rows.z)) - room));
    bottom = min(bottom, floor(max(rows.x, max(rows.y, rows.z)) + room));
  }
  if (left > right || top > bottom)
  {
    return;
  }
  const ivec2 low = ivec2(int(left), int(top));
  const ivec2 high = ivec2(int(right), int(bottom));
  const ivec2 extent = high - low + 1;

  if (extent.x <= MAMMORAY_RASTER_SMALL && extent.y <= MAMMORAY_RASTER_SMALL &&
    extent.x * extent.y <= MAMMORAY_RASTER_SMALL)
  {
    if (parameters.Again == 0u)
    {
      addCrossings(index, triangle, uvec2(low), uvec2(extent));
      if (Reverse && triangle.Gradient != Real3(0))
      {
        storeGradient(index, triangle);
      }
      return;
    }
    if (!anyTraced(low, high))
    {
      return;
    }
  }

  const ivec2 firstTile = low / MAMMORAY_RASTER_TILE;
  const ivec2 lastTile = high / MAMMORAY_RASTER_TILE;
  // A tile is left out only where all its pixels lie clearly outside of one edge, for either orientation.
  Real3 slack;
  for (int edge = 0; edge < 3; ++edge)
  {
    const Real3 factors = abs(triangle.Edges[edge]);
    slack[edge] = Real(MAMMORAY_RASTER_SLACK) * dot(factors, Real3(right, bottom, 1)) +
      drift * (factors.x + factors.y);
  }
  for (int tileRow = firstTile.y; tileRow <= lastTile.y; ++tileRow)
  {
    for (int tileColumn = firstTile.x; tileColumn <= lastTile.x; ++tileColumn)
    {
      const Real column = Real(tileColumn * MAMMORAY_RASTER_TILE);
      const Real row = Real(tileRow * MAMMORAY_RASTER_TILE);
      bool mayBePositive = true;
      bool mayBeNegative = true;
      for (int edge = 0; edge < 3; ++edge)
      {
        Real least;
        Real most;
        edgeRange(triangle.Edges[edge], column, row, least, most);
        mayBePositive = mayBePositive && most >= -slack[edge];
        mayBeNegative = mayBeNegative && least <= slack[edge];
      }
      if (mayBePositive || mayBeNegative)
      {
        const uint entry = atomicAdd(tiles[0], 1u);
        if (entry < parameters.TileCapacity)
        {
          tiles[2u * entry + 2u] = index;
          tiles[2u * entry + 3u] = uint(tileColumn) | uint(tileRow) << 16u;
        }
      }
    }
  }
}
