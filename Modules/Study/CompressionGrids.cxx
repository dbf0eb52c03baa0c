// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Study/CompressionGrids.h"

#include "mammoray/IO/AtomicFile.h"
#include "mammoray/IO/MeshIO.h"

#include "vtkCellData.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkUnstructuredGrid.h"
#include "vtkXMLDataElement.h"
#include "vtkXMLUtilities.h"

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <sstream>

namespace mammoray
{
namespace
{
vtkSmartPointer<vtkDoubleArray> MakeArray(const char* name, int components, std::size_t tuples)
{
  auto array = vtkSmartPointer<vtkDoubleArray>::New();
  array->SetName(name);
  array->SetNumberOfComponents(components);
  array->SetNumberOfTuples(static_cast<vtkIdType>(tuples));
  return array;
}

void AddValue(vtkFieldData* data, const char* name, double value)
{
  const auto array = MakeArray(name, 1, 1);
  array->SetValue(0, value);
  data->AddArray(array);
}

std::vector<double> CellMiddles(const TetrahedralMesh& mesh)
{
  std::vector<double> middles;
  for (std::size_t cell = 0; cell < mesh.NumberOfCells(); ++cell)
  {
    Vector3 middle{ 0, 0, 0 };
    for (int corner = 0; corner < 4; ++corner)
    {
      middle = middle + 0.25 * mesh.Point(mesh.Cells[4 * cell + corner]);
    }
    middles.insert(middles.end(), middle.begin(), middle.end());
  }
  return middles;
}

/// One value per node, as the first component of a vector: an embedding maps vectors.
std::vector<double> AsVectors(const std::vector<double>& values)
{
  std::vector<double> vectors(3 * values.size(), 0.0);
  for (std::size_t index = 0; index < values.size(); ++index)
  {
    vectors[3 * index] = values[index];
  }
  return vectors;
}
}

CompressionGrids::CompressionGrids(vtkUnstructuredGrid* grid, CompressionSimulation& simulation)
  : Grid(grid)
  , Simulation(simulation)
{
}

CompressionGrids::CompressionGrids(vtkUnstructuredGrid* grid, const TetrahedralMesh& mesh,
  CompressionSimulation& simulation)
  : Grid(grid)
  , Simulation(simulation)
  , Carried(mesh)
  , Points(std::in_place, simulation, mesh.Points)
  , Middles(std::in_place, simulation, CellMiddles(mesh))
{
}

vtkSmartPointer<vtkUnstructuredGrid> CompressionGrids::At(const CompressionState& state,
  std::optional<double> thicknessMm) const
{
  const auto pointCount = static_cast<std::size_t>(this->Grid->GetNumberOfPoints());
  const auto cellCount = static_cast<std::size_t>(this->Grid->GetNumberOfCells());
  std::vector<double> moved = state.Positions;
  const std::vector<double>& image = this->Simulation.ImagePositions();
  for (std::size_t c = 0; c < moved.size(); ++c)
  {
    moved[c] -= image[c];
  }
  std::vector<double> pressures = AsVectors(this->Simulation.ContactPressuresKPa(state));
  if (this->Points)
  {
    moved = this->Points->Map(moved);
    pressures = this->Points->Map(pressures);
  }
  const auto displacement = MakeArray("Displacement", 3, pointCount);
  const auto pressure = MakeArray("ContactPressureKPa", 1, pointCount);
  vtkNew<vtkPoints> points;
  points->SetDataTypeToDouble();
  points->SetNumberOfPoints(static_cast<vtkIdType>(pointCount));
  for (std::size_t p = 0; p < pointCount; ++p)
  {
    const auto id = static_cast<vtkIdType>(p);
    double position[3];
    this->Grid->GetPoint(id, position);
    points->SetPoint(id, position[0] + moved[3 * p], position[1] + moved[3 * p + 1],
      position[2] + moved[3 * p + 2]);
    displacement->SetTuple(id, &moved[3 * p]);
    // Quadratic shape functions undershoot beside a pressure's edge.
    pressure->SetValue(id, std::max(0.0, pressures[3 * p]));
  }

  const auto volumeRatio = MakeArray("J", 1, cellCount);
  const auto stress = MakeArray("VonMisesStressKPa", 1, cellCount);
  const std::vector<CellMeasures> measures = this->Simulation.MeasuresOf(state);
  std::size_t inverted = 0;
  std::optional<TetrahedralMesh> deformed = this->Carried;
  for (std::size_t c = 0; deformed && c < deformed->Points.size(); ++c)
  {
    deformed->Points[c] += moved[c];
  }
  for (std::size_t cell = 0; cell < cellCount; ++cell)
  {
    const std::size_t own =
      this->Middles ? static_cast<std::size_t>(this->Middles->Cells()[cell]) : cell;
    // Corners alone can turn over in a quadratic cell that has not: at the border of the fixed
    // tissue mostly.
    const double ratio =
      deformed ? deformed->CellVolume(cell) / this->Carried->CellVolume(cell) : measures[own].J;
    inverted += ratio > 0 ? 0 : 1;
    volumeRatio->SetValue(static_cast<vtkIdType>(cell), ratio);
    stress->SetValue(static_cast<vtkIdType>(cell), measures[own].VonMisesKPa);
  }

  auto result = vtkSmartPointer<vtkUnstructuredGrid>::New();
  result->ShallowCopy(this->Grid);
  result->SetPoints(points);
  result->GetPointData()->AddArray(displacement);
  result->GetPointData()->AddArray(pressure);
  result->GetCellData()->AddArray(volumeRatio);
  result->GetCellData()->AddArray(stress);
  vtkFieldData* data = result->GetFieldData();
  AddValue(data, "PaddleForceN", state.PaddleForceN);
  AddValue(data, "SupportForceN", state.SupportForceN);
  AddValue(data, "ThicknessMm", thicknessMm.value_or(GapMm(state.Plates)));
  AddValue(data, "LargestPenetrationMm", state.LargestPenetrationMm);
  AddValue(data, "LargestWallLiftMm", state.LargestWallLiftMm);
  AddValue(data, "LargestWallGlideMm", state.LargestWallGlideMm);
  AddValue(data, "SmallestJ", state.SmallestJ);
  AddValue(data, "LargestJ", state.LargestJ);
  AddValue(data, "VolumeRatio", state.VolumeRatio);
  AddValue(data, "RelativeResidual", state.RelativeResidual);
  AddValue(data, "StiffnessFactor", state.StiffnessFactor);
  if (deformed)
  {
    AddValue(data, "InvertedCells", static_cast<double>(inverted));
  }
  return result;
}

double TimeOf(std::size_t step, std::size_t count)
{
  return count > 1 ? static_cast<double>(step) / static_cast<double>(count - 1) : 1;
}

std::vector<std::string> SeriesFiles(const std::string& path, std::size_t count)
{
  const std::filesystem::path target(path);
  std::vector<std::string> files;
  for (std::size_t step = 0; step < count; ++step)
  {
    char suffix[32];
    std::snprintf(suffix, sizeof suffix, "_%03zu.vtu", step);
    files.push_back((target.parent_path() / (target.stem().string() + suffix)).string());
  }
  return files;
}

void WriteSeries(const std::string& path,
  const std::vector<vtkSmartPointer<vtkUnstructuredGrid>>& grids)
{
  const std::vector<std::string> files = SeriesFiles(path, grids.size());
  try
  {
    vtkNew<vtkXMLDataElement> collection;
    collection->SetName("Collection");
    for (std::size_t step = 0; step < grids.size(); ++step)
    {
      WriteMesh(grids[step], files[step]);
      vtkNew<vtkXMLDataElement> entry;
      entry->SetName("DataSet");
      entry->SetDoubleAttribute("timestep", TimeOf(step, grids.size()));
      entry->SetIntAttribute("part", 0);
      entry->SetAttribute("file", std::filesystem::path(files[step]).filename().string().c_str());
      collection->AddNestedElement(entry);
    }
    vtkNew<vtkXMLDataElement> file;
    file->SetName("VTKFile");
    file->SetAttribute("type", "Collection");
    file->SetAttribute("version", "0.1");
    file->AddNestedElement(collection);
    std::ostringstream text;
    vtkXMLUtilities::FlattenElement(file, text);
    WriteAtomicFile(path, text.str());
  }
  catch (...)
  {
    std::error_code ignored;
    for (const std::string& file : files)
    {
      std::filesystem::remove(file, ignored);
    }
    std::filesystem::remove(path, ignored);
    throw;
  }
}
}
