// SPDX-License-Identifier: Apache-2.0
// Against plastimatch's exact digitally reconstructed radiograph, which knows voxels only: source,
// detector and cone beam are its own. Debian's package plastimatch; skipped without it.
#include "Files.h"
#include "SurfaceShapes.h"
#include "mammoray/XRay/PathLengthProjector.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <sstream>

namespace
{
using namespace mammoray;
using test::TemporaryFolder;

/// Two balls, one in the other.
constexpr Vector3 Center{ 3, -2, 5 };
constexpr Vector3 InnerCenter{ 7, 1, 3 };
constexpr double Radius = 20;
constexpr double InnerRadius = 9;
constexpr double Mu[3] = { 0, 0.5, 1.7 };
constexpr double VoxelMm = 0.25;
constexpr int VoxelsPerEdge = 224;
constexpr int Columns = 80;
constexpr int Rows = 100;
constexpr double PixelMm = 0.8;

/// A ray that passes a ball's middle at so many radii meets a surface that rises by 45 degrees.
constexpr double Steepest = 0.7;

double DistanceFromRay(const Vector3& point, const Vector3& from, const Vector3& to)
{
  return Norm(Cross(point - from, to - from)) / Norm(to - from);
}

/// Share of a voxel at distance d from the centre of a ball.
double Covered(double d, double radius)
{
  return std::clamp(0.5 + (radius - d) / VoxelMm, 0.0, 1.0);
}

void WriteVoxels(const std::string& path)
{
  const double origin = -0.5 * (VoxelsPerEdge - 1) * VoxelMm;
  std::vector<float> values;
  values.reserve(static_cast<std::size_t>(VoxelsPerEdge) * VoxelsPerEdge * VoxelsPerEdge);
  for (int k = 0; k < VoxelsPerEdge; ++k)
  {
    for (int j = 0; j < VoxelsPerEdge; ++j)
    {
      for (int i = 0; i < VoxelsPerEdge; ++i)
      {
        const Vector3 point{ origin + VoxelMm * i, origin + VoxelMm * j, origin + VoxelMm * k };
        const double inner = Covered(Norm(point - InnerCenter), InnerRadius);
        const double outer = Covered(Norm(point - Center), Radius) - inner;
        values.push_back(static_cast<float>(Mu[1] * outer + Mu[2] * inner));
      }
    }
  }
  std::ofstream file(path, std::ios::binary);
  file
    << "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\nOffset ="
    << " " << origin << " " << origin << " " << origin << "\nElementSpacing = " << VoxelMm << " "
    << VoxelMm << " " << VoxelMm << "\nDimSize = " << VoxelsPerEdge << " " << VoxelsPerEdge << " "
    << VoxelsPerEdge << "\nElementType = MET_FLOAT\nElementDataFile = LOCAL\n";
  file.write(reinterpret_cast<const char*>(values.data()),
    static_cast<std::streamsize>(values.size() * sizeof(float)));
}

/// The floats of a .pfm, as they lie there.
std::vector<float> ReadPfm(const std::string& path)
{
  const std::string bytes = test::ReadFile(path);
  std::vector<float> values(static_cast<std::size_t>(Columns) * Rows);
  const std::size_t length = values.size() * sizeof(float);
  if (bytes.size() > length)
  {
    std::copy(bytes.end() - static_cast<std::ptrdiff_t>(length), bytes.end(),
      reinterpret_cast<char*>(values.data()));
  }
  return values;
}
}

TEST(PlastimatchPeer, NestedBallsUnderAConeBeam)
{
  if (ListDevices().empty())
  {
    GTEST_SKIP() << "no Vulkan device";
  }
  if (std::system("command -v plastimatch >/dev/null") != 0)
  {
    GTEST_SKIP() << "no plastimatch (apt install plastimatch; 180 MB)";
  }
  const TemporaryFolder folder;
  WriteVoxels(folder.File("balls.mha"));
  std::ostringstream command;
  command << "plastimatch drr -I '" << folder.File("balls.mha") << "' -O '" << folder.File("drr_")
          << "' -t pfm --nrm '0 0 1' --vup '0 1 0' --sad 600 --sid 650 -r '" << Columns << " "
          << Rows << "' -z '" << Columns * PixelMm << " " << Rows * PixelMm
          << "' -o '0 0 0' -i exact -P none -A cpu >'" << folder.File("log") << "' 2>&1";
  ASSERT_EQ(std::system(command.str().c_str()), 0) << test::ReadFile(folder.File("log"));
  const std::vector<float> peer = ReadPfm(folder.File("drr_0000.pfm"));

  // Facets of the balls lie at most (0.33 mm)^2 / (8 * 20 mm), 7e-4 mm, within them.
  SurfaceMesh mesh;
  shapes::AddSphere(mesh, Center, Radius, 6, 1);
  shapes::AddSphere(mesh, InnerCenter, InnerRadius, 6, 2, 1);
  XRaySource source;
  source.Position = { 0, 0, 600 };
  XRayDetector detector;
  detector.Columns = Columns;
  detector.Rows = Rows;
  detector.ColumnStep = { PixelMm, 0, 0 };
  detector.RowStep = { 0, -PixelMm, 0 };
  detector.Origin = { -0.5 * (Columns - 1) * PixelMm, 0.5 * (Rows - 1) * PixelMm, -50 };
  const auto projector = MakeProjector({ .Validation = true });
  projector->SetSurface(mesh);
  const PathLengthImage image = projector->Project(source, detector);

  double sum = 0;
  double squares = 0;
  double largest = 0;
  int count = 0;
  for (std::size_t pixel = 0; pixel < image.NumberOfPixels(); ++pixel)
  {
    const Vector3 place = detector.Origin +
      static_cast<double>(pixel % Columns) * detector.ColumnStep +
      static_cast<double>(pixel / Columns) * detector.RowStep;
    const double inner = DistanceFromRay(InnerCenter, source.Position, place) / InnerRadius;
    const double outer = DistanceFromRay(Center, source.Position, place) / Radius;
    if (outer < Steepest && (inner < Steepest || inner > 1.1))
    {
      const double ours = Mu[1] * image.Material(1)[pixel] + Mu[2] * image.Material(2)[pixel];
      const double difference = 10 * double{ peer[pixel] } - ours; // plastimatch counts in cm
      sum += difference;
      squares += difference * difference;
      largest = std::max(largest, std::abs(difference));
      ++count;
    }
  }
  ASSERT_GT(count, 800);
  // A voxel at the surface holds its share of both materials, wherever in it the ray passes: up to
  // half of its diagonal beside the middle, which displaces a surface that rises by 45 degrees by
  // as much, 0.7 of a voxel; at two crossings with a step of mu of 0.5 and two with 1.2, 2.4
  // voxels. Evenly spread that is an eighth of it in the mean square, 0.3, and next to nothing in
  // the mean.
  EXPECT_LE(largest, 2.4 * VoxelMm);
  EXPECT_LE(std::sqrt(squares / count), 0.3 * VoxelMm);
  EXPECT_LE(std::abs(sum / count), 0.03 * VoxelMm);
}
