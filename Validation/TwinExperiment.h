// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Validation_TwinExperiment_h
#define mammoray_Validation_TwinExperiment_h

#include "SimulatedMammogram.h"
#include "mammoray/Foundation/MaterialTable.h"
#include "mammoray/Foundation/Progress.h"
#include "mammoray/Foundation/Volumes.h"
#include "mammoray/Registration/Registration.h"
#include "mammoray/Registration/RegistrationTarget.h"

#include <nlohmann/json_fwd.hpp>

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace mammoray
{
/// What makes a twin experiment harder than the differences that all of them have (see
/// TwinExperiment).
enum class TwinKind
{
  /// The start differs as a header may: thickness by up to 3 mm, roll by up to 10 degrees, unknown
  /// shifts, pitch and yaw by up to 5 degrees, tilt by up to 2.
  Plain,
  /// The target's fat is 1.5 times as stiff as the model's.
  WrongMaterial,
  /// The start is off by 5 mm in thickness, 20 degrees in roll and 15 mm in each shift.
  WrongStart,
  /// Pitch, yaw, tilt and the stiffness of gland differ more, and all of them are free.
  EveryParameter,
  // Wrong pairs, otherwise as Plain: the registered breast is not the one in the picture.
  /// The breast of another phantom, scaled to the same volume.
  OtherBreast,
  /// The mirror image, as the patient's other breast.
  OtherSide,
  /// Scaled by 0.85 (even numbers) or 1.2 (odd numbers) in each direction.
  WrongSize,
  /// A segmentation that lost the front (even numbers) or the upper quarter of the breast.
  LostTissue,
  /// A header whose thickness is 15 mm too large (even numbers) or too small.
  WrongThickness,
  /// A mammogram that shows only the half of larger (even numbers) or smaller x.
  HalfPicture
};

inline constexpr std::array<TwinKind, 4> RightTwins{ TwinKind::Plain, TwinKind::WrongMaterial,
  TwinKind::WrongStart, TwinKind::EveryParameter };
inline constexpr std::array<TwinKind, 6> WrongPairs{ TwinKind::OtherBreast, TwinKind::OtherSide,
  TwinKind::WrongSize, TwinKind::LostTissue, TwinKind::WrongThickness, TwinKind::HalfPicture };

bool IsWrongPair(TwinKind kind);

/// "plain", "wrong-material", "wrong-start", "every-parameter", "other-breast", "other-side",
/// "wrong-size", "lost-tissue", "wrong-thickness", "half-picture".
const char* NameOf(TwinKind kind);

enum class TwinSearch
{
  /// As `mammoray register`, with its starts and resolutions.
  Register,
  /// For comparing searches, each from the start alone, at the finest resolution and with globally
  /// normalised pictures, whose cost is one quantity from the first to the last iteration: exact
  /// derivatives, central differences, simulated annealing.
  Exact,
  CentralDifferences,
  Annealing
};

/// "register", "exact", "central-differences", "annealing".
const char* NameOf(TwinSearch search);

/// A truth and a mammogram of it.
struct TwinProblem
{
  TwinKind Kind = TwinKind::Plain;
  int Number = 0;
  /// ParameterCount values, in the order of PoseParameters.
  std::vector<double> Truth;
  RegistrationTarget Target;
  /// Bounds, priors and which parameters are free, around the start.
  std::vector<RegistrationParameter> Parameters;
  /// Points of the imaged tissue, 3 x pointCount, mm, at rest in the frame of the model's volume;
  /// and their true positions in the gantry frame. Empty if the model is of another breast.
  std::vector<double> Points;
  std::vector<Vector3> TruePositions;
  /// Number of truths drawn before this one that the target's mechanics could not reach.
  int Redrawn = 0;
};

struct TwinOptions
{
  /// Edge of a cube with the breast's volume over the cell size of the mechanics: of the model
  /// (quadratic elements; 0: the registration's default), and of the target (linear elements).
  double ModelFineness = 0.0;
  double TargetFineness = 14.5;
  /// Upper bounds of the cell sizes of the X-rayed anatomy, mm.
  double ModelAnatomyMm = 4.0;
  double TargetAnatomyMm = 5.5;
  /// Pixel size of the target, mm; standard deviation of its noise relative to the intensity.
  double PixelMm = 0.4;
  double Noise = 0.02;
  PictureKind Picture = PictureKind::Display;
  std::string ModelSpectrum = "W28kVp_Rh50um_Be1mm";
  std::string TargetSpectrum = "W30kVp_Rh50um_Be1mm";
  int NumberOfPoints = 100;
  std::uint32_t Seed = 1;
  /// Of the searches; Parameters are filled in.
  RegistrationOptions Registration;
};

/**
 * Registers a phantom to mammograms of itself whose truth is known. The target shares only the
 * label volume with the model: it is compressed on another mesh with the other element type
 * (patch-averaged linear), X-rayed from another mesh of the anatomy with another spectrum and with
 * noise, stored in 12 bits as TwinOptions::Picture, and outlined like a real mammogram.
 *
 * Truths are drawn uniformly: thickness 0.52 to 0.72 of the breast's height, roll within 30
 * degrees, lateral shift within 15 mm, anterior 0 to 15 mm, pitch and yaw within 5 and tilt within
 * 2 degrees; for TwinKind::EveryParameter pitch and yaw within 10 and tilt within 4 degrees, and
 * stiffness 0.5 to 2 (log-uniform). A number gives the same truth in every other kind, and on every
 * machine.
 */
class TwinExperiment
{
public:
  /// `materials`: indices of `table`; `other`: those of the breast for TwinKind::OtherBreast, in a
  /// frame with the same axes. Throws InputError, DeviceError, Interrupted.
  TwinExperiment(const std::string& phantom, const LabelVolume& materials,
    const MaterialTable& table, const AnatomicalAxes& axes, const TwinOptions& options,
    const ProgressCallback& progress = {}, const LabelVolume* other = nullptr);
  ~TwinExperiment();

  /// Problem 0, 1, ... of a kind. Throws ConvergenceError if ten truths in turn could not be
  /// reached, and InputError if a wrong pair is refused.
  TwinProblem Draw(TwinKind kind, int number, const ProgressCallback& progress = {});

  /**
   * Runs a search and gives what ValidationFile keeps of it: kind, search and number, truth, start,
   * found values and standard deviations by parameter, errors of the points in the gantry frame
   * (mm), similarity, trust, iterations with times and costs. `budget`: number of equilibria for
   * annealing. Throws as Register, and Interrupted during the search, too.
   */
  nlohmann::json Run(const TwinProblem& problem, TwinSearch search, int budget = 0,
    const ProgressCallback& progress = {});

private:
  struct Internals;
  std::unique_ptr<Internals> Internal;
};

/// The same of a problem that could not be drawn or searched: nothing found, no trust.
nlohmann::json FailedTwin(const std::string& phantom, TwinKind kind, TwinSearch search, int number,
  const std::string& reason);
}

#endif
