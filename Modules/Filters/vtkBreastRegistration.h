// SPDX-License-Identifier: Apache-2.0
/**
 * @class   vtkBreastRegistration
 * @brief   Finds the compression and pose whose synthetic mammogram matches a mammogram.
 *
 * Input 0: the uncompressed breast, vtkUnstructuredGrid of linear tetrahedra (mm) with the cell
 * array "Material" (indices of MaterialTable), as vtkBreastMesher makes it; or the labels
 * themselves, vtkImageData as that filter takes them: then meshes, stiffness and where the unit
 * stands follow from them as in 'mammoray register'. Input 1: the
 * mammogram, vtkImageData of vtkMammogramReader. Input 2, optional: a coarse vtkUnstructuredGrid to
 * simulate on (vtkBreastMesher with ForMechanics); made of input 0 where it is missing.
 *
 * Output 0: the breast compressed, with the arrays of the uncompressed grid, the point arrays
 * "Displacement" (3 doubles, mm) and "Sensitivity_<name>" of each free parameter (3 doubles, mm per
 * mm or degree, seen from the unit), and the field arrays
 * "ParameterNames" (n strings), "Parameters" (n doubles; mm, degrees, or a factor),
 * "ParameterDeviations" (n doubles, NaN where fixed), "Covariance" (n x n doubles, row by row, 0
 * for fixed ones; no values where it is not known), "Placement" (4 x 3 doubles: the gantry's
 * origin, mm, and its x, y and z axes in the frame of the input), "Correlation",
 * "TissueCorrelation", "MeanOutlineDistanceMm", "LargestOutlineDistanceMm", "PaddleForceN",
 * "Converged" (0 or 1), "StopReason" (string), "Trust" ("good", "doubtful" or "none"),
 * "TrustReasons" (a string for each reason not to trust) and "ExpectedErrorMm" (2 doubles: half of
 * the tissue between the plates lies within the first, 95 % within the second, if both are of one
 * breast; no values where the covariance is not known).
 *
 * Meshes, simulation, mammogram and Vulkan device are kept: another mammogram does not mesh again,
 * another start neither. An abort during the search ends it with the best pose so far, before it
 * with an empty output. Unusable input raises ErrorEvent once and leaves the output empty.
 */
#ifndef vtkBreastRegistration_h
#define vtkBreastRegistration_h

#include "mammorayFiltersModule.h" // export macro
#include "vtkUnstructuredGridAlgorithm.h"
#include <string> // names

