// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Case/RegistrationCaseWriter.h"

#include "mammoray/Case/RegisteredBreast.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/IO/MeshConversion.h"
#include "mammoray/IO/MeshIO.h"
#include "mammoray/Report/RegistrationReport.h"

#include "vtkDoubleArray.h"
#include "vtkFloatArray.h"
#include "vtkImageData.h"
#include "vtkMetaImageWriter.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkUnstructuredGrid.h"

#include <algorithm>
#include <cctype>
#include <filesystem>

namespace mammoray
{
namespace
{
void WriteMeshes(const RegistrationCaseResult& result, const RegisteredView& view,
  const std::string& folder)
{
  const auto grid = UncompressedGrid(result, view);
  WriteMesh(grid, folder + "/uncompressed.vtu");

  vtkNew<vtkDoubleArray> compressed;
  compressed->SetNumberOfComponents(3);
  compressed->SetNumberOfTuples(grid->GetNumberOfPoints());
  std::copy(view.CompressedPoints.begin(), view.CompressedPoints.end(), compressed->GetPointer(0));
  grid->GetPoints()->SetData(compressed);
  grid->Modified();
  WriteMesh(grid, folder + "/compressed.vtu");
}

void WriteSynthetic(const RegisteredView& view, const std::string& path)
{
  vtkNew<vtkImageData> image;
  image->SetDimensions(view.Target.Columns, view.Target.Rows, 1);
  image->SetSpacing(view.Mammogram.ColumnSpacingMm, view.Mammogram.RowSpacingMm, 1.0);
  image->AllocateScalars(VTK_FLOAT, 1);
  std::copy(view.Synthetic.LogAttenuation.begin(), view.Synthetic.LogAttenuation.end(),
    static_cast<float*>(image->GetScalarPointer()));
  vtkNew<vtkMetaImageWriter> writer;
  writer->SetInputData(image);
  writer->SetFileName(path.c_str());
  writer->SetCompression(true);
  writer->Write();
  if (writer->GetErrorCode() != 0)
  {
    throw InputError(path + ": cannot be written");
  }
}

RegistrationReport ReportOf(const RegistrationCase& input, const RegistrationCaseResult& result,
  const RegisteredView& view)
{
  RegistrationReport report;
  report.RealMammogram = &view.Mammogram;
  report.Target = &view.Target;
  report.Result = &view.Registration;
  report.Synthetic = view.Synthetic.LogAttenuation;
  report.SyntheticOutline = { view.Synthetic.Outline };
  report.Placed = view.Placed;
  report.Unit = view.Unit;
  report.Timings = result.Timings;
  report.Inputs = CaseInputs(input, view.Path);
  report.Versions = { { "Vulkan device", result.Device }, { "Spectrum", input.Spectrum },
    { "Anatomy",
      std::to_string(result.Anatomy.NumberOfCells()) + " tetrahedra, " +
        std::to_string(result.SurfaceTriangles) + " interface triangles" },
    { "Mechanics", std::to_string(result.SimulationCells) + " quadratic tetrahedra" } };
  report.Warnings = view.Warnings;
  return report;
}
}

vtkSmartPointer<vtkUnstructuredGrid> UncompressedGrid(const RegistrationCaseResult& result,
  const RegisteredView& view)
{
  const auto grid = ToGrid(result.Anatomy, result.Materials.Names());
  AddPlacement(grid, view.Placed);
  vtkNew<vtkDoubleArray> displacement;
  displacement->SetName("Displacement");
  displacement->SetNumberOfComponents(3);
  displacement->SetNumberOfTuples(grid->GetNumberOfPoints());
  double* values = displacement->GetPointer(0);
  for (std::size_t index = 0; index < view.CompressedPoints.size(); ++index)
  {
    values[index] = view.CompressedPoints[index] - result.Anatomy.Points[index];
  }
  grid->GetPointData()->SetVectors(displacement);
  for (std::size_t parameter = 0; parameter < view.Sensitivities.size(); ++parameter)
  {
    const std::vector<double>& velocities = view.Sensitivities[parameter];
    if (velocities.empty())
    {
      continue;
    }
    // Floats: six digits of a derivative are plenty, and files stay half as large.
    vtkNew<vtkFloatArray> sensitivity;
    sensitivity->SetName(
      (SensitivityArrayPrefix + view.Registration.Parameters[parameter].Name).c_str());
    sensitivity->SetNumberOfComponents(3);
    sensitivity->SetNumberOfTuples(grid->GetNumberOfPoints());
    std::copy(velocities.begin(), velocities.end(), sensitivity->GetPointer(0));
    grid->GetPointData()->AddArray(sensitivity);
  }
  return grid;
}

std::vector<std::string> ViewFolders(const RegistrationCaseResult& result)
{
  if (result.Views.size() == 1)
  {
    return { "" };
  }
  std::vector<std::string> folders;
  for (const RegisteredView& view : result.Views)
  {
    std::string name;
    for (const char letter : view.Mammogram.View)
    {
      if (std::isalnum(static_cast<unsigned char>(letter)) != 0)
      {
        name += static_cast<char>(std::tolower(static_cast<unsigned char>(letter)));
      }
    }
    name = name.empty() ? "view" : name;
    std::string unique = name;
    for (int number = 2; std::find(folders.begin(), folders.end(), unique) != folders.end();
         ++number)
    {
      unique = name + "-" + std::to_string(number);
    }
    folders.push_back(unique);
  }
  return folders;
}

void WriteRegistrationCase(const RegistrationCase& input, const RegistrationCaseResult& result,
  const std::string& folder)
{
  JointReport joint;
  joint.Folders = ViewFolders(result);
  joint.Unknowns = result.Unknowns;
  joint.Covariance = result.Covariance;
  for (std::size_t number = 0; number < result.Views.size(); ++number)
  {
    const RegisteredView& view = result.Views[number];
    const std::string& name = joint.Folders[number];
    const std::string own = name.empty() ? folder : folder + "/" + name;
    std::filesystem::create_directories(own);
    WriteMeshes(result, view, own);
    WriteSynthetic(view, own + "/synthetic.mha");
    joint.Views.push_back(ReportOf(input, result, view));
  }
  if (result.Views.size() == 1)
  {
    WriteRegistrationReport(joint.Views.front(), folder);
  }
  else
  {
    WriteJointReport(joint, folder);
  }
}
}
