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
   * Path of a spectrum (.spc) or the name of a shipped one. Default "W28kVp_Rh50um_Be1mm".
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

  ///@{
  /**
   * True where the picture that is compared has what breast tissue scatters, by the thickness along
   * each ray (mammoray/XRay/Scatter/ScatterModel.h), AirGapMm from the back of the tissue to the
   * detector, 0 to 200 mm. Defaults false, 17.
   */
  vtkSetMacro(Scatter, bool);
  vtkGetMacro(Scatter, bool);
  vtkBooleanMacro(Scatter, bool);
  vtkSetMacro(AirGapMm, double);
  vtkGetMacro(AirGapMm, double);
  ///@}

  ///@{
  /**
   * Anti-scatter grid of lead and fibre, focused on the source, before the detector of a mammogram
   * that is compared with Scatter: ratio (0: no grid, the default; else 1 to 30), lines per cm (5
   * to 200), thickness of the septa, micrometres.
   */
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
   * Names of the parameters that are found, with blanks between: thickness, roll, pitch, yaw,
   * lateral, anterior, vertical, tilt, stiffness. Default "thickness roll pitch yaw lateral
   * anterior tilt", as of 'mammoray register'.
   */
  void SetFreeParameters(const char* names);
  vtkGetCharFromStdStringMacro(FreeParameters);
  ///@}

  ///@{
  /**
   * Compressed thickness where the search begins, mm; 0: the mammogram's, else 50. Default 0.
   */
  vtkSetMacro(ThicknessMm, double);
  vtkGetMacro(ThicknessMm, double);
  ///@}

  ///@{
  /**
   * Added to the nominal roll of the mammogram's view (0 where it has none) for the start, degrees.
   * Default 0.
   */
  vtkSetMacro(RollDeg, double);
  vtkGetMacro(RollDeg, double);
  ///@}

  ///@{
  /**
   * Distance of the receptor's edge from the chest wall where the search begins, mm. Default 5.
   */
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
   * Radius of the plates' chest-wall edges, mm, 0 to 100. Default 8, wider than a unit's, which
   * is what a patient's mechanics can follow (mammoray/Registration/BreastModel.h); where the
   * body or its cells are much smaller, take the unit's own 3.
   */
  vtkSetMacro(EdgeRadiusMm, double);
  vtkGetMacro(EdgeRadiusMm, double);
  ///@}

  ///@{
  /**
   * Pixels in which the pictures are compared, first coarse, then fine, mm. Positive; default (3,
   * 1.5).
   */
  vtkSetVector2Macro(PixelSizesMm, double);
  vtkGetVector2Macro(PixelSizesMm, double);
  ///@}

  ///@{
  /**
   * Most iterations at each pixel size. 1 to 1000; default 15.
   */
  vtkSetClampMacro(MaximumIterations, int, 1, 1000);
  vtkGetMacro(MaximumIterations, int);
  ///@}

  ///@{
  /**
   * Part of the wanted Vulkan device's name; empty takes the most capable one. Default empty.
   */
  void SetDeviceName(const char* name);
  vtkGetCharFromStdStringMacro(DeviceName);
  ///@}

  /**
   * How often a mesh was made and a simulation was set up since the filter was made.
   */
  vtkGetMacro(NumberOfSetups, int);

  ///@{
  /**
   * Take what no patient has (mammoray/Foundation/ValidRange.h), too. Default off.
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
  double AnteriorMm = 5;
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
