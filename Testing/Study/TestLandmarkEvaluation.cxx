// SPDX-License-Identifier: Apache-2.0
#include "Files.h"
#include "Refusals.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/MeshConversion.h"
#include "mammoray/Study/LandmarkEvaluation.h"

#include "vtkDoubleArray.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkUnstructuredGrid.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

using mammoray::test::RefusalOf;
using namespace mammoray;
using test::TemporaryFolder;

namespace
{
/// A big tetrahedron with the displacement u = A x of its points, which linear cells represent
/// exactly.
vtkSmartPointer<vtkUnstructuredGrid> StretchedTetrahedron()
{
  TetrahedralMesh mesh;
  mesh.Points = { -100, -100, -100, 300, -100, -100, -100, 300, -100, -100, -100, 300 };
  mesh.Cells = { 0, 1, 2, 3 };
  mesh.Materials = { 1 };
  auto grid = ToGrid(mesh, { "air", "fat" });
  vtkNew<vtkDoubleArray> displacement;
  displacement->SetName("Displacement");
  displacement->SetNumberOfComponents(3);
  for (int point = 0; point < 4; ++point)
  {
    displacement->InsertNextTuple3(0.1 * mesh.Points[3 * point], 0,
      -0.5 * mesh.Points[3 * point + 2]);
  }
  grid->GetPointData()->AddArray(displacement);
  return grid;
}
}

TEST(LandmarkEvaluation, KnowsTheErrorOfAKnownDeformation)
{
  // The truth is the displacement field, seen by a unit that stands 3 mm beside the registered one.
  std::vector<Landmark> landmarks;
  for (const Vector3 point : { Vector3{ 5, 6, 7 }, Vector3{ -8, 9, 1 }, Vector3{ 2, -4, -9 } })
  {
    landmarks.push_back({ point, { 1.1 * point[0], point[1], 0.5 * point[2] }, point[0] > 0 });
  }
  LandmarkTruth truth;
  truth.Placed.Origin = { 3, 0, -20 };
  truth.SourceToDetectorMm = 600;
  VolumeFromGantry registered;
  registered.Origin = { 0, 0, -20 };
  const auto methods = EvaluateLandmarks(landmarks, truth, StretchedTetrahedron(), registered,
    { .SourceToDetectorMm = 600 });
  ASSERT_EQ(methods.size(), 4u);
  EXPECT_EQ(methods[0].Method, "identity");
  EXPECT_EQ(methods[3].Method, "registered");
  // The first and the last landmark are imaged.
  for (const LandmarkErrors& errors : methods)
  {
    EXPECT_THAT(errors.Imaged.InSpaceMm,
      testing::ElementsAre(errors.All.InSpaceMm[0], errors.All.InSpaceMm[2]));
    EXPECT_THAT(errors.Imaged.OnReceptorMm,
      testing::ElementsAre(errors.All.OnReceptorMm[0], errors.All.OnReceptorMm[2]));
  }
  for (std::size_t index = 0; index < landmarks.size(); ++index)
  {
    const Vector3& u = landmarks[index].Uncompressed;
    EXPECT_NEAR(methods[0].All.InSpaceMm[index], std::hypot(0.1 * u[0], 0.5 * u[2]), 1e-9);
    EXPECT_NEAR(methods[3].All.InSpaceMm[index], 3, 1e-9);
    EXPECT_NEAR(methods[3].All.OnReceptorMm[index], 3 * 600 / (600 - (0.5 * u[2] + 20)), 1e-9);
    // No rigid motion is worse than the identity in the sum of squares, and none explains a
    // stretch.
    EXPECT_GT(methods[2].All.InSpaceMm[index], 0);
  }
}

TEST(LandmarkEvaluation, RigidFitFindsARigidMotion)
{
  std::vector<Landmark> landmarks;
  for (const Vector3 p :
    { Vector3{ 5, 6, 7 }, Vector3{ -8, 9, 1 }, Vector3{ 2, -4, -9 }, Vector3{ 11, 0, 3 } })
  {
    landmarks.push_back({ p, { -p[1] + 4, p[0] - 2, p[2] + 9 }, true });
  }
  const auto methods = EvaluateLandmarks(landmarks, LandmarkTruth{}, StretchedTetrahedron(),
    VolumeFromGantry{}, MammographyUnit{});
  for (const double error : methods[1].All.InSpaceMm)
  {
    EXPECT_NEAR(error, 0, 1e-9); // double, points of size 10
  }
}

TEST(LandmarkEvaluation, SummarisesOddAndEvenCounts)
{
  const ErrorSummary odd = Summarise({ 3, 1, 8 });
  EXPECT_EQ(odd.Median, 3);
  EXPECT_EQ(odd.Mean, 4);
  EXPECT_EQ(odd.Largest, 8);
  EXPECT_EQ(Summarise({ 1, 2, 4, 9 }).Median, 3);
  EXPECT_EQ(Summarise({}).Count, 0);
}

TEST(LandmarkEvaluation, RefusesUnusableFiles)
{
  const TemporaryFolder folder;
  const std::string header = "ux,uy,uz,cx,cy,cz,imaged\n";
  const auto refused = [&](const std::string& text, const std::string& expected)
  {
    const std::string path = folder.Write("landmarks.csv", text);
    EXPECT_THAT(RefusalOf([&] { ReadLandmarks(path); }), testing::HasSubstr(expected));
  };
  EXPECT_THROW(ReadLandmarks(folder.File("missing.csv")), InputError);
  refused("", "line 1");
  refused("a,b,c\n", "line 1");
  refused(header + "1,2,3,4,5,6\n", "line 2: expected 7 values (ux,uy,uz,cx,cy,cz,imaged)");
  refused(header + "1,2,3,4,5,6,1\n1,2,3,x,5,6,1\n", "line 3: expected a number in column 4");
  refused(header + "1,2,3,4,5,nan,1\n", "line 2");
  refused(header + "1,2,3,4,5,6,1\n", "at least 3");
  EXPECT_EQ(ReadLandmarks(folder.Write("good.csv",
                            "ux,uy,uz,cx,cy,cz\r\n1, 2,+3,4,5,6\r\n1,2,3,4,5,6\r\n1,2,3,4,5,6\r\n"))
              .size(),
    3u);
}

TEST(LandmarkEvaluation, TwoReadersLieApart)
{
  LandmarkTruth truth;
  truth.SourceToDetectorMm = 600;
  // The second reader marks 3 mm beside, and between the plates 4 mm to the side at half the way to
  // the source, where shadows are twice as large.
  const std::vector<Landmark> first{ { { 0, 0, 0 }, { 10, 20, 300 } } };
  const std::vector<Landmark> second{ { { 0, 3, 0 }, { 14, 20, 300 } } };
  const ReaderDistances apart = DistancesBetween(first, second, truth);
  EXPECT_EQ(apart.Uncompressed, std::vector<double>{ 3 });
  EXPECT_EQ(apart.Compressed, std::vector<double>{ 4 });
  EXPECT_NEAR(apart.OnReceptor.at(0), 8, 1e-12);
  EXPECT_THAT(test::RefusalOf([&] { DistancesBetween(first, {}, truth); }),
    testing::HasSubstr("found 1 and 0"));
}
