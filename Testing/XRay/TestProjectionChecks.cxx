// SPDX-License-Identifier: Apache-2.0
#include "LabelShapes.h"
#include "Refusals.h"
#include "mammoray/XRay/Private/ProjectionChecks.h"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>

namespace
{
using mammoray::test::RefusalOf;
using namespace mammoray;

constexpr double Infinity = std::numeric_limits<double>::infinity();

TEST(ProjectionChecks, NameWhatIsWrongWithADetector)
{
  const XRaySource source;
  XRayDetector detector;
  EXPECT_NO_THROW(CheckGeometry(source, detector));
  detector.Rows = 65536;
  EXPECT_EQ(RefusalOf([&] { CheckGeometry(source, detector); }),
    "detector: expected 1 to 65535 columns and rows, found 1 x 65536");
  detector.Rows = 1;
  detector.Samples = 17;
  EXPECT_EQ(RefusalOf([&] { CheckGeometry(source, detector); }),
    "detector: expected 1 to 16 samples, found 17");
  detector.Samples = 1;
  detector.RowStep = -2.0 * detector.ColumnStep;
  EXPECT_THAT(RefusalOf([&] { CheckGeometry(source, detector); }),
    testing::HasSubstr("span a plane"));
  for (const double odd : { Infinity, -Infinity, std::nan(""), 1e13, 1e308, 1e-10, 0.0 })
  {
    detector.RowStep = { 0, odd, 0 };
    EXPECT_THAT(RefusalOf([&] { CheckGeometry(source, detector); }),
      testing::HasSubstr("span a plane"))
      << odd;
  }
  detector.RowStep = XRayDetector().RowStep;
  // The device would have made it infinite.
  detector.Origin = { 1e308, 0, 0 };
  EXPECT_EQ(RefusalOf([&] { CheckGeometry(source, detector); }),
    "detector: expected coordinates up to 1e12 mm and steps from 1e-9 to 1e12 mm that span a "
    "plane, found origin (1e+308, 0, 0), column step (0.1, 0, 0), row step (0, 0.1, 0) mm");
}

TEST(ProjectionChecks, NameWhatIsWrongWithASource)
{
  const XRayDetector detector;
  XRaySource source;
  source.Position = { 3, 4, 0 };
  EXPECT_THAT(RefusalOf([&] { CheckGeometry(source, detector); }),
    testing::HasSubstr("off the detector's plane"));
  source.Type = XRaySource::Kind::Parallel;
  EXPECT_NO_THROW(CheckGeometry(source, detector)); // its position is not looked at
  source.Direction = { 1, 2, 0 };
  EXPECT_THAT(RefusalOf([&] { CheckGeometry(source, detector); }),
    testing::HasSubstr("crosses the detector's plane"));
  for (const double odd : { 0.0, 1e-300, 1e300, Infinity, std::nan("") })
  {
    source.Direction = { 0, 0, odd };
    EXPECT_THAT(RefusalOf([&] { CheckGeometry(source, detector); }),
      testing::HasSubstr("of a length from 1e-100 to 1e100"))
      << odd;
  }
}

TEST(ProjectionChecks, NameThePointOrField)
{
  EXPECT_THAT(RefusalOf(
                [&] {
                  CheckPoints({ 1, 2, 3 }, 2);
                }),
    testing::HasSubstr("expected 6 coordinates"));
  EXPECT_THAT(RefusalOf(
                [&] {
                  CheckPoints({ 1, 2, 3, 4, Infinity, 6 }, 2);
                }),
    testing::HasSubstr("point 1"));
  // A device would have made it infinite, and the picture no number.
  EXPECT_EQ(RefusalOf(
              [&] {
                CheckPoints({ 1, 2, -5e31 }, 1);
              }),
    "projector: point 0: expected coordinates up to 1e12 mm, found -5e+31");
  EXPECT_THAT(RefusalOf([&] { CheckVelocities({}, 1); }), testing::HasSubstr("at least one field"));
  EXPECT_THAT(RefusalOf(
                [&] {
                  CheckVelocities({ { 1, 2, 3, 4, 5, -Infinity }, 3 }, 1);
                }),
    testing::HasSubstr("field 1, point 0"));
  EXPECT_EQ(RefusalOf(
              [&] {
                CheckVelocities({ { 1, 1e13, 3 }, 3 }, 1);
              }),
    "projector: field 0, point 0: expected a velocity up to 1e12 mm per unit, found 1e+13");
}
}
