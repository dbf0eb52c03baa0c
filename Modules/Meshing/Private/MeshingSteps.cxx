// SPDX-License-Identifier: Apache-2.0
#include "Private/MeshingSteps.h"

#include "Private/EditableMesh.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/LabelEditing.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace mammoray
{
LabelVolume PrepareVolume(const LabelVolume& materials, int margin)
{
  const LabelVolume tissue = CropToTissue(materials, 0);
  LabelVolume padded;
  static_cast<VolumeGrid&>(padded) = tissue;
  for (int a = 0; a < 3; ++a)
  {
    padded.Size[a] += 2 * margin;
  }
  padded.Origin = tissue.PointAt(-margin, -margin, -margin);
  padded.Voxels.assign(static_cast<std::size_t>(padded.Size[0]) * padded.Size[1] * padded.Size[2],
    0);
  for (int k = 0; k < tissue.Size[2]; ++k)
  {
    for (int j = 0; j < tissue.Size[1]; ++j)
    {
      std::copy_n(&tissue.Voxels[tissue.Index(0, j, k)], tissue.Size[0],
        &padded.Voxels[padded.Index(margin, j + margin, k + margin)]);
    }
  }
  return padded;
}

std::size_t MergeTissue(LabelVolume& volume, double smallestMm3)
{
  const std::size_t merged = MergeSmallComponents(volume, smallestMm3);
  if (std::all_of(volume.Voxels.begin(), volume.Voxels.end(), [](int m) { return m == 0; }))
  {
    throw InputError(
      FormattedText("volume to mesh: expected a component of at least %g mm3, found smaller "
                    "ones only",
        smallestMm3));
  }
  return merged;
}

void CheckComponents(const TetrahedralMesh& mesh, const LabelVolume& volume,
  const LabelComponents& found)
{
  const auto& components = found.Components;
  std::vector<char> present(components.size(), 0);
  for (std::size_t cell = 0; cell < mesh.NumberOfCells(); ++cell)
  {
    // Sample the centre, and points towards the corners for cells that extend beyond a small
    // component.
    Vector3 centre{ 0, 0, 0 };
    for (int corner = 0; corner < 4; ++corner)
    {
      centre = centre + 0.25 * mesh.Point(mesh.Cells[4 * cell + corner]);
    }
    for (int sample = 0; sample < 5; ++sample)
    {
      const Vector3 point =
        sample == 4 ? centre : 0.5 * (centre + mesh.Point(mesh.Cells[4 * cell + sample]));
      int index[3];
      bool inside = true;
      for (int a = 0; a < 3; ++a)
      {
        index[a] = static_cast<int>(std::floor(point[a] / volume.Spacing[a] + 0.5));
        inside = inside && index[a] >= 0 && index[a] < volume.Size[a];
      }
      if (inside)
      {
        const std::uint32_t id = found.OfVoxel[volume.Index(index[0], index[1], index[2])];
        present[id] = present[id] || components[id].Material == mesh.Materials[cell];
      }
    }
  }
  for (std::size_t id = 0; id < components.size(); ++id)
  {
    const LabelComponent& lost = components[id];
    if (lost.Material != 0 && !present[id])
    {
      const Vector3 place = volume.PointAt(lost.Deepest[0], lost.Deepest[1], lost.Deepest[2]);
      throw ConvergenceError("mesh: material " + std::to_string(lost.Material) +
        FormattedText(": the component at (%.1f, %.1f, %.1f) mm", place[0], place[1], place[2]) +
        FormattedText(
          " of %.3g mm3 is not in the mesh; expected facets finer than its thickness of about "
          "%.2g mm, or a larger smallest component",
          static_cast<double>(lost.Voxels) * volume.VoxelVolume(), 2 * lost.DepthMm));
    }
  }
}

MeshCheck CheckClosed(const SurfaceMesh& surfaces)
{
  MeshCheck check = CheckSurface(surfaces);
  for (const auto kind : { MeshDefect::Kind::DoubledTriangles, MeshDefect::Kind::TurnedTriangles,
         MeshDefect::Kind::OpenSeams, MeshDefect::Kind::Holes })
  {
    if (const MeshDefect* defect = check.Find(kind))
    {
      throw InputError("surfaces: expected closed ones, found " + defect->Text({}));
    }
  }
  return check;
}

double LargestShift(const LabelVolume& materials, const MeshingOptions& options)
{
  double distanceMm = options.FacetDistanceMm;
  for (const auto& [material, own] : options.FacetDistanceOfMaterialMm)
  {
    distanceMm = std::min(distanceMm, own);
  }
  const Vector3& spacing = materials.Spacing;
  return 0.5 * std::max(distanceMm, std::min({ spacing[0], spacing[1], spacing[2] }));
}

void FinishMesh(const LabelVolume& materials, const MeshingOptions& options, TetrahedralMesh& mesh,
  const ProgressCallback& progress)
{
  const double shiftMm = LargestShift(materials, options);
  std::map<std::int32_t, double> volumesMm3;
  for (const auto& [material, count] : materials.CountLabels())
  {
    if (material != 0)
    {
      volumesMm3[material] = static_cast<double>(count) * materials.VoxelVolume();
    }
  }
  EditableMesh edited(mesh);
  const double goalDeg = options.SmallestDihedralDeg;
  ImproveCells(edited, goalDeg, shiftMm, ShareOf(progress, 0.0, 0.4));
  RepairPinches(edited, ShareOf(progress, 0.4, 0.6));
  ImproveCells(edited, goalDeg, shiftMm, ShareOf(progress, 0.6, 0.7));
  FitVolumes(edited, volumesMm3, shiftMm, goalDeg, ShareOf(progress, 0.7, 0.9));
  ImproveCells(edited, goalDeg, 0, ShareOf(progress, 0.9, 1.0));
  mesh = edited.Finish();
}

void PlaceInVolumeFrame(const LabelVolume& volume, TetrahedralMesh& mesh)
{
  for (std::size_t point = 0; point < mesh.NumberOfPoints(); ++point)
  {
    const Vector3 at = mesh.Point(point);
    const Vector3 placed = volume.PointAt(at[0] / volume.Spacing[0], at[1] / volume.Spacing[1],
      at[2] / volume.Spacing[2]);
    std::copy(placed.begin(), placed.end(), &mesh.Points[3 * point]);
  }
  if (Dot(volume.Direction[0], Cross(volume.Direction[1], volume.Direction[2])) < 0)
  {
    for (std::size_t cell = 0; cell < mesh.NumberOfCells(); ++cell)
    {
      std::swap(mesh.Cells[4 * cell + 2], mesh.Cells[4 * cell + 3]);
    }
  }
}

double SmallestDihedralDeg(const TetrahedralMesh& mesh, std::size_t cell)
{
  Vector3 corner[4];
  for (int c = 0; c < 4; ++c)
  {
    corner[c] = mesh.Point(mesh.Cells[4 * cell + c]);
  }
  double smallest = std::numbers::pi;
  for (int a = 0; a < 4; ++a)
  {
    for (int b = a + 1; b < 4; ++b)
    {
      // Project the other two corners along the edge ab; the angle between them is the dihedral
      // angle.
      const int c = a == 0 ? (b == 1 ? 2 : 1) : 0;
      const int d = 6 - a - b - c;
      const Vector3 edge = corner[b] - corner[a];
      const Vector3 n1 = Cross(edge, corner[c] - corner[a]);
      const Vector3 n2 = Cross(edge, corner[d] - corner[a]);
      smallest = std::min(smallest, std::atan2(Norm(Cross(n1, n2)), Dot(n1, n2)));
    }
  }
  return smallest * 180.0 / std::numbers::pi;
}

double RadiusEdgeRatio(const TetrahedralMesh& mesh, std::size_t cell)
{
  const std::int32_t* ids = &mesh.Cells[4 * cell];
  const Vector3 origin = mesh.Point(ids[0]);
  const Vector3 a = mesh.Point(ids[1]) - origin;
  const Vector3 b = mesh.Point(ids[2]) - origin;
  const Vector3 c = mesh.Point(ids[3]) - origin;
  const Vector3 numerator =
    Dot(a, a) * Cross(b, c) + Dot(b, b) * Cross(c, a) + Dot(c, c) * Cross(a, b);
  const double radius = Norm(numerator) / (2 * std::abs(Dot(a, Cross(b, c))));
  const double shortest =
    std::min({ Norm(a), Norm(b), Norm(c), Norm(b - a), Norm(c - a), Norm(c - b) });
  return shortest > 0 ? radius / shortest : std::numeric_limits<double>::infinity();
}

std::vector<MaterialReport> ReportMaterials(const LabelVolume& materials,
  const TetrahedralMesh& mesh)
{
  std::map<int, MaterialReport> reports;
  const auto of = [&reports](int material) -> MaterialReport&
  {
    const auto [entry, isNew] = reports.try_emplace(material);
    if (isNew)
    {
      entry->second.Material = material;
      entry->second.SmallestDihedralDeg = 180;
    }
    return entry->second;
  };
  for (const auto& [material, count] : materials.CountLabels())
  {
    if (material != 0)
    {
      of(material).VolumeInMm3 = static_cast<double>(count) * materials.VoxelVolume();
    }
  }
  for (std::size_t cell = 0; cell < mesh.NumberOfCells(); ++cell)
  {
    MaterialReport& report = of(mesh.Materials[cell]);
    ++report.Cells;
    report.VolumeOutMm3 += mesh.CellVolume(cell);
    report.SmallestDihedralDeg =
      std::min(report.SmallestDihedralDeg, SmallestDihedralDeg(mesh, cell));
    report.LargestRadiusEdgeRatio =
      std::max(report.LargestRadiusEdgeRatio, RadiusEdgeRatio(mesh, cell));
  }
  std::vector<MaterialReport> result;
  for (auto& [material, report] : reports)
  {
    report.SmallestDihedralDeg = report.Cells > 0 ? report.SmallestDihedralDeg : 0;
    result.push_back(report);
  }
  return result;
}
}
