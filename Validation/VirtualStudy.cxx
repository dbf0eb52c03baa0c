// SPDX-License-Identifier: Apache-2.0
#include "VirtualStudy.h"

#include "PatientTissue.h"
#include "SimulatedMammogram.h"
#include "VirtualStudyFiles.h"
#include "mammoray/Biomechanics/Embedding.h"
#include "mammoray/Biomechanics/Plates.h"
#include "mammoray/Dicom/DicomWriter.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/LabelEditing.h"
#include "mammoray/IO/AtomicFile.h"
#include "mammoray/IO/ShippedData.h"
#include "mammoray/Meshing/LabelMesher.h"
#include "mammoray/Registration/BreastModel.h"
#include "mammoray/Registration/PosedBreast.h"
#include "mammoray/Registration/RegistrationResult.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

namespace mammoray
{
namespace
{
/// All of a study is in DICOM LPS.
const AnatomicalAxes PatientAxes = AnatomicalAxes::FromCode("LPS");

constexpr int LargestNumberOfTries = 3;
constexpr double ClosingFactor = 0.85;
/// Part of the points that a technologist wants in the picture.
constexpr double ImagedPart = 0.86;
/// The receptor's edge against the front of the chest wall, mm. Behind it the plates press the
/// body above and below the breast along the ribs, which nobody does.
constexpr double DeepestAnteriorMm = -3;
/// The plates never close further than this part of the breast's height.
constexpr double LeastPartOfHeight = 0.4;

std::vector<Vector3> AsPoints(const std::vector<double>& flat)
{
  std::vector<Vector3> points;
  for (std::size_t index = 0; index < flat.size(); index += 3)
  {
    points.push_back({ flat[index], flat[index + 1], flat[index + 2] });
  }
  return points;
}

/// The breast and its true mechanics.
struct TrueBreast
{
  /// The phantom alone, and with what goes on around it.
  LabelVolume Phantom;
  LabelVolume Rest;
  MaterialTable Table;
  std::vector<double> Factors;
  ChestCurve Curve;
  double OffMm = 0;
  /// Stiffness of the wall against gliding, kPa / mm.
  double GlideStiffness = 0;

  CompressionOptions Loading(PatientPosition position) const
  {
    CompressionOptions options;
    options.ChestWall = ChestWallMode::Elastic;
    options.Wall.Tangential = this->GlideStiffness;
    options.GravityMPerS2 = GravityIn(position, PatientAxes);
    return options;
  }
};

TrueBreast MakeBreast(const LabelVolume& materials, const MaterialTable& table,
  const AnatomicalAxes& axes, const VirtualStudyOptions& options, Draws& draws)
{
  TrueBreast breast;
  breast.Table = table;
  for (Material& material : breast.Table.Materials)
  {
    const bool soft = !material.Fixed && !material.Attenuation.empty();
    // Of each twice and half are as likely.
    breast.Factors.push_back(soft ? std::exp2(draws.Between(-1, 1)) : 1);
    material.YoungsModulusKPa *= breast.Factors.back();
  }
  // The weight of a breast of 0.4 kg on a base of 80 cm^2 shears it by 0.5 kPa: it glides 8 to 33
  // mm when she stands up, the order of what is seen between lying and standing.
  breast.GlideStiffness = 0.03 * std::exp2(draws.Between(-1, 1));
  breast.OffMm = OffMidlineMm(materials, axes);
  breast.Curve.RadiusMm = draws.Between(400, 700);
  breast.Phantom =
    PlaceOnChest(materials, table, axes, options.Laterality, breast.OffMm, breast.Curve);
  breast.Rest = options.ChestAroundMm > 0
    ? SurroundByChest(breast.Phantom, table, breast.Curve,
        WallThicknessMm(breast.Phantom, table.Fixed()), options.ChestAroundMm)
    : breast.Phantom;
  if (const std::vector<int> thin = table.Thin(); !thin.empty())
  {
    // Resampling tears layers of a voxel or two. Breast skin is 0.8 to 3 mm thick, 1.5 on average
    // (Huang 2008).
    const double thickness = std::max(1.5, 1.01 * breast.Rest.Spacing[0]);
    breast.Rest = AddSkin(breast.Rest, thickness, thin.front(), table.Fixed());
  }
  return breast;
}

/// Moves the stress-free breast to its equilibrium under gravity alone.
class HangingBreast
{
public:
  HangingBreast(const TrueBreast& breast, const VirtualStudyOptions& options,
    PatientPosition position, const ProgressCallback& progress)
    : Model(MeshFor(breast, options, progress), breast.Table,
        { .Volume = breast.Rest, .Compression = breast.Loading(position) }, progress)
  {
    const UnitPlacement placement{ FindPoseFrame(breast.Rest, breast.Table.Fixed(), PatientAxes),
      {} };
    // Plates that touch nothing.
    BreastPose open;
    open.ThicknessMm = 400;
    CompressionSimulation& simulation = this->Model.Body().Simulation();
    this->State = simulation.Compress(placement.PlatesAt(open), nullptr, progress,
      CompressionSimulation::Refusal::AtOnce);
  }

