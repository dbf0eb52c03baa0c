// SPDX-License-Identifier: Apache-2.0
// Derivatives of path lengths against closed forms, identities and central differences.
#include "ProjectorTesting.h"
#include "Refusals.h"
#include "mammoray/Foundation/Error.h"

#include <gmock/gmock.h>

#include <functional>
#include <random>
#include <set>

namespace
{
using mammoray::test::RefusalOf;
using namespace mammoray;
using namespace mammoray::shapes;

using Motion = std::function<Vector3(const Vector3&)>;

/// The velocity of every point, a field for each motion.
VectorFields Velocities(const SurfaceMesh& mesh, const std::vector<Motion>& motions)
{
  VectorFields velocities;
  velocities.Length = mesh.Points.size();
  for (const Motion& motion : motions)
  {
    for (std::uint32_t point = 0; point < mesh.NumberOfPoints(); ++point)
    {
      const Vector3 velocity = motion(PointOf(mesh, point));
      velocities.Values.insert(velocities.Values.end(), velocity.begin(), velocity.end());
    }
  }
  return velocities;
}

class DerivativeTest : public ProjectorTest
{
protected:
  PathLengthImage Differentiate(const SurfaceMesh& mesh, const XRaySource& source,
    const XRayDetector& detector, const std::vector<Motion>& motions)
  {
    this->Projector->SetSurface(mesh);
    return this->Projector->Project(source, detector, Velocities(mesh, motions), this->Rates);
  }
  /// Relative to the value, and to the field's largest speed: normals, slopes and barycentric
  /// coordinates are used as floats, 6e-8 each, in about ten operations, and rasterisation rounds
  /// each of up to ten hits to 1e-6. In single precision the hit itself moves by up to 1e-4 mm,
  /// 1e-4 of the smallest triangles here, along which velocities change.
  double Tolerance() const { return this->GetParam().Double ? 1e-5 : 1e-3; }

