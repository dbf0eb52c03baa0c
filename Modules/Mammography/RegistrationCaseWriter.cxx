// SPDX-License-Identifier: Apache-2.0
#include "RegistrationCaseWriter.h"

#include "Error.h"
#include "MeshConversion.h"
#include "MeshIO.h"
#include "RegisteredBreast.h"
#include "RegistrationReport.h"

#include "vtkDoubleArray.h"
#include "vtkFloatArray.h"
#include "vtkImageData.h"
#include "vtkMetaImageWriter.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkUnstructuredGrid.h"

#include <algorithm>

namespace mammoray
{
namespace
{
void WriteMeshes(const RegistrationCaseResult& result, const std::string& folder)
{
  const auto grid = UncompressedGrid(result);
  WriteMesh(grid, folder + "/uncompressed.vtu");

  vtkNew<vtkDoubleArray> compressed;
  compressed->SetNumberOfComponents(3);
  compressed->SetNumberOfTuples(grid->GetNumberOfPoints());
  std::copy(result.CompressedPoints.begin(), result.CompressedPoints.end(),
    compressed->GetPointer(0));
  grid->GetPoints()->SetData(compressed);
  grid->Modified();
  WriteMesh(grid, folder + "/compressed.vtu");
}

void WriteSynthetic(const RegistrationCaseResult& result, const std::string& path)
{
  vtkNew<vtkImageData> image;
  image->SetDimensions(result.Target.Columns, result.Target.Rows, 1);
  image->SetSpacing(result.Mammogram.ColumnSpacingMm, result.Mammogram.RowSpacingMm, 1.0);
  image->AllocateScalars(VTK_FLOAT, 1);
  std::copy(result.Synthetic.LogAttenuation.begin(), result.Synthetic.LogAttenuation.end(),
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
}

vtkSmartPointer<vtkUnstructuredGrid> UncompressedGrid(const RegistrationCaseResult& result)
{
  const auto grid = ToGrid(result.Anatomy, result.Materials.Names());
  vtkNew<vtkDoubleArray> displacement;
  displacement->SetName("Displacement");
  displacement->SetNumberOfComponents(3);
  displacement->SetNumberOfTuples(grid->GetNumberOfPoints());
  double* values = displacement->GetPointer(0);
  for (std::size_t index = 0; index < result.CompressedPoints.size(); ++index)
  {
    values[index] = result.CompressedPoints[index] - result.Anatomy.Points[index];
  }
  grid->GetPointData()->SetVectors(displacement);
  for (std::size_t parameter = 0; parameter < result.Sensitivities.size(); ++parameter)
  {
    const std::vector<double>& velocities = result.Sensitivities[parameter];
    if (velocities.empty())
    {
      continue;
    }
    // Floats: six digits of a derivative are plenty, and files stay half as large.
    vtkNew<vtkFloatArray> sensitivity;
    sensitivity->SetName(
      (SensitivityArrayPrefix + result.Registration.Parameters[parameter].Name).c_str());
    sensitivity->SetNumberOfComponents(3);
    sensitivity->SetNumberOfTuples(grid->GetNumberOfPoints());
    std::copy(velocities.begin(), velocities.end(), sensitivity->GetPointer(0));
    grid->GetPointData()->AddArray(sensitivity);
  }
  return grid;
}

void WriteRegistrationCase(const RegistrationCase& input, const RegistrationCaseResult& result,
  const std::string& folder)
{
  WriteMeshes(result, folder);
  WriteSynthetic(result, folder + "/synthetic.mha");

  RegistrationReport report;
  report.RealMammogram = &result.Mammogram;
  report.Target = &result.Target;
  report.Result = &result.Registration;
  report.Synthetic = result.Synthetic.LogAttenuation;
  report.SyntheticOutline = { result.Synthetic.Outline };
  report.Placed = result.Placed;
  report.Unit = result.Unit;
  report.Timings = result.Timings;
  report.Inputs = CaseInputs(input);
  report.Versions = { { "Vulkan device", result.Device }, { "Spectrum", input.Spectrum },
    { "Anatomy",
      std::to_string(result.Anatomy.NumberOfCells()) + " tetrahedra, " +
        std::to_string(result.SurfaceTriangles) + " interface triangles" },
    { "Mechanics", std::to_string(result.SimulationCells) + " quadratic tetrahedra" } };
  report.Warnings = result.Warnings;
  WriteRegistrationReport(report, folder);
}
}
