// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Mammogram_h
#define mammoray_Mammogram_h

#include "mammorayFoundationModule.h"

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace mammoray
{
/// A point of the receptor plane (z = 0 of the gantry frame): x and y, mm.
using ReceptorPoint = std::array<double, 2>;

/**
 * Grid of pixels in the receptor plane (z = 0 of the gantry frame).
 *
 * Pixel (column, row) has its centre at Origin + column * ColumnStep + row * RowStep, in mm; rows
 * follow one another in memory. The steps must be linearly independent.
 */
struct MAMMORAYFOUNDATION_EXPORT ReceptorGrid
{
  int Columns = 0;
  int Rows = 0;
  ReceptorPoint Origin{ 0, 0 };
  std::array<double, 2> ColumnStep{ 0.1, 0 };
  std::array<double, 2> RowStep{ 0, 0.1 };

  bool operator==(const ReceptorGrid&) const = default;

  /// Columns * Rows; 0 where either is not positive.
  std::size_t NumberOfPixels() const;
  /// Place of a pixel in arrays with one value per pixel.
  std::size_t Index(int column, int row) const
  {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(this->Columns) +
      static_cast<std::size_t>(column);
  }

  /// Lengths of the steps, mm.
  double ColumnSpacingMm() const;
  double RowSpacingMm() const;
  /// Area of a pixel, mm^2; 0 where the steps are dependent.
  double PixelAreaMm2() const;

  /// Position of a continuous pixel index; pixel centres are at whole numbers.
  ReceptorPoint PositionOf(double column, double row) const;
  /// Continuous column and row of a position: the inverse of PositionOf.
  std::array<double, 2> IndexOf(const ReceptorPoint& position) const;
  /// Whether a position lies on a pixel, at least `marginMm` away from the borders of the grid.
  bool Contains(const ReceptorPoint& position, double marginMm = 0) const;

  /// The grid of factor x factor pixels averaged into one; the rest at the far borders is dropped.
  ReceptorGrid Coarsened(int factor) const;
};

/// The pixels and the header fields of a mammogram, independent of the file format.
struct MAMMORAYFOUNDATION_EXPORT Mammogram
{
  enum class Intent
  {
    ForProcessing,
    ForPresentation
  };
  /// Relation of stored values to X-ray intensity (DICOM Pixel Intensity Relationship).
  enum class Relationship
  {
    Unknown, ///< not said, or made for display
    Linear,
    Logarithmic
  };

  int Columns = 0;
  int Rows = 0;
  /// Rows * Columns values, row by row from the top. The modality LUT (rescale) is applied;
  /// otherwise as stored. NaN marks declared padding, where no X-ray was measured.
  std::vector<float> Pixels;
  /// True for MONOCHROME1: small values are shown bright.
  bool InvertedForDisplay = false;
  Intent PresentationIntent = Intent::ForPresentation;
  Relationship IntensityRelationship = Relationship::Unknown;
  /// Pixel Intensity Relationship Sign: +1 if larger values mean more X-ray intensity behind the
  /// breast, -1 if less, 0 if unknown.
  int IntensitySign = 0;
  /// Bits per stored value, 1 to 16 (32 in rare files).
  int BitsStored = 16;
  /// Distance between neighbouring columns and rows in the receptor plane, mm.
  double ColumnSpacingMm = 0.1;
  double RowSpacingMm = 0.1;
  /// View: "CC", "MLO", "ML", ...; empty if the header lacks it.
  std::string View;
  /// 'L', 'R', or '?' if unknown.
  char Laterality = '?';
  /// Patient directions of increasing column and of increasing row, as in the header ("A", "P",
  /// "R", ...); empty if it lacks them.
  std::string RowDirection;
  std::string ColumnDirection;
  std::optional<double> BodyPartThicknessMm;
  std::optional<double> PositionerPrimaryAngleDeg;
  std::optional<double> SourceToDetectorMm;
  std::optional<double> SourceToPatientMm;
  /// Continuous column and row of the pixel vertically below the focal spot, which lies
  /// SourceToDetectorMm above it. Set for the projections of a tomosynthesis; otherwise the middle
  /// of the chest-wall edge is assumed.
  std::optional<std::array<double, 2>> SourceFootPixel;
  std::optional<double> PeakKilovoltage;
  std::string AnodeMaterial;
  std::string FilterMaterial;
};

/// The part of a DICOM header that pictures and digitised films lack.
struct PictureDescription
{
  /// Distance of pixel centres at the receptor, mm.
  std::optional<double> PixelSpacingMm;
  /// "CC", "MLO", ...; "" if unknown.
  std::string View;
  /// 'L', 'R' or '?'.
  char Laterality = '?';
  /// Distance of the plates, mm. Not needed; a refusal asks for it along with what is.
  std::optional<double> ThicknessMm;
};

/// "left" for 'L', "right" for 'R', else "unnamed".
MAMMORAYFOUNDATION_EXPORT std::string SideName(char laterality);

/**
 * Nominal rotation of the unit for the mammogram's view, degrees, with the sign of
 * BreastPose::RollDeg. It is 0 for CC; the source is medial and above for MLO and ML, lateral for
 * LM and LMO, below for FB. Oblique views use the magnitude of PositionerPrimaryAngleDeg, or 45 if
 * that is absent or 0. No value for other views, or if the view needs an unknown laterality.
 */
MAMMORAYFOUNDATION_EXPORT std::optional<double> NominalRollDeg(const Mammogram& mammogram);
}

#endif
