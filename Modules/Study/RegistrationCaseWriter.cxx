// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Study/RegistrationCase.h"

#include "Private/AskedPlaces.h"
#include "Private/Checkpoint.h"
#include "mammoray/Dicom/DicomHeader.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/AtomicFile.h"
#include "mammoray/IO/LabelVolumeIO.h"
#include "mammoray/IO/MeshConversion.h"
#include "mammoray/IO/MeshIO.h"
#include "mammoray/Study/RegisteredBreast.h"
#include "mammoray/Study/RegistrationReport.h"
#include "mammoray/Study/ResultFile.h"
#include "mammoray/Study/StudyCase.h"

#include "vtkDoubleArray.h"
#include "vtkFloatArray.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkUnstructuredGrid.h"
#include "vtkVersion.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <map>
#include <numbers>
#include <optional>
#include <set>
#include <utility>
#include <vector>

namespace mammoray
{
namespace
{
namespace fs = std::filesystem;

void WriteSynthetic(const RegisteredView& registered, const std::string& path)
{
  const ReceptorGrid& grid = registered.View.Target.Grid;
  IntensityVolume image;
  image.Size = { grid.Columns, grid.Rows, 1 };
  image.Spacing = { registered.Mammogram.ColumnSpacingMm, registered.Mammogram.RowSpacingMm, 1 };
  image.Voxels = registered.Registration.Synthetic.LogAttenuation;
  // A volume must be finite. Report pictures show other values as air, too.
  std::replace_if(
    image.Voxels.begin(), image.Voxels.end(), [](float value) { return !std::isfinite(value); },
    0.0F);
  WriteIntensityVolume(image, path);
}

/// Share of the breast's picture that is not compared, [0, 1].
double ShareExcluded(const RegistrationTarget& target)
{
  std::size_t breast = 0;
  std::size_t excluded = 0;
  for (std::size_t pixel = 0; pixel < target.BreastMask.size(); ++pixel)
  {
    breast += target.BreastMask[pixel] != 0 ? 1 : 0;
    excluded += target.BreastMask[pixel] != 0 && IsExcluded(target, pixel) ? 1 : 0;
  }
  return static_cast<double>(excluded) / static_cast<double>(std::max<std::size_t>(breast, 1));
}

ResultFile ResultOf(const RegistrationCase& input, const RegistrationCaseResult& result,
  const RegisteredView& registered)
{
  const ViewResult& found = registered.Registration;
  const RegistrationTarget& target = registered.View.Target;
  const Mammogram& mammogram = registered.Mammogram;
  ResultFile file;
  static_cast<ViewFigures&>(file) = found;
  file.Axes = result.Axes;
  file.Anchor = result.Anchor;
  file.Parameters = ParametersOf(found);
  file.Grid = target.Grid;
  file.Unit = registered.View.Unit;
  for (std::size_t other = 0; other < registered.View.Projections.size(); ++other)
  {
    file.Projections.push_back(
      { registered.View.Projections[other].FocalSpotMm, found.ProjectionsAfter[other] });
  }
  file.Timings = result.Timings;
  file.Compression = found.State;
  file.Mammogram = mammogram;
  file.Mammogram.Pixels.clear();
  file.ShareExcluded = ShareExcluded(target);
  file.Warnings = registered.Warnings;
  file.Notes = result.Notes;
  file.Inputs = InputsOf(input, registered.Path);
  file.Spectrum = fs::path(input.Spectrum).has_extension()
    ? ShownName(input.Spectrum, input.NameInputs)
    : input.Spectrum;
  if (input.Scatter)
  {
    file.Scatter = { "kernels",
      input.Scatter->AirGapMm.value_or(registered.View.Unit.SupportHeightMm),
      input.Scatter->Grid.value_or(std::array<double, 3>{}), input.Scatter->Interspace };
  }
  file.Versions = { { "MammoRay", MAMMORAY_VERSION }, { "VTK", vtkVersion::GetVTKVersion() },
    { "Vulkan device", result.Device },
    { "Anatomy",
      std::to_string(result.Anatomy.NumberOfCells()) + " tetrahedra, " +
        std::to_string(result.SurfaceTriangles) + " interface triangles" },
    { "Mechanics", std::to_string(result.SimulationCells) + " quadratic tetrahedra" } };
  return file;
}

/// How each projection of a tomosynthesis agrees with the one compression.
ReportSection ProjectionSection(const RegisteredView& registered)
{
  ReportSection section;
  section.Title = "Projections of the tomosynthesis";
  std::vector<std::pair<Vector3, Similarity>> projections{ { registered.View.Unit.FocalSpot(),
    registered.Registration.After } };
  for (std::size_t other = 0; other < registered.View.Projections.size(); ++other)
  {
    projections.emplace_back(registered.View.Projections[other].FocalSpotMm,
      registered.Registration.ProjectionsAfter[other]);
  }
  std::sort(projections.begin(), projections.end(),
    [](const auto& a, const auto& b) { return a.first[0] < b.first[0]; });
  for (const auto& [spot, after] : projections)
  {
    const double angle = std::atan2(spot[0], spot[2]) * 180 / std::numbers::pi;
    char row[2][80];
    std::snprintf(row[0], sizeof row[0], "Source at %.1f°", angle);
    std::snprintf(row[1], sizeof row[1], "correlation %.3f, outlines %.2f mm apart",
      after.Correlation, after.MeanOutlineDistanceMm);
    section.Rows.emplace_back(row[0], row[1]);
  }
  section.Notes = { "Angles are those of the focal spot over the middle of the receptor's "
                    "chest-wall edge, positive along gantry x. All projections were compared with "
                    "one compressed breast, here in the finest pixels of the search; the middle "
                    "one, whose pictures and figures stand above, in its own." };
  return section;
}

/// "2024-03-01" for DICOM's 20240301. Empty if it is no such date: it may be a name.
std::string DateText(const std::string& date)
{
  const bool isDate = date.size() == 8 && date.find_first_not_of("0123456789") == std::string::npos;
  return isDate ? date.substr(0, 4) + '-' + date.substr(4, 2) + '-' + date.substr(6) : "";
}

/// When the pictures were made, and of whom if the case asks for it.
std::vector<std::pair<std::string, std::string>> ExaminationOf(const RegistrationCase& input,
  const RegisteredView& registered)
{
  std::vector<std::pair<std::string, std::string>> lines;
  const auto add = [&](const char* name, const std::string& text)
  {
    if (!text.empty())
    {
      lines.emplace_back(name, EscapeControls(text));
    }
  };
  if (input.Study && input.Study->Mri())
  {
    add("MRI of", DateText(input.Study->Mri()->Date));
  }
  std::optional<DicomHeader> header;
  try
  {
    header = ReadDicomHeader(registered.Path);
  }
  catch (const InputError&) // it was a picture without a header
  {
  }
  if (header)
  {
    const DicomIdentity& identity = header->Identity;
    add("mammogram of",
      DateText(header->AcquisitionDate.empty() ? identity.StudyDate : header->AcquisitionDate));
    if (input.NamePatient)
    {
      add("patient", identity.PatientName);
      add("ID", identity.PatientId);
      add("born", DateText(identity.PatientBirthDate));
      add("accession number", identity.AccessionNumber);
    }
  }
  return lines;
}

JointResultFile JointOf(const RegistrationCaseResult& result,
  const std::vector<std::string>& folders, const std::vector<ResultFile>& files)
{
  JointResultFile joint;
  for (std::size_t number = 0; number < files.size(); ++number)
  {
    const ResultFile& file = files[number];
    joint.Mammograms.push_back({ folders[number], file.Mammogram.View, file.Mammogram.Laterality,
      file.Trust.Level, file.After.Correlation, file.After.MeanOutlineDistanceMm });
  }
  const std::size_t count = result.FreeParameters.size();
  for (std::size_t index = 0; index < count; ++index)
  {
    const FreeParameter& free = result.FreeParameters[index];
    const ResultParameter& parameter = files[free.Views.front()].Parameters[free.Parameter];
    JointResultFile::Unknown& told = joint.Unknowns.emplace_back();
    told.Name = parameter.Name;
    told.Unit = parameter.Unit;
    told.Value = parameter.Value;
    if (!free.IsShared())
    {
      told.Folder = folders[free.Views.front()];
    }
    if (!result.Covariance.empty())
    {
      told.StandardDeviation = std::sqrt(result.Covariance[index * (count + 1)]);
    }
  }
  joint.Covariance = result.Covariance;
  joint.Converged = files.front().Converged;
  joint.StopReason = files.front().StopReason;
  joint.Seconds = files.front().Seconds;
  return joint;
}

/// Everything of a result into a folder that exists.
void WriteInto(const std::string& folder, const RegistrationCase& input,
  const RegistrationCaseResult& result)
{
  const std::vector<std::string> folders = MammogramFolders(result);
  std::vector<ResultFile> files;
  files.reserve(folders.size()); // reports refer to them
  JointReport report;
  if (result.Tissue)
  {
    WriteLabelVolume(result.Tissue->Labels, folder + "/labels.seg.nrrd");
    WriteIntensityVolume(result.Tissue->Mri, folder + "/mri.nrrd");
    const std::string& labels = input.Labels.Path;
    report.Sections.push_back(StudySection(*input.Study, *result.Tissue,
      labels.empty() ? labels : ShownName(labels, input.NameInputs)));
  }
  else if (result.Image)
  {
    WriteIntensityVolume(*result.Image, folder + "/mri.nrrd");
  }
  const std::vector<AskedPlace> asked = AskedOf(input, result);
  for (std::size_t number = 0; number < result.Views.size(); ++number)
  {
    const RegisteredView& registered = result.Views[number];
    const std::string own = (fs::path(folder) / folders[number]).string();
    fs::create_directories(own);
    WriteSynthetic(registered, own + "/synthetic.mha");
    files.push_back(ResultOf(input, result, registered));
    const RegisteredBreast breast = BreastOf(result, registered, files.back());
    WriteMesh(breast.Uncompressed(), own + "/uncompressed.vtu");
    WriteMesh(breast.Compressed(), own + "/compressed.vtu");
    RegistrationReport& told = report.Mammograms.emplace_back();
    told.Registered = &registered;
    told.File = &files.back();
    told.Examination = ExaminationOf(input, registered);
    told.Asked = asked;
    told.Places = PlacesIn(input, result, asked, breast);
    told.BetweenPlates = PictureBetweenPlates(result, registered, asked, breast);
    for (const ReportSection& section : report.Sections)
    {
      // Those of the study are told in its section.
      files.back().Warnings.insert(files.back().Warnings.end(), section.Notes.begin(),
        section.Notes.end());
    }
    WriteResultFile(files.back(), own);
    if (!registered.View.Projections.empty())
    {
      told.Sections.push_back(ProjectionSection(registered));
    }
  }
  if (result.Views.size() == 1)
  {
    std::vector<ReportSection>& sections = report.Mammograms.front().Sections;
    sections.insert(sections.begin(), report.Sections.begin(), report.Sections.end());
    WriteRegistrationReport(report.Mammograms.front(), folder);
    return;
  }
  const JointResultFile joint = JointOf(result, folders, files);
  report.File = &joint;
  WriteJointReport(report, folder);
  WriteResultFile(joint, folder);
}

/// The first entry of a result's folder, or of a mammogram's folder in it, that no result has.
std::optional<fs::path> FindForeign(const fs::path& folder)
{
  for (const fs::directory_entry& entry : fs::directory_iterator(folder))
  {
    const fs::path& path = entry.path();
    const bool isFolder = entry.is_directory() && !entry.is_symlink();
    if (isFolder && fs::exists(path / ResultFileName))
    {
      if (auto foreign = FindForeign(path))
      {
        return foreign;
      }
    }
    else if (!entry.is_regular_file() || !IsFileOfResult(path.filename().string()))
    {
      return path;
    }
  }
  return std::nullopt;
}
}

vtkSmartPointer<vtkUnstructuredGrid> UncompressedGrid(const RegistrationCaseResult& result,
  const RegisteredView& registered)
{
  auto grid = ToGrid(result.Anatomy, result.Materials.Names());
  AddPlacement(grid, registered.Registration.Placed);
  vtkNew<vtkDoubleArray> displacement;
  displacement->SetName("Displacement");
  displacement->SetNumberOfComponents(3);
  displacement->SetNumberOfTuples(grid->GetNumberOfPoints());
  double* values = displacement->GetPointer(0);
  for (std::size_t index = 0; index < registered.Registration.Points.size(); ++index)
  {
    values[index] = registered.Registration.Points[index] - result.Anatomy.Points[index];
  }
  grid->GetPointData()->SetVectors(displacement);
  for (std::size_t parameter = 0; parameter < registered.Registration.Sensitivities.size();
       ++parameter)
  {
    const std::vector<double>& velocities = registered.Registration.Sensitivities[parameter];
    if (velocities.empty())
    {
      continue;
    }
    // Floats: six digits of a derivative are plenty, and files stay half as large.
    vtkNew<vtkFloatArray> sensitivity;
    sensitivity->SetName(
      (SensitivityArrayPrefix + registered.Registration.Parameters[parameter].Name).c_str());
    sensitivity->SetNumberOfComponents(3);
    sensitivity->SetNumberOfTuples(grid->GetNumberOfPoints());
    std::copy(velocities.begin(), velocities.end(), sensitivity->GetPointer(0));
    grid->GetPointData()->AddArray(sensitivity);
  }
  return grid;
}

std::vector<std::string> MammogramFolders(const RegistrationCaseResult& result)
{
  std::vector<std::string> folders;
  std::map<std::string, int> counts;
  for (const RegisteredView& registered : result.Views)
  {
    std::string name;
    for (const char letter : registered.Mammogram.View)
    {
      if (std::isalnum(static_cast<unsigned char>(letter)) != 0)
      {
        name += static_cast<char>(std::tolower(static_cast<unsigned char>(letter)));
      }
    }
    name = name.empty() ? "view" : name;
    const int number = ++counts[name];
    folders.push_back(number > 1 ? name + "-" + std::to_string(number) : name);
  }
  return folders.size() == 1 ? std::vector<std::string>{ "" } : folders;
}

bool IsFileOfResult(const std::string& name)
{
  // All that WriteInto writes.
  static const std::set<std::string> names{ "uncompressed.vtu", "compressed.vtu", "synthetic.mha",
    "labels.seg.nrrd", "mri.nrrd", "real.png", "synthetic.png", "overlay.png", "difference.png",
    "convergence.svg", "report.html", ResultFileName };
  return names.count(name) > 0;
}

std::string CheckpointPath(const std::string& folder)
{
  const fs::path named(folder);
  return (named.has_filename() ? named : named.parent_path()).string() + ".checkpoint.json";
}

void CheckResultFolder(const std::string& path, bool overwrite)
{
  const fs::path folder(path);
  const std::string output = "output " + path + ": ";
  if (fs::exists(folder) && !IsEmptyFolder(path))
  {
    if (!overwrite)
    {
      throw InputError(output + "exists already", { "Output", path, { "Overwrite" } });
    }
    if (!fs::is_directory(folder) || !fs::exists(folder / ResultFileName))
    {
      throw InputError(output +
        "expected an earlier result (a folder with result.json) to overwrite, found something "
        "else");
    }
    if (const auto foreign = FindForeign(folder))
    {
      throw InputError(output +
        "expected nothing but an earlier result, which is replaced as a whole, found " +
        foreign->lexically_relative(folder).string() + "; it can be moved elsewhere");
    }
  }
  ReserveFolder(path);
}

void WriteRegistrationCase(const RegistrationCase& input, const RegistrationCaseResult& result,
  const std::string& path, bool overwrite)
{
  CheckResultFolder(path, overwrite);
  WriteAtomicFolder(path, [&](const std::string& folder) { WriteInto(folder, input, result); });
  if (!input.Checkpoint.empty())
  {
    fs::remove(input.Checkpoint);
  }
}
}