  std::vector<double> Move(const std::vector<double>& points) const
  {
    return Embedding(this->Model.Body().Simulation(), points).Map(this->State.Positions);
  }

private:
  static TetrahedralMesh MeshFor(const TrueBreast& breast, const VirtualStudyOptions& options,
    const ProgressCallback& progress)
  {
    return MakeSimulationMesh(breast.Rest, breast.Table.Fixed(),
      CubeEdgeMm(breast.Phantom) / options.GravityFineness, progress);
  }

  BreastModel Model;
  CompressionState State;
};

/// The same breast between plates.
class PressedBreast
{
public:
  PressedBreast(const TrueBreast& breast, const VirtualStudyOptions& options,
    const ProgressCallback& progress)
    // Specks of gland that no facet of this size can bound become part of their surroundings.
    : Options(options)
    , Model(MeshAnatomy(breast.Rest, breast.Table, options.AnatomyMm, 30, progress), breast.Table,
        { .Volume = breast.Rest,
          .SimulationMesh = MakeSimulationMesh(breast.Rest, breast.Table.Fixed(),
            CubeEdgeMm(breast.Phantom) / options.CompressionFineness, progress),
          .Compression = breast.Loading(PatientPosition::Upright),
          .Predicted = true },
        progress)
    , Placement{ FindPoseFrame(breast.Rest, breast.Table.Fixed(), PatientAxes), {} }
  {
    this->Model.SetXRays(ExtractInterfaces(this->Model.Anatomy()), MakeProjector(),
      MakeBeam(breast.Table, FindSpectrum(options.Spectrum), DetectorResponse::EnergyIntegrating));
  }

  /// Projections of the CC, once it is taken; empty unless the options ask for them.
  std::vector<Mammogram> Projections;

  /// Finds the view's pose by the faster mechanics, compresses there, less if that has no
  /// equilibrium, and takes the mammogram.
  std::pair<TrueView, Mammogram> Take(const std::string& view, const TrueBreast& breast,
    const std::vector<double>& points, Draws& draws, const ProgressCallback& progress)
  {
    TrueView taken;
    taken.View = view;
    taken.Unit = this->Placement.Unit;
    // Lateral or head up, the left breast's chest wall on the left.
    const bool left = this->Options.Laterality == 'L';
    const bool oblique = view == "MLO";
    Mammogram hung{ .View = view,
      .Laterality = this->Options.Laterality,
      .RowDirection = left ? "A" : "P",
      .ColumnDirection = oblique ? "F"
        : left                   ? "R"
                                 : "L",
      .AnodeMaterial = "TUNGSTEN",
      .FilterMaterial = "RHODIUM" };
    hung.PositionerPrimaryAngleDeg = oblique ? draws.Between(40, 55) : draws.Between(-3, 3);
    taken.Pose = this->DrawPose(hung, breast, draws);
    const double front = taken.Pose.AnteriorMm;
    for (int attempt = 1;; ++attempt)
    {
      try
      {
        CompressionState state =
          this->Model.Predictor()->Compress(this->Placement, taken.Pose, nullptr, progress);
        this->CloseFirmly(breast, taken.Pose, state, progress);
        this->PullOnto(points, taken.Pose, state, progress);
        state = this->CloseAnew(front, taken.Pose, progress);
        this->Centre(points, state, taken.Pose);
        return { taken, this->Picture(hung, state, points, taken, draws) };
      }
      catch (const ConvergenceError&)
      {
        if (attempt == LargestNumberOfTries)
        {
          throw;
        }
        taken.Pose.ThicknessMm *= 1.12;
      }
    }
  }

private:
  BreastPose DrawPose(const Mammogram& hung, const TrueBreast& breast, Draws& draws) const
  {
    BreastPose pose;
    // The unit stands where the header says to a few degrees, and the patient not quite straight.
    pose.RollDeg = hung.View == "CC" ? *hung.PositionerPrimaryAngleDeg + draws.Between(-3, 3)
                                     : *NominalRollDeg(hung) + draws.Between(-5, 5);
    pose.PitchDeg = draws.Between(-3, 3);
    pose.YawDeg = draws.Between(-3, 3);
    pose.LateralMm = draws.Between(-10, 10);
    pose.AnteriorMm = draws.Between(0, 8);
    pose.VerticalMm = draws.Between(-8, 8);
    pose.TiltDeg = 2;
    const VolumeFromGantry placed = this->Placement.At(pose);
    pose.ThicknessMm = draws.Between(0.48, 0.65) * HeightBetweenPlates(breast, placed);
    return pose;
  }

