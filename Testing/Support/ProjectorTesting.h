// SPDX-License-Identifier: Apache-2.0
// The set-up that the projectors' tests share: one projector per method and precision, with the
// Khronos validation layer, synchronisation included, on: any message of it is a DeviceError and
// fails the test.
#ifndef mammoray_ProjectorTesting_h
#define mammoray_ProjectorTesting_h

#include "SurfaceShapes.h"
#include "mammoray/XRay/PathLengthProjector.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <string>

namespace mammoray::shapes
{
using Method = ProjectorOptions::Method;

/// A method and its precision.
struct Variant
{
  Method Projection;
  bool Double;
};

/// One projector per method and precision for the whole run; skips without a device for it.
class ProjectorTest : public testing::TestWithParam<Variant>
{
protected:
  void SetUp() override
  {
    std::string reason;
    const auto devices = ListDevices(&reason);
    if (devices.empty())
    {
      GTEST_SKIP() << reason;
    }
    if (this->GetParam().Projection == Method::RayTracing &&
      std::none_of(devices.begin(), devices.end(),
        [](const DeviceDescription& device) { return device.RayTracing; }))
    {
      GTEST_SKIP() << "no device that traces rays";
    }
    std::unique_ptr<PathLengthProjector>& shared = Shared(this->GetParam());
    if (!shared)
    {
      shared = MakeProjector({ .Projection = this->GetParam().Projection,
        .DoublePrecision = this->GetParam().Double,
        .Validation = true });
    }
    this->Projector = shared.get();
  }
  static void TearDownTestSuite()
  {
    for (const Method method : { Method::RayTracing, Method::Rasterisation })
    {
      Shared({ method, true }).reset();
      Shared({ method, false }).reset();
    }
  }
  static std::unique_ptr<PathLengthProjector>& Shared(const Variant& variant)
  {
    static std::unique_ptr<PathLengthProjector> projectors[4];
    return projectors[(variant.Projection == Method::RayTracing ? 2 : 0) +
      (variant.Double ? 1 : 0)];
  }

  PathLengthImage Project(const SurfaceMesh& mesh, const XRaySource& source,
    const XRayDetector& detector)
  {
    this->Projector->SetSurface(mesh);
    return this->Projector->Project(source, detector);
  }

  PathLengthProjector* Projector = nullptr;
};

inline auto AllVariants()
{
  return testing::Values(Variant{ Method::RayTracing, true }, Variant{ Method::RayTracing, false },
    Variant{ Method::Rasterisation, true }, Variant{ Method::Rasterisation, false });
}

inline std::string VariantName(const testing::TestParamInfo<Variant>& instance)
{
  return std::string(
           instance.param.Projection == Method::RayTracing ? "RayTracing" : "Rasterisation") +
    (instance.param.Double ? "Double" : "Single");
}

inline XRaySource PointSource(const Vector3& position)
{
  XRaySource source;
  source.Position = position;
  return source;
}

inline XRaySource ParallelBeam(const Vector3& direction)
{
  XRaySource source;
  source.Type = XRaySource::Kind::Parallel;
  source.Direction = direction;
  return source;
}

/// A detector of columns x rows pixels centred on `center` with unit axes u, v.
inline XRayDetector CentredDetector(const Vector3& center, const Vector3& u, const Vector3& v,
  double width, double height, int columns, int rows)
{
  XRayDetector detector;
  detector.Columns = columns;
  detector.Rows = rows;
  detector.ColumnStep = (width / columns) * u;
  detector.RowStep = (height / rows) * v;
  detector.Origin =
    center - (0.5 * (columns - 1)) * detector.ColumnStep - (0.5 * (rows - 1)) * detector.RowStep;
  return detector;
}

inline Vector3 Pixel(const XRayDetector& detector, double column, double row)
{
  return detector.Origin + column * detector.ColumnStep + row * detector.RowStep;
}

/// A sphere (material 2) and a box (3) inside a big sphere (1); a box (4) that touches the outside.
inline SurfaceMesh NestedBodies()
{
  SurfaceMesh mesh;
  AddSphere(mesh, { 0, 0, 0 }, 40, 3, 1);
  AddSphere(mesh, { 10, 5, -8 }, 12, 2, 2, 1);
  AddBox(mesh, { -20, -10, -5 }, { -6, 4, 11 }, 3, 1, Rotation(0.1, 0.2, 0.3));
  AddSphere(mesh, { 12, 6, -8 }, 5, 2, 5, 2);
  AddBox(mesh, { 41, -10, -10 }, { 60, 10, 10 }, 4);
  AddBox(mesh, { 60, -10, -10 }, { 70, 10, 10 }, 6);
  return mesh;
}

/// NestedBodies with material numbers 30, 60, ... 180: path lengths of 181 materials.
inline SurfaceMesh NestedBodiesOfManyMaterials()
{
  SurfaceMesh mesh = NestedBodies();
  for (std::vector<std::uint16_t>* materials : { &mesh.FrontMaterials, &mesh.BackMaterials })
  {
    for (std::uint16_t& material : *materials)
    {
      material = static_cast<std::uint16_t>(30 * material);
    }
  }
  return mesh;
}
}

#endif
