// SPDX-License-Identifier: Apache-2.0
/**
 * @class   vtkXRayProjector
 * @brief   Projects a body of several materials onto a flat X-ray detector.
 *
 * Input 0: vtkUnstructuredGrid of linear tetrahedra with the cell array "Material" (index; 0 =
 * air), or vtkPolyData of triangles. Triangles have the cell arrays "FrontMaterial" (on the side of
 * the right-handed normal) and "BackMaterial"; or "Material", the material inside closed surfaces
 * in air; or no arrays, for closed surfaces of material 1. The field array "MaterialNames"
 * (strings) has the names of the materials 0, 1, 2, ...
 *
 * Output 0: vtkImageData, columns x rows x 1, at the place of the detector in the world frame of
 * the input (mm). Point arrays, one value per pixel: "Transmission" (float, (0, 1]),
 * "LogAttenuation" (float, -ln Transmission), "PathLength_<name>" (float, mm) for each material but
 * air, and "Consistency" (unsigned char): 1 if every ray of the pixel crossed closed surfaces; 0
 * where the mesh leaks and the value is estimated from neighbours. With refraction also
 * "Deflection" (float, radians along columns and rows).
 *
 * Properties and keys make a mammoray::Scene, and mammoray/XRay/Exposer.h keeps its mesh on the
 * Vulkan device across updates: moved points refit, a moved source or detector traces again, and
 * another beam or attenuation needs no tracing. Unusable input, a material without attenuation and
 * a missing device raise ErrorEvent once and leave the output empty.
 */
#ifndef vtkXRayProjector_h
#define vtkXRayProjector_h

#include "mammorayFiltersModule.h" // export macro
#include "vtkImageAlgorithm.h"
#include <string> // names

namespace mammoray
{
struct Scene;
struct SceneDescription;
}