  /// Closes the plates until the paddle presses as in clinics, or as far as there is an
  /// equilibrium.
  void CloseFirmly(const TrueBreast& breast, BreastPose& pose, CompressionState& state,
    const ProgressCallback& progress)
  {
    const double least = LeastPartOfHeight * HeightBetweenPlates(breast, this->Placement.At(pose));
    while (
      state.PaddleForceN < this->Options.LeastForceN && ClosingFactor * pose.ThicknessMm > least)
    {
      BreastPose closer = pose;
      closer.ThicknessMm *= ClosingFactor;
      if (!this->TryPose(closer, &state, pose, state, progress))
      {
        return;
      }
    }
  }

  /// Moves the unit towards the chest wall until most of the points are imaged, as a technologist
  /// pulls the breast onto the support until the muscle shows; as far as there is an equilibrium.
  void PullOnto(const std::vector<double>& points, BreastPose& pose, CompressionState& state,
    const ProgressCallback& progress)
  {
    for (double behind = this->LeastImagedMm(points, pose, state);
         behind < 0 && pose.AnteriorMm > DeepestAnteriorMm;
         behind = this->LeastImagedMm(points, pose, state))
    {
      BreastPose deeper = pose;
      deeper.AnteriorMm = std::max(DeepestAnteriorMm, pose.AnteriorMm + behind - 0.5);
      if (!this->TryPose(deeper, &state, pose, state, progress) &&
        !this->TryPose(deeper, nullptr, pose, state, progress))
      {
        return;
      }
    }
  }

  /// Closes open plates at the pose that was found, as a unit does. A breast that was pulled and
  /// pressed in turns can have ended in another equilibrium: two large ones lay 8 and 13 mm away.
  /// Where there is none, the plates stand farther from the chest wall, at most at `front`.
  CompressionState CloseAnew(double front, BreastPose& pose, const ProgressCallback& progress)
  {
    for (;; pose.AnteriorMm = std::min(front, pose.AnteriorMm + 1))
    {
      try
      {
        return this->Model.Body().Compress(this->Placement, pose, nullptr, progress);
      }
      catch (const ConvergenceError&)
      {
        if (pose.AnteriorMm >= front)
        {
          throw;
        }
      }
    }
  }

  /// Where these points lie between the plates in a state of a body.
  static std::vector<Vector3> Moved(const std::vector<double>& points, const BreastBody& body,
    const CompressionState& state)
  {
    return AsPoints(Embedding(body.Simulation(), points).Map(state.Positions));
  }

  /// Centres the breast on the receptor, as far off as the pose was drawn. Plates without friction
  /// are the same all along their edges.
  void Centre(const std::vector<double>& points, const CompressionState& state, BreastPose& pose)
  {
    const std::vector<Vector3> moved = Moved(points, this->Model.Body(), state);
    BreastPose middle = pose;
    middle.LateralMm = 0;
    const VolumeFromGantry placed = this->Placement.At(middle);
    for (const Vector3& point : moved)
    {
      pose.LateralMm += placed.ToGantry(point)[0] / static_cast<double>(moved.size());
    }
  }

  /// Moves the plates to a pose, from a state or, without one, by a cold start. Returns false and
  /// leaves `pose` and `state` if there is no equilibrium.
  bool TryPose(const BreastPose& next, const CompressionState* from, BreastPose& pose,
    CompressionState& state, const ProgressCallback& progress)
  {
    try
    {
      CompressionState found =
        this->Model.Predictor()->Compress(this->Placement, next, from, progress);
      state = std::move(found);
      pose = next;
      return true;
    }
    catch (const ConvergenceError&)
    {
      return false;
    }
  }

  /// Distance in front of the receptor's edge that ImagedPart of the points have at least, mm.
  double LeastImagedMm(const std::vector<double>& points, const BreastPose& pose,
    const CompressionState& state)
  {
    const VolumeFromGantry placed = this->Placement.At(pose);
    std::vector<double> depths;
    for (const Vector3& point : Moved(points, *this->Model.Predictor(), state))
    {
      depths.push_back(placed.ToGantry(point)[1]);
    }
    const auto least = depths.begin() +
      static_cast<std::ptrdiff_t>((1 - ImagedPart) * static_cast<double>(depths.size()));
    std::nth_element(depths.begin(), least, depths.end());
    return *least;
  }

