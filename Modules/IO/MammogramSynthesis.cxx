// SPDX-License-Identifier: Apache-2.0
#include "mammoray/IO/MammogramSynthesis.h"

#include "mammoray/Foundation/Error.h"
#include "mammoray/XRay/Display.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

namespace mammoray
{
namespace
{
/// Letters of DICOM's Patient Orientation for a direction, the largest component first (PS3.3
/// section C.7.6.1.1.1).
std::string PatientLetters(const Vector3& direction, const AnatomicalAxes& axes)
{
  const double length = Norm(direction);
  std::vector<std::pair<double, char>> parts;
  const auto add = [&](const Vector3& axis, char towards, char away)
  {
    const double part = Dot(direction, axis) / length;
    parts.emplace_back(std::abs(part), part > 0 ? towards : away);
  };
  add(axes.Left, 'L', 'R');
  add(axes.Anterior, 'A', 'P');
  add(axes.Superior, 'H', 'F');
  std::stable_sort(parts.begin(), parts.end(),
    [](const auto& a, const auto& b) { return a.first > b.first; });
  std::string letters;
  for (const auto& [part, letter] : parts)
  {
    // Beyond 20 degrees off, so that a slight tilt of the unit does not make the view oblique.
    if (part > std::sin(std::numbers::pi / 9))
    {
      letters.push_back(letter);
    }
  }
  return letters;
}

/// The view of a unit turned by `rollDeg` around a breast of that side.
std::string ViewOfRoll(double rollDeg, char laterality)
{
  // The source medial is the patient's left of the right breast, so a positive roll.
  const double medial = laterality == 'R' ? rollDeg : -rollDeg;
  static constexpr const char* Views[] = { "FB", "", "LM", "LMO", "CC", "MLO", "ML", "", "FB" };
  return Views[std::lround((medial + 180) / 45)];
}

/// The number of pixels of the mammogram; throws InputError unless there are as many values.
std::size_t CheckedPixelCount(const Mammogram& mammogram, const std::vector<float>& values)
{
  const std::size_t pixelCount =
    static_cast<std::size_t>(mammogram.Columns) * static_cast<std::size_t>(mammogram.Rows);
  if (values.size() != pixelCount)
  {
    throw InputError("mammogram: expected " + std::to_string(pixelCount) + " pixels, found " +
      std::to_string(values.size()));
  }
  return pixelCount;
}
}

XRayDetector DetectorOfUnit(const VolumeFromGantry& placed, int columns, int rows,
  const std::array<double, 2>& spacingMm)
{
  XRayDetector detector;
  detector.Columns = columns;
  detector.Rows = rows;
  detector.Origin = placed.Point({ 0.5 * (rows - 1) * spacingMm[1], 0.5 * spacingMm[0], 0 });
  detector.ColumnStep = spacingMm[0] * placed.Y;
  detector.RowStep = spacingMm[1] * (-1.0 * placed.X);
  return detector;
}

Mammogram DescribeProjection(const XRaySource& source, const XRayDetector& detector,
  const AnatomicalAxes& axes, char laterality)
{
  if (laterality != 'L' && laterality != 'R')
  {
    throw InputError("laterality: expected L or R, found '" + std::string(1, laterality) + "'");
  }
  Mammogram mammogram;
  mammogram.Columns = detector.Columns;
  mammogram.Rows = detector.Rows;
  mammogram.ColumnSpacingMm = Norm(detector.ColumnStep);
  mammogram.RowSpacingMm = Norm(detector.RowStep);
  const Vector3 normal = Cross(detector.ColumnStep, detector.RowStep);
  const double area = Norm(normal);
  const double product = mammogram.ColumnSpacingMm * mammogram.RowSpacingMm;
  // 1e-6: directions computed in float.
  if (!(product > 0) || std::abs(Dot(detector.ColumnStep, detector.RowStep)) > 1e-6 * product)
  {
    throw InputError("detector: expected columns and rows at right angles");
  }
  mammogram.RowDirection = PatientLetters(detector.ColumnStep, axes);
  mammogram.ColumnDirection = PatientLetters(detector.RowStep, axes);
  mammogram.Laterality = laterality;
  const Vector3 toSource = source.Type == XRaySource::Kind::Parallel
    ? -1.0 * source.Direction
    : source.Position - detector.Origin;
  const double height = Dot(toSource, normal) / area;
  if (source.Type == XRaySource::Kind::Point)
  {
    mammogram.SourceToDetectorMm = std::abs(height);
  }
  const Vector3 up = (height < 0 ? -1.0 : 1.0) * normal;
  const double roll =
    std::atan2(Dot(up, axes.Left), Dot(up, axes.Superior)) * 180 / std::numbers::pi;
  // 1e-9: rounding of a CC view.
  mammogram.PositionerPrimaryAngleDeg = std::abs(roll) < 1e-9 ? 0 : roll;
  mammogram.View = ViewOfRoll(roll, laterality);
  return mammogram;
}

void SetPixels(Mammogram& mammogram, const std::vector<float>& logAttenuation,
  Mammogram::Intent intent)
{
  const std::size_t pixelCount = CheckedPixelCount(mammogram, logAttenuation);
  const bool processing = intent == Mammogram::Intent::ForProcessing;
  mammogram.PresentationIntent = intent;
  mammogram.InvertedForDisplay = processing;
  mammogram.IntensityRelationship =
    processing ? Mammogram::Relationship::Linear : Mammogram::Relationship::Logarithmic;
  mammogram.IntensitySign = processing ? 1 : -1;
  mammogram.BitsStored = 16;
  mammogram.Pixels.resize(pixelCount);
  for (std::size_t pixel = 0; pixel < pixelCount; ++pixel)
  {
    const double value = logAttenuation[pixel];
    if (!std::isfinite(value))
    {
      throw InputError("mammogram: expected finite log attenuations, found another in pixel " +
        std::to_string(pixel));
    }
    const double stored = processing ? ProcessingValuesPerTransmission * std::exp(-value)
                                     : PresentationValuesPerLogAttenuation * value;
    mammogram.Pixels[pixel] = static_cast<float>(std::round(std::clamp(stored, 0.0, 65535.0)));
  }
}

void SetDisplayPixels(Mammogram& mammogram, const std::vector<float>& values)
{
  const std::size_t pixelCount = CheckedPixelCount(mammogram, values);
  mammogram.PresentationIntent = Mammogram::Intent::ForPresentation;
  mammogram.InvertedForDisplay = false;
  mammogram.IntensityRelationship = Mammogram::Relationship::Unknown;
  mammogram.IntensitySign = -1;
  mammogram.BitsStored = 12;
  mammogram.Pixels.resize(pixelCount);
  for (std::size_t pixel = 0; pixel < pixelCount; ++pixel)
  {
    if (!(values[pixel] >= 0 && values[pixel] <= 1))
    {
      throw InputError("mammogram: expected values of 0 to 1, found " +
        std::to_string(values[pixel]) + " in pixel " + std::to_string(pixel));
    }
    mammogram.Pixels[pixel] = std::round(4095 * values[pixel]);
  }
}

Mammogram DescribeMammogram(const Scene& scene, const SceneMammogram& of)
{
  Mammogram mammogram = DescribeProjection(scene.Source, scene.Detector, of.Axes, of.Laterality);
  mammogram.View = of.View.empty() ? mammogram.View : of.View;
  if (mammogram.View.empty())
  {
    throw InputError("expected View for a DICOM mammogram of this roll, found none", { "View" });
  }
  mammogram.BodyPartThicknessMm = of.ThicknessMm;
  mammogram.SourceToPatientMm = of.SourceToPatientMm;
  mammogram.PeakKilovoltage = scene.XRays.PeakEnergyKeV();
  return mammogram;
}

Mammogram MakeMammogram(const Exposure& exposure, const Scene& scene, const SceneMammogram& of)
{
  Mammogram mammogram = DescribeMammogram(scene, of);
  if (of.Display)
  {
    SetDisplayPixels(mammogram, DisplayValues(exposure, scene.Detector));
  }
  else
  {
    SetPixels(mammogram, exposure.LogAttenuation,
      of.ForProcessing ? Mammogram::Intent::ForProcessing : Mammogram::Intent::ForPresentation);
  }
  return mammogram;
}

std::string SyntheticDerivation(bool forProcessing, const std::string& what)
{
  char values[80];
  std::snprintf(values, sizeof values,
    forProcessing ? "Stored values are %.0f times the transmission."
                  : "Stored values are %.0f times the log attenuation.",
    forProcessing ? ProcessingValuesPerTransmission : PresentationValuesPerLogAttenuation);
  return "Synthetic X-ray image, computed by MammoRay " MAMMORAY_VERSION " from a mesh of " + what +
    "; not a radiograph. " + values;
}
}
