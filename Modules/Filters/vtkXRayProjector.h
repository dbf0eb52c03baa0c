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
 * where the mesh leaks and the value is estimated from neighbours. With Refraction also
 * "Deflection" (float, radians along columns and rows).
 *
 * Properties make a scene for mammoray/XRay/Exposer.h, which keeps the mesh on the Vulkan device
 * across updates: moved points refit, a moved source or detector traces again, and another beam or
 * attenuation needs no tracing. Unusable input, a material without attenuation and a missing device
 * raise ErrorEvent once and leave the output empty.
 */
#ifndef vtkXRayProjector_h
#define vtkXRayProjector_h

#include "mammorayFiltersModule.h" // export macro
#include "vtkImageAlgorithm.h"
#include <string> // names

namespace mammoray
{
struct Scene;
}

class MAMMORAYFILTERS_EXPORT vtkXRayProjector : public vtkImageAlgorithm
{
public:
  static vtkXRayProjector* New();
  vtkTypeMacro(vtkXRayProjector, vtkImageAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /**
   * Path of a scene file (docs/reference/scene-files.md) with samples or a mesh, source and
   * detector. The filter then needs no input, and only DeviceName and ProjectionMethod of its
   * properties count. Default empty.
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
   * detector's properties only PixelSpacing and DetectorSize are used. Default false.
   */
  vtkSetMacro(PlacedByInput, bool);
  vtkGetMacro(PlacedByInput, bool);
  vtkBooleanMacro(PlacedByInput, bool);
  vtkSetMacro(SourceToDetectorMm, double);
  vtkGetMacro(SourceToDetectorMm, double);
  ///@}

  ///@{
  /**
   * Position of a point source, mm, world; default (0, 0, 650). With ParallelBeam instead parallel
   * X-rays that travel along BeamDirection, of any length, world; defaults false, (0, 0, -1).
   */
  vtkSetVector3Macro(SourcePosition, double);
  vtkGetVector3Macro(SourcePosition, double);
  vtkSetMacro(ParallelBeam, bool);
  vtkGetMacro(ParallelBeam, bool);
  vtkBooleanMacro(ParallelBeam, bool);
  vtkSetVector3Macro(BeamDirection, double);
  vtkGetVector3Macro(BeamDirection, double);
  ///@}

  ///@{
  /**
   * DetectorOrigin is the centre of the pixel in column 0 and row 0, mm, world, default (0, 0, 0).
   * ColumnDirection and RowDirection are unit vectors at right angles, world, towards the next
   * column, default (1, 0, 0), and towards the next row, default (0, 1, 0).
   */
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
   * positive, default (256, 256). Each pixel has Samples x Samples rays, whose transmissions and
   * path lengths are averaged; Samples is 1 to 16, default 1.
   */
  vtkSetVector2Macro(PixelSpacing, double);
  vtkGetVector2Macro(PixelSpacing, double);
  vtkSetVector2Macro(DetectorSize, int);
  vtkGetVector2Macro(DetectorSize, int);
  vtkSetMacro(Samples, int);
  vtkGetMacro(Samples, int);
  ///@}

  ///@{
  /**
   * True when the detector counts photons, false when it adds up their energy. Default false.
   */
  vtkSetMacro(PhotonCounting, bool);
  vtkGetMacro(PhotonCounting, bool);
  vtkBooleanMacro(PhotonCounting, bool);
  ///@}

  ///@{
  /**
   * Mean number of photons that meet a pixel without the object, 0 to 1e12. Their quantum noise
   * follows from NoiseSeed. Default 0: no noise.
   */
  vtkSetMacro(PhotonsPerPixel, double);
  vtkGetMacro(PhotonsPerPixel, double);
  vtkSetMacro(NoiseSeed, int);
  vtkGetMacro(NoiseSeed, int);
  ///@}

  ///@{
  /**
   * Whether scatter of breast tissue is added, from the thickness along each ray
   * (mammoray/XRay/Scatter/ScatterModel.h). AirGapMm is the distance from the back of the tissue to
   * the detector, 0 to 200 mm. Grid is an anti-scatter grid of lead and fibre, focused on the
   * source, with septa along the rows' direction: ratio (0: no grid; else 1 to 30), lines per cm (5
   * to 200), thickness of the septa, micrometres. Transmissions are relative to air behind the
   * grid. Defaults false, 17, (0, 31, 65).
   */
  vtkSetMacro(Scatter, bool);
  vtkGetMacro(Scatter, bool);
  vtkBooleanMacro(Scatter, bool);
  vtkSetMacro(AirGapMm, double);
  vtkGetMacro(AirGapMm, double);
  vtkSetVector3Macro(Grid, double);
  vtkGetVector3Macro(Grid, double);
  ///@}

  enum RefractionType
  {
    NO_REFRACTION = 0,
    GEOMETRIC = 1,
    NEAR_FIELD = 2
  };
  ///@{
  /**
   * Whether bodies bend rays (RefractionOptions of mammoray/XRay/Exposure.h), at the distance
   * BendDistanceMm from the detector, not negative. Attenuations of materials must be compositions.
   * Excludes noise and scatter. Defaults NO_REFRACTION, 0.
   */
  vtkSetClampMacro(Refraction, int, NO_REFRACTION, NEAR_FIELD);
  vtkGetMacro(Refraction, int);
  vtkSetMacro(BendDistanceMm, double);
  vtkGetMacro(BendDistanceMm, double);
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
   * Path of a material table (JSON) or the name of a shipped one, with attenuation and density of
   * the input's materials: by name if the input has names, else by index. SetAttenuationTable and
   * SetLinearAttenuation take precedence. Default empty: only these. MaterialTableFile, a path,
   * takes precedence; it serves interfaces that offer the shipped tables as a list, as ParaView
   * does.
   */
  void SetMaterialTable(const char* pathOrName);
  vtkGetCharFromStdStringMacro(MaterialTable);
  void SetMaterialTableFile(const char* path);
  vtkGetCharFromStdStringMacro(MaterialTableFile);
  ///@}

  ///@{
  /**
   * Path of a spectrum (see IO's ReadSpectrum) or the name of a shipped one. Default empty: the
   * photons of SetMonochromatic or AddSpectrumLine. SpectrumFile, a path, takes precedence.
   */
  void SetSpectrum(const char* pathOrName);
  vtkGetCharFromStdStringMacro(Spectrum);
  void SetSpectrumFile(const char* path);
  vtkGetCharFromStdStringMacro(SpectrumFile);
  ///@}

  ///@{
  /**
   * The photons: all of one energy, keV; or none, and then some of each energy (keV, above all
   * added before) in any common unit. The default beam has 20 keV.
   */
  void SetMonochromatic(double energyKeV);
  void ClearSpectrum();
  void AddSpectrumLine(double energyKeV, double photons);
  ///@}

  ///@{
  /**
   * Gives a material the attenuation table of that name in the data directory ("adipose",
   * "glandular"), scaled to the density, g/cm^3 (0: its own, where it has one), and read at the
   * next update; or a linear attenuation coefficient that does not depend on energy, 1/mm,
   * positive. ClearAttenuation removes what was set for single materials.
   */
  void SetAttenuationTable(int material, const std::string& table, double densityGPerCm3 = 0);
  void SetLinearAttenuation(int material, double muPerMm);
  void ClearAttenuation();
  ///@}

  ///@{
  /**
   * Number of pixels of the last image whose Consistency is 0; and how often rays have been traced
   * since the filter was made: once per image and sample.
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
  /// The scene file, or what the properties make of the input. Throws InputError.
  mammoray::Scene Describe(vtkDataObject* input);
  /// Throws InputError, DeviceError and Interrupted.
  void Project(vtkDataObject* input, vtkImageData* output);
  /// Bring the properties into the scene. Throw InputError.
  void PlaceBeam(vtkDataObject* input, mammoray::Scene& scene) const;
  void DescribeDetection(mammoray::Scene& scene) const;

  vtkXRayProjector(const vtkXRayProjector&) = delete;
  void operator=(const vtkXRayProjector&) = delete;

  std::string SceneFile;
  bool PlacedByInput = false;
  double SourceToDetectorMm = 650;
  double SourcePosition[3] = { 0, 0, 650 };
  bool ParallelBeam = false;
  double BeamDirection[3] = { 0, 0, -1 };
  double DetectorOrigin[3] = { 0, 0, 0 };
  double ColumnDirection[3] = { 1, 0, 0 };
  double RowDirection[3] = { 0, 1, 0 };
  double PixelSpacing[2] = { 0.1, 0.1 };
  int DetectorSize[2] = { 256, 256 };
  int Samples = 1;
  bool PhotonCounting = false;
  double PhotonsPerPixel = 0;
  int NoiseSeed = 0;
  bool Scatter = false;
  double AirGapMm = 17;
  double Grid[3] = { 0, 31, 65 };
  int Refraction = NO_REFRACTION;
  double BendDistanceMm = 0;
  std::string MaterialTable;
  std::string MaterialTableFile;
  std::string Spectrum;
  std::string SpectrumFile;
  std::string DeviceName;
  int ProjectionMethod = AUTO;
  vtkIdType NumberOfInconsistentPixels = 0;
  vtkIdType NumberOfTraces = 0;

  struct Internals;
  Internals* Internal;
};

#endif