  /// Height of the tissue that the plates meet, mm: of the breast without the body that a patient's
  /// MRI shows beside it, in front of the plates' edges.
  static double HeightBetweenPlates(const TrueBreast& breast, const VolumeFromGantry& placed)
  {
    const std::vector<bool> held = breast.Table.Fixed();
    LabelVolume met = KeepBreast(breast.Phantom, held, PatientAxes);
    met.ForEachVoxel(
      [&](int i, int j, int k, std::size_t voxel)
      {
        if (placed.ToGantry(met.PointAt(i, j, k))[1] < 0)
        {
          met.Voxels[voxel] = 0;
        }
      });
    return HeightMm(met, held, placed.Z);
  }

  Mammogram Picture(const Mammogram& hung, const CompressionState& state,
    const std::vector<double>& points, TrueView& taken, Draws& draws)
  {
    // Lateral or head up: gantry +x on the left, -x on the right.
    const double up = hung.Laterality == 'L' ? 1 : -1;
    PosedBreast seen(this->Model, this->Model.Body(), this->Placement, taken.Pose, state);
    ReceptorGrid grid = SimulatedDetector(this->Options.MammogramPixelMm, up);
    std::vector<float> picture = seen.PictureOn(grid, 2).LogAttenuation;
    if (IsCutAtFront(picture, grid))
    {
      grid = SimulatedDetector(this->Options.MammogramPixelMm, up, LargeField);
      picture = seen.PictureOn(grid, 2).LogAttenuation;
    }
    Mammogram mammogram =
      Develop(hung, picture, grid, { .Noise = this->Options.MammogramNoise }, draws);
    taken.HeaderThicknessMm = std::round(taken.Pose.ThicknessMm + draws.Between(-4, 4));
    mammogram.BodyPartThicknessMm = taken.HeaderThicknessMm;
    mammogram.SourceToDetectorMm = taken.Unit.SourceToDetectorMm;
    mammogram.SourceToPatientMm = taken.Unit.SourceToDetectorMm - taken.Unit.SupportHeightMm;
    mammogram.PeakKilovoltage = 30;
    taken.PaddleForceN = state.PaddleForceN;
    if (taken.View == "CC" && this->Options.Projections > 1)
    {
      this->Sweep(seen, mammogram, grid);
    }

    const VolumeFromGantry placed = this->Placement.At(taken.Pose);
    for (const Vector3& point : Moved(points, this->Model.Body(), state))
    {
      const Vector3 at = placed.ToGantry(point);
      taken.Gantry.push_back(at);
      taken.Receptor.push_back(ShadowOf(at, taken.Unit));
      taken.Pixels.push_back(grid.IndexOf(taken.Receptor.back()));
    }
    return mammogram;
  }

  /// Pictures of the same compression from an arc of the source.
  void Sweep(PosedBreast& breast, const Mammogram& header, const ReceptorGrid& grid)
  {
    // Numbers of its own: those of the study are the same with and without it.
    Draws draws(this->Options.Seed, 1, 0);
    const int count = this->Options.Projections;
    const double radius = breast.Placement().Unit.SourceToDetectorMm - TomosynthesisAxisMm;
    for (int number = 0; number < count; ++number)
    {
      const double angle = this->Options.SpanDeg * std::numbers::pi / 180 *
        (static_cast<double>(number) / (count - 1) - 0.5);
      const Vector3 spot{ radius * std::sin(angle), 0,
        TomosynthesisAxisMm + radius * std::cos(angle) };
      const std::vector<float>& picture = breast.SeenFrom(spot).PictureOn(grid, 2).LogAttenuation;
      Mammogram& projection = this->Projections.emplace_back(Develop(header, picture, grid,
        { .Noise = std::sqrt(static_cast<double>(count)) * this->Options.MammogramNoise }, draws));
      projection.SourceToDetectorMm = spot[2];
      projection.SourceToPatientMm = spot[2] - breast.Placement().Unit.SupportHeightMm;
      projection.SourceFootPixel = grid.IndexOf({ spot[0], spot[1] });
    }
  }

