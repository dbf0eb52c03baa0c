#version 460
// SPDX-License-Identifier: Apache-2.0
// The tiles of larger triangles: neighbouring invocations take the columns of one tile.
#extension GL_GOOGLE_include_directive : require
#include "raster.glsl"

void main()
{
  const uint lane = gl_GlobalInvocationID.x % MAMMORAY_RASTER_TILE;
  const uint step = gl_NumWorkGroups.x * MAMMORAY_RASTER_GROUP / MAMMORAY_RASTER_TILE;
  const uint count = min(tiles[0], parameters.TileCapacity);
  for (uint entry = gl_GlobalInvocationID.x / MAMMORAY_RASTER_TILE; entry < count; entry += step)
  {
    Real3 corners[3];
    const Triangle triangle = loadTriangle(tiles[2u * entry + 2u], corners);
    const uint tile = tiles[2u * entry + 3u];
    const uint column = (tile & 0xffffu) * MAMMORAY_RASTER_TILE + lane;
    const uint tileRow = (tile >> 16u) * MAMMORAY_RASTER_TILE;
    const uint firstRow = max(tileRow, parameters.FirstRow);
    const uint endRow =
      min(tileRow + MAMMORAY_RASTER_TILE, parameters.FirstRow + parameters.RowCount);
    if (column < parameters.Columns)
    {
      for (uint row = firstRow; row < endRow; ++row)
      {
        addCrossing(triangle, int(column), int(row));
      }
    }
  }
}
