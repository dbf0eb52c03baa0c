// The only file that uses TetGen's types.
#include "Private/TetGen.h"

#include "mammoray/Foundation/Error.h"

#ifndef TETLIBRARY
#define TETLIBRARY
#endif
#include <tetgen.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <new>
#include <string>

namespace mammoray
{
namespace
{
/// Converts the complex to TetGen's input; TetGen frees the arrays. It merges coplanar triangles
/// with equal markers, so that needles inside a plane need not stay.
void Load(const TriangleComplex& complex, tetgenio& input, bool joinsPlanes = false)
{
  input.firstnumber = 0;
  input.numberofpoints = static_cast<int>(complex.Points.size() / 3);
  input.pointlist = new REAL[complex.Points.size()];
  std::copy(complex.Points.begin(), complex.Points.end(), input.pointlist);
  input.numberoffacets = static_cast<int>(complex.Triangles.size());
  input.facetlist = new tetgenio::facet[complex.Triangles.size()];
  input.facetmarkerlist = new int[complex.Triangles.size()];
  for (std::size_t index = 0; index < complex.Triangles.size(); ++index)
  {
    tetgenio::facet& facet = input.facetlist[index];
    tetgenio::init(&facet);
    facet.numberofpolygons = 1;
    facet.polygonlist = new tetgenio::polygon[1];
    tetgenio::polygon& polygon = facet.polygonlist[0];
    tetgenio::init(&polygon);
    polygon.numberofvertices = 3;
    polygon.vertexlist = new int[3];
    std::copy(complex.Triangles[index].begin(), complex.Triangles[index].end(), polygon.vertexlist);
    input.facetmarkerlist[index] = joinsPlanes ? 1 : static_cast<int>(index) + 1;
  }
}

void Run(const std::string& switches, tetgenio& input, tetgenio& output)
{
  tetgenbehavior behaviour;
  std::string text = switches;
  if (!behaviour.parse_commandline(text.data()))
  {
    throw ConvergenceError("TetGen: the switches " + switches + " were not understood");
  }
  try
  {
    tetrahedralize(&behaviour, &input, &output);
  }
  catch (const int code)
  {
    // Error codes of terminatetetgen() in tetgen.h.
    if (code == 1)
    {
      throw std::bad_alloc();
    }
    if (code == 3)
    {
      throw InputError("surfaces: expected triangles that meet at common edges, found ones that "
                       "cut each other",
        { "Surfaces", "", { "SurfaceVoxelsMm" } });
    }
    if (code == 4 || code == 5)
    {
      throw InputError(
        "surfaces: expected triangles at a distance from each other, found ones that "
        "nearly touch");
    }
    throw ConvergenceError("TetGen ended with its error " + std::to_string(code));
  }
}

/// Data for TetGen's callback, which has no user argument.
struct Watch
{
  const ProgressCallback* Progress = nullptr;
  std::size_t Calls = 0;
  double Expected = 1;
};
thread_local Watch watch;

/// TetGen asks whether a cell is too large. The answer is always no; the call is used to stop the
/// work.
bool NeverUnsuitable(REAL*, REAL*, REAL*, REAL*, REAL*, REAL)
{
  if (++watch.Calls % 16384 == 0)
  {
    ReportProgress(*watch.Progress, 0.4 + 0.5 * (1 - std::exp(-watch.Calls / watch.Expected)),
      "filling surfaces");
  }
  return false;
}

double Determinant(const REAL* points, const int* ids)
{
  Vector3 edge[3];
  for (int e = 0; e < 3; ++e)
  {
    for (int a = 0; a < 3; ++a)
    {
      edge[e][a] = points[3 * ids[e + 1] + a] - points[3 * ids[0] + a];
    }
  }
  return Dot(edge[0], Cross(edge[1], edge[2]));
}

/// Converts TetGen's output: the points that cells use, and the cells with positive orientation.
TetrahedralMesh Unload(const tetgenio& output)
{
  TetrahedralMesh mesh;
  std::vector<std::int32_t> newId(static_cast<std::size_t>(output.numberofpoints), -1);
  for (int cell = 0; cell < output.numberoftetrahedra; ++cell)
  {
    const int* ids =
      &output.tetrahedronlist[static_cast<std::ptrdiff_t>(cell) * output.numberofcorners];
    for (int corner = 0; corner < 4; ++corner)
    {
      std::int32_t& id = newId[static_cast<std::size_t>(ids[corner])];
      if (id < 0)
      {
        id = static_cast<std::int32_t>(mesh.NumberOfPoints());
        const REAL* at = &output.pointlist[3 * static_cast<std::ptrdiff_t>(ids[corner])];
        mesh.Points.insert(mesh.Points.end(), at, at + 3);
      }
      mesh.Cells.push_back(id);
    }
    if (Determinant(output.pointlist, ids) < 0)
    {
      std::swap(mesh.Cells[mesh.Cells.size() - 1], mesh.Cells[mesh.Cells.size() - 2]);
    }
    mesh.Materials.push_back(static_cast<std::int32_t>(
      std::lround(output.tetrahedronattributelist[static_cast<std::ptrdiff_t>(cell) *
        output.numberoftetrahedronattributes])));
  }
  return mesh;
}
}

std::vector<TetGenRegion> FindRegions(const TriangleComplex& complex)
{
  tetgenio input;
  tetgenio output;
  Load(complex, input);
  Run("pAQ", input, output);
  struct Largest
  {
    double Volume = 0;
    int Cell = -1;
    double Sum = 0;
  };
  std::map<long, Largest> largest;
  for (int cell = 0; cell < output.numberoftetrahedra; ++cell)
  {
    const double volume = std::abs(Determinant(output.pointlist,
      &output.tetrahedronlist[static_cast<std::ptrdiff_t>(cell) * output.numberofcorners]));
    Largest& entry =
      largest[std::lround(output.tetrahedronattributelist[static_cast<std::ptrdiff_t>(cell) *
        output.numberoftetrahedronattributes])];
    entry.Sum += volume / 6;
    if (volume > entry.Volume)
    {
      entry.Volume = volume;
      entry.Cell = cell;
    }
  }
  std::vector<TetGenRegion> regions;
  for (const auto& [number, entry] : largest)
  {
    if (entry.Cell < 0)
    {
      continue;
    }
    TetGenRegion region;
    region.VolumeMm3 = entry.Sum;
    for (int corner = 0; corner < 4; ++corner)
    {
      const int id =
        output.tetrahedronlist[static_cast<std::ptrdiff_t>(entry.Cell) * output.numberofcorners +
          corner];
      for (int a = 0; a < 3; ++a)
      {
        region.Inside[a] += 0.25 * output.pointlist[3 * static_cast<std::ptrdiff_t>(id) + a];
      }
    }
    regions.push_back(region);
  }
  return regions;
}

TetrahedralMesh FillRegions(const TriangleComplex& complex,
  const std::vector<TetGenRegion>& regions, const TetGenQuality& quality,
  const ProgressCallback& progress)
{
  tetgenio input;
  tetgenio output;
  Load(complex, input, quality.DividesTriangles);
  std::vector<double> holes;
  std::vector<double> seeds;
  for (const TetGenRegion& region : regions)
  {
    const bool isHole = region.Material == 0 && !quality.KeepsAir;
    auto& list = isHole ? holes : seeds;
    list.insert(list.end(), region.Inside.begin(), region.Inside.end());
    if (!isHole)
    {
      const double noBound = -1;
      seeds.insert(seeds.end(),
        { static_cast<double>(region.Material),
          region.Material == 0 ? noBound : region.CellVolumeMm3 });
    }
  }
  input.numberofholes = static_cast<int>(holes.size() / 3);
  input.holelist = new REAL[holes.size()];
  std::copy(holes.begin(), holes.end(), input.holelist);
  input.numberofregions = static_cast<int>(seeds.size() / 5);
  input.regionlist = new REAL[seeds.size()];
  std::copy(seeds.begin(), seeds.end(), input.regionlist);
  input.tetunsuitable = NeverUnsuitable;
  watch = { &progress, 0, 10.0 * static_cast<double>(complex.Triangles.size()) };
  char switches[64];
  std::snprintf(switches, sizeof(switches), "p%sq%.6g/%.6gAaQ", quality.DividesTriangles ? "" : "Y",
    quality.Ratio > 0 ? quality.Ratio : 1e6, quality.DihedralDeg);
  Run(switches, input, output);
  return Unload(output);
}
}
