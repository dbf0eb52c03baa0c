// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_LandmarkEvaluation_h
#define mammoray_LandmarkEvaluation_h

#include "mammoray/Foundation/MammographyGeometry.h"
#include "mammorayStudyModule.h"

#include <string>
#include <vector>

class vtkUnstructuredGrid;

namespace mammoray
{
/// A point known in the uncompressed and in the compressed breast.
struct Landmark
{
  /// In the frame of the label volume, mm.
  Vector3 Uncompressed{ 0, 0, 0 };
  /// In the frame of the truth, mm.
  Vector3 Compressed{ 0, 0, 0 };
  /// True if it is between the plates, so that the mammogram shows it.
  bool Imaged = true;
};

/**
 * Reads a CSV file with the header ux,uy,uz,cx,cy,cz[,imaged] (mm). Throws InputError that names
 * file and line.
 */
MAMMORAYSTUDY_EXPORT std::vector<Landmark> ReadLandmarks(const std::string& path);

/// Median, mean and largest of some errors, mm.
struct ErrorSummary
{
  int Count = 0;
  double Median = 0;
  double Mean = 0;
  double Largest = 0;
};
MAMMORAYSTUDY_EXPORT ErrorSummary Summarise(std::vector<double> errors);

/// The quantile of values for `part` in [0, 1], linear between them; NaN without values.
MAMMORAYSTUDY_EXPORT double Quantile(std::vector<double> values, double part);

/**
 * Moves points by the point array "Displacement" (mm) of a body of linear tetrahedra, interpolated
 * in the cell that contains or is nearest to each. Throws InputError without that array and on
 * other cells.
 */
MAMMORAYSTUDY_EXPORT std::vector<Vector3> Displace(const std::vector<Vector3>& points,
  vtkUnstructuredGrid* body);

/// Distances of points from their true places in one mammogram, one entry for each point, mm.
struct MAMMORAYSTUDY_EXPORT PointErrors
{
  /// In the gantry frame. Empty for a method that does not find the depth.
  std::vector<double> InSpaceMm;
  /// On the receptor, between the shadows.
  std::vector<double> OnReceptorMm;
  /// Along gantry z, nearly the direction of the beam, in which positions are least determined.
  std::vector<double> AlongBeamMm;

  /// `error`: found position less the true one, gantry frame, mm.
  void Add(const Vector3& error, double onReceptorMm);
};

/// Errors of one method that predicts the compressed landmarks.
struct LandmarkErrors
{
  std::string Method;
  /// At the landmarks that the mammogram shows, and at all landmarks.
  PointErrors Imaged;
  PointErrors All;
};

/// The true unit: its placement in the truth's frame, and the distance of its focal spot.
struct LandmarkTruth
{
  VolumeFromGantry Placed;
  double SourceToDetectorMm = 650;
};

/**
 * Distances between two readers' marks of the same landmarks, in the same order, mm: in the
 * uncompressed breast, in the compressed one, and on the receptor of `truth`. They limit how
 * accurately any method can be measured. DistancesBetween throws InputError if the numbers of marks
 * differ.
 */
struct ReaderDistances
{
  std::vector<double> Uncompressed;
  std::vector<double> Compressed;
  std::vector<double> OnReceptor;
};
MAMMORAYSTUDY_EXPORT ReaderDistances DistancesBetween(const std::vector<Landmark>& first,
  const std::vector<Landmark>& second, const LandmarkTruth& truth);

/**
 * Errors of the identity, of the best rigid motion (fitted to the truth itself, over the imaged
 * landmarks and over all), and of a registration. `uncompressed` is the uncompressed body with the
 * point array "Displacement" (mm); `registered` and `registeredUnit`: the unit and its placement
 * in the frame of the label volume, by the registration. Errors are measured in the gantry frame,
 * so that they contain the deformation's and the pose's share. Throws InputError.
 */
MAMMORAYSTUDY_EXPORT std::vector<LandmarkErrors> EvaluateLandmarks(
  const std::vector<Landmark>& landmarks, const LandmarkTruth& truth,
  vtkUnstructuredGrid* uncompressed, const VolumeFromGantry& registered,
  const MammographyUnit& registeredUnit);
}

#endif