  VirtualStudyOptions Options;
  BreastModel Model;
  UnitPlacement Placement;
};

/// Draws centres of voxels within fat or gland, 3 x pointCount: the skin is found by any method.
std::vector<double> DrawPoints(const TrueBreast& breast, int count, Draws& draws)
{
  const std::vector<Tissue> tissues = TissuesOf(breast.Table);
  const LabelVolume& rest = breast.Rest;
  const double front = breast.Curve.At(breast.OffMm);
  std::vector<double> points;
  while (points.size() < 3 * static_cast<std::size_t>(count))
  {
    const auto along = [&](std::size_t axis)
    { return static_cast<int>(draws.Between(0, rest.Size[axis])); };
    const int i = along(0);
    const int j = along(1);
    const int k = along(2);
    const Tissue tissue = tissues[rest.Voxels[rest.Index(i, j, k)]];
    const Vector3 at = rest.PointAt(i, j, k);
    // What lies within two centimetres of the chest wall's face is often behind the plates' edges.
    if ((tissue == Tissue::Fat || tissue == Tissue::Gland) && at[1] < front - 20 &&
      breast.Phantom.LabelAt(at) != 0)
    {
      points.insert(points.end(), at.begin(), at.end());
    }
  }
  return points;
}

void CheckInput(const LabelVolume& materials, const MaterialTable& table,
  const AnatomicalAxes& axes, const VirtualStudyOptions& options, const std::string& folder)
{
  if (options.Laterality != 'L' && options.Laterality != 'R')
  {
    throw InputError("virtual study: expected the side L or R, found '" +
      std::string(1, options.Laterality) + "'");
  }
  if (!options.Plain && !options.FatSuppressed)
  {
    throw InputError(
      "virtual study: expected a T1 without or with fat suppression, found neither wanted");
  }
  const std::vector<bool> held = table.Fixed();
  if (std::find(held.begin(), held.end(), true) == held.end())
  {
    throw InputError("virtual study: expected a material that is held (chest wall) in the table " +
      table.Name + ", found none");
  }
  if (MidlineBetweenBreasts(materials, held, axes))
  {
    throw InputError("virtual study: expected labels of one breast, found two side by side; "
                     "'mammoray segment --side left' (or right) makes labels of one");
  }
  ReserveEmptyFolder(folder);
}
}

StudyTruth MakeVirtualStudy(const LabelVolume& materials, const MaterialTable& table,
  const AnatomicalAxes& axes, const VirtualStudyOptions& options, const std::string& folder,
  const ProgressCallback& progress)
{
  CheckInput(materials, table, axes, options, folder);
  Draws draws(options.Seed, 0, 0);
  const TrueBreast breast = MakeBreast(materials, table, axes, options, draws);
  StudyTruth truth;
  truth.Laterality = options.Laterality;
  truth.Seed = options.Seed;
  truth.Scanner = options.Scanner.empty() ? Scanners[options.Seed % 3] : options.Scanner;
  truth.Materials = table.Names();
  truth.StiffnessFactors = breast.Factors;
  truth.GlideStiffness = breast.GlideStiffness;
  for (const Material& material : breast.Table.Materials)
  {
    truth.YoungsModuliKPa.push_back(material.YoungsModulusKPa);
  }
  const std::vector<double> points = DrawPoints(breast, options.NumberOfPoints, draws);
  truth.RestPoints = AsPoints(points);

  // Between the plates first: what cannot be compressed needs no MRI.
  std::vector<Mammogram> mammograms;
  std::vector<Mammogram> projections;
  {
    PressedBreast pressed(breast, options, ShareOf(progress, 0, 0.2));
    double done = 0.2;
    for (const char* view : { "CC", "MLO" })
    {
      auto [taken, mammogram] =
        pressed.Take(view, breast, points, draws, ShareOf(progress, done, done + 0.25));
      done += 0.25;
      truth.Views.push_back(std::move(taken));
      mammograms.push_back(std::move(mammogram));
    }
    projections = std::move(pressed.Projections);
  }
  const HangingBreast hanging(breast, options, PatientPosition::Prone,
    ShareOf(progress, 0.7, 0.85));
  truth.MriPoints = AsPoints(hanging.Move(points));
  for (std::size_t index = 0; index < truth.MriPoints.size(); ++index)
  {
    truth.MeanHangMm += Norm(truth.MriPoints[index] - truth.RestPoints[index]) /
      static_cast<double>(truth.MriPoints.size());
  }
  const StudyPatient patient{ breast.Rest, breast.Table, breast.Curve, breast.OffMm,
    [&hanging](const std::vector<double>& rest) { return hanging.Move(rest); } };
  WriteStudyFiles(patient, mammograms, options, draws, folder, truth, ShareOf(progress, 0.85, 1));
  if (!projections.empty())
  {
    WriteProjections(projections, { .Derivation = "Computed from a label phantom." },
      TomosynthesisAxisMm, folder + "/" + StudyProjectionsFile);
  }
  ReportProgress(progress, 1, "done");
  return truth;
}
}
