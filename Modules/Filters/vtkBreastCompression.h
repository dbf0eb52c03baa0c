// SPDX-License-Identifier: Apache-2.0
/**
 * @class   vtkBreastCompression
 * @brief   Squeezes a breast between the plates of a mammography unit.
 *
 * Input 0: vtkUnstructuredGrid of linear tetrahedra (mm) with the cell array "Material". Input 1,
 * optional: a coarse vtkUnstructuredGrid of the same breast to simulate on (vtkBreastMesher with
 * ForMechanics), which carries input 0 along; its stiffness is sampled from the materials of
 * input 0. Without it the simulation runs on input 0 up to 20000 cells, or 150000 with
 * SetElementToLinear, and beyond that on a mesh made of it (MostSimulationCells). Elastic constants
 * come from MaterialTable or SetMaterial; cells of fixed materials (the chest wall) do not move,
 * but where the breast glides along them (ChestWall) those beside it are drawn along.
 *
 * Output 0: input 0 deformed, with its arrays and the point arrays "Displacement" (mm) and
 * "ContactPressureKPa" (of the plates; 0 where nothing touches), the cell arrays "J" (deformed over
 * undeformed volume) and "VonMisesStressKPa" (of the Cauchy stress), both means over the cell's
 * quadrature points (a linear cell has one, and keeps its volume together with its patch only) or,
 * of a carried grid, J of the volumes between the corners; and the field arrays "PaddleForceN",
 * "SupportForceN", "ThicknessMm", "LargestPenetrationMm", "LargestWallLiftMm",
 * "LargestWallGlideMm", "SmallestJ", "LargestJ", "VolumeRatio", "RelativeResidual",
 * "StiffnessFactor" (1, or what the tissue had to be stiffened by to bear its weight in the image),
 * of a carried grid "InvertedCells" (a fine mesh may have a few; vtkXRayProjector takes them), and
 * "Placement" (4 x 3 doubles: the gantry's origin, mm, and its x, y and z axes in the frame of the
 * input, from which vtkXRayProjector knows where source and detector stand).
 *
 * With NumberOfTimeSteps above 1 the output is a time series of the compression: at time 0 the
 * plates just touch nothing, at 1 they are closed. Without a requested time they are closed.
 *
 * The simulation and its last state live across updates: while only plates or time change, a
 * compression to a thickness starts from the last one (not with friction, whose result would depend
 * on the order of requests). Unusable input or plates without an equilibrium raise
 * ErrorEvent once and leave the output empty.
 */
#ifndef vtkBreastCompression_h
#define vtkBreastCompression_h

#include "mammorayFiltersModule.h" // export macro
#include "vtkUnstructuredGridAlgorithm.h"
#include <string> // file name and axes

class vtkDataArray;
class vtkFieldData;

