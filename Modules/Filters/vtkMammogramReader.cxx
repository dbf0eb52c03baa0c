// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Filters/vtkMammogramReader.h"

#include "Private/FilterRequest.h"
#include "mammoray/Dicom/DicomReader.h"
#include "mammoray/IO/ImageConversion.h"

#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkObjectFactory.h"
#include "vtkStreamingDemandDrivenPipeline.h"

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

mammorayCxxSetTextMacro(vtkMammogramReader, FileName);

void vtkMammogramReader::PrintSelf(ostream& os, vtkIndent indent)
{
  this->Superclass::PrintSelf(os, indent);
  os << indent << "FileName: " << this->FileName << "\n";
}

// VTK requests the size before the pixels. One reading serves both until the reader is modified.
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
  catch (const std::exception& error)
  {
    vtkErrorMacro(<< mammoray::TextOf(error));
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
  vtkImageData::GetData(outputs)->ShallowCopy(mammoray::ToImage(this->Internal->Mammogram));
  return 1;
}