class MAMMORAYFILTERS_EXPORT vtkBreastRegistration : public vtkUnstructuredGridAlgorithm
{
public:
  static vtkBreastRegistration* New();
  vtkTypeMacro(vtkBreastRegistration, vtkUnstructuredGridAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /**
   * The inputs 1 and 2.
   */
  void SetMammogramConnection(vtkAlgorithmOutput* mammogram);
  void SetSimulationMeshConnection(vtkAlgorithmOutput* mesh);
  ///@}

  ///@{
  /**
   * Path of a material table (JSON), or the name of a shipped one. Required.
   * MaterialTableFile, the path of a table, takes precedence; it serves interfaces that offer the
   * shipped tables as a list, as ParaView does. Default empty.
   */
  void SetMaterialTable(const char* pathOrName);
  vtkGetCharFromStdStringMacro(MaterialTable);
  void SetMaterialTableFile(const char* path);
  vtkGetCharFromStdStringMacro(MaterialTableFile);
  ///@}

  ///@{
  /**
   * Path of a spectrum (see IO's ReadSpectrum) or the name of a shipped one. Default
   * "W28kVp_Rh50um_Be1mm". SpectrumFile, the path of a spectrum, takes precedence as
   * MaterialTableFile does.
   */
  void SetSpectrum(const char* pathOrName);
  vtkGetCharFromStdStringMacro(Spectrum);
  void SetSpectrumFile(const char* path);
  vtkGetCharFromStdStringMacro(SpectrumFile);
  ///@}

  ///@{
  /**
   * Whether the synthetic picture contains the scatter of breast tissue, from the thickness along
   * each ray (mammoray/XRay/Scatter/ScatterModel.h). AirGapMm is the distance from the back of the
   * tissue to the detector, 0 to 200 mm. Grid is an anti-scatter grid of lead and fibre, focused on
   * the source: ratio (0: no grid; else 1 to 30), lines per cm (5 to 200), thickness of the septa,
   * micrometres. Defaults false, 17, (0, 31, 65).
   */
  vtkSetMacro(Scatter, bool);
  vtkGetMacro(Scatter, bool);
  vtkBooleanMacro(Scatter, bool);
  vtkSetMacro(AirGapMm, double);
  vtkGetMacro(AirGapMm, double);
  vtkSetVector3Macro(Grid, double);
  vtkGetVector3Macro(Grid, double);
  ///@}

  ///@{
  /**
   * Directions of the input's +x, +y, +z: one letter each of L/R, A/P, S/I. Default "LPS".
   */
  void SetOrientation(const char* axes);
  vtkGetCharFromStdStringMacro(Orientation);
  ///@}

  ///@{
  /**
   * Names of the parameters that are estimated, separated by blanks: thickness, roll, pitch, yaw,
   * lateral, anterior, vertical, tilt, stiffness. Default "thickness roll pitch yaw lateral
   * anterior tilt", as in 'mammoray register'.
   */
  void SetFreeParameters(const char* names);
  vtkGetCharFromStdStringMacro(FreeParameters);
  ///@}

  ///@{
  /**
   * Where the search begins: compressed thickness, mm (0: the mammogram's, else 50); roll, degrees,
   * added to the nominal roll of the mammogram's view (0 if it has none); distance of the
   * receptor's edge from the chest wall, mm. Defaults 0, 0, 5.
   */
  vtkSetMacro(ThicknessMm, double);
  vtkGetMacro(ThicknessMm, double);
  vtkSetMacro(RollDeg, double);
  vtkGetMacro(RollDeg, double);
  vtkSetMacro(AnteriorMm, double);
  vtkGetMacro(AnteriorMm, double);
  ///@}

  ///@{
  /**
   * Source to detector distance, mm; 0: the mammogram's, else 650. Default 0.
   */
  vtkSetMacro(SourceToDetectorMm, double);
  vtkGetMacro(SourceToDetectorMm, double);
  ///@}

  ///@{
  /**
   * Radius of the plates' chest-wall edges, mm, 0 to 100. Default 8: a patient's mechanics cannot
   * follow the sharper edges of a unit (mammoray/Registration/BreastModel.h). Use the unit's own 3
   * if the body or its cells are much smaller.
   */
  vtkSetMacro(EdgeRadiusMm, double);
  vtkGetMacro(EdgeRadiusMm, double);
  ///@}

  ///@{
  /**
   * Pixel sizes at which the pictures are compared, first coarse, then fine, mm, positive; and the
   * largest number of iterations at each, 1 to 1000. Defaults (3, 1.5), 15.
   */
  vtkSetVector2Macro(PixelSizesMm, double);
  vtkGetVector2Macro(PixelSizesMm, double);
  vtkSetClampMacro(MaximumIterations, int, 1, 1000);
  vtkGetMacro(MaximumIterations, int);
  ///@}

  ///@{
  /**
   * Part of the Vulkan device's name. Default empty: the most capable device.
   */
  void SetDeviceName(const char* name);
  vtkGetCharFromStdStringMacro(DeviceName);
  ///@}

  /**
   * Number of times that the filter has made meshes and simulation.
   */
  vtkGetMacro(NumberOfSetups, int);

  ///@{
  /**
   * Accepts implausible values (mammoray/Foundation/ValidRange.h), too. Default off.
   */
  vtkSetMacro(AcceptUnusual, bool);
  vtkGetMacro(AcceptUnusual, bool);
  vtkBooleanMacro(AcceptUnusual, bool);
  ///@}

protected:
  vtkBreastRegistration();
  ~vtkBreastRegistration() override;
  int FillInputPortInformation(int port, vtkInformation* info) override;
  int RequestUpdateExtent(vtkInformation* request, vtkInformationVector** inputs,
    vtkInformationVector* outputs) override;
  int RequestData(vtkInformation* request, vtkInformationVector** inputs,
    vtkInformationVector* outputs) override;

private:
  vtkBreastRegistration(const vtkBreastRegistration&) = delete;
  void operator=(const vtkBreastRegistration&) = delete;

  std::string MaterialTable;
  std::string MaterialTableFile;
  std::string Spectrum = "W28kVp_Rh50um_Be1mm";
  std::string SpectrumFile;
  bool Scatter = false;
  double AirGapMm = 17;
  double Grid[3] = { 0, 31, 65 };
  std::string Orientation = "LPS";
  std::string FreeParameters;
  double ThicknessMm = 0;
  double RollDeg = 0;
  double AnteriorMm;
  double SourceToDetectorMm = 0;
  double EdgeRadiusMm;
  double PixelSizesMm[2] = { 3, 1.5 };
  int MaximumIterations = 15;
  std::string DeviceName;
  int NumberOfSetups = 0;

  struct Internals;
  Internals* Internal;
  bool AcceptUnusual = false;
};

#endif