class MAMMORAYFILTERS_EXPORT vtkXRayProjector : public vtkImageAlgorithm
{
public:
  static vtkXRayProjector* New();
  vtkTypeMacro(vtkXRayProjector, vtkImageAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /**
   * Sets what a key of scene files means (docs/reference/commands/scene-keys.md), as 'mammoray
   * project --set' does: SetKey("beam.tube", "W"), SetKey("source.beam-direction", "[0, 0, -1]"),
   * SetKey("attenuations.gland", "H2O@1.04"). The input's materials without a name are called by
   * their index: SetKey("attenuations.1", "0.05/mm"). Keys take precedence over properties and
   * the scene file. An empty text removes the key. Raises ErrorEvent on an unknown key and an
   * unusable value, and keeps what was set before. Dose is not computed here.
   */
  void SetKey(const char* key, const char* value);
  ///@}

  ///@{
  /**
   * Path of a scene file (docs/reference/scene-files.md) with source and detector. The input is
   * X-rayed if the scene has no samples and no mesh. Of the properties only PlacedByInput,
   * SourceToDetectorMm, DeviceName and ProjectionMethod count then. Default empty.
   */
  void SetSceneFile(const char* path);
  vtkGetCharFromStdStringMacro(SceneFile);
  ///@}

  ///@{
  /**
   * True: source and detector have the places of the input's field array "Placement", which
   * vtkBreastCompression, vtkBreastRegistration and the commands compress and register write. The
   * focus is SourceToDetectorMm (positive; default 650) above the receptor; columns run from its
   * chest-wall edge towards the nipple, rows along gantry -x, centred on the receptor. Of the
   * detector only its pixels count. Default false.
   */
  vtkSetMacro(PlacedByInput, bool);
  vtkGetMacro(PlacedByInput, bool);
  vtkBooleanMacro(PlacedByInput, bool);
  vtkSetMacro(SourceToDetectorMm, double);
  vtkGetMacro(SourceToDetectorMm, double);
  ///@}

  ///@{
  /**
   * Places, mm, and directions, in the world. SourcePosition is that of a point source, default (0,
   * 0, 650); DetectorOrigin the centre of the pixel in column 0 and row 0, default (0, 0, 0).
   * ColumnDirection and RowDirection are unit vectors at right angles towards the next column,
   * default (1, 0, 0), and towards the next row, default (0, 1, 0).
   */
  vtkSetVector3Macro(SourcePosition, double);
  vtkGetVector3Macro(SourcePosition, double);
  vtkSetVector3Macro(DetectorOrigin, double);
  vtkGetVector3Macro(DetectorOrigin, double);
  vtkSetVector3Macro(ColumnDirection, double);
  vtkGetVector3Macro(ColumnDirection, double);
  vtkSetVector3Macro(RowDirection, double);
  vtkGetVector3Macro(RowDirection, double);
  ///@}

  ///@{
  /**
   * PixelSpacing is the distance between the centres of neighbouring columns and of neighbouring
   * rows, mm, positive, default (0.1, 0.1). DetectorSize is the number of columns and of rows,
   * positive, default (256, 256).
   */
  vtkSetVector2Macro(PixelSpacing, double);
  vtkGetVector2Macro(PixelSpacing, double);
  vtkSetVector2Macro(DetectorSize, int);
  vtkGetVector2Macro(DetectorSize, int);
  ///@}

  enum ProjectionMethodType
  {
    AUTO = 0,
    RAY_TRACING = 1,
    RASTERISATION = 2
  };
  ///@{
  /**
   * Part of the Vulkan device's name, default empty: the most capable device; and how path lengths
   * are computed on it. AUTO, the default, traces rays on hardware that supports it and rasterises
   * on CPU devices and all others.
   */
  void SetDeviceName(const char* name);
  vtkGetCharFromStdStringMacro(DeviceName);
  vtkSetClampMacro(ProjectionMethod, int, AUTO, RASTERISATION);
  vtkGetMacro(ProjectionMethod, int);
  ///@}

  ///@{
  /**
   * MaterialTable is the path of a material table (JSON) or the name of a shipped one, with
   * attenuation and density of the input's materials: by name if the input has names, else by
   * index. Default empty: only those of keys. Spectrum is the path of a spectrum (see IO's
   * ReadSpectrum) or the name of a shipped one. Default empty: the beam of the keys, else photons
   * of 20 keV.
   */
  void SetMaterialTable(const char* pathOrName);
  vtkGetCharFromStdStringMacro(MaterialTable);
  void SetSpectrum(const char* pathOrName);
  vtkGetCharFromStdStringMacro(Spectrum);
  ///@}

  ///@{
  /**
   * Number of pixels of the last image whose Consistency is 0; and how often rays have been traced
   * on the present device: once per image and sample.
   */
  vtkGetMacro(NumberOfInconsistentPixels, vtkIdType);
  vtkGetMacro(NumberOfTraces, vtkIdType);
  ///@}

protected:
  vtkXRayProjector();
  ~vtkXRayProjector() override;
  int FillInputPortInformation(int port, vtkInformation* info) override;
  int RequestInformation(vtkInformation* request, vtkInformationVector** inputs,
    vtkInformationVector* outputs) override;
  int RequestUpdateExtent(vtkInformation* request, vtkInformationVector** inputs,
    vtkInformationVector* outputs) override;
  int RequestData(vtkInformation* request, vtkInformationVector** inputs,
    vtkInformationVector* outputs) override;

private:
  /// The scene file, or the properties; then the keys. Throws InputError.
  mammoray::SceneDescription Describe() const;
  /// The scene of Describe with what the input gives. Throws InputError.
  mammoray::Scene MakeScene(vtkDataObject* input);
  /// Throws InputError, DeviceError and Interrupted.
  void Project(vtkDataObject* input, vtkImageData* output);

  vtkXRayProjector(const vtkXRayProjector&) = delete;
  void operator=(const vtkXRayProjector&) = delete;

  std::string SceneFile;
  bool PlacedByInput = false;
  double SourceToDetectorMm = 650;
  double SourcePosition[3] = { 0, 0, 650 };
  double DetectorOrigin[3] = { 0, 0, 0 };
  double ColumnDirection[3] = { 1, 0, 0 };
  double RowDirection[3] = { 0, 1, 0 };
  double PixelSpacing[2] = { 0.1, 0.1 };
  int DetectorSize[2] = { 256, 256 };
  std::string MaterialTable;
  std::string Spectrum;
  std::string DeviceName;
  int ProjectionMethod = AUTO;
  vtkIdType NumberOfInconsistentPixels = 0;
  vtkIdType NumberOfTraces = 0;

  struct Internals;
  Internals* Internal;
};

#endif