class MAMMORAYFILTERS_EXPORT vtkBreastCompression : public vtkUnstructuredGridAlgorithm
{
public:
  static vtkBreastCompression* New();
  vtkTypeMacro(vtkBreastCompression, vtkUnstructuredGridAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  /**
   * Input 1.
   */
  void SetSimulationMeshConnection(vtkAlgorithmOutput* mesh);

  ///@{
  /**
   * Path of a material table (JSON), or the name of a shipped one, with the elastic constants of
   * the input's materials, by their names if it has some, and which are fixed. Empty: only the
   * constants of SetMaterial.
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
   * Directions of the input's +x, +y, +z: one letter each of L/R, A/P, S/I. Default "LPS".
   */
  void SetOrientation(const char* axes);
  vtkGetCharFromStdStringMacro(Orientation);
  ///@}

  /**
   * Elastic constants of a material (1, 2, ...): Young's modulus, kPa, positive; Poisson's ratio in
   * [0, 0.5); whether its cells are fixed; how fast it stiffens (Fung's exponent in [0, 50]; 0:
   * neo-Hookean); density, g/cm^3, which weight needs (0: not known). Takes precedence over the
   * table.
   */
  void SetMaterial(int material, double youngsModulusKPa, double poissonRatio, bool fixed,
    double fungExponent = 0, double densityGPerCm3 = 0);

  /**
   * Removes the constants of SetMaterial.
   */
  void ClearMaterials();

  enum ElementTypes
  {
    QUADRATIC = 0,
    LINEAR = 1
  };

  ///@{
  /**
   * The simulation's tetrahedra: quadratic, or linear with the volume averaged over patches of
   * about eight cells, which take a tenth of the time and are less accurate. Default QUADRATIC.
   */
  vtkSetClampMacro(Element, int, QUADRATIC, LINEAR);
  vtkGetMacro(Element, int);
  void SetElementToQuadratic() { this->SetElement(QUADRATIC); }
  void SetElementToLinear() { this->SetElement(LINEAR); }
  ///@}

  ///@{
  /**
   * How far the plates are closed: distance of their faces, mm, positive; or, if ForceN is
   * positive, the force of the paddle, N, for which the thickness is found. Defaults 50, 0.
   */
  vtkSetMacro(ThicknessMm, double);
  vtkGetMacro(ThicknessMm, double);
  vtkSetMacro(ForceN, double);
  vtkGetMacro(ForceN, double);
  ///@}

  ///@{
  /**
   * Turns of the unit, degrees: RollDeg about the anterior axis (0 is CC, positive towards the
   * patient's left), then PitchDeg about its lateral axis (positive turns the source to the front),
   * then YawDeg about its vertical axis (positive to the patient's left in CC); and TiltDeg of the
   * paddle about its chest-wall edge, where the thickness then holds (positive opens it towards the
   * nipple). Default 0.
   */
  vtkSetMacro(RollDeg, double);
  vtkGetMacro(RollDeg, double);
  vtkSetMacro(PitchDeg, double);
  vtkGetMacro(PitchDeg, double);
  vtkSetMacro(YawDeg, double);
  vtkGetMacro(YawDeg, double);
  vtkSetMacro(TiltDeg, double);
  vtkGetMacro(TiltDeg, double);
  ///@}

  ///@{
  /**
   * Shifts, mm: of the receptor along its chest-wall edge (LateralMm) and away from the chest wall
   * (AnteriorMm), and of the plates' mid-plane towards the source (VerticalMm). Default 0.
   */
  vtkSetMacro(LateralMm, double);
  vtkGetMacro(LateralMm, double);
  vtkSetMacro(AnteriorMm, double);
  vtkGetMacro(AnteriorMm, double);
  vtkSetMacro(VerticalMm, double);
  vtkGetMacro(VerticalMm, double);
  ///@}

  ///@{
  /**
   * Chest-wall edges of support and paddle, mm in front of the receptor's, default 0; and their
   * radius, 0 to 100 mm, default 3.
   */
  vtkSetMacro(SupportEdgeMm, double);
  vtkGetMacro(SupportEdgeMm, double);
  vtkSetMacro(PaddleEdgeMm, double);
  vtkGetMacro(PaddleEdgeMm, double);
  vtkSetMacro(EdgeRadiusMm, double);
  vtkGetMacro(EdgeRadiusMm, double);
  ///@}

  enum ChestWallType
  {
    FIXED,
    SLIDING,
    ELASTIC
  };
  ///@{
  /**
   * How the breast is attached to the fixed materials: FIXED, the default, SLIDING along their
   * surface, or by an ELASTIC layer. WallStiffness is the stiffness of that layer across the wall
   * (positive; also with SLIDING) and along it (not negative), kPa/mm, default (1000, 1).
   */
  vtkSetClampMacro(ChestWall, int, FIXED, ELASTIC);
  vtkGetMacro(ChestWall, int);
  void SetChestWallToFixed() { this->SetChestWall(FIXED); }
  void SetChestWallToSliding() { this->SetChestWall(SLIDING); }
  void SetChestWallToElastic() { this->SetChestWall(ELASTIC); }
  vtkSetVector2Macro(WallStiffness, double);
  vtkGetVector2Macro(WallStiffness, double);
  ///@}

  ///@{
  /**
   * Force that draws the breast forwards onto the receptor, N, spread over its volume; and
   * coefficient of friction between breast and plates, not negative. Default 0.
   */
  vtkSetMacro(PullN, double);
  vtkGetMacro(PullN, double);
  vtkSetMacro(Friction, double);
  vtkGetMacro(Friction, double);
  ///@}

  enum ImagePositionType
  {
    NONE,
    PRONE,
    SUPINE
  };
  ///@{
  /**
   * How the patient lay when the input was imaged: PRONE or SUPINE breasts are first unloaded of
   * their weight, then compressed under that of the standing patient. With NONE, the default, the
   * input is free of load, and Gravity (default off) applies the weight of the standing patient
   * during the compression.
   */
  vtkSetClampMacro(ImagePosition, int, NONE, SUPINE);
  vtkGetMacro(ImagePosition, int);
  void SetImagePositionToNone() { this->SetImagePosition(NONE); }
  void SetImagePositionToProne() { this->SetImagePosition(PRONE); }
  void SetImagePositionToSupine() { this->SetImagePosition(SUPINE); }
  vtkSetMacro(Gravity, bool);
  vtkGetMacro(Gravity, bool);
  vtkBooleanMacro(Gravity, bool);
  ///@}

  ///@{
  /**
   * Steps of the time series, evenly spaced from 0 to 1; 1: none. Default 1.
   */
  vtkSetClampMacro(NumberOfTimeSteps, int, 1, 1000);
  vtkGetMacro(NumberOfTimeSteps, int);
  ///@}

  ///@{
  /**
   * Accepts implausible values (mammoray/Foundation/ValidRange.h), too. Default off.
   */
  vtkSetMacro(AcceptUnusual, bool);
  vtkGetMacro(AcceptUnusual, bool);
  vtkBooleanMacro(AcceptUnusual, bool);
  ///@}

  /**
   * The gradient of a number, the loss, whose derivatives with respect to the points of the output
   * are `loss` (3 components, 1/mm), in reverse mode: one back-substitution at the state of the
   * last update. Sets arrays of `gradient`: "Stiffness", with respect to a relative change of the
   * Young's modulus of each cell of the input (not where a coarse mesh carries it); "Materials",
   * the same of all cells of a material, from material 0; "Pose", with respect to thickness, roll,
   * pitch, yaw, lateral, anterior, vertical and tilt, which move the plates, per mm or degree. The
   * plates stay where they are, also where a force has found them. False, after ErrorEvent: no
   * update with closed plates before, a loss of another size, or an image under gravity
   * (ImagePosition).
   */
  bool Backward(vtkDataArray* loss, vtkFieldData* gradient);

protected:
  vtkBreastCompression();
  ~vtkBreastCompression() override;
  int FillInputPortInformation(int port, vtkInformation* info) override;
  int RequestInformation(vtkInformation* request, vtkInformationVector** inputs,
    vtkInformationVector* outputs) override;
  int RequestData(vtkInformation* request, vtkInformationVector** inputs,
    vtkInformationVector* outputs) override;

private:
  vtkBreastCompression(const vtkBreastCompression&) = delete;
  void operator=(const vtkBreastCompression&) = delete;

  /// Throws InputError, CompressionError and Interrupted.
  void Compress(vtkUnstructuredGrid* input, vtkUnstructuredGrid* coarse, double time,
    vtkUnstructuredGrid* output);

  std::string MaterialTable;
  std::string MaterialTableFile;
  std::string Orientation = "LPS";
  int Element = QUADRATIC;
  double ThicknessMm = 50;
  double ForceN = 0;
  double TiltDeg = 0;
  double RollDeg = 0;
  double PitchDeg = 0;
  double YawDeg = 0;
  double LateralMm = 0;
  double AnteriorMm = 0;
  double VerticalMm = 0;
  double SupportEdgeMm = 0;
  double PaddleEdgeMm = 0;
  double EdgeRadiusMm = 3;
  int ChestWall = FIXED;
  double WallStiffness[2] = { 1000, 1 };
  double PullN = 0;
  double Friction = 0;
  int ImagePosition = NONE;
  bool Gravity = false;
  int NumberOfTimeSteps = 1;

  struct Internals;
  Internals* Internal;
  bool AcceptUnusual = false;
};

#endif
