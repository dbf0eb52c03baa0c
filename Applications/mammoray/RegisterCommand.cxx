// SPDX-License-Identifier: Apache-2.0
#include "CommandLine.h"
#include "ComparisonOptions.h"
#include "mammoray/Case/RegistrationCase.h"
#include "mammoray/Case/RegistrationCaseWriter.h"
#include "mammoray/Foundation/PoseParameters.h"

#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>

namespace mammoray
{
namespace
{
namespace fs = std::filesystem;

struct RegisterOptions
{
  RegistrationCase Case;
  std::string Output;
  bool Overwrite = false;
};

/// A result folder appears complete or not at all; only an earlier result is ever replaced.
void CheckOutputFolder(const std::string& path, bool overwrite)
{
  const fs::path folder = fs::absolute(path).lexically_normal();
  const fs::path parent =
    folder.has_filename() ? folder.parent_path() : folder.parent_path().parent_path();
  if (!fs::is_directory(parent) || access(parent.c_str(), W_OK) != 0)
  {
    throw InputError("output " + path + ": expected a writable folder " + parent.string());
  }
  if (!fs::exists(folder))
  {
    return;
  }
  if (!overwrite)
  {
    throw InputError("output " + path + ": exists already; --overwrite replaces it");
  }
  if (!fs::is_directory(folder) || (!fs::is_empty(folder) && !fs::exists(folder / "result.json")))
  {
    throw InputError("output " + path +
      ": expected an earlier result (a folder with result.json) to overwrite, found something "
      "else");
  }
}

void PrintView(const RegisteredView& view)
{
  const RegistrationResult& registration = view.Registration;
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
  std::printf("outline distance %.2f mm mean, %.2f mm largest; correlation %.3f\n",
    registration.After.MeanOutlineDistanceMm, registration.After.LargestOutlineDistanceMm,
    registration.After.Correlation);
  std::printf("%d equilibria in %.1f s, %d pictures in %.1f s, derivatives in %.1f s\n",
    registration.Evaluations, registration.MechanicsSeconds, registration.Projections,
    registration.ProjectionSeconds, registration.JacobianSeconds);
  for (const std::string& warning : view.Warnings)
  {
    std::fprintf(stderr, "mammoray: note: %s\n", warning.c_str());
  }
}

void RunRegister(const RegisterOptions& options)
{
  CheckOutputFolder(options.Output, options.Overwrite);
  for (const std::vector<std::string>& paths : { options.Case.Mammograms, options.Case.Masks })
  {
    for (const std::string& path : paths)
    {
      CheckInputFile(path);
    }
  }
  for (const std::string& path : { options.Case.AnatomyMesh, options.Case.SimulationMesh })
  {
    if (!path.empty())
    {
      CheckInputFile(path);
    }
  }
  if (!fs::is_directory(options.Case.Labels.Path))
  {
    CheckInputFile(options.Case.Labels.Path);
  }
  const RegistrationCaseResult result = RunRegistrationCase(options.Case, MakeProgressBar());

  const fs::path target = fs::absolute(options.Output).lexically_normal();
  const fs::path temporary = (target.has_filename() ? target : target.parent_path()).string() +
    ".partial-" + std::to_string(getpid());
  fs::create_directory(temporary);
  try
  {
    WriteRegistrationCase(options.Case, result, temporary.string());
    if (options.Overwrite)
    {
      fs::remove_all(target);
    }
    fs::rename(temporary, target);
  }
  catch (...)
  {
    std::error_code ignored;
    fs::remove_all(temporary, ignored);
    throw;
  }

  const std::vector<std::string> folders = ViewFolders(result);
  for (std::size_t view = 0; view < folders.size(); ++view)
  {
    if (folders.size() > 1)
    {
      std::printf("%s (%s)\n", folders[view].c_str(), result.Views[view].Path.c_str());
    }
    PrintView(result.Views[view]);
  }
  const RegistrationResult& registration = result.Views.front().Registration;
  std::printf("%zu iterations in %.1f s: %s\n", registration.Iterations.size(),
    registration.Seconds, registration.StopReason.c_str());
  std::printf("wrote %s\n", options.Output.c_str());
}

/// An option for each parameter of the pose.
void AddStartOptions(CLI::App& command, RegistrationCase& input)
{
  for (const PoseParameter& parameter : PoseParameters)
  {
    const std::string unit = *parameter.Unit != 0 ? std::string(", ") + parameter.Unit : "";
    const std::string start = parameter.InHeader
      ? "one for each mammogram; default: from the header"
      : "default: " + parameter.Format(parameter.Start, 0);
    command
      .add_option(parameter.Option(), input.Start[parameter.Index],
        parameter.Help + unit + "; " + start)
      ->group("Start of the search, kept by what is not --free");
  }
}

std::string DefaultFree()
{
  std::string names;
  for (const std::string& name : FreePoseParameterNames())
  {
    names += (names.empty() ? "" : ", ") + name;
  }
  return names;
}
}

void AddRegisterCommand(CLI::App& application)
{
  auto options = std::make_shared<RegisterOptions>();
  RegistrationCase& input = options->Case;
  CLI::App* command = application.add_subcommand("register",
    "Find the compression and pose whose synthetic mammogram matches a mammogram");
  AddLabelOptions(*command, input.Labels)->required();
  AddMaterialsOption(*command, input.Materials)->required();
  command
    ->add_option("--mammogram", input.Mammograms,
      "mammogram, DICOM MG; repeated for several of the same breast (CC and MLO), which are "
      "registered together with one stiffness of gland")
    ->required();
  command
    ->add_option("--view", input.MammogramViews, "in place of the header's, one for each mammogram")
    ->check(CLI::IsMember({ "CC", "MLO", "ML", "LM", "LMO", "FB" }))
    ->group("Mammogram");
  command
    ->add_option("--laterality", input.Laterality, "the breast's side, in place of the header's")
    ->check(CLI::IsMember({ "L", "R" }))
    ->group("Mammogram");
  command
    ->add_option("--pixel-spacing", input.PixelSpacingMm,
      "of the mammogram's pixels at the receptor, mm, in place of the header's; a picture without "
      "a header (.jpg .png) needs it, --view and --laterality")
    ->check(PositiveNumber())
    ->group("Mammogram");
  command
    ->add_option("--mask", input.Masks,
      "image of the mammogram's size (.png .mha), not 0 where it is not to be compared, one for "
      "each mammogram")
    ->group("Mammogram");
  command
    ->add_flag_callback(
      "--compare-pectoral", [&input]() { input.Targets.ExcludePectoral = false; },
      "compare the pectoral muscle, too: it is looked for in oblique views and left out")
    ->group("Mammogram");
  command
    ->add_flag_callback(
      "--compare-markers", [&input]() { input.Targets.ExcludeMarkers = false; },
      "compare the brightest pixels, too: text, markers and saturated tissue are left out")
    ->group("Mammogram");
  command
    ->add_option("-o,--output", options->Output,
      "folder for meshes, pictures, result.json and report.html")
    ->required();
  command->add_flag("--overwrite", options->Overwrite, "replace an earlier result folder");
  command
    ->add_option("--spectrum", input.Spectrum,
      "X-ray spectrum: a file (.spc) or the name of a shipped one")
    ->capture_default_str()
    ->group("X-rays");
  command->add_option("--device", input.Device, "part of the name of the Vulkan device to use")
    ->group("X-rays");
  AddProjectorOption(*command, input.Projector)->group("X-rays");
  command
    ->add_option("--orientation", input.Orientation,
      "directions of the volume's axes: L/R, A/P, S/I, e.g. LPS (DICOM) or ALS (FDA phantoms)")
    ->capture_default_str();
  command
    ->add_option("--label-spacing", input.Labels.SpacingMm,
      "finer label volumes are resampled to this spacing, mm; 0 keeps them")
    ->check(NonNegativeNumber())
    ->capture_default_str()
    ->group("Meshes");
  command->add_option("--anatomy-cell-size", input.AnatomyCellSizeMm, "largest cells X-rayed, mm")
    ->check(PositiveNumber())
    ->capture_default_str()
    ->group("Meshes");
  command
    ->add_option("--simulation-cell-size", input.SimulationCellSizeMm,
      "largest cells of the mechanics, mm; 0: by the size of the breast, 3000 to 4000 cells")
    ->check(NonNegativeNumber())
    ->capture_default_str()
    ->group("Meshes");
  command
    ->add_option("--anatomy-mesh", input.AnatomyMesh,
      "mesh of 'mammoray mesh' to X-ray (.vtu); default: made from the labels")
    ->group("Meshes");
  command
    ->add_option("--simulation-mesh", input.SimulationMesh,
      "coarse mesh for the mechanics (.vtu); default: made from the labels")
    ->group("Meshes");
  command
    ->add_option("--source-to-detector", input.SourceToDetectorMm,
      "source to detector distance, mm; default: from the header")
    ->group("Unit");
  command
    ->add_option("--support-height", input.SupportHeightMm,
      "height of the breast support's face above the receptor plane, mm; default 2")
    ->group("Unit");
  command
    ->add_option("--support-edge", input.SupportEdgeMm,
      "chest-wall edge of the support, gantry y, mm")
    ->capture_default_str()
    ->group("Unit");
  command
    ->add_option("--paddle-edge", input.PaddleEdgeMm, "chest-wall edge of the paddle, gantry y, mm")
    ->capture_default_str()
    ->group("Unit");
  command
    ->add_option("--edge-radius", input.EdgeRadiusMm, "radius of the plates' chest-wall edges, mm")
    ->check(NonNegativeNumber())
    ->capture_default_str()
    ->group("Unit");
  AddStartOptions(*command, input);
  command
    ->add_option("--free", input.Free,
      "parameters that are found; the others keep their start: " + PoseParameterNames() +
        " (one for all mammograms); default: " + DefaultFree() +
        ", and stiffness with more than one mammogram")
    ->group("Search");
  command
    ->add_option("--resume", input.Resume,
      "go on from the pose in this earlier result folder of the same inputs")
    ->group("Search");
  command
    ->add_option("--pixel-sizes", input.Options.PixelSizesMm,
      "pixels in which the pictures are compared, coarse to fine, mm")
    ->check(PositiveNumber())
    ->capture_default_str()
    ->group("Search");
  command
    ->add_option("--iterations", input.Options.MaximumIterations,
      "most iterations at each pixel size")
    ->check(PositiveNumber())
    ->capture_default_str()
    ->group("Search");
  command
    ->add_option("--outline-sigma", input.Options.OutlineSigmaMm,
      "expected error of the model's outline, mm")
    ->check(PositiveNumber())
    ->capture_default_str()
    ->group("Search");
  AddComparisonOptions(*command, input.Options);
  command
    ->add_option("--intensity-sigma", input.Options.IntensitySigma,
      "expected error of the model's picture, in its standard deviations")
    ->check(PositiveNumber())
    ->capture_default_str()
    ->group("Search");
  AddConfigurationOptions(*command);
  command->callback([options]() { RunRegister(*options); });
}
}
