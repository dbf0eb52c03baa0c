// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Filters/vtkBreastMesher.h"

#include "Private/FilterRequest.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/LabelEditing.h"
#include "mammoray/Foundation/ValidRange.h"
#include "mammoray/IO/ImageConversion.h"
#include "mammoray/IO/MeshConversion.h"
#include "mammoray/IO/ShippedData.h"

#ifdef MAMMORAY_HAS_MESHING
#include "mammoray/Meshing/LabelMesher.h"
#endif

#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkUnstructuredGrid.h"

#include <algorithm>

namespace
{
using namespace mammoray;

#ifdef MAMMORAY_HAS_MESHING
/// Labels as material indices, named by their numbers.
MaterialTable TableOfIndices(const LabelVolume& labels)
{
  MaterialTable table;
  table.Name = "labels";
  const int most = labels.CountLabels().rbegin()->first;
  for (int label = 0; label <= most; ++label)
  {
    Material& material = table.Materials.emplace_back();
    material.Name = label == 0 ? "air" : std::to_string(label);
    table.MaterialOfLabel[label] = label;
  }
  return table;
}
#endif
}

vtkStandardNewMacro(vtkBreastMesher);

vtkBreastMesher::vtkBreastMesher() = default;
vtkBreastMesher::~vtkBreastMesher() = default;

mammorayCxxSetTextMacro(vtkBreastMesher, MaterialTable);
mammorayCxxSetTextMacro(vtkBreastMesher, MaterialTableFile);

int vtkBreastMesher::FillInputPortInformation(int, vtkInformation* info)
{
  info->Set(vtkAlgorithm::INPUT_REQUIRED_DATA_TYPE(), "vtkImageData");
  return 1;
}

int vtkBreastMesher::RequestUpdateExtent(vtkInformation*, vtkInformationVector** inputs,
  vtkInformationVector*)
{
  RequestWholeExtent(inputs[0]->GetInformationObject(0));
  return 1;
}

int vtkBreastMesher::RequestData(vtkInformation*, vtkInformationVector** inputs,
  vtkInformationVector* outputs)
{
  vtkUnstructuredGrid* output = vtkUnstructuredGrid::GetData(outputs);
  return AnswerRequest(this, output,
    [&]() { this->Mesh(vtkImageData::GetData(inputs[0]), output); });
}

void vtkBreastMesher::Mesh(vtkImageData* input, vtkUnstructuredGrid* output)
{
#ifdef MAMMORAY_HAS_MESHING
  const LabelVolume labels = ToLabelVolume(input);
  if (!this->AcceptUnusual)
  {
    CheckValidRange(ValidRanges::VoxelSpacing, labels.Spacing, "input");
  }
  const std::string& name = FileOrName(this->MaterialTableFile, this->MaterialTable);
  const mammoray::MaterialTable table =
    name.empty() ? TableOfIndices(labels) : FindMaterialTable(name);
  LabelVolume materials = table.ToMaterials(labels, "input");
  if (this->LabelSpacingMm > *std::max_element(labels.Spacing.begin(), labels.Spacing.end()))
  {
    materials = ResampleLabels(materials, this->LabelSpacingMm);
  }
  MeshingResult result;
  if (this->ForMechanics)
  {
    result = MeshForSimulation(materials, table.Fixed(), this->CellSizeMm, ProgressOf(this));
  }
  else
  {
    MeshingOptions options = MeshingOptions::Anatomy(table.Thin());
    options.CellSizeMm = this->CellSizeMm;
    options.Triangles = static_cast<std::size_t>(this->NumberOfTriangles);
    result = MeshMaterials(materials, options, ProgressOf(this));
  }
  output->ShallowCopy(ToGrid(result.Mesh, table.Names()));
  vtkNew<vtkDoubleArray> volumes;
  volumes->SetName("MaterialVolumesMm3");
  volumes->SetNumberOfValues(static_cast<vtkIdType>(table.Materials.size()));
  volumes->Fill(0);
  for (const MaterialReport& report : result.Reports)
  {
    volumes->SetValue(report.Material, report.VolumeOutMm3);
  }
  output->GetFieldData()->AddArray(volumes);
#else
  static_cast<void>(input);
  static_cast<void>(output);
  throw InputError("meshing: this build has no Meshing module");
#endif
}

void vtkBreastMesher::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "MaterialTable: " << this->MaterialTable << "\n";
  os << indent << "MaterialTableFile: " << this->MaterialTableFile << "\n";
  os << indent << "LabelSpacingMm: " << this->LabelSpacingMm << "\n";
  os << indent << "CellSizeMm: " << this->CellSizeMm << "\n";
  os << indent << "NumberOfTriangles: " << this->NumberOfTriangles << "\n";
  os << indent << "ForMechanics: " << this->ForMechanics << "\n";
  os << indent << "AcceptUnusual: " << this->AcceptUnusual << "\n";
}
