// SPDX-License-Identifier: Apache-2.0
/**
 * @class   vtkXRayProjector
 * @brief   Projects a body of several materials onto a flat X-ray detector.
 *
 * Input 0: vtkUnstructuredGrid of linear tetrahedra with the cell array "Material" (index; 0 =
 * air), or vtkPolyData of triangles with the cell arrays "FrontMaterial" and "BackMaterial" (front:
 * where the right-handed normal points), or with "Material", the material inside of closed surfaces
 * in air, or without arrays (closed surfaces of material 1). The field array "MaterialNames"
 * (strings) names the materials 0, 1, 2, ...
 *
 * Output 0: vtkImageData, columns x rows x 1, that lies where the detector is, in the world frame
 * of the input (mm). Point arrays, one value per pixel: "Transmission" (float, (0, 1]),
 * "LogAttenuation" (float, -ln Transmission), "PathLength_<name>" (float, mm) for each material but
 * air, and "Consistency" (unsigned char, 1 = every ray of the pixel crossed closed surfaces, 0 =
 * the mesh leaks there and the value is estimated from neighbours).
 *
 * With Refraction "Deflection" (float, radians along columns and rows) comes with them.
 *
 * The Vulkan device and the mesh on it live across updates: moved points refit the structure, a
 * moved source or detector only traces again, and another beam or attenuation does not even that
 * (as long as the path lengths of all samples fit into 512 MiB). Unusable input, a material without
 * attenuation or a missing device raises ErrorEvent once and leaves the output empty.
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
   * True where source and detector stand as the input's field array "Placement" says (of
   * vtkBreastCompression, vtkBreastRegistration and the meshes that the commands compress and
   * register write): the focus SourceToDetectorMm above the
   * receptor, columns from its chest-wall edge towards the nipple, rows along gantry -x, their
   * middle at the receptor's. Only PixelSpacing and DetectorSize count then. Default false.
   */
  vtkSetMacro(PlacedByInput, bool);
  vtkGetMacro(PlacedByInput, bool);
  vtkBooleanMacro(PlacedByInput, bool);
  ///@}

  ///@{
  /**
   * Focus to receptor plane where PlacedByInput is true, mm. Positive; default 650.
   */
  vtkSetMacro(SourceToDetectorMm, double);
  vtkGetMacro(SourceToDetectorMm, double);
  ///@}

  ///@{
  /**
   * Position of a point source, mm, world. Default (0, 0, 650).
   */
  vtkSetVector3Macro(SourcePosition, double);
  vtkGetVector3Macro(SourcePosition, double);
  ///@}

  ///@{
  /**
   * True for parallel X-rays along BeamDirection instead of a point source. Default false.
   */
  vtkSetMacro(ParallelBeam, bool);
  vtkGetMacro(ParallelBeam, bool);
  vtkBooleanMacro(ParallelBeam, bool);
  ///@}

  ///@{
  /**
   * Direction in which parallel X-rays travel, any length, world. Default (0, 0, -1).
   */
  vtkSetVector3Macro(BeamDirection, double);
  vtkGetVector3Macro(BeamDirection, double);
  ///@}

  ///@{
  /**
   * Centre of the detector's pixel in column 0 and row 0, mm, world. Default (0, 0, 0).
   */
  vtkSetVector3Macro(DetectorOrigin, double);
  vtkGetVector3Macro(DetectorOrigin, double);
  ///@}

  ///@{
  /**
   * Unit vector along a row, towards the next column, world. Default (1, 0, 0).
   */
  vtkSetVector3Macro(ColumnDirection, double);
  vtkGetVector3Macro(ColumnDirection, double);
  ///@}

  ///@{
  /**
   * Unit vector along a column, towards the next row, world; at right angles to ColumnDirection.
   * Default (0, 1, 0).
   */
  vtkSetVector3Macro(RowDirection, double);
  vtkGetVector3Macro(RowDirection, double);
  ///@}

  ///@{
  /**
   * Distance between the centres of neighbouring columns and of neighbouring rows, mm. Positive;
   * default (0.1, 0.1).
   */
  vtkSetVector2Macro(PixelSpacing, double);
  vtkGetVector2Macro(PixelSpacing, double);
  ///@}

  ///@{
  /**
   * Number of columns and of rows. Positive; default (256, 256).
   */
  vtkSetVector2Macro(DetectorSize, int);
  vtkGetVector2Macro(DetectorSize, int);
  ///@}

  ///@{
  /**
   * Samples x Samples rays per pixel; transmissions are averaged, and path lengths. 1 to 16;
   * default 1.
   */
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
   * Mean number of photons that meet a pixel without the object, 0 to 1e12; quantum noise of them
   * is added from NoiseSeed. Default 0, no noise.
   */
  vtkSetMacro(PhotonsPerPixel, double);
  vtkGetMacro(PhotonsPerPixel, double);
  vtkSetMacro(NoiseSeed, int);
  vtkGetMacro(NoiseSeed, int);
  ///@}

  ///@{
  /**
   * True where what breast tissue scatters is added, by the thickness along each ray
   * (mammoray/XRay/Scatter/ScatterModel.h), AirGapMm from the back of the tissue to the detector, 0
   * to 200 mm. Defaults false, 17.
   */
  vtkSetMacro(Scatter, bool);
  vtkGetMacro(Scatter, bool);
  vtkBooleanMacro(Scatter, bool);
  vtkSetMacro(AirGapMm, double);
  vtkGetMacro(AirGapMm, double);
  ///@}

  ///@{
  /**
   * Anti-scatter grid of lead and fibre, focused on the source, before a detector with Scatter:
   * ratio (0: no grid, the default; else 1 to 30), lines per cm (5 to 200), thickness of the septa,
   * micrometres. Transmissions are relative to air behind it. Septa run along the rows' direction.
   */
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
   * Whether rays are bent where they pass bodies (mammoray/XRay/Refraction.h), BendDistanceMm
   * before the detector, not negative; materials need attenuations that are compositions. Without
   * noise and scatter. Defaults NO_REFRACTION, 0.
   */
  vtkSetClampMacro(Refraction, int, NO_REFRACTION, NEAR_FIELD);
  vtkGetMacro(Refraction, int);
  vtkSetMacro(BendDistanceMm, double);
  vtkGetMacro(BendDistanceMm, double);
  ///@}

  ///@{
  /**
   * Part of the wanted Vulkan device's name; empty takes the most capable one. Default empty.
   */
  void SetDeviceName(const char* name);
  vtkGetCharFromStdStringMacro(DeviceName);
  ///@}

  enum ProjectionMethodType
  {
    AUTO = 0,
    RAY_TRACING = 1,
    RASTERISATION = 2
  };
  ///@{
  /**
   * How path lengths are found. AUTO, the default, traces rays on hardware that can and rasterises
   * on CPU devices and on all others.
   */
  vtkSetClampMacro(ProjectionMethod, int, AUTO, RASTERISATION);
  vtkGetMacro(ProjectionMethod, int);
  ///@}

  ///@{
  /**
   * Path of a material table (JSON), or the name of a shipped one, with attenuation and density of
   * the input's materials: by name where the input names them, else by index. SetAttenuationTable
   * and SetLinearAttenuation go before it. Empty: only what these say. Default empty.
   */
  void SetMaterialTable(const char* pathOrName);
  vtkGetCharFromStdStringMacro(MaterialTable);
  ///@}

  ///@{
  /**
   * Path of a material table's file, which goes before MaterialTable: for interfaces that offer the
   * shipped ones as a list, as ParaView does. Empty, the default: none.
   */
  void SetMaterialTableFile(const char* path);
  vtkGetCharFromStdStringMacro(MaterialTableFile);
  ///@}

  ///@{
  /**
   * Path of a spectrum (.spc) or the name of a shipped one. Empty: what SetMonochromatic or
   * AddSpectrumLine said. Default empty.
   */
  void SetSpectrum(const char* pathOrName);
  vtkGetCharFromStdStringMacro(Spectrum);
  ///@}

  ///@{
  /**
   * Path of a spectrum's file, which goes before Spectrum: for interfaces that offer the shipped
   * ones as a list, as ParaView does. Empty, the default: none.
   */
  void SetSpectrumFile(const char* path);
  vtkGetCharFromStdStringMacro(SpectrumFile);
  ///@}

  /**
   * All photons have this energy, keV. The default beam has 20 keV.
   */
  void SetMonochromatic(double energyKeV);

  /**
   * Removes all photons, before AddSpectrumLine.
   */
  void ClearSpectrum();

  /**
   * Adds photons of an energy (keV, above all added before) in any common unit.
   */
  void AddSpectrumLine(double energyKeV, double photons);

  /**
   * Gives a material the attenuation table of that name in the data directory ("adipose",
   * "glandular"), scaled to the density, g/cm^3. Read at the next update.
   */
  void SetAttenuationTable(int material, const std::string& table, double densityGPerCm3);

  /**
   * Gives a material a linear attenuation coefficient that does not depend on energy, 1/mm,
   * positive.
   */
  void SetLinearAttenuation(int material, double muPerMm);

  /**
   * Forgets the attenuation of all materials.
   */
  void ClearAttenuation();

  /**
   * Number of pixels of the last image whose Consistency is 0.
   */
  vtkGetMacro(NumberOfInconsistentPixels, vtkIdType);

  /**
   * How often rays have been traced (once per image and sample) since the filter was made.
   */
  vtkGetMacro(NumberOfTraces, vtkIdType);

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
  /// Throws InputError, DeviceError and Interrupted.
  void Project(vtkDataObject* input, vtkImageData* output);
  /// Bring the properties into the scene. Throw InputError.
  void PlaceBeam(vtkDataObject* input, mammoray::Scene& scene) const;
  void SetDetection(mammoray::Scene& scene) const;

  vtkXRayProjector(const vtkXRayProjector&) = delete;
  void operator=(const vtkXRayProjector&) = delete;

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
