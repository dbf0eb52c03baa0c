// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_TwinExperiment_h
#define mammoray_TwinExperiment_h

#include "mammoray/Foundation/LabelVolume.h"
#include "mammoray/Foundation/MaterialTable.h"
#include "mammoray/Foundation/Progress.h"
#include "mammoray/Registration/Registration.h"
#include "mammoray/Registration/RegistrationTarget.h"
#include "mammorayEvidenceModule.h"

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace mammoray
{
/// What a twin experiment makes hard beside the differences that all have (see TwinExperiment).
enum class TwinKind
{
  /// The start is off as a header is: thickness by up to 3 mm, roll by up to 10 degrees, shifts
  /// unknown, pitch and yaw by up to 5 degrees, tilt by up to 2.
  Plain,
  /// The target's fat is 1.5 times as stiff as the model's.
  WrongMaterial,
  /// The start is off by 5 mm, 20 degrees and, each way, 15 mm.
  WrongStart,
  /// Pitch, yaw, tilt and the stiffness of gland are off, and all to be found.
  EveryParameter,
  // Wrong pairs, else as Plain: what is registered is not what was pictured.
  /// Another phantom's breast, made as large.
  OtherBreast,
  /// The mirror image: a patient's other breast.
  OtherSide,
  /// 0.85 (even numbers) or 1.2 times as large in each direction.
  WrongSize,
  /// A segmentation that lost the front (even numbers) or the upper quarter of the breast.
  LostTissue,
  /// A header that says 15 mm more (even numbers) or less.
  WrongThickness,
  /// A mammogram that shows a half of the breast, the one of larger (even numbers) or smaller x.
  HalfPicture
};

inline constexpr std::array<TwinKind, 4> RightTwins{ TwinKind::Plain, TwinKind::WrongMaterial,
  TwinKind::WrongStart, TwinKind::EveryParameter };
inline constexpr std::array<TwinKind, 6> WrongPairs{ TwinKind::OtherBreast, TwinKind::OtherSide,
  TwinKind::WrongSize, TwinKind::LostTissue, TwinKind::WrongThickness, TwinKind::HalfPicture };

/// Whether it is one of WrongPairs.
MAMMORAYEVIDENCE_EXPORT bool IsWrongPair(TwinKind kind);

/// "plain", "wrong-material", "wrong-start", "every-parameter", "other-breast", "other-side",
/// "wrong-size", "lost-tissue", "wrong-thickness", "half-picture".
MAMMORAYEVIDENCE_EXPORT const char* NameOf(TwinKind kind);

/// As what kind of picture a unit stores the target, for each of which `--residual` may serve
/// better or worse.
enum class PictureKind
{
  /// For Presentation: logarithm, then a sigmoid.
  Display,
  /// For Presentation, as vendors even pictures out: of what varies over more than 12 mm within the
  /// breast 0.7 are taken off before the sigmoid.
  Equalised,
  /// For Processing: intensities.
  Raw,
  /// For Processing with a tube's heel, which takes 20 % of the intensity towards the nipple, and
  /// scatter: half of the primary radiation behind the breast, spread over 15 mm. (Boone 2000: 0.3
  /// to 1 without a grid.)
  Scattered
};

inline constexpr std::array<PictureKind, 4> PictureKinds{ PictureKind::Display,
  PictureKind::Equalised, PictureKind::Raw, PictureKind::Scattered };

/// "display", "equalised", "raw", "scattered".
MAMMORAYEVIDENCE_EXPORT const char* NameOf(PictureKind kind);

enum class TwinSearch
{
  /// As `mammoray register`, with its starts and resolutions.
  Register,
  /// From the start alone and at the finest resolution, to compare searches: with exact
  /// derivatives, with Ceres' central differences, and simulated annealing.
  Exact,
  CentralDifferences,
  Annealing
};

/// "register", "exact", "central-differences", "annealing".
MAMMORAYEVIDENCE_EXPORT const char* NameOf(TwinSearch search);

/// A truth and a mammogram of it.
struct TwinProblem
{
  TwinKind Kind = TwinKind::Plain;
  int Number = 0;
  /// All ParameterCount, in their order.
  std::vector<double> Truth;
  RegistrationTarget Target;
  /// Bounds, priors and what is free, around the start.
  std::vector<RegistrationParameter> Parameters;
  /// Points of the imaged tissue at rest, 3 x pointCount, frame of the model's volume, mm, and
  /// where the truth has them, gantry frame. None where the model is of another breast.
  std::vector<double> Points;
  std::vector<Vector3> TruePositions;
  /// Truths drawn before this one that the target's mechanics could not reach.
  int Redrawn = 0;
};

/// What a search made of a problem.
struct TwinRun
{
  std::string Phantom;
  std::string Kind;
  std::string Search;
  int Number = 0;
  int Redrawn = 0;
  /// Of the meshes for the mechanics.
  std::size_t ModelCells = 0;
  std::size_t TargetCells = 0;
  std::vector<std::string> Names;
  std::vector<double> Truth;
  std::vector<double> Start;
  std::vector<double> Found;
  /// NaN where fixed or unknown.
  std::vector<double> Sigma;
  /// Median and largest distance of the points from where the truth has them, gantry frame, mm;
  /// NaN where the search found nothing.
  double MedianErrorMm = 0;
  double LargestErrorMm = 0;
  /// Of the points' coordinates in the gantry frame the share that is within two of their standard
  /// deviations of the truth (ImagedPoint::Covariance); NaN where there are none.
  double CoordinatesWithin = 0;
  double MeanOutlineMm = 0;
  double LargestOutlineMm = 0;
  double Correlation = 0;
  double TissueCorrelation = 0;
  /// "good", "doubtful" or "none": what a report says of it, the start being its header's, and why.
  std::string Trust;
  std::vector<std::string> Reasons;
  int Iterations = 0;
  int Equilibria = 0;
  double Seconds = 0;
  /// Time since the search began and cost after each iteration.
  std::vector<double> IterationSeconds;
  std::vector<double> IterationCosts;
  bool Converged = false;
  std::string StopReason;
};

struct TwinOptions
{
  /// Edge of a cube as large as the breast over the cells of the mechanics: of the model (quadratic
  /// elements; 0: as a registration makes them), of the target (linear ones).
  double ModelFineness = 0.0;
  double TargetFineness = 14.5;
  /// Upper bounds of the cells of the pictured anatomy, mm.
  double ModelAnatomyMm = 4.0;
  double TargetAnatomyMm = 5.5;
  /// Pixels of the target, mm, and standard deviation of its intensities' noise, of the intensity.
  double PixelMm = 0.4;
  double Noise = 0.02;
  PictureKind Picture = PictureKind::Display;
  std::string ModelSpectrum = "W28kVp_Rh50um_Be1mm";
  std::string TargetSpectrum = "W30kVp_Rh50um_Be1mm";
  int NumberOfPoints = 100;
  std::uint32_t Seed = 1;
  /// Of the searches; their parameters are filled in.
  RegistrationOptions Registration;
};

/**
 * Registers one phantom to mammograms of itself whose truth is known. The target shares nothing
 * with the model but the label volume: it is compressed on another mesh with the other element type
 * (patch-averaged linear), pictured from another mesh of the anatomy with another spectrum and
 * noise, stored in 12 bits as TwinOptions::Picture says, and outlined as a real mammogram.
 * Meshes are made once. Truths are drawn over: thickness 0.52 to 0.72 of the breast's height, roll
 * 30 degrees and lateral 15 mm to both sides, anterior 0 to 15 mm, pitch and yaw 5, tilt 2 degrees
 * to both sides; with TwinKind::EveryParameter pitch and yaw 10, tilt 4 degrees, and stiffness 0.5
 * to 2. The same numbers give the same truth in every other kind.
 */
class MAMMORAYEVIDENCE_EXPORT TwinExperiment
{
public:
  /// `materials`: indices of `table`; `other`: those of the breast of TwinKind::OtherBreast, in
  /// another frame of the same axes. Throws InputError, DeviceError, Interrupted.
  TwinExperiment(const std::string& phantom, const LabelVolume& materials,
    const MaterialTable& table, const AnatomicalAxes& axes, const TwinOptions& options,
    const ProgressCallback& progress = {}, const LabelVolume* other = nullptr);
  ~TwinExperiment();

  /// Number 0, 1, ... of a kind. Throws ConvergenceError where ten truths in turn could not be
  /// reached, and InputError where a wrong pair is refused.
  TwinProblem Draw(TwinKind kind, int number, const ProgressCallback& progress = {});

  /// `budget`: equilibria, for annealing. Throws as Register; Interrupted also during the search.
  TwinRun Run(const TwinProblem& problem, TwinSearch search, int budget = 0,
    const ProgressCallback& progress = {});

private:
  struct Internals;
  std::unique_ptr<Internals> Internal;
};
}

#endif
