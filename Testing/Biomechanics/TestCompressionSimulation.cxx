// SPDX-License-Identifier: Apache-2.0
#include "BreastBetweenPlates.h"
#include "EquilibriumChecks.h"
#include "EveryElement.h"
#include "HangingBody.h"
#include "TestMeshes.h"
#include "mammoray/Biomechanics/CompressionSimulation.h"
#include "mammoray/Biomechanics/Private/EquilibriumSolver.h"
#include "mammoray/Foundation/Error.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <optional>
#include <random>

namespace
{
using namespace mammoray;
using test::MakeBreast;
using test::MakePlates;
using test::WithElement;

using ElementCompression = test::EveryElement;

void ExpectSameEquilibrium(const CompressionState& found, const CompressionState& expected)
{
  // A residual of 1e-10 over a stiffness ratio contact : tissue of 1e4.
  EXPECT_LT(test::LargestDifference(found.Positions, expected.Positions), 1e-5);
  EXPECT_NEAR(found.PaddleForceN, expected.PaddleForceN, 1e-6 * expected.PaddleForceN);
}
MAMMORAY_FOR_EVERY_ELEMENT(ElementCompression);

TEST_P(ElementCompression, BlockBetweenPlatesMatchesUniaxialCompression)
{
  // A block whose top and bottom touch frictionless plates that reach over it: uniaxial
  // compression. Held against floating by the symmetry planes x = 0 and y = 0 alone.
  const ElasticMaterial material{ 5, 0.45 };
  const ElasticBody body(test::MakeBoxMesh({ 0, 0, 0 }, { 20, 20, 20 }, { 3, 3, 3 }),
    { {}, material }, {}, {}, GetParam());
  std::vector<double> x = body.RestPositions();
  std::vector<bool> fixed(x.size(), false);
  for (std::size_t n = 0; n < x.size(); n += 3)
  {
    fixed[n] = x[n] < 1e-9;
    fixed[n + 1] = x[n + 1] < 1e-9;
    x[n + 2] = 2 + 0.8 * x[n + 2];
    x[n] *= 1.1;
    x[n + 1] *= 1.1;
  }
  PlatePair plates;
  plates.Support.Edge = { 0, -50, 2 };
  plates.Paddle.Edge = { 0, -50, 18 };
  plates.Paddle.Normal = { 0, 0, -1 };
  EquilibriumSolver solver(body, fixed, 1e5);
  const EquilibriumReport report = solver.Solve(x, &plates, 1e-10, 60);
  ASSERT_TRUE(report.Converged) << report.Reason << " " << report.RelativeResidual;
  EXPECT_NEAR(report.PaddleForceN / report.SupportForceN, 1, 1e-8);

  // The stretch along the axis as found, by the mean of the faces; then the closed form.
  double height = 0;
  int count = 0;
  for (std::size_t n = 0; n < x.size(); n += 3)
  {
    const double z = body.RestPositions()[n + 2];
    if (z < 1e-9 || z > 20 - 1e-9)
    {
      height += z > 1 ? x[n + 2] : -x[n + 2];
      ++count;
    }
  }
  const double axial = height / (count / 2) / 20;
  EXPECT_NEAR(axial, 0.8, 0.005); // the contact layers: at most 2 x 0.05 mm in 20 mm
  const double mu = material.ShearModulusKPa(), kappa = material.BulkModulusKPa();
  double low = 0.5, high = 2;
  for (int i = 0; i < 200; ++i)
  {
    const double l = 0.5 * (low + high), j = axial * l * l, trace = axial * axial + 2 * l * l;
    const double stress =
      mu * std::pow(j, -2 / 3.0) * (l - trace / (3 * l)) + kappa * (j - 1) * axial * l;
    (stress > 0 ? high : low) = l;
  }
  const double lateral = low;
  const double j = axial * lateral * lateral, trace = axial * axial + 2 * lateral * lateral;
  const double stress = mu * std::pow(j, -2 / 3.0) * (axial - trace / (3 * axial)) +
    kappa * (j - 1) * lateral * lateral;
  // 0.2 %: the penalty lets the faces wave by a few micrometres between contact points.
  EXPECT_NEAR(report.PaddleForceN / (-1e-3 * 400 * stress), 1, 2e-3);
  EXPECT_NEAR(report.VolumeRatio / j, 1, 2e-3);
}

TEST_P(ElementCompression, SphereBetweenPlatesMatchesHertz)
{
  // An eighth of a ball of 10 m, so large that the contact layer of 0.05 mm is thin beside
  // the indentation; bricks crowd where the plate touches.
  constexpr double radius = 1e4;
  const double across[] = { 0, 0.025, 0.05, 0.075, 0.1, 0.15, 0.27, 0.5, 1 };
  const double deep[] = { 0, 0.03, 0.07, 0.14, 0.27, 0.5, 1 };
  TetrahedralMesh mesh = test::MakeBoxMesh({ 0, 0, 0 }, { 8, 8, 6 }, { 8, 8, 6 });
  for (std::size_t p = 0; p < mesh.Points.size(); p += 3)
  {
    mesh.Points[p] = across[std::lround(mesh.Points[p])];
    mesh.Points[p + 1] = across[std::lround(mesh.Points[p + 1])];
    mesh.Points[p + 2] = 1 - deep[6 - std::lround(mesh.Points[p + 2])];
  }
  test::MapCubeToBall(mesh, radius, radius, radius);
  const ElasticMaterial material{ 10, 0.3 };
  const ElasticBody body(mesh, { {}, material }, {}, {}, GetParam());
  std::vector<double> x = body.RestPositions();
  std::vector<bool> fixed(x.size(), false);
  for (std::size_t c = 0; c < x.size(); ++c)
  {
    fixed[c] = x[c] < 1e-6; // the planes of symmetry
  }
  constexpr double contactRadius = 0.1 * radius;
  // Tatara (1991): Hertz's approach less what the force on the far side pushes this pole back.
  const double e = material.YoungsModulusKPa, nu = material.PoissonRatio;
  const double hertz = 4 / 3.0 * e / (1 - nu * nu) * std::pow(contactRadius, 3) / radius;
  const double diagonal = std::hypot(contactRadius, 2 * radius);
  const double far =
    2 * (1 + nu) * radius * radius / std::pow(diagonal, 3) + (1 - nu * nu) / diagonal;
  const double approach = contactRadius * contactRadius / radius - far * hertz / (M_PI * e);
  PlatePair plates;
  plates.Support.Edge = { 0, -1e6, -1e6 };
  plates.Paddle.Edge = { 0, -1e6, radius - approach };
  plates.Paddle.Normal = { 0, 0, -1 };
  EquilibriumSolver solver(body, fixed, 100);
  const EquilibriumReport report = solver.Solve(x, &plates, 1e-6, 100);
  ASSERT_TRUE(report.Converged) << report.Reason << " " << report.RelativeResidual;
  // 3 %: flat faces of a quarter of the contact's radius on a round body leave 1 %, the closed form
  // is one of small contacts (second order in a / R = 0.1). Linear cells as large as these see the
  // field of the contact less well: 7 %.
  EXPECT_NEAR(4 * 1e3 * report.PaddleForceN / hertz, 1,
    GetParam() == ElementType::Quadratic ? 0.03 : 0.08);
}

TEST_P(ElementCompression, ForcesBalance)
{
  const CompressionOptions options = WithElement(GetParam(), 1e-10);
  CompressionSimulation simulation = MakeBreast(options);
  const PlatePair plates = MakePlates(48);
  const CompressionState state = simulation.Compress(plates);
  EXPECT_GT(state.PaddleForceN, 1);
  EXPECT_LE(state.RelativeResidual, 1e-10);
  EXPECT_GT(state.SmallestJ, 0.3);
  EXPECT_NEAR(state.VolumeRatio, 1, 0.02);
  EXPECT_LT(state.LargestPenetrationMm, 0.05);

  // The same body by hand: the gradient at held nodes is the force that holds them; with the
  // plates' forces it must vanish in all three directions, since no part of the energy sees a
  // translation.
  const TetrahedralMesh mesh = test::MakeHalfEllipsoidMesh(40, 45, 38, 6);
  const ElasticBody body(mesh, { {}, { 6, 0.49 }, { 5, 0.49 } }, {}, { false, false, true },
    GetParam());
  std::vector<bool> fixed(3 * body.NumberOfNodes(), false);
  for (std::size_t cell = 0; cell < mesh.NumberOfCells(); ++cell)
  {
    for (int a = 0; a < body.NodesPerCell() && mesh.Materials[cell] == 2; ++a)
    {
      const std::int32_t node = body.Cells()[body.NodesPerCell() * cell + a];
      fixed[3 * node] = fixed[3 * node + 1] = fixed[3 * node + 2] = true;
    }
  }
  EquilibriumSolver solver(body, fixed, state.ContactStiffness);
  const std::vector<double> with = test::GradientOf(solver, state.Positions, &plates);
  const std::vector<double> without = test::GradientOf(solver, state.Positions, nullptr);
  Vector3 sum{ 0, 0, 0 }, contact{ 0, 0, 0 }, reaction{ 0, 0, 0 };
  for (std::size_t n = 0; n < with.size(); n += 3)
  {
    for (int axis = 0; axis < 3; ++axis)
    {
      sum[axis] += without[n + axis];
      contact[axis] -= with[n + axis] - without[n + axis];
      reaction[axis] += fixed[n] ? with[n + axis] : 0;
    }
  }
  // Elastic forces of the whole body cancel; what the plates push the chest wall takes up.
  const double scale = 1e3 * (state.PaddleForceN + state.SupportForceN);
  EXPECT_LT(Norm(sum), 1e-9 * scale);
  EXPECT_LT(Norm(contact + reaction), 1e-7 * scale);
  EXPECT_NEAR(contact[2], 1e3 * (state.SupportForceN - state.PaddleForceN), 1e-9 * scale);
}

TEST_P(ElementCompression, WarmAndColdStartsAgree)
{
  const CompressionOptions options = WithElement(GetParam(), 1e-10);
  CompressionSimulation simulation = MakeBreast(options);
  const CompressionState first = simulation.Compress(MakePlates(54));
  const CompressionState warm = simulation.Compress(MakePlates(52, 2), &first);
  const CompressionState cold = simulation.Compress(MakePlates(52, 2));
  EXPECT_EQ(warm.LoadSteps, 1);
  ExpectSameEquilibrium(warm, cold);
}

TEST_P(ElementCompression, IsTheSameWithAPredictorOnAnotherMesh)
{
  const CompressionOptions options = WithElement(GetParam(), 1e-10);
  // Farther closed this breast has several equilibria, folded in several ways.
  const CompressionState alone = MakeBreast(options).Compress(MakePlates(58, 2));
  CompressionSimulation simulation = MakeBreast(options);
  simulation.SetPredictor(std::make_unique<CompressionSimulation>(MakeBreast({}, 0.49, 4)));
  const CompressionState led = simulation.Compress(MakePlates(58, 2));
  EXPECT_EQ(led.LoadSteps, 1); // it has not gone the way itself
  ExpectSameEquilibrium(led, alone);
}

TEST_P(ElementCompression, AdoptsWhatAnotherMeshHasFound)
{
  const CompressionOptions options = WithElement(GetParam(), 1e-10);
  const CompressionState alone = MakeBreast(options).Compress(MakePlates(58, 2));
  CompressionSimulation other = MakeBreast({}, 0.49, 4);
  const CompressionState adopted =
    MakeBreast(options).Adopt(other, other.Compress(MakePlates(58, 2)));
  EXPECT_EQ(adopted.LoadSteps, 1);
  ExpectSameEquilibrium(adopted, alone);
  EXPECT_THROW(MakeBreast(options).Adopt(MakeBreast({}, 0.49, 3), alone), InputError);
}

TEST(CompressionSimulation, AdoptsTheSideToWhichABreastHasToppled)
{
  // Three times as high as wide: between the plates it falls to the one side or to the other.
  const auto make = []
  {
    return CompressionSimulation(test::MakeHalfEllipsoidMesh(14, 60, 42, 4),
      { {}, { 6, 0.49 }, { 5, 0.49 } }, { false, false, true }, {},
      WithElement(ElementType::Quadratic, 1e-10));
  };
  CompressionSimulation toppled = make();
  CompressionSimulation other = make();
  std::vector<std::vector<double>> found;
  for (const double roll : { 20.0, -20.0 })
  {
    CompressionState state = toppled.Compress(MakePlates(64, roll));
    for (const double part : { 0.5, 0.25, 0.0 })
    {
      const CompressionState rolled = toppled.Compress(MakePlates(64, part * roll), &state);
      state = rolled;
    }
    // The tolerance is that between warm and cold starts.
    const CompressionState adopted = other.Adopt(toppled, state);
    EXPECT_LT(test::LargestDifference(adopted.Positions, state.Positions), 1e-5);
    found.push_back(state.Positions);
  }
  EXPECT_GT(test::LargestDifference(found[0], found[1]), 5);
}

TEST(CompressionSimulation, PlatesThatSlideAlongTheirEdgesChangeNothing)
{
  CompressionSimulation simulation = MakeBreast();
  const PlatePair plates = MakePlates(54);
  const CompressionState first = simulation.Compress(plates);
  PlatePair beside = plates;
  beside.Support.Edge = beside.Support.Edge + Vector3{ 35, 0, 0 };
  beside.Paddle.Edge = beside.Paddle.Edge + Vector3{ 35, 0, 0 };
  const CompressionState second = simulation.Compress(beside, &first);
  EXPECT_EQ(second.NewtonSteps, 0);
  EXPECT_EQ(second.Positions, first.Positions);
  EXPECT_EQ(second.Plates.Paddle.Edge, beside.Paddle.Edge);
}

TEST_P(ElementCompression, IsDeterministic)
{
  const CompressionOptions options = WithElement(GetParam(), 1e-8);
  const CompressionState a = MakeBreast(options).Compress(MakePlates(56));
  const CompressionState b = MakeBreast(options).Compress(MakePlates(56));
  EXPECT_EQ(a.Positions, b.Positions);
  CompressionOptions loaded = options;
  loaded.ChestWall = ChestWallMode::Elastic;
  loaded.Wall = { 30, 3 };
  loaded.Friction = 0.3;
  loaded.GravityMPerS2 = { 0, 0, -StandardGravityMPerS2 };
  std::vector<double> positions[2];
  for (std::vector<double>& found : positions)
  {
    CompressionSimulation simulation = MakeBreast(loaded, 0.49, 4);
    simulation.Unload({ 0, StandardGravityMPerS2, 0 });
    found = simulation.Compress(MakePlates(60)).Positions;
  }
  EXPECT_EQ(positions[0], positions[1]);
}

TEST(CompressionSimulation, TellsTimeAndMemory)
{
  const CompressionState state = MakeBreast({}, 0.49, 4).Compress(MakePlates(70));
  EXPECT_GT(state.Seconds, 0);
  // Its lower triangle alone has some ten thousand entries of 8 bytes.
  EXPECT_GT(state.FactorMiB, 0.1);
  EXPECT_LT(state.FactorMiB, 100);
}

/// Fixed, sliding or elastic chest wall; gravity in every other case, pull in some. Without
/// friction, whose normal forces do not settle in one such case of forty and are then refused.
CompressionOptions LoadingOf(ElementType type, unsigned int seed)
{
  std::mt19937 generator(1000 + seed);
  const auto draw = [&](double low, double high)
  { return std::uniform_real_distribution<double>(low, high)(generator); };
  CompressionOptions options = WithElement(type, 1e-8);
  constexpr ChestWallMode modes[] = { ChestWallMode::Fixed, ChestWallMode::Sliding,
    ChestWallMode::Elastic };
  options.ChestWall = modes[seed % 3];
  options.Wall = { std::pow(10.0, draw(1, 3)), std::pow(10.0, draw(-1, 2)) };
  if (seed % 2 == 0)
  {
    options.GravityMPerS2 = { 0, 0, -StandardGravityMPerS2 };
  }
  if (seed % 4 == 1)
  {
    options.PullN = { 0, draw(0, 3), 0 };
  }
  return options;
}

/// A lump of gland in a half-ellipsoid of fat, squeezed to this part of its extent (none: a drawn
/// one) by tilted plates.
void CompressRandomBreast(ElementType type, unsigned int seed, std::optional<double> given = {})
{
  std::mt19937 generator(seed);
  const auto draw = [&](double low, double high)
  { return std::uniform_real_distribution<double>(low, high)(generator); };
  const double a = draw(35, 60), b = draw(40, 65), c = draw(35, 55);
  const double nu = draw(0.45, 0.499), drawn = draw(0.4, 0.7), roll = draw(-40, 40);
  const double ratio = std::pow(10.0, draw(0, 1)), tilt = draw(-8, 8);
  const double part = given.value_or(drawn);
  const CompressionOptions options = LoadingOf(type, seed);
  SCOPED_TRACE(testing::Message() << "seed " << seed << ": half axes " << a << " " << b << " " << c
                                  << ", nu " << nu << ", gland/fat " << ratio << ", to " << part
                                  << ", roll " << roll << ", tilt " << tilt << ", chest wall "
                                  << static_cast<int>(options.ChestWall) << ", gravity "
                                  << Norm(options.GravityMPerS2) << ", pull "
                                  << Norm(options.PullN));
  const ElasticMaterial fat{ draw(3, 8), nu };
  const ElasticMaterial gland{ ratio * fat.YoungsModulusKPa, nu };
  const int coarse = type == ElementType::Quadratic ? 6 : 8;
  const int count = given ? 10 : coarse;
  CompressionSimulation simulation(
    test::MakeHalfEllipsoidMesh(a, b, c, count), { {}, fat, { 5, nu }, gland },
    { false, false, true, false },
    [&](const Vector3& x)
    { return std::hypot(x[0] / a, (x[1] - 0.45 * b) / b, x[2] / c) < 0.45 ? 3 : 1; },
    options);
  // Part of the breast's extent along the plates' normal.
  const double extent =
    2 * std::hypot(a * std::sin(roll * M_PI / 180), c * std::cos(roll * M_PI / 180));
  PlatePair plates = MakePlates(part * extent, roll);
  // So far together plates stand in front of the chest wall, which they would squeeze flat.
  const Vector3 deeper{ 0, given ? b / (count / 2) + 5 : b / 8, 0 };
  plates.Support.Edge = plates.Support.Edge + deeper;
  plates.Paddle.Edge = plates.Paddle.Edge + deeper;
  // The paddle gives way to the breast: turned about its lateral axis, half way in.
  PlatePairVelocity turn;
  const Vector3 lateral = Cross(plates.Paddle.Inward, plates.Paddle.Normal);
  turn.Paddle.Angular = (tilt * M_PI / 180) * lateral;
  turn.Paddle.Linear = (-0.25 * b * tilt * M_PI / 180) * Cross(lateral, plates.Paddle.Inward);
  plates = MovedPlates(plates, turn, 1);

  const CompressionState state = simulation.Compress(plates);
  EXPECT_LE(state.RelativeResidual, 1e-8);
  EXPECT_GT(state.SmallestJ, 0);
  EXPECT_LE(state.LargestPenetrationMm, PenetrationLimitMm(plates));
  // Under its weight a breast that glides may lie on the support only.
  EXPECT_GT(state.PaddleForceN + state.SupportForceN, 0);
  // What kappa explains: the mean pressure in the breast cannot exceed that under the plates by
  // much. It is the force over the area that carries it, at least 0.3 of the greatest section; in a
  // lump of gland it is higher by up to the ratio of the stiffnesses, and kappa as well.
  const double pressure = 1e3 * std::max(state.PaddleForceN, state.SupportForceN) / (0.3 * a * b);
  EXPECT_LT(std::abs(state.VolumeRatio - 1), 0.005 + pressure / fat.BulkModulusKPa());
}

/// Those of the seeds `from` to `to`.
void CompressRandomBreasts(ElementType type, unsigned int from, unsigned int to,
  std::optional<double> part = {})
{
  for (unsigned int seed = from; seed <= to; ++seed)
  {
    try
    {
      CompressRandomBreast(type, seed, part);
    }
    catch (const ConvergenceError& error)
    {
      ADD_FAILURE() << "seed " << seed << ": " << error.what();
    }
  }
}

TEST_P(ElementCompression, ConvergesOnRandomBreasts)
{
  CompressRandomBreasts(GetParam(), 1, 20);
}

TEST_P(ElementCompression, ConvergesOnManyRandomBreastsLong)
{
  if (!std::getenv("MAMMORAY_LONG_TESTS"))
  {
    GTEST_SKIP() << "some minutes; set MAMMORAY_LONG_TESTS to run it";
  }
  CompressRandomBreasts(GetParam(), 21, 200);
}

/// As far as published simulations of 516 breasts went (Said 2023).
TEST_P(ElementCompression, ReachesAQuarterOfManyRandomBreastsLong)
{
  if (!std::getenv("MAMMORAY_LONG_TESTS"))
  {
    GTEST_SKIP() << "some minutes; set MAMMORAY_LONG_TESTS to run it";
  }
  CompressRandomBreasts(GetParam(), 1, 200, 0.24);
}

TEST(CompressionSimulation, SaysHowFarItGot)
{
  CompressionOptions options;
  options.MaximumNewtonSteps = 12;
  CompressionSimulation simulation = MakeBreast(options, 0.49, 4);
  try
  {
    simulation.Compress(MakePlates(0.5));
    FAIL() << "half a millimetre was reached";
  }
  catch (const ConvergenceError& error)
  {
    const std::string message = error.what();
    EXPECT_NE(message.find("gap of 0.50 mm"), std::string::npos) << message;
    EXPECT_NE(message.find("last one reached is at"), std::string::npos) << message;
  }
}

TEST(CompressionSimulation, RefusesTwoMillimetresWithTheLastGoodThickness)
{
  for (const ChestWallMode mode :
    { ChestWallMode::Fixed, ChestWallMode::Sliding, ChestWallMode::Elastic })
  {
    CompressionOptions options;
    options.ChestWall = mode;
    CompressionSimulation simulation = MakeBreast(options, 0.49, 4);
    double last = 0;
    try
    {
      simulation.Compress(MakePlates(2));
      FAIL() << "2 mm was reached";
    }
    catch (const CompressionError& error)
    {
      EXPECT_NE(std::string(error.what()).find("at a gap of 2.00 mm"), std::string::npos)
        << error.what();
      last = error.LastGapMm();
    }
    ASSERT_GT(last, 2);
    ASSERT_LT(last, 40);
    // There is an equilibrium indeed, contact hard and all limits kept. (Among gaps a few mm wider
    // there are some that are not reached: this tissue folds at a quarter of its thickness.)
    const CompressionState state = simulation.Compress(MakePlates(last));
    EXPECT_GE(state.SmallestJ, 0.1);
    EXPECT_LE(state.LargestPenetrationMm, PenetrationLimitMm(state.Plates));
  }
}

TEST(CompressionSimulation, TellsItsEndOnce)
{
  CompressionSimulation simulation = MakeBreast({}, 0.49, 4);
  int ends = 0;
  double last = 0;
  const ProgressCallback count = [&](double fraction, const char*)
  {
    ends += fraction >= 1 ? 1 : 0;
    last = fraction;
    return true;
  };
  const CompressionState state = simulation.Compress(MakePlates(60), nullptr, count);
  EXPECT_EQ(ends, 1);
  EXPECT_EQ(last, 1);
  simulation.Compress(MakePlates(59), &state, count);
  EXPECT_EQ(ends, 2);
}

TEST(CompressionSimulation, StopsWhenAsked)
{
  CompressionSimulation simulation = MakeBreast();
  EXPECT_THROW(simulation.Compress(MakePlates(50), nullptr,
                 [](double fraction, const char*) { return fraction < 0.3; }),
    Interrupted);
}

TEST(CompressionSimulation, RefusesBadInput)
{
  const std::vector<ElasticMaterial> materials(3);
  EXPECT_THROW(CompressionSimulation(test::MakeHalfEllipsoidMesh(40, 45, 38, 4, false), materials,
                 { false, false, true }),
    InputError)
    << "nothing is held";
  CompressionSimulation simulation = MakeBreast({}, 0.49, 4);
  PlatePair plates = MakePlates(50);
  plates.Support.Normal = { 0, 0, 2 };
  EXPECT_THROW(simulation.Compress(plates), InputError);
  plates = MakePlates(50);
  plates.Paddle.EdgeRadiusMm = 1e300; // of which nothing presses
  EXPECT_THROW(simulation.Compress(plates), InputError);
  CompressionState foreign;
  foreign.Positions.resize(9);
  EXPECT_THROW(simulation.Compress(MakePlates(50), &foreign), InputError);
}
}