  PathLengthDerivatives Rates;
};

/// Calls `check` for each pixel with its centre and index.
void ForEachPixel(const XRayDetector& detector,
  const std::function<void(const Vector3&, std::size_t)>& check)
{
  for (int row = 0; row < detector.Rows; ++row)
  {
    for (int column = 0; column < detector.Columns; ++column)
    {
      check(Pixel(detector, column, row),
        static_cast<std::size_t>(row) * detector.Columns + column);
    }
  }
}

SurfaceMesh Moved(const SurfaceMesh& mesh, const Motion& motion, double amount)
{
  SurfaceMesh moved = mesh;
  for (std::uint32_t point = 0; point < mesh.NumberOfPoints(); ++point)
  {
    const Vector3 place = PointOf(mesh, point) + amount * motion(PointOf(mesh, point));
    std::copy(place.begin(), place.end(), moved.Points.begin() + 3 * std::ptrdiff_t{ point });
  }
  return moved;
}

/**
 * Compares with central differences of the slow reference, in double precision. Steps of 1e-4 of
 * fields whose speed is about 1 mm leave 1e-8 of truncation, magnified at most by the square of the
 * slope; a pixel near which the ray passes from one triangle to the next has no derivative, which
 * shows as different one-sided differences. Gives the share of pixels compared.
 */
double CompareWithDifferences(const PathLengthDerivatives& rates, const SurfaceMesh& mesh,
  const XRaySource& source, const XRayDetector& detector, const std::vector<Motion>& motions,
  double tolerance)
{
  constexpr double step = 1e-4;
  std::size_t compared = 0;
  for (std::size_t field = 0; field < motions.size(); ++field)
  {
    const SurfaceMesh forward = Moved(mesh, motions[field], step);
    const SurfaceMesh backward = Moved(mesh, motions[field], -step);
    ForEachPixel(detector,
      [&](const Vector3& pixel, std::size_t index)
      {
        const Vector3 from = source.Type == XRaySource::Kind::Point
          ? source.Position
          : pixel - 1e3 / Norm(source.Direction) * source.Direction;
        const auto after = ReferenceLengths(forward, from, pixel);
        const auto here = ReferenceLengths(mesh, from, pixel);
        const auto before = ReferenceLengths(backward, from, pixel);
        bool smooth = !after.empty() && !here.empty() && !before.empty();
        for (std::size_t material = 1; smooth && material < here.size(); ++material)
        {
          const double rate = (after[material] - before[material]) / (2 * step);
          smooth = std::abs(after[material] - 2 * here[material] + before[material]) / step <
            1e-3 * (1 + std::abs(rate));
        }
        for (std::size_t material = 1; smooth && material < here.size(); ++material)
        {
          const double rate = (after[material] - before[material]) / (2 * step);
          const double found = rates.Of(static_cast<int>(field), static_cast<int>(material))[index];
          EXPECT_NEAR(found, rate, tolerance * (1 + std::abs(rate)))
            << "field " << field << " material " << material << " pixel " << index;
        }
        compared += smooth ? 1 : 0;
      });
  }
  return static_cast<double>(compared) /
    static_cast<double>(motions.size() * detector.NumberOfPixels());
}

/// Smooth fields of speeds up to about 1 mm.
std::vector<Motion> SmoothMotions(int count)
{
  std::mt19937 generator(5);
  std::uniform_real_distribution<double> number(-1, 1);
  std::vector<Motion> motions;
  for (int field = 0; field < count; ++field)
  {
    const Vector3 a{ number(generator), number(generator), number(generator) };
    const Vector3 b{ number(generator), number(generator), number(generator) };
    motions.emplace_back(
      [a, b](const Vector3& p) { return std::sin(0.03 * Dot(b, p)) * a + 0.01 * Cross(b, p); });
  }
  return motions;
}

TEST_P(DerivativeTest, MovedAndTiltedInterfaceOfASlab)
{
  const SurfaceMesh mesh = Layers({ 10, 30, 60 }, 200);
  const XRaySource source = PointSource({ 5, -3, 650 });
  const XRayDetector detector =
    CentredDetector({ 0, 0, 0 }, { 1, 0, 0 }, { 0, 1, 0 }, 140, 100, 21, 17);
  const auto atInterface = [](const Vector3& p) { return p[2] == 30 ? 1.0 : 0.0; };
  const PathLengthImage image = this->Differentiate(mesh, source, detector,
    { [&](const Vector3& p) {
       return Vector3{ 0, 0, atInterface(p) };
     },
      [&](const Vector3& p) {
        return Vector3{ 3, 4, 0.01 * p[0] * atInterface(p) };
      } });
  EXPECT_EQ(this->Rates.Fields, 2);
  EXPECT_EQ(this->Rates.Lengths.size(), 2 * image.Lengths.size());
  ForEachPixel(detector,
    [&](const Vector3& pixel, std::size_t index)
    {
      const Vector3 ray = pixel - source.Position;
      const double stretch = Norm(ray) / std::abs(ray[2]);
      const Vector3 hit = source.Position + (30 - source.Position[2]) / ray[2] * ray;
      // Field 1's largest speed is 5.4 mm; the sums' steps are 2^-19 of that.
      for (const auto& [field, rate] :
        { std::pair(0, stretch), std::pair(1, 0.01 * hit[0] * stretch) })
      {
        ASSERT_EQ(this->Rates.Of(field, 0)[index], 0.0f);
        ASSERT_NEAR(this->Rates.Of(field, 1)[index], rate, 5.4 * this->Tolerance());
        ASSERT_NEAR(this->Rates.Of(field, 2)[index], -rate, 5.4 * this->Tolerance());
      }
    });
}

TEST_P(DerivativeTest, ScalingAboutTheSourceScalesPathLengths)
{
  // Rays through the centre of scaling stay where they are on the body: dL/dp = L, exactly, on any
  // mesh, unless something lies beyond the pixel.
  const SurfaceMesh mesh = NestedBodies();
  const XRaySource source = PointSource({ 10, 20, 400 });
  const XRayDetector detector =
    CentredDetector({ 10, 0, -80 }, { 1, 0, 0 }, { 0, 1, 0 }, 150, 110, 43, 31);
  const PathLengthImage image = this->Differentiate(mesh, source, detector,
    { [&](const Vector3& p) { return 1e-2 * (p - source.Position); } });
  ASSERT_EQ(image.NumberOfInconsistentRays(), 0u);
  std::size_t wrong = 0;
  for (int material = 1; material < image.Materials; ++material)
  {
    for (std::size_t pixel = 0; pixel < image.NumberOfPixels(); ++pixel)
    {
      const double expected = 1e-2 * image.Material(material)[pixel];
      // The largest speed is 5 mm; a ray at an angle of a to a triangle magnifies what it rounds to
      // by 1 / sin a, and below 1/256 the guard acts.
      wrong +=
        std::abs(this->Rates.Of(0, material)[pixel] - expected) > 25 * this->Tolerance() ? 1 : 0;
    }
  }
  // Fewer than 1 in 256 rays graze a body of curved surface within the guard's angle.
  EXPECT_LT(wrong, image.NumberOfPixels() / 256);
}

TEST_P(DerivativeTest, GrowingSphereMatchesClosedForm)
{
  SurfaceMesh mesh;
  AddSphere(mesh, { 0, 0, 0 }, 30, 5, 1);
  double volume = 0;
  for (std::size_t triangle = 0; triangle < mesh.NumberOfTriangles(); ++triangle)
  {
    const std::uint32_t* ids = &mesh.Triangles[3 * triangle];
    volume += Dot(PointOf(mesh, ids[0]), Cross(PointOf(mesh, ids[1]), PointOf(mesh, ids[2]))) / 6;
  }
  const XRayDetector detector =
    CentredDetector({ 0.013, 0.017, -50 }, { 1, 0, 0 }, { 0, 1, 0 }, 64, 64, 160, 160);
  this->Differentiate(mesh, ParallelBeam({ 0, 0, -1 }), detector,
    { [](const Vector3& p) { return 1.0 / 30 * p; } });
  double sum = 0;
  ForEachPixel(detector,
    [&](const Vector3& pixel, std::size_t index)
    {
      const double rate = this->Rates.Of(0, 1)[index];
      sum += rate;
      const double distance = std::hypot(pixel[0], pixel[1]);
      if (distance < 24)
      {
        // Triangles lean by up to 1.1 degrees (half an edge of 1.2 mm over the radius) against the
        // sphere, which at 53 degrees of slope changes 1 / cos by up to 2.6 %.
        const double closed = 2 * 30 / std::sqrt(30 * 30 - distance * distance);
        ASSERT_NEAR(rate / closed, 1, 0.03);
      }
    });
  // All of the image is the volume's derivative, 3 V / r, also what silhouettes contribute: the
  // integrand is infinite there, which pixels of 0.4 mm on 190 mm of outline sum to about 1 %.
  EXPECT_NEAR(sum * 0.4 * 0.4 / (3 * volume / 30), 1, 0.01);
}

TEST_P(DerivativeTest, RigidMotionOfABoxMatchesMovedSourceAndDetector)
{
  // Moving the box by +h is moving source and detector by -h; the chord is known in closed form.
  const auto axes = Rotation(0.4, 0.7, -0.3);
  const Vector3 low{ -30, -20, -10 };
  const Vector3 high{ 25, 30, 15 };
  SurfaceMesh mesh;
  AddBox(mesh, low, high, 1, 0, axes);
  const XRayDetector detector =
    CentredDetector({ 0, 0, -80 }, { 1, 0, 0 }, { 0, 1, 0 }, 110, 90, 37, 29);
  const XRaySource source = PointSource({ 20, 10, 350 });
  std::vector<Motion> motions;
  std::vector<std::array<Vector3, 2>> rigid; // translation, rotation per unit
  for (std::size_t axis = 0; axis < 3; ++axis)
  {
    Vector3 unit{ 0, 0, 0 };
    unit[axis] = 1;
    rigid.push_back({ unit, Vector3{ 0, 0, 0 } });
    rigid.push_back({ Vector3{ 0, 0, 0 }, 0.03 * unit }); // speeds of about 1 mm
  }
  for (const auto& [shift, turn] : rigid)
  {
    motions.emplace_back(
      [shift = shift, turn = turn](const Vector3& p) { return shift + Cross(turn, p); });
  }
  this->Differentiate(mesh, source, detector, motions);
  std::size_t compared = 0;
  for (std::size_t field = 0; field < motions.size(); ++field)
  {
    const auto chord = [&](const Vector3& pixel, double amount)
    {
      const auto back = Rotation(amount * rigid[field][1][0], amount * rigid[field][1][1],
        amount * rigid[field][1][2]);
      const auto move = [&](const Vector3& p) { return Apply(back, p) + amount * rigid[field][0]; };
      return BoxChord(low, high, axes, move(source.Position), move(pixel));
    };
    ForEachPixel(detector,
      [&](const Vector3& pixel, std::size_t index)
      {
        constexpr double step = 1e-4;
        const double after = chord(pixel, -step);
        const double here = chord(pixel, 0);
        const double before = chord(pixel, step);
        const double rate = (after - before) / (2 * step);
        if (std::abs(after - 2 * here + before) < 1e-3 * step * (1 + std::abs(rate)))
        {
          // Differences of 100 mm in double precision, 1e-14 each, over 2e-4: far below.
          ASSERT_NEAR(this->Rates.Of(static_cast<int>(field), 1)[index], rate,
            3 * this->Tolerance() * (1 + std::abs(rate)))
            << "field " << field << " pixel " << index;
          ++compared;
        }
      });
  }
  EXPECT_GT(compared, motions.size() * 37 * 29 * 99 / 100);
}

TEST_P(DerivativeTest, MatchesDifferencesOfTheReference)
{
  const SurfaceMesh mesh = NestedBodies();
  const std::vector<Motion> motions = SmoothMotions(3);
  const XRayDetector detector =
    CentredDetector({ 10, 0, -80 }, { 1, 0, 0 }, { 0, 1, 0 }, 120, 90, 31, 23);
  for (const XRaySource& source : { PointSource({ 20, 10, 500 }), ParallelBeam({ 0.2, -0.1, -1 }),
         PointSource({ 1, 2, 30 }) }) // the last lies inside: surfaces behind it do not count
  {
    this->Differentiate(mesh, source, detector, motions);
    EXPECT_GT(
      CompareWithDifferences(this->Rates, mesh, source, detector, motions, 10 * this->Tolerance()),
      0.97);
  }
  // A detector inside the body, and surfaces beyond it.
  const XRayDetector inside =
    CentredDetector({ 2, 1, -6 }, { 1, 0, 0 }, { 0, 1, 0 }, 30, 30, 21, 23);
  const XRaySource source = PointSource({ 20, 10, 500 });
  this->Differentiate(mesh, source, inside, motions);
  EXPECT_GT(
    CompareWithDifferences(this->Rates, mesh, source, inside, motions, 10 * this->Tolerance()),
    0.97);
}

/// In double precision: rounding of single precision, 1e-3 mm, hides the differences.
class ConvergenceTest : public DerivativeTest
{
};

TEST_P(ConvergenceTest, DifferencesOfImagesConverge)
{
  const SurfaceMesh mesh = NestedBodies();
  const std::vector<Motion> motions = SmoothMotions(1);
  const XRaySource source = PointSource({ 20, 10, 500 });
  const XRayDetector detector =
    CentredDetector({ 0, 0, -80 }, { 1, 0, 0 }, { 0, 1, 0 }, 120, 90, 61, 47);
  this->Differentiate(mesh, source, detector, motions);
  std::vector<double> medians;
  for (const double step : { 2.0, 1.0, 0.5, 0.25 })
  {
    this->Projector->UpdatePoints(Moved(mesh, motions[0], step).Points);
    const PathLengthImage after = this->Projector->Project(source, detector);
    this->Projector->UpdatePoints(Moved(mesh, motions[0], -step).Points);
    const PathLengthImage before = this->Projector->Project(source, detector);
    std::vector<double> errors;
    for (std::size_t pixel = 0; pixel < after.NumberOfPixels(); ++pixel)
    {
      const double rate = (after.Material(1)[pixel] - before.Material(1)[pixel]) / (2 * step);
      if (after.Material(1)[pixel] > 0)
      {
        errors.push_back(std::abs(rate - this->Rates.Of(0, 1)[pixel]));
      }
    }
    std::nth_element(errors.begin(),
      errors.begin() + static_cast<std::ptrdiff_t>(errors.size() / 2), errors.end());
    medians.push_back(errors[errors.size() / 2]);
  }
  // Triangles of up to 10 mm: the shorter the step, the fewer rays change triangles on the way, and
  // those that do are off by the change of slope.
  for (std::size_t index = 1; index < medians.size(); ++index)
  {
    EXPECT_LT(medians[index], 0.75 * medians[index - 1]) << "step " << index;
  }
  EXPECT_LT(medians.back(), 2e-3);
}

TEST_P(DerivativeTest, ManyFieldsEqualOneAtATime)
{
  const SurfaceMesh mesh = NestedBodies();
  const std::vector<Motion> motions = SmoothMotions(19);
  const XRaySource source = PointSource({ 20, 10, 500 });
  const XRayDetector detector =
    CentredDetector({ 10, 0, -80 }, { 1, 0, 0 }, { 0, 1, 0 }, 120, 90, 31, 23);
  const PathLengthImage image = this->Differentiate(mesh, source, detector, motions);
  const PathLengthImage plain = this->Projector->Project(source, detector);
  // The same sums, perhaps compiled to other roundings.
  EXPECT_THAT(image.Lengths, testing::Pointwise(testing::FloatNear(1e-4f), plain.Lengths));
  const PathLengthDerivatives all = std::exchange(this->Rates, {});
  for (std::size_t field = 0; field < motions.size(); ++field)
  {
    this->Differentiate(mesh, source, detector, { motions[field] });
    for (int material = 1; material < image.Materials; ++material)
    {
      for (std::size_t pixel = 0; pixel < image.NumberOfPixels(); ++pixel)
      {
        const double expected = this->Rates.Of(0, material)[pixel];
        ASSERT_NEAR(all.Of(static_cast<int>(field), material)[pixel], expected,
          this->Tolerance() * (1 + std::abs(expected)));
      }
    }
  }
}

TEST_P(DerivativeTest, SamplesAreTheMeanOfTheirRays)
{
  const SurfaceMesh mesh = NestedBodies();
  XRayDetector coarse = CentredDetector({ 10, 0, -80 }, { 1, 0, 0 }, { 0, 1, 0 }, 120, 90, 12, 9);
  const XRayDetector fine =
    CentredDetector({ 10, 0, -80 }, { 1, 0, 0 }, { 0, 1, 0 }, 120, 90, 36, 27);
  coarse.Samples = 3;
  const XRaySource source = PointSource({ 20, 10, 500 });
  const std::vector<Motion> motions = SmoothMotions(3);
  this->Differentiate(mesh, source, fine, motions);
  const PathLengthDerivatives rays = std::exchange(this->Rates, {});
  const PathLengthImage image = this->Differentiate(mesh, source, coarse, motions);
  std::set<std::size_t> different;
  for (int field = 0; field < 3; ++field)
  {
    for (int material = 1; material < image.Materials; ++material)
    {
      ForEachPixel(coarse,
        [&](const Vector3&, std::size_t index)
        {
          const std::size_t row = index / 12;
          const std::size_t column = index % 12;
          double sum = 0;
          double size = 1;
          for (std::size_t k = 0; k < 9; ++k)
          {
            const double rate =
              rays.Of(field, material)[(3 * row + k / 3) * 36 + 3 * column + k % 3];
            sum += rate / 9;
            size += std::abs(rate);
          }
          // Pixels' places are summed in another order: hits move by 1e-13 mm, in single
          // precision by 1e-4 mm, which slopes of up to 256 magnify.
          if (std::abs(this->Rates.Of(field, material)[index] - sum) >
            (this->GetParam().Double ? 1e-5 : 1e-2) * size)
          {
            different.insert(index);
          }
        });
    }
  }
  // A ray that hits an edge, by the driver's test in single precision, is traced again beside it,
  // each in its own direction: of 972 rays NVIDIA's driver finds one such.
  EXPECT_LE(different.size(), 2u);
}

TEST_P(DerivativeTest, GrazingHitsAreGuarded)
{
  // Wedges whose left face leans against the beam; they move sideways.
  const double height = 20;
  for (const double slope : { 0.02, 0.0055, 0.0025, 0.0 })
  {
    SurfaceMesh mesh = Layers({ 0, height }, 10);
    for (std::size_t point = 0; point < mesh.NumberOfPoints(); ++point)
    {
      double* p = &mesh.Points[3 * point];
      p[0] += p[0] < 0 ? slope * p[2] : 5;
    }
    // Rays through the middle of the left face where it leans, and a tenth inside where it stands.
    const double x = -10 + (slope > 0 ? 0.5 * slope * height : 0.1);
    const XRayDetector detector =
      CentredDetector({ x, 0.3, -5 }, { 1, 0, 0 }, { 0, 1, 0 }, 1e-3, 6, 1, 5);
    this->Differentiate(mesh, ParallelBeam({ 0, 0, -1 }), detector, { [](const Vector3&) {
      return Vector3{ 1, 0, 0 };
    } });
    // n . v is cos of the lean, n . d its sine: their quotient 1 / slope, or, guarded, 256 cos.
    const double cosine = 1 / std::sqrt(1 + slope * slope);
    const double expected = slope == 0 ? 0 : -std::min(1 / slope, 256 * cosine);
    for (int pixel = 0; pixel < 5; ++pixel)
    {
      // Single: the normal is off by the points' rounding, 5e-7 of 20 mm.
      EXPECT_NEAR(this->Rates.Of(0, 1)[pixel], expected,
        (this->GetParam().Double ? 1e-5 : 1e-3) * (1 + std::abs(expected)))
        << "slope " << slope;
    }
  }
}

TEST_P(DerivativeTest, HolesTakeTheirNeighboursDerivatives)
{
  SurfaceMesh mesh = Layers({ 0, 10 }, 40);
  // A hole of 2 mm in the top: a ring of triangles around it instead of two.
  mesh.Triangles.erase(mesh.Triangles.end() - 6, mesh.Triangles.end());
  mesh.FrontMaterials.resize(mesh.NumberOfTriangles());
  mesh.BackMaterials.resize(mesh.NumberOfTriangles());
  const auto base = static_cast<std::uint32_t>(mesh.NumberOfPoints());
  for (const auto& [x, y] :
    { std::pair(-1, -1), std::pair(1, -1), std::pair(1, 1), std::pair(-1, 1) })
  {
    AddPoint(mesh, { 1.0 * x, 1.0 * y, 10 });
  }
  for (std::uint32_t side = 0; side < 4; ++side)
  {
    const std::uint32_t next = (side + 1) % 4;
    AddTriangle(mesh, 4 + side, 4 + next, base + next, 1, 0);
    AddTriangle(mesh, 4 + side, base + next, base + side, 1, 0);
  }
  const XRayDetector detector =
    CentredDetector({ 0.01, 0.02, -5 }, { 1, 0, 0 }, { 0, 1, 0 }, 20, 20, 40, 40);
  const PathLengthImage image =
    this->Differentiate(mesh, ParallelBeam({ 0, 0, -1 }), detector, { [](const Vector3& p) {
      return Vector3{ 0, 0, p[2] > 5 ? 2.0 : 0.0 };
    } });
  EXPECT_GE(image.NumberOfInconsistentRays(), 9u);
  EXPECT_LE(image.NumberOfInconsistentRays(), 25u);
  for (std::size_t pixel = 0; pixel < image.NumberOfPixels(); ++pixel)
  {
    ASSERT_NEAR(this->Rates.Of(0, 1)[pixel], 2, 2 * this->Tolerance());
  }
}

TEST_P(DerivativeTest, RefusesUnusableVelocities)
{
  SurfaceMesh mesh;
  AddBox(mesh, { -5, -5, 0 }, { 5, 5, 5 }, 1);
  this->Projector->SetSurface(mesh);
  const XRayDetector detector = CentredDetector({ 0, 0, -5 }, { 1, 0, 0 }, { 0, 1, 0 }, 8, 8, 8, 8);
  const XRaySource source = PointSource({ 0, 0, 300 });
  VectorFields velocities(1, mesh.Points.size());
  const VectorFields shorter(2, mesh.Points.size() / 2);
  EXPECT_THROW(this->Projector->Project(source, detector, shorter, this->Rates), InputError);
  EXPECT_THROW(this->Projector->Project(source, detector, {}, this->Rates), InputError);
  this->Projector->Project(source, detector, velocities, this->Rates);
  EXPECT_THAT(this->Rates.Lengths, testing::Each(0.0f));
  velocities[0][4] = NAN;
  EXPECT_THAT(
    RefusalOf([&] { this->Projector->Project(source, detector, velocities, this->Rates); }),
    testing::HasSubstr("field 0, point 1"));
}

TEST(PathLengthDerivatives, ImagesLargerThanABufferAreDoneInStrips)
{
  // 200,000 pixels of 181 materials are 145 MB; lavapipe's buffers hold 134 MB. Devices with larger
  // ones do it at once.
  if (ListDevices().empty())
  {
    GTEST_SKIP() << "no Vulkan device";
  }
  const SurfaceMesh mesh = NestedBodiesOfManyMaterials();
  const VectorFields velocities = Velocities(mesh, SmoothMotions(1));
  const auto projector =
    MakeProjector({ .Projection = ProjectorOptions::Method::Rasterisation, .Validation = true });
  projector->SetSurface(mesh);
  const XRaySource source = PointSource({ 20, 10, 500 });
  const XRayDetector whole =
    CentredDetector({ 10, 0, -80 }, { 1, 0, 0 }, { 0, 1, 0 }, 150, 110, 500, 400);
  PathLengthDerivatives rates;
  const PathLengthImage image = projector->Project(source, whole, velocities, rates);
  // The last quarter, which is in the second strip or lies across its border.
  XRayDetector part = whole;
  part.Rows = 100;
  part.Origin = whole.Origin + 300.0 * whole.RowStep;
  PathLengthDerivatives partRates;
  const PathLengthImage partImage = projector->Project(source, part, velocities, partRates);
  const std::size_t offset = std::size_t{ 300 } * 500;
  std::size_t different = 0;
  for (int material = 30; material < image.Materials; material += 30)
  {
    for (std::size_t pixel = 0; pixel < partImage.NumberOfPixels(); ++pixel)
    {
      ASSERT_NEAR(image.Material(material)[offset + pixel], partImage.Material(material)[pixel],
        3e-5);
      const double rate = partRates.Of(0, material)[pixel];
      different +=
        std::abs(rates.Of(0, material)[offset + pixel] - rate) > 2e-5 * (1 + std::abs(rate)) ? 1
                                                                                             : 0;
    }
  }
  // They differ as the methods do: rays next to an edge may see the triangle on its other side.
  EXPECT_LE(different, 6 * partImage.NumberOfPixels() / 1000);
}

TEST(PathLengthDerivatives, MethodsAgree)
{
  std::string reason;
  const auto devices = ListDevices(&reason);
  if (std::none_of(devices.begin(), devices.end(),
        [](const DeviceDescription& device) { return device.RayTracing; }))
  {
    GTEST_SKIP() << "no device that traces rays " << reason;
  }
  SurfaceMesh mesh = NestedBodies();
  const VectorFields velocities = Velocities(mesh, SmoothMotions(4));
  const XRaySource source = PointSource({ 20, 10, 500 });
  const XRayDetector detector =
    CentredDetector({ 10, 0, -80 }, { 1, 0, 0 }, { 0, 1, 0 }, 150, 110, 101, 83);
  std::array<PathLengthDerivatives, 2> rates;
  const std::array<Method, 2> methods{ Method::RayTracing, Method::Rasterisation };
  for (std::size_t index = 0; index < 2; ++index)
  {
    const auto projector = MakeProjector({ .Projection = methods[index], .Validation = true });
    projector->SetSurface(mesh);
    projector->Project(source, detector, velocities, rates[index]);
  }
  std::size_t different = 0;
  for (std::size_t index = 0; index < rates[0].Lengths.size(); ++index)
  {
    const double a = rates[0].Lengths[index];
    const double b = rates[1].Lengths[index];
    different += std::abs(a - b) > 2e-5 * (1 + std::abs(a)) ? 1 : 0;
  }
  // Rays within 1e-5 mm of an edge may see the triangle on its other side, whose slope differs:
  // 1e-5 mm on either side of 5 mm of edges per mm^2 of surface.
  EXPECT_LE(different, rates[0].Lengths.size() / 1000);
}

INSTANTIATE_TEST_SUITE_P(Methods, DerivativeTest, AllVariants(), VariantName);
INSTANTIATE_TEST_SUITE_P(Methods, ConvergenceTest,
  testing::Values(Variant{ Method::RayTracing, true }, Variant{ Method::Rasterisation, true }),
  VariantName);
}
