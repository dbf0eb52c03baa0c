// SPDX-License-Identifier: Apache-2.0
/**
 * @class   vtkMammogramReader
 * @brief   Reads a DICOM mammogram (modality MG, one frame).
 *
 * Output 0: vtkImageData, Columns x Rows x 1, point array "Mammogram" (float, modality rescale
 * applied, NaN where the header declares padding), spacing at the image receptor in mm, origin 0.
 * The first row of the picture is the last in the array, so that VTK shows it upright. MONOCHROME1
 * is not inverted. Field data: "View", "Laterality", "RowDirection", "ColumnDirection",
 * "PresentationIntent" (strings), "InvertedForDisplay", "IntensityRelationship" (0 not said, 1
 * linear, 2 logarithmic), "IntensitySign", "BitsStored" (ints), and those of "BodyPartThicknessMm",
 * "PositionerPrimaryAngleDeg", "SourceToDetectorMm", "SourceToPatientMm" and "PeakKilovoltage" that
 * the header states. A file that is missing, damaged or no mammogram raises ErrorEvent once and
 * leaves the output empty.
 */
#ifndef vtkMammogramReader_h
#define vtkMammogramReader_h

#include "mammorayFiltersModule.h" // export macro
#include "vtkImageAlgorithm.h"
#include <string> // the file name

class MAMMORAYFILTERS_EXPORT vtkMammogramReader : public vtkImageAlgorithm
{
public:
  static vtkMammogramReader* New();
  vtkTypeMacro(vtkMammogramReader, vtkImageAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /**
   * Path of the DICOM file.
   */
  void SetFileName(const char* path);
  vtkGetCharFromStdStringMacro(FileName);
  ///@}

protected:
  vtkMammogramReader();
  ~vtkMammogramReader() override;
  int RequestInformation(vtkInformation* request, vtkInformationVector** inputs,
    vtkInformationVector* outputs) override;
  int RequestData(vtkInformation* request, vtkInformationVector** inputs,
    vtkInformationVector* outputs) override;

private:
  vtkMammogramReader(const vtkMammogramReader&) = delete;
  void operator=(const vtkMammogramReader&) = delete;

  bool Load();

  struct Internals;
  Internals* Internal;
  std::string FileName;
};

#endif
