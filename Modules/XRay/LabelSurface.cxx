// SPDX-License-Identifier: Apache-2.0
#include "mammoray/XRay/LabelSurface.h"

#include "mammoray/Foundation/Error.h"

#include <algorithm>

namespace mammoray
{
namespace
{
constexpr std::uint32_t NoPoint = 0xffffffff;

/// A point of the net: where it began and where it is, in voxels.
struct NetPoints
{
  std::vector<std::array<float, 3>> Start;
  std::vector<std::array<float, 3>> Place;
};

/// Collects the faces between different materials, corners numbered as they are met.
class FaceCollector
{
public:
  FaceCollector(const LabelVolume& volume, QuadMesh& mesh, NetPoints& net)
    : Volume(volume)
    , Mesh(mesh)
    , Net(net)
    , PointIds(static_cast<std::size_t>(volume.Size[0] + 1) * (volume.Size[1] + 1) *
          (volume.Size[2] + 1),
        NoPoint)
  {
  }

  void Collect()
  {
    const std::array<int, 3>& size = this->Volume.Size;
    for (int k = 0; k <= size[2]; ++k)
    {
      for (int j = 0; j <= size[1]; ++j)
      {
        for (int i = 0; i <= size[0]; ++i)
        {
          const std::uint16_t here = this->At(i, j, k);
          this->Face({ i, j, k }, 0, this->At(i - 1, j, k), here);
          this->Face({ i, j, k }, 1, this->At(i, j - 1, k), here);
          this->Face({ i, j, k }, 2, this->At(i, j, k - 1), here);
        }
      }
    }
  }

private:
  std::uint16_t At(int i, int j, int k) const
  {
    const std::array<int, 3>& size = this->Volume.Size;
    const bool inside = i >= 0 && j >= 0 && k >= 0 && i < size[0] && j < size[1] && k < size[2];
    return inside ? this->Volume.Voxels[this->Volume.Index(i, j, k)] : std::uint16_t{ 0 };
  }

  /// The face at the low end of a voxel along an axis; its front looks along the axis.
  void Face(const std::array<int, 3>& voxel, std::size_t axis, std::uint16_t below,
    std::uint16_t above)
  {
    if (below == above)
    {
      return;
    }
    const std::size_t first = (axis + 1) % 3;
    const std::size_t second = (axis + 2) % 3;
    std::array<int, 3> corner = voxel;
    std::array<std::uint32_t, 4> quad{};
    quad[0] = this->Point(corner);
    ++corner[first];
    quad[1] = this->Point(corner);
    ++corner[second];
    quad[2] = this->Point(corner);
    --corner[first];
    quad[3] = this->Point(corner);
    this->Mesh.Quads.push_back(quad);
    this->Mesh.FrontMaterials.push_back(above);
    this->Mesh.BackMaterials.push_back(below);
  }

  /// The corner at the low end of a voxel.
  std::uint32_t Point(const std::array<int, 3>& corner)
  {
    const std::array<int, 3>& size = this->Volume.Size;
    std::uint32_t& id =
      this->PointIds[(static_cast<std::size_t>(corner[2]) * (size[1] + 1) + corner[1]) *
          (size[0] + 1) +
        corner[0]];
    if (id == NoPoint)
    {
      id = static_cast<std::uint32_t>(this->Net.Start.size());
      this->Net.Start.push_back(
        { corner[0] - 0.5f, corner[1] - 0.5f, corner[2] - 0.5f }); // voxel centres are whole
    }
    return id;
  }

