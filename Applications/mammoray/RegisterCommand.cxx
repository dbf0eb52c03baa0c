// SPDX-License-Identifier: Apache-2.0
#include "Commands.h"
#include "DicomOptions.h"
#include "OptionNames.h"
#include "OutputFiles.h"
#include "ProgressBar.h"
#include "ResultNotes.h"
#include "SharedOptions.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/PoseParameters.h"
#include "mammoray/Study/RegistrationCase.h"
#include "mammoray/Study/StudyCase.h"
#include "mammoray/XRay/Scatter/Photons.h"

#include <cmath>
#include <cstdio>
#include <filesystem>

namespace mammoray
{
namespace
{
struct RegisterArguments
{
  RegistrationCase Case;
  std::string Study;
  /// Empty: by the mammograms.
  std::optional<char> Side;
  /// Nothing: as a study says, else fixed and without weight.
  std::optional<ChestWallMode> ChestWall;
  std::optional<std::optional<PatientPosition>> ImagePosition;
  std::optional<double> ChestWallMarginMm;
  /// Empty: none; "kernels".
  std::string ScatterMethod;
  RegisteredScatter Scatter;
  std::string Output;
};

/// Declares a clinic's export, or labels, materials and mammograms.
void DeclareInputs(const OptionList& add, RegisterArguments& arguments)
{
  RegistrationCase& input = arguments.Case;
  CLI::Option* const study = add.Input("--study", arguments.Study,
    "a clinic's export, in place of labels, materials and mammograms\n(a folder of MRI and "
    "mammograms; 'mammoray intake' lists what is used; --labels replace its segmentation)");
  AddSideOption(add, arguments.Side);
  add.Expert()(Shared::Series, input.Series);
  AddLabelOptions(add, input.Labels);
  add(Shared::Materials, input.Materials);
  add(Shared::Orientation, input.Orientation);
  add(Shared::Mammograms, input.Mammograms)->excludes(study);
  AddViewOption(add, input.MammogramViews);
  add(Shared::PixelSpacing, input.PixelSpacingMm);
  add.File("--mask", input.Masks, "pictures (.png .mha), not 0 where a mammogram is not compared");
  const OptionList file = add.Group("Mammogram").CaseFile();
  file.FlagOff("--compare-pectoral", input.Targets.ExcludePectoral,
    "compare the pectoral muscle, too: it is looked for in oblique views and left out");
  file.FlagOff("--compare-markers", input.Targets.ExcludeMarkers,
    "compare the brightest pixels, too: text, markers and saturated tissue are left out");
  file("--chest-wall-margin", arguments.ChestWallMarginMm, NonNegative("mm"),
    "depth of a strip along the chest wall that is not compared, picture and outline; default: 0, "
    "of a study 10");
}

/// Declares what the report begins with, and whom it names.
void DeclareReport(const OptionList& add, RegistrationCase& input)
{
  const OptionList report = add.Group("Report");
  report(Shared::Point, input.Point);
  report(Shared::Lesion, input.Lesions);
  report(Shared::Image, input.Image);
  AddSamePatientFlag(report, input.NamePatient);
  report.Expert().Flag("--name-inputs", input.NameInputs,
    "write the names of input files and series, which may hold a patient's name");
}

void DeclareMeshes(const OptionList& add, RegistrationCase& input)
{
  const OptionList meshes = add.Group("Meshes").Expert();
  meshes(Shared::LabelSpacing, input.Labels.SpacingMm);
  meshes("--anatomy-cell-size", input.AnatomyCellSizeMm, Positive("mm"), "largest cells X-rayed");
  meshes.File("--anatomy-mesh", input.AnatomyMesh,
    "mesh of 'mammoray mesh' to X-ray (.vtu); default: made from the labels");
  meshes(Shared::SimulationMesh, input.SimulationMesh);
  meshes(Shared::SimulationCellSize, input.SimulationCellSizeMm);
}

void DeclareUnit(const OptionList& add, RegistrationCase& input)
{
  const OptionList unit = add.Group("Unit").Expert();
  unit(Shared::SourceToDetector, input.SourceToDetectorMm);
  unit(Shared::SupportHeight, input.SupportHeightMm);
}

/// An option for each parameter of the pose: where the search starts, and what is kept if it is not
/// free. One value for each mammogram; the header's by default, where it has one.
void DeclareStart(const OptionList& add, RegistrationCase& input)
{
  const OptionList start = add.Group("Start of the search, kept by what is not --free");
  for (const PoseParameter& parameter : PoseParameters)
  {
    const OptionList list = parameter.Index == ThicknessParameter ? start : start.Expert();
    list(Shared::Pose(parameter), input.Start[parameter.Index]);
  }
}

void DeclareSearch(const OptionList& add, RegistrationCase& input)
{
  const OptionList search = add.Group("Search");
  std::string free;
  for (const std::string& name : FreePoseParameterNames())
  {
    free += name + ", ";
  }
  search("--free", input.Free,
    "parameters that are found; the others keep their start\n(of " + PoseParameterNames() +
      ", one for all mammograms; default: " + free + "and stiffness with more than one mammogram)");
  search.Input("--resume", input.Resume,
    "go on from an earlier result folder of the same inputs\n(or from the last step of a run for "
    "that folder that was cut off)");
  const OptionList expert = search.Expert();
  expert("--pixel-sizes", input.Options.PixelSizesMm, Positive("mm"),
    "pixels in which the pictures are compared, coarse to fine");
  expert.Choice<PictureComparison>("--residual", input.Options.Comparison,
    { { NameOf(PictureComparison::Gradient), PictureComparison::Gradient },
      { NameOf(PictureComparison::Global), PictureComparison::Global },
      { NameOf(PictureComparison::Local), PictureComparison::Local } },
    "how pictures are compared at last: the gradient of log attenuation, or log attenuation "
    "normalised globally or locally (in windows)");
  expert("--iterations", input.Options.MaximumIterations, Positive(),
    "most iterations at each pixel size");
  const OptionList file = search.CaseFile();
  file("--window", input.Options.WindowMm, Positive("mm"),
    "edge of the windows of the local residual");
  file("--outline-sigma", input.Options.OutlineSigmaMm, Positive("mm"),
    "expected error of the model's outline; where gradients are compared the pictures tell it");
}

void DeclareLoading(const OptionList& add, RegisterArguments& arguments)
{
  const OptionList loading = add.Group("Loading");
  loading.Choice<std::optional<ChestWallMode>>("--chest-wall", arguments.ChestWall,
    { { "auto", std::nullopt }, { "fixed", ChestWallMode::Fixed },
      { "sliding", ChestWallMode::Sliding }, { "elastic", ChestWallMode::Elastic } },
    "attachment\n(to the fixed materials; auto: sliding in a --study, as along the pectoral "
    "muscle, "
    "else fixed)");
  using Position = std::optional<PatientPosition>;
  loading.Choice<std::optional<Position>>("--mri-position", arguments.ImagePosition,
    { { "auto", std::nullopt }, { "none", Position() },
      { "prone", Position(PatientPosition::Prone) },
      { "supine", Position(PatientPosition::Supine) } },
    "how the patient lay\n(prone, supine: the breast is relieved of its weight and compressed "
    "standing; none: no weight; auto: by the header of a --study's MRI, else none)");
}

void DeclareXRays(const OptionList& add, RegisterArguments& arguments)
{
  const OptionList xrays = add.Group("X-rays").Expert();
  xrays(Shared::Spectrum, arguments.Case.Spectrum);
  xrays.Word("--scatter", arguments.ScatterMethod, { "kernels" },
    "the synthetic mammogram has what tissue scatters onto the detector\n(by kernels that are "
    "tabulated for breast tissue by the thickness along each ray; default: primary radiation "
    "alone)");
  xrays.Numbers("--grid", arguments.Scatter.Grid, "RATIO LINES UM",
    "anti-scatter grid of lead: ratio, lines per cm, septum ('5 31 65')\n(focused, micrometres; "
    "septa run along the chest wall; transmissions are relative to air behind the grid)");
  xrays("--air-gap", arguments.Scatter.AirGapMm, Between(0, 200, "mm"),
    "of --scatter kernels: from the back of the tissue to the detector\n(default: the height of "
    "the unit's support)");
  xrays.CaseFile().Word("--grid-interspace", arguments.Scatter.Interspace,
    { "fibre", "air", "aluminium" }, "what is between the septa");
}

void Declare(const OptionList& add, RegisterArguments& arguments)
{
  RegistrationCase& input = arguments.Case;
  DeclareInputs(add, arguments);
  add("-o,--output", arguments.Output, "folder for meshes, pictures, result.json and report.html")
    ->required();
  DeclareReport(add, input);
  DeclareLoading(add, arguments);
  DeclareStart(add, input);
  DeclareSearch(add, input);
  DeclareXRays(add, arguments);
  DeclareMeshes(add, input);
  DeclareUnit(add, input);
}

/// The volumes, which may be folders, are read long after the search has begun.
void CheckInputs(const RegistrationCase& input)
{
  for (const std::string& volume : { input.Lesions, input.Image, input.Labels.Path })
  {
    if (!std::filesystem::is_directory(volume) && !volume.empty())
    {
      CheckInputFile(volume);
    }
  }
}

/// Throws InputError if there are options of scatter without its method, or an impossible grid.
void SetScatter(RegisterArguments& arguments)
{
  const RegisteredScatter& scatter = arguments.Scatter;
  if (arguments.ScatterMethod.empty() && (scatter.Grid || scatter.AirGapMm))
  {
    throw InputError("--grid, --air-gap: expected --scatter beside them, found none");
  }
  if (scatter.Grid)
  {
    AntiscatterGrid(AntiscatterGridOptions::OfLead(*scatter.Grid, scatter.Interspace));
  }
  if (!arguments.ScatterMethod.empty())
  {
    arguments.Case.Scatter = scatter;
  }
}

void PrintView(const RegisteredView& view)
{
  const ViewResult& registration = view.Registration;
  for (std::size_t index = 0; index < registration.Parameters.size(); ++index)
  {
    const RegistrationParameter& parameter = registration.Parameters[index];
    char deviation[32] = "(fixed)";
    if (!parameter.Fixed)
    {
      const double value = registration.StandardDeviations[index];
      std::snprintf(deviation, sizeof deviation, std::isfinite(value) ? "+- %.2f" : "+- unknown",
        value);
    }
    std::printf("%-10s %8.2f %-4s %s\n", parameter.Name.c_str(), registration.Values[index],
      parameter.Unit.c_str(), deviation);
  }
  std::printf(
    "outline distance %.2f mm mean, %.2f mm largest; correlation %.3f, of the tissue %.2f\n",
    registration.After.MeanOutlineDistanceMm, registration.After.LargestOutlineDistanceMm,
    registration.After.Correlation, registration.After.TissueCorrelation);
  if (registration.Expected)
  {
    std::printf("expected error in 3D: half of the tissue within %.1f mm, 95 %% within %.1f mm\n",
      registration.Expected->MedianMm, registration.Expected->Most95Mm);
  }
  std::printf("%d equilibria in %.1f s, %d pictures in %.1f s, derivatives in %.1f s\n",
    registration.Evaluations, registration.MechanicsSeconds, registration.Projections,
    registration.ProjectionSeconds, registration.JacobianSeconds);
  for (const std::string& warning : view.Warnings)
  {
    std::fprintf(stderr, "mammoray: note: %s\n", warning.c_str());
  }
}

/// Prints what is taken of a study, and warnings about it.
void PrintStudy(const StudyChoice& choice)
{
  const auto print = [](const std::string& name, const std::string& reason)
  {
    if (reason.starts_with("taken"))
    {
      std::printf("%s %s\n", name.c_str(), reason.c_str());
    }
  };
  for (const StudySeries& series : choice.Found.Series)
  {
    print("'" + series.Description + "'", series.Reason);
  }
  for (const StudyMammogram& image : choice.Found.Mammograms)
  {
    print(image.Header.View, image.Reason);
  }
  std::fflush(stdout);
  for (const std::string& warning : choice.Warnings)
  {
    std::fprintf(stderr, "mammoray: note: %s\n", warning.c_str());
  }
}

void PrintTissue(const StudyTissue& tissue, bool isGiven)
{
  std::printf("breast %.0f cm3 in the %s, %.0f %% gland, stands out by %.0f mm\n", tissue.BreastCm3,
    isGiven ? "labels" : "MRI", 100 * tissue.GlandFraction, tissue.DepthMm);
  for (const std::string& warning : tissue.Warnings)
  {
    std::fprintf(stderr, "mammoray: note: %s\n", warning.c_str());
  }
}

/// Searches and writes the result. If that fails after the search has begun (the device, memory or
/// the disk), the error says that the checkpoint has what was found so far.
RegistrationCaseResult RegisterAndWrite(const RegisterArguments& arguments)
{
  const RegistrationCase& input = arguments.Case;
  const auto written = [&input]
  {
    std::error_code absent; // answered by the earliest time
    return std::filesystem::last_write_time(input.Checkpoint, absent);
  };
  const auto before = written();
  try
  {
    RegistrationCaseResult result = RunRegistrationCase(input, MakeProgressBar());
    WriteRegistrationCase(input, result, arguments.Output, Program().Overwrite);
    return result;
  }
  catch (const std::exception& error)
  {
    if (written() <= before)
    {
      throw;
    }
    throw Error(Complaint(error) + "; the search is kept: --resume " + arguments.Output +
      " goes on from " + input.Checkpoint);
  }
}

void Run(RegisterArguments& arguments)
{
  RegistrationCase& input = arguments.Case;
  Program().ApplyTo(input.Labels);
  if (arguments.Study.empty() &&
    (input.Labels.Path.empty() || input.Materials.empty() || input.Mammograms.empty()))
  {
    throw CLI::RequiredError("--study, or --labels, --materials and --mammogram together,");
  }
  if (!arguments.Study.empty() && !input.Image.empty())
  {
    throw CLI::ExcludesError("--image", "--study");
  }
  if (arguments.Study.empty() && !input.Series.empty() &&
    (input.Image.empty() || input.Series.size() > 1))
  {
    throw CLI::ValidationError(
      "--series: expected a --study or, for one number, an --image beside it");
  }
  SetScatter(arguments);
  CheckNoInputWithin(arguments.Output);
  CheckResultFolder(arguments.Output, Program().Overwrite);
  if (!arguments.Study.empty())
  {
    if (arguments.ImagePosition) // which says that no gravity is taken off, too
    {
      input.ImagePosition = arguments.ImagePosition->value_or(PatientPosition::Prone);
    }
    TakeStudy(arguments.Study, arguments.Side, input, MakeProgressBar());
    PrintStudy(*input.Study);
  }
  else if (arguments.Side)
  {
    input.Laterality = *arguments.Side;
  }
  input.ChestWall = arguments.ChestWall.value_or(input.ChestWall);
  input.Targets.ChestWallMarginMm =
    arguments.ChestWallMarginMm.value_or(input.Targets.ChestWallMarginMm);
  input.ImagePosition = arguments.ImagePosition.value_or(input.ImagePosition);
  CheckInputs(input);
  input.Projector = Program().Projector;
  input.Checkpoint = CheckpointPath(arguments.Output);
  const RegistrationCaseResult result = RegisterAndWrite(arguments);

  if (result.Tissue)
  {
    PrintTissue(*result.Tissue, !input.Labels.Path.empty());
  }
  const std::vector<std::string> folders = MammogramFolders(result);
  for (std::size_t view = 0; view < folders.size(); ++view)
  {
    if (folders.size() > 1)
    {
      std::printf("%s (%s)\n", folders[view].c_str(),
        ShownName(result.Views[view].Path, input.NameInputs).c_str());
    }
    PrintView(result.Views[view]);
  }
  const ViewResult& registration = result.Views.front().Registration;
  std::printf("%zu iterations in %.1f s: %s\n", registration.Iterations.size(),
    registration.Seconds, registration.StopReason.c_str());
  std::printf("wrote %s\n", arguments.Output.c_str());
  // Last, where it is seen.
  for (std::size_t view = 0; view < folders.size(); ++view)
  {
    std::printf("%s%s\n", folders.size() > 1 ? (folders[view] + ": ").c_str() : "",
      Verdict(result.Views[view].Registration.Trust).c_str());
  }
}
}

void AddRegisterCommand(CLI::App& application)
{
  AddCommand<RegisterArguments>(application, "register",
    "Find the compression and pose whose synthetic mammogram matches a mammogram",
    "register --study export/ --side left -o result", Declare, Run);
}
}
