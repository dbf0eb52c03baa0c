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
    const uint index = tiles[2u * entry + 2u];
    Triangle triangle = loadTriangle(index, corners);
    const uint tile = tiles[2u * entry + 3u];
    const uint column = (tile & 0xffffu) * MAMMORAY_RASTER_TILE + lane;
    const uint tileRow = (tile >> 16u) * MAMMORAY_RASTER_TILE;
    const uint firstRow = max(tileRow, parameters.FirstRow);
    const uint endRow =
      min(tileRow + MAMMORAY_RASTER_TILE, parameters.FirstRow + parameters.RowCount);
    if (column < parameters.Columns)
    {
      uint crossed = 0u;
      for (uint row = firstRow; row < endRow; ++row)
      {
        if (isTraced(column, row) && crossing(triangle, Real(column), Real(row)) != 0)
        {
          crossed |= 1u << (row - firstRow);
        }
      }
      if (WithRates && crossed != 0u)
      {
        loadSpeeds(index, triangle);
      }
      while (crossed != 0u)
      {
        addCrossing(triangle, column, firstRow + uint(findLSB(crossed)));
        crossed &= crossed - 1u;
      }
      if (Reverse && triangle.Gradient != Real3(0))
      {
        storeGradient(index, triangle);
      }
    }
  }
}