  const LabelVolume& Volume;
  QuadMesh& Mesh;
  NetPoints& Net;
  std::vector<std::uint32_t> PointIds;
};

/// Moves every point to the mean of its neighbours along the quads' edges, within its voxel.
void Smooth(const QuadMesh& mesh, NetPoints& net)
{
  std::vector<std::array<float, 4>> sums(net.Place.size(), { 0, 0, 0, 0 });
  const auto add = [&](std::uint32_t to, std::uint32_t from)
  {
    for (std::size_t axis = 0; axis < 3; ++axis)
    {
      sums[to][axis] += net.Place[from][axis];
    }
    sums[to][3] += 1;
  };
  for (const std::array<std::uint32_t, 4>& quad : mesh.Quads)
  {
    for (std::size_t corner = 0; corner < 4; ++corner)
    {
      add(quad[corner], quad[(corner + 1) % 4]);
      add(quad[(corner + 1) % 4], quad[corner]);
    }
  }
  for (std::size_t point = 0; point < net.Place.size(); ++point)
  {
    for (std::size_t axis = 0; axis < 3; ++axis)
    {
      const float start = net.Start[point][axis];
      net.Place[point][axis] =
        std::clamp(sums[point][axis] / sums[point][3], start - 0.5f, start + 0.5f);
    }
  }
}

/// Adds triangles with the materials of a quad.
class TriangleAdder
{
public:
  TriangleAdder(SurfaceMesh& surface, std::uint16_t front, std::uint16_t back)
    : Surface(surface)
    , Front(front)
    , Back(back)
  {
  }
  void Add(const std::array<std::uint32_t, 3>& corners)
  {
    this->Surface.Triangles.insert(this->Surface.Triangles.end(), corners.begin(), corners.end());
    this->Surface.FrontMaterials.push_back(this->Front);
    this->Surface.BackMaterials.push_back(this->Back);
  }

private:
  SurfaceMesh& Surface;
  std::uint16_t Front;
  std::uint16_t Back;
};

/// A new point in the middle of others.
template <std::size_t N>
std::uint32_t AddMiddle(SurfaceMesh& surface, const std::array<std::uint32_t, N>& ids)
{
  for (std::size_t axis = 0; axis < 3; ++axis)
  {
    double sum = 0;
    for (const std::uint32_t id : ids)
    {
      sum += surface.Points[3 * static_cast<std::size_t>(id) + axis];
    }
    surface.Points.push_back(sum / N);
  }
  return static_cast<std::uint32_t>(surface.NumberOfPoints() - 1);
}
}

SurfaceMesh QuadMesh::Triangulate(std::size_t triangleCount) const
{
  const std::size_t quadCount = this->Quads.size();
  if (triangleCount % 2 != 0 || triangleCount < 2 * quadCount || quadCount == 0)
  {
    throw InputError("quads: expected an even number of triangles, at least " +
      std::to_string(2 * quadCount) + ", found " + std::to_string(triangleCount));
  }
  const std::size_t extra = triangleCount / 2 - quadCount;
  SurfaceMesh surface;
  surface.Points.reserve(3 * (this->Points.size() + extra));
  for (const Vector3& point : this->Points)
  {
    surface.Points.insert(surface.Points.end(), point.begin(), point.end());
  }
  surface.Triangles.reserve(3 * triangleCount);
  surface.FrontMaterials.reserve(triangleCount);
  surface.BackMaterials.reserve(triangleCount);
  for (std::size_t index = 0; index < quadCount; ++index)
  {
    const std::array<std::uint32_t, 4>& quad = this->Quads[index];
    TriangleAdder adder(surface, this->FrontMaterials[index], this->BackMaterials[index]);
    std::size_t inner = (index + 1) * extra / quadCount - index * extra / quadCount;
    if (inner == 0)
    {
      adder.Add({ quad[0], quad[1], quad[2] });
      adder.Add({ quad[0], quad[2], quad[3] });
      continue;
    }
    const std::uint32_t middle = AddMiddle(surface, quad);
    for (std::size_t corner = 0; corner < 3; ++corner)
    {
      adder.Add({ quad[corner], quad[corner + 1], middle });
    }
    std::array<std::uint32_t, 3> last{ quad[3], quad[0], middle };
    for (; inner > 1; --inner)
    {
      const std::uint32_t within = AddMiddle(surface, last);
      adder.Add({ last[0], last[1], within });
      adder.Add({ last[1], last[2], within });
      last = { last[2], last[0], within };
    }
    adder.Add(last);
  }
  return surface;
}

QuadMesh ExtractInterfaces(const LabelVolume& materials, int smoothingSteps)
{
  materials.Validate("interfaces");
  QuadMesh mesh;
  NetPoints net;
  FaceCollector(materials, mesh, net).Collect();
  if (mesh.Quads.empty())
  {
    throw InputError("interfaces: expected a material other than air, found none");
  }
  net.Place = net.Start;
  for (int step = 0; step < smoothingSteps; ++step)
  {
    Smooth(mesh, net);
  }
  mesh.Points.reserve(net.Place.size());
  for (const std::array<float, 3>& place : net.Place)
  {
    mesh.Points.push_back(materials.PointAt(place[0], place[1], place[2]));
  }
  const Vector3& k = materials.Direction[2];
  if (Dot(Cross(materials.Direction[0], materials.Direction[1]), k) < 0)
  {
    std::swap(mesh.FrontMaterials, mesh.BackMaterials); // a left-handed grid turns quads around
  }
  return mesh;
}
}
