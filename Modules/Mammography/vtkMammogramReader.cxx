// SPDX-License-Identifier: Apache-2.0
#include "vtkMammogramReader.h"

#include "Error.h"
#include "MammogramIO.h"

#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkFloatArray.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkIntArray.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkStringArray.h"

#include <algorithm>

vtkStandardNewMacro(vtkMammogramReader);

struct vtkMammogramReader::Internals
{
  mammoray::Mammogram Mammogram;
  std::string LoadedFile;
  vtkTimeStamp LoadTime;
};

vtkMammogramReader::vtkMammogramReader()
  : Internal(new Internals)
{
  this->SetNumberOfInputPorts(0);
}

vtkMammogramReader::~vtkMammogramReader()
{
  delete this->Internal;
}

void vtkMammogramReader::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "FileName: " << this->FileName << "\n";
}

// The size is asked for before the pixels: one reading serves both until the reader is modified.
bool vtkMammogramReader::Load()
{
  Internals& in = *this->Internal;
  if (in.LoadedFile == this->FileName && !in.LoadedFile.empty() &&
    in.LoadTime.GetMTime() > this->GetMTime())
  {
    return true;
  }
  in.LoadedFile.clear();
  try
  {
    in.Mammogram = mammoray::ReadMammogram(this->FileName);
  }
  catch (const mammoray::Error& error)
  {
    vtkErrorMacro(<< error.what());
    return false;
  }
  in.LoadedFile = this->FileName;
  in.LoadTime.Modified();
  return true;
}

int vtkMammogramReader::RequestInformation(vtkInformation*, vtkInformationVector**,
  vtkInformationVector* outputs)
{
  if (!this->Load())
  {
    return 0;
  }
  const mammoray::Mammogram& mammogram = this->Internal->Mammogram;
  vtkInformation* information = outputs->GetInformationObject(0);
  const int extent[6] = { 0, mammogram.Columns - 1, 0, mammogram.Rows - 1, 0, 0 };
  const double spacing[3] = { mammogram.ColumnSpacingMm, mammogram.RowSpacingMm, 1 };
  const double origin[3] = { 0, 0, 0 };
  information->Set(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(), extent, 6);
  information->Set(vtkDataObject::SPACING(), spacing, 3);
  information->Set(vtkDataObject::ORIGIN(), origin, 3);
  vtkDataObject::SetPointDataActiveScalarInfo(information, VTK_FLOAT, 1);
  return 1;
}

int vtkMammogramReader::RequestData(vtkInformation*, vtkInformationVector**,
  vtkInformationVector* outputs)
{
  if (!this->Load())
  {
    return 0;
  }
  const mammoray::Mammogram& mammogram = this->Internal->Mammogram;
  vtkImageData* image = vtkImageData::GetData(outputs);
  image->SetDimensions(mammogram.Columns, mammogram.Rows, 1);
  image->SetSpacing(mammogram.ColumnSpacingMm, mammogram.RowSpacingMm, 1);
  image->SetOrigin(0, 0, 0);
  vtkNew<vtkFloatArray> pixels;
  pixels->SetName("Mammogram");
  pixels->SetNumberOfValues(static_cast<vtkIdType>(mammogram.Pixels.size()));
  for (int row = 0; row < mammogram.Rows; ++row)
  {
    const auto first =
      mammogram.Pixels.begin() + static_cast<std::ptrdiff_t>(row) * mammogram.Columns;
    std::copy(first, first + mammogram.Columns,
      pixels->GetPointer(static_cast<vtkIdType>(mammogram.Rows - 1 - row) * mammogram.Columns));
  }
  image->GetPointData()->SetScalars(pixels);

  const auto addText = [image](const char* name, const std::string& value)
  {
    vtkNew<vtkStringArray> array;
    array->SetName(name);
    array->InsertNextValue(value);
    image->GetFieldData()->AddArray(array);
  };
  const auto addNumber = [image](const char* name, const std::optional<double>& value)
  {
    if (value)
    {
      vtkNew<vtkDoubleArray> array;
      array->SetName(name);
      array->InsertNextValue(*value);
      image->GetFieldData()->AddArray(array);
    }
  };
  addText("View", mammogram.View);
  addText("Laterality", std::string(1, mammogram.Laterality));
  addText("RowDirection", mammogram.RowDirection);
  addText("ColumnDirection", mammogram.ColumnDirection);
  addText("PresentationIntent",
    mammogram.PresentationIntent == mammoray::Mammogram::Intent::ForProcessing
      ? "FOR PROCESSING"
      : "FOR PRESENTATION");
  vtkNew<vtkIntArray> inverted;
  inverted->SetName("InvertedForDisplay");
  inverted->InsertNextValue(mammogram.InvertedForDisplay ? 1 : 0);
  image->GetFieldData()->AddArray(inverted);
  addNumber("BodyPartThicknessMm", mammogram.BodyPartThicknessMm);
  addNumber("PositionerPrimaryAngleDeg", mammogram.PositionerPrimaryAngleDeg);
  addNumber("SourceToDetectorMm", mammogram.SourceToDetectorMm);
  addNumber("SourceToPatientMm", mammogram.SourceToPatientMm);
  addNumber("PeakKilovoltage", mammogram.PeakKilovoltage);
  return 1;
}
