// SPDX-License-Identifier: Apache-2.0
#include "EmbreePathLengths.h"

#include "mammoray/Foundation/Error.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <string>
#include <thread>

namespace mammoray::test
{
namespace
{
constexpr std::size_t PacketSize = 8;
constexpr std::size_t MaterialLimit = 16;

/// Embree hands the context to the filter function: what a packet has summed so far.
struct PacketContext
{
  RTCIntersectContext Base;
  const SurfaceMesh* Mesh;
  HitDistance Distance;
  /// Distances count from here, which keeps sums small.
  double Reference;
  Vector3 Origins[PacketSize];
  Vector3 Directions[PacketSize];
  double Lengths[PacketSize][MaterialLimit];
  /// Entered minus left.
  int Balance[PacketSize][MaterialLimit];
};

/// Distance along a ray of unit direction to the plane of a triangle.
double PlaneDistance(const SurfaceMesh& mesh, std::size_t triangle, const Vector3& origin,
  const Vector3& direction)
{
  Vector3 corners[3];
  for (std::size_t corner = 0; corner < 3; ++corner)
  {
    const std::size_t id = mesh.Triangles[3 * triangle + corner];
    corners[corner] =
      Vector3{ mesh.Points[3 * id], mesh.Points[3 * id + 1], mesh.Points[3 * id + 2] } - origin;
  }
  const Vector3 normal = Cross(corners[1] - corners[0], corners[2] - corners[0]);
  return Dot(normal, corners[0]) / Dot(normal, direction);
}

/// Adds a hit to its ray and lets the ray go on.
void AddHits(const RTCFilterFunctionNArguments* arguments)
{
  auto& context = *reinterpret_cast<PacketContext*>(arguments->context);
  const SurfaceMesh& mesh = *context.Mesh;
  const unsigned int n = arguments->N;
  for (unsigned int lane = 0; lane < n; ++lane)
  {
    if (arguments->valid[lane] == 0)
    {
      continue;
    }
    arguments->valid[lane] = 0;
    RTCRayN* ray = arguments->ray;
    const unsigned int id = RTCRayN_id(ray, n, lane);
    const unsigned int triangle = RTCHitN_primID(arguments->hit, n, lane);
    const Vector3 direction{ RTCRayN_dir_x(ray, n, lane), RTCRayN_dir_y(ray, n, lane),
      RTCRayN_dir_z(ray, n, lane) };
    const Vector3 normal{ RTCHitN_Ng_x(arguments->hit, n, lane),
      RTCHitN_Ng_y(arguments->hit, n, lane), RTCHitN_Ng_z(arguments->hit, n, lane) };
    double t = RTCRayN_tfar(ray, n, lane);
    if (context.Distance == HitDistance::Double)
    {
      t = PlaneDistance(mesh, triangle, context.Origins[id], context.Directions[id]);
    }
    const bool frontFirst = Dot(normal, direction) < 0;
    const std::size_t left =
      frontFirst ? mesh.FrontMaterials[triangle] : mesh.BackMaterials[triangle];
    const std::size_t entered =
      frontFirst ? mesh.BackMaterials[triangle] : mesh.FrontMaterials[triangle];
    context.Lengths[id][left] += t - context.Reference;
    context.Lengths[id][entered] -= t - context.Reference;
    --context.Balance[id][left];
    ++context.Balance[id][entered];
  }
}

/// The ray of a pixel, with the sample in its middle.
struct Ray
{
  Vector3 Origin;
  Vector3 Direction;
  double Length;
};

Ray RayOf(const XRaySource& source, const Vector3& pixel, double parallelLength)
{
  Ray ray;
  if (source.Type == XRaySource::Kind::Parallel)
  {
    ray.Direction = (1 / Norm(source.Direction)) * source.Direction;
    ray.Length = parallelLength;
    ray.Origin = pixel - ray.Length * ray.Direction;
    return ray;
  }
  ray.Origin = source.Position;
  ray.Length = Norm(pixel - source.Position);
  ray.Direction = (1 / ray.Length) * (pixel - source.Position);
  return ray;
}
}

EmbreePathLengths::EmbreePathLengths(const SurfaceMesh& mesh)
  : Mesh(mesh)
  , Device(rtcNewDevice(nullptr))
  , Scene(rtcNewScene(this->Device.get()))
{
  if (mesh.NumberOfMaterials() > static_cast<int>(MaterialLimit))
  {
    throw InputError("embree: expected at most " + std::to_string(MaterialLimit) + " materials");
  }
  RTCGeometry geometry = rtcNewGeometry(this->Device.get(), RTC_GEOMETRY_TYPE_TRIANGLE);
  auto* points = static_cast<float*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0,
    RTC_FORMAT_FLOAT3, 3 * sizeof(float), mesh.NumberOfPoints()));
  std::transform(mesh.Points.begin(), mesh.Points.end(), points,
    [](double coordinate) { return static_cast<float>(coordinate); });
  auto* triangles =
    static_cast<std::uint32_t*>(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0,
      RTC_FORMAT_UINT3, 3 * sizeof(std::uint32_t), mesh.NumberOfTriangles()));
  std::copy(mesh.Triangles.begin(), mesh.Triangles.end(), triangles);
  rtcSetGeometryIntersectFilterFunction(geometry, AddHits);
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(this->Scene.get(), geometry);
  rtcReleaseGeometry(geometry);
  rtcSetSceneFlags(this->Scene.get(), RTC_SCENE_FLAG_ROBUST);
  rtcCommitScene(this->Scene.get());
}

