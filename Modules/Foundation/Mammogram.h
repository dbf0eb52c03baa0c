// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Mammogram_h
#define mammoray_Mammogram_h

#include "mammorayFoundationModule.h"

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace mammoray
{
/// What a mammogram's header says and its pixels, free of the file format.
struct MAMMORAYFOUNDATION_EXPORT Mammogram
{
  enum class Intent
  {
    ForProcessing,
    ForPresentation
  };
  /// How stored values follow X-ray intensity (DICOM Pixel Intensity Relationship).
  enum class Relationship
  {
    Unknown, ///< not said, or made for display
    Linear,
    Logarithmic
  };

  int Columns = 0;
  int Rows = 0;
  /**
   * Rows * Columns values, row by row from the top. Modality LUT (rescale) applied; as stored
   * otherwise. NaN where the header declares padding (no X-ray was measured there).
   */
  std::vector<float> Pixels;
  /// True for MONOCHROME1: small values are shown bright.
  bool InvertedForDisplay = false;
  Intent PresentationIntent = Intent::ForPresentation;
  Relationship IntensityRelationship = Relationship::Unknown;
  /// +1: larger values mean more X-ray intensity behind the breast; -1: less; 0: not said.
  int IntensitySign = 0;
  /// Bits per stored value, 1 to 16 (32 in rare files).
  int BitsStored = 16;
  /// Distance of neighbouring columns and rows at the image receptor, mm.
  double ColumnSpacingMm = 0.1;
  double RowSpacingMm = 0.1;
  /// "CC", "MLO", "ML", ...; empty where the header does not say.
  std::string View;
  /// 'L', 'R' or '?'.
  char Laterality = '?';
  /// Patient directions of a row (increasing column) and of a column (increasing row), as in the
  /// header ("A", "P", "R", ...);
  /// empty where it does not say.
  std::string RowDirection;
  std::string ColumnDirection;
  std::optional<double> BodyPartThicknessMm;
  std::optional<double> PositionerPrimaryAngleDeg;
  std::optional<double> SourceToDetectorMm;
  std::optional<double> SourceToPatientMm;
  /// Continuous column and row of the pixel under the focal spot, SourceToDetectorMm above it: of
  /// the projections of a tomosynthesis. Nothing: the middle of the chest-wall edge.
  std::optional<std::array<double, 2>> SourceFootPixel;
  std::optional<double> PeakKilovoltage;
  std::string AnodeMaterial;
  std::string FilterMaterial;
};

/**
 * Rotation of the unit for a view, degrees, in the sense of BreastPose::RollDeg: 0 for CC, the
 * source medial and above for MLO and ML, lateral for LM and LMO, below for FB. Oblique views take
 * the size of PositionerPrimaryAngleDeg, 45 where it is absent or 0. Nothing when the view is not
 * one of these, or needs a laterality that is not known.
 */
MAMMORAYFOUNDATION_EXPORT std::optional<double> NominalRollDeg(const Mammogram& mammogram);
}

#endif
