// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_InputSurface_h
#define mammoray_InputSurface_h

#include "mammoray/Foundation/MaterialTable.h"
#include "mammoray/Foundation/Meshes.h"
#include "mammoray/IO/MeshConversion.h"
#include "mammoray/IO/SceneIO.h"

#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkPolyData.h"
#include "vtkUnstructuredGrid.h"

#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace mammoray
{
/// The interfaces of a filter's input, a grid or surfaces, and its materials' names.
class InputSurface
{
public:
  /// Extracts interfaces only where cells or their materials are others than at the last call;
  /// moved points move the last surface. Throws InputError.
  const std::shared_ptr<const SurfaceMesh>& Update(vtkDataObject* input)
  {
    if (auto* polyData = vtkPolyData::SafeDownCast(input))
    {
      this->Topology = TopologyStamp();
      this->Surface =
        std::make_shared<const SurfaceMesh>(FromPolyData(polyData, &this->MaterialNames));
      return this->Surface;
    }
    auto* grid = vtkUnstructuredGrid::SafeDownCast(input);
    const TopologyStamp topology(grid);
    if (!(topology == this->Topology) || !this->Surface)
    {
      this->Topology = TopologyStamp();
      this->Surface = std::make_shared<const SurfaceMesh>(
        ExtractInterfaces(FromGrid(grid, &this->MaterialNames), &this->PointIds));
      this->Topology = topology;
      return this->Surface;
    }
    std::vector<double> points(this->Surface->Points.size());
    for (std::size_t point = 0; point < this->PointIds.size(); ++point)
    {
      grid->GetPoint(this->PointIds[point], &points[3 * point]);
    }
    if (points != this->Surface->Points)
    {
      auto moved = std::make_shared<SurfaceMesh>(*this->Surface);
      moved->Points = std::move(points);
      this->Surface = std::move(moved);
    }
    return this->Surface;
  }

  /// The materials of the input by index: from the scene's table by name where the input names
  /// them, else by index. Throws InputError.
  MaterialTable MaterialsOf(const SceneDescription& scene) const
  {
    const MaterialTable known = scene.ReadTable();
    MaterialTable table;
    table.Name = "input";
    table.Materials.push_back({ .Name = "air" });
    for (int index = 1; index < this->Surface->NumberOfMaterials(); ++index)
    {
      const auto number = static_cast<std::size_t>(index);
      const bool isNamed =
        number < this->MaterialNames.size() && !this->MaterialNames[number].empty();
      const std::string name = isNamed ? this->MaterialNames[number] : std::to_string(index);
      const bool isByName =
        isNamed && !known.Materials.empty() && !scene.Attenuations.contains(name);
      const std::size_t inTable = isByName ? static_cast<std::size_t>(known.IndexOf(name)) : number;
      table.Materials.push_back(
        inTable < known.Materials.size() ? known.Materials[inTable] : Material());
      table.Materials.back().Name = name;
    }
    return table;
  }

private:
  /// What the interfaces of a grid depend on besides its points.
  struct TopologyStamp
  {
    explicit TopologyStamp(vtkUnstructuredGrid* grid = nullptr)
    {
      if (grid)
      {
        vtkDataArray* materials = grid->GetCellData()->GetArray(MaterialArrayName);
        this->Cells = grid->GetCells();
        this->Materials = materials;
        this->CellsTime = grid->GetCells() ? grid->GetCells()->GetMTime() : 0;
        this->MaterialsTime = materials ? materials->GetMTime() : 0;
        this->Points = grid->GetNumberOfPoints();
      }
    }
    bool operator==(const TopologyStamp&) const = default;

    const void* Cells = nullptr;
    const void* Materials = nullptr;
    vtkMTimeType CellsTime = 0;
    vtkMTimeType MaterialsTime = 0;
    vtkIdType Points = 0;
  };

  std::shared_ptr<const SurfaceMesh> Surface;
  std::vector<std::string> MaterialNames;
  std::vector<std::int32_t> PointIds;
  TopologyStamp Topology;
};
}

#endif