PathLengthImage EmbreePathLengths::Project(const XRaySource& source, const XRayDetector& detector,
  HitDistance distance) const
{
  PathLengthImage image;
  image.Columns = detector.Columns;
  image.Rows = detector.Rows;
  image.Materials = this->Mesh.NumberOfMaterials();
  const std::size_t pixelCount = image.NumberOfPixels();
  image.Lengths.assign(pixelCount * static_cast<std::size_t>(image.Materials), 0.0f);
  image.Inconsistent.assign(pixelCount, 0);

  RTCBounds bounds;
  rtcGetSceneBounds(this->Scene.get(), &bounds);
  const Vector3 low{ bounds.lower_x, bounds.lower_y, bounds.lower_z };
  const Vector3 high{ bounds.upper_x, bounds.upper_y, bounds.upper_z };
  const Vector3 middle = 0.5 * (low + high);
  const double parallelLength = 2 * (Norm(high - low) + Norm(detector.Origin - middle));
  const double reference = source.Type == XRaySource::Kind::Parallel
    ? parallelLength - Norm(detector.Origin - middle)
    : Norm(middle - source.Position);

  // Packets of 4 x 2 neighbouring pixels.
  const int packetColumns = (detector.Columns + 3) / 4;
  const int packetRows = (detector.Rows + 1) / 2;
  std::atomic<int> nextRow{ 0 };
  const auto work = [&]
  {
    alignas(32) int valid[PacketSize];
    RTCRayHit8 packet;
    PacketContext context;
    context.Mesh = &this->Mesh;
    context.Distance = distance;
    context.Reference = reference;
    for (int packetRow = nextRow++; packetRow < packetRows; packetRow = nextRow++)
    {
      for (int packetColumn = 0; packetColumn < packetColumns; ++packetColumn)
      {
        rtcInitIntersectContext(&context.Base);
        context.Base.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
        for (unsigned int lane = 0; lane < PacketSize; ++lane)
        {
          const int column = 4 * packetColumn + static_cast<int>(lane % 4);
          const int row = 2 * packetRow + static_cast<int>(lane / 4);
          valid[lane] = column < detector.Columns && row < detector.Rows ? -1 : 0;
          const Ray ray = RayOf(source,
            detector.Origin + static_cast<double>(column) * detector.ColumnStep +
              static_cast<double>(row) * detector.RowStep,
            parallelLength);
          packet.ray.org_x[lane] = static_cast<float>(ray.Origin[0]);
          packet.ray.org_y[lane] = static_cast<float>(ray.Origin[1]);
          packet.ray.org_z[lane] = static_cast<float>(ray.Origin[2]);
          packet.ray.dir_x[lane] = static_cast<float>(ray.Direction[0]);
          packet.ray.dir_y[lane] = static_cast<float>(ray.Direction[1]);
          packet.ray.dir_z[lane] = static_cast<float>(ray.Direction[2]);
          packet.ray.tnear[lane] = 0;
          packet.ray.tfar[lane] = static_cast<float>(ray.Length);
          packet.ray.time[lane] = 0;
          packet.ray.mask[lane] = 0xffffffff;
          packet.ray.flags[lane] = 0;
          packet.ray.id[lane] = lane;
          packet.hit.geomID[lane] = RTC_INVALID_GEOMETRY_ID;
          packet.hit.instID[0][lane] = RTC_INVALID_GEOMETRY_ID;
          context.Origins[lane] = ray.Origin;
          context.Directions[lane] = ray.Direction;
          std::fill_n(context.Lengths[lane], image.Materials, 0.0);
          std::fill_n(context.Balance[lane], image.Materials, 0);
        }
        rtcIntersect8(valid, this->Scene.get(), &context.Base, &packet);
        for (unsigned int lane = 0; lane < PacketSize; ++lane)
        {
          if (valid[lane] == 0)
          {
            continue;
          }
          const std::size_t pixel =
            static_cast<std::size_t>(2 * packetRow + static_cast<int>(lane / 4)) * image.Columns +
            static_cast<std::size_t>(4 * packetColumn + static_cast<int>(lane % 4));
          for (int material = 1; material < image.Materials; ++material)
          {
            image.Lengths[static_cast<std::size_t>(material) * pixelCount + pixel] =
              static_cast<float>(context.Lengths[lane][material]);
            image.Inconsistent[pixel] |= context.Balance[lane][material] != 0 ? 1 : 0;
          }
        }
      }
    }
  };
  std::vector<std::thread> threads;
  for (unsigned int thread = 1; thread < std::thread::hardware_concurrency(); ++thread)
  {
    threads.emplace_back(work);
  }
  work();
  for (std::thread& thread : threads)
  {
    thread.join();
  }
  return image;
}
}
