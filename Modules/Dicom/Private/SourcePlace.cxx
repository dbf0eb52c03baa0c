// SPDX-License-Identifier: Apache-2.0
#include "Private/SourcePlace.h"

#include "mammoray/Foundation/Error.h"

#include <cmath>
#include <numbers>

namespace mammoray
{
namespace
{
constexpr double Degree = std::numbers::pi / 180;

/// About Y, from Z towards X.
Vector3 Turned(const Vector3& vector, double degrees)
{
  const double cosine = std::cos(degrees * Degree);
  const double sine = std::sin(degrees * Degree);
  return { cosine * vector[0] + sine * vector[2], vector[1],
    cosine * vector[2] - sine * vector[0] };
}
}

SourcePlace PlaceSource(const Mammogram& mammogram, double axisHeightMm)
{
  const char letter = mammogram.RowDirection.empty() ? ' ' : mammogram.RowDirection[0];
  if (letter != 'A' && letter != 'P')
  {
    throw InputError(
      "projections: expected rows that run towards A or P, found '" + mammogram.RowDirection + "'");
  }
  // Seen from the source (row x column = -Z), rows of a left breast run along Y, columns along X.
  const double sense = letter == 'A' ? 1 : -1;
  SourcePlace place;
  place.Row = { 0, sense, 0 };
  place.Column = { sense, 0, 0 };
  const double depth = sense > 0 ? 0.5 : mammogram.Columns - 0.5;
  place.FirstPixel = { -sense * 0.5 * (mammogram.Rows - 1) * mammogram.RowSpacingMm,
    depth * mammogram.ColumnSpacingMm, 0 };
  const std::array<double, 2>& foot = mammogram.SourceFootPixel.value();
  const Vector3 source = place.FirstPixel + (foot[0] * mammogram.ColumnSpacingMm) * place.Row +
    (foot[1] * mammogram.RowSpacingMm) * place.Column +
    Vector3{ 0, 0, mammogram.SourceToDetectorMm.value() - axisHeightMm };
  place.SourceToIsocenterMm = Norm(source);
  if (!(place.SourceToIsocenterMm > 0))
  {
    throw InputError("projections: expected a source away from its axis, found one on it");
  }
  // Positive towards the patient's right, against the positioner's angle.
  place.DetectorPrimaryDeg = -mammogram.PositionerPrimaryAngleDeg.value_or(0);
  place.SourcePrimaryDeg = place.DetectorPrimaryDeg + std::atan2(source[0], source[2]) / Degree;
  place.SourceSecondaryDeg = std::asin(source[1] / place.SourceToIsocenterMm) / Degree;
  place.Detector = Turned({ 0, 0, -axisHeightMm }, place.DetectorPrimaryDeg);
  return place;
}

Vector3 SourceOverPixels(const SourcePlace& place, double columnSpacingMm, double rowSpacingMm)
{
  const double secondary = place.SourceSecondaryDeg * Degree;
  const Vector3 source = place.SourceToIsocenterMm *
    Turned({ 0, std::sin(secondary), std::cos(secondary) }, place.SourcePrimaryDeg);
  const Vector3 over = Turned(source - place.Detector, -place.DetectorPrimaryDeg);
  const Vector3 fromFirst = over - place.FirstPixel;
  return { Dot(fromFirst, place.Row) / columnSpacingMm, Dot(fromFirst, place.Column) / rowSpacingMm,
    fromFirst[2] };
}
}
