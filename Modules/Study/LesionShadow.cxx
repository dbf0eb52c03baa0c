// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Study/LesionShadow.h"

#include "mammoray/Dicom/DicomReader.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Study/ContourLines.h"
#include "mammoray/XRay/LabelSurface.h"

#include <algorithm>
#include <cstdio>
#include <iterator>
#include <map>
#include <utility>

namespace mammoray
{
namespace
{
/// They take the stairs off a lesion's voxel surface.
constexpr int SmoothingSteps = 5;

/// The voxels of one label as material 1.
LabelVolume OnlyLabel(const LabelVolume& labels, int label)
{
  LabelVolume only = labels;
  for (std::uint16_t& voxel : only.Voxels)
  {
    voxel = voxel == label ? 1 : 0;
  }
  return only;
}

/// Moves a surface's points with the tissue, and answers the share of them that lie outside the
/// breast.
double CompressSurface(const RegisteredBreast& breast, SurfaceMesh& surface)
{
  std::size_t outside = 0;
  for (std::size_t id = 0; id < surface.NumberOfPoints(); ++id)
  {
    const CarriedPoint carried = breast.Carry(
      { surface.Points[3 * id], surface.Points[3 * id + 1], surface.Points[3 * id + 2] });
    outside += carried.Outside ? 1 : 0;
    for (int axis = 0; axis < 3; ++axis)
    {
      surface.Points[3 * id + axis] += carried.Displacement[axis];
    }
  }
  return static_cast<double>(outside) / static_cast<double>(surface.NumberOfPoints());
}
}

std::vector<Lesion> FindLesions(const LabelVolume& volume)
{
  std::map<int, std::pair<double, Vector3>> sums;
  volume.ForEachVoxel(
    [&](int i, int j, int k, std::size_t voxel)
    {
      if (volume.Voxels[voxel] != 0)
      {
        auto& [count, places] = sums[volume.Voxels[voxel]];
        count += 1;
        places = places + volume.PointAt(i, j, k);
      }
    });
  std::vector<Lesion> lesions;
  lesions.reserve(sums.size());
  for (const auto& [label, sum] : sums)
  {
    const auto& [count, places] = sum;
    lesions.push_back({ label, count * volume.VoxelVolume(), (1 / count) * places });
  }
  return lesions;
}

LabelVolume ReadLesions(const std::string& path, VolumeAxes axes)
{
  LabelVolume volume = ReadLabelVolume(path, axes);
  if (std::all_of(volume.Voxels.begin(), volume.Voxels.end(),
        [](std::uint16_t label) { return label == 0; }))
  {
    throw InputError(path + ": expected voxels that are not 0, found none");
  }
  return volume;
}

LesionShadow ProjectLesion(const RegisteredBreast& breast, const LabelVolume& lesions, int label,
  PathLengthProjector& projector)
{
  const LabelVolume lesion = OnlyLabel(lesions, label);
  const std::vector<Lesion> found = FindLesions(lesion);
  if (found.empty())
  {
    throw InputError("lesion: expected voxels of label " + std::to_string(label) + ", found none");
  }
  LesionShadow imaged;
  imaged.VolumeMm3 = found.front().VolumeMm3;
  imaged.Centre = found.front().Centre;
  const QuadMesh quads = ExtractInterfaces(lesion, SmoothingSteps);
  SurfaceMesh surface = quads.Triangulate(2 * quads.Quads.size());
  imaged.ShareOutside = CompressSurface(breast, surface);
  if (imaged.ShareOutside > LargestShareOutside)
  {
    char text[200];
    std::snprintf(text, sizeof text,
      "lesion: expected label %d in the breast, found %.0f %% of its surface outside; is it in the "
      "frame of the registered volume?",
      label, 100 * imaged.ShareOutside);
    throw InputError(text);
  }
  imaged.ImagedCentre = breast.ToMammogram(imaged.Centre);
  projector.SetSurface(surface);
  const XRayDetector detector = breast.Detector();
  const PathLengthImage lengths = projector.Project(breast.Source(), detector);
  const float* lesionMm = lengths.Material(1);
  std::transform(lesionMm, lesionMm + lengths.NumberOfPixels(), std::back_inserter(imaged.Shadow),
    [](float length) { return static_cast<unsigned char>(length > 0); });
  imaged.AreaMm2 = static_cast<double>(std::count(imaged.Shadow.begin(), imaged.Shadow.end(), 1)) *
    Norm(Cross(detector.ColumnStep, detector.RowStep));
  imaged.LargestThicknessMm = *std::max_element(lesionMm, lesionMm + lengths.NumberOfPixels());
  const std::vector<float> inside(imaged.Shadow.begin(), imaged.Shadow.end());
  imaged.Outlines = ContourLines(inside.data(), detector.Columns, detector.Rows, 0.5F, 0.0F);
  return imaged;
}
}
