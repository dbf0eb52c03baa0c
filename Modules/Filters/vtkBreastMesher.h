// SPDX-License-Identifier: Apache-2.0
/**
 * @class   vtkBreastMesher
 * @brief   Meshes a label volume: tetrahedra with a material each.
 *
 * Input 0: vtkImageData, i x j x k voxels, point scalars of one component: labels, whole numbers in
 * [0, 65535], 0 mostly air; origin, spacing (mm) and direction are kept. MaterialTable has the
 * material of each label; without one the labels are material indices.
 *
 * Output 0: vtkUnstructuredGrid of linear tetrahedra, points in mm in the image's frame, cell array
 * "Material" (int), field arrays "MaterialNames" (strings) and "MaterialVolumesMm3" (double, of the
 * cells, 0 for air). The mesh conforms: neighbouring materials share triangles, the boundary of
 * every material is closed, and none is lost.
 *
 * Needs the Meshing module. Unusable input raises ErrorEvent once and leaves the output empty, an
 * abort during the work leaves it empty.
 */
#ifndef vtkBreastMesher_h
#define vtkBreastMesher_h

#include "mammorayFiltersModule.h" // export macro
#include "vtkUnstructuredGridAlgorithm.h"
#include <string> // name of the table

class vtkImageData;

class MAMMORAYFILTERS_EXPORT vtkBreastMesher : public vtkUnstructuredGridAlgorithm
{
public:
  static vtkBreastMesher* New();
  vtkTypeMacro(vtkBreastMesher, vtkUnstructuredGridAlgorithm);
  void PrintSelf(ostream& os, vtkIndent indent) override;

  ///@{
  /**
   * Path of a material table (JSON), or the name of a shipped one. Empty: labels are material
   * indices.
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
   * Voxel size to which finer labels are resampled first, mm; 0 keeps them. Not negative; default
   * 0.
   */
  vtkSetMacro(LabelSpacingMm, double);
  vtkGetMacro(LabelSpacingMm, double);
  ///@}

  ///@{
  /**
   * Largest circumradius of the cells, mm; 0 with ForMechanics: by the size of the breast. Default
   * 4.
   */
  vtkSetMacro(CellSizeMm, double);
  vtkGetMacro(CellSizeMm, double);
  ///@}

  ///@{
  /**
   * Number of triangles between materials to end with, within 10 %; 0 takes the sizes as they are.
   * Default 0.
   */
  vtkSetClampMacro(NumberOfTriangles, int, 0, VTK_INT_MAX);
  vtkGetMacro(NumberOfTriangles, int);
  ///@}

  ///@{
  /**
   * Makes a coarse mesh for vtkBreastCompression, of 3000 to 6000 cells with CellSizeMm 0, which
   * follows only the skin and the border of the fixed tissue and ignores NumberOfTriangles. Default
   * off.
   */
  vtkSetMacro(ForMechanics, bool);
  vtkGetMacro(ForMechanics, bool);
  vtkBooleanMacro(ForMechanics, bool);
  ///@}

  ///@{
  /**
   * Accepts implausible values (mammoray/Foundation/ValidRange.h), too. Default off.
   */
  vtkSetMacro(AcceptUnusual, bool);
  vtkGetMacro(AcceptUnusual, bool);
  vtkBooleanMacro(AcceptUnusual, bool);
  ///@}

protected:
  vtkBreastMesher();
  ~vtkBreastMesher() override;
  int FillInputPortInformation(int port, vtkInformation* info) override;
  int RequestUpdateExtent(vtkInformation* request, vtkInformationVector** inputs,
    vtkInformationVector* outputs) override;
  int RequestData(vtkInformation* request, vtkInformationVector** inputs,
    vtkInformationVector* outputs) override;

private:
  vtkBreastMesher(const vtkBreastMesher&) = delete;
  void operator=(const vtkBreastMesher&) = delete;

  /// Throws InputError and Interrupted.
  void Mesh(vtkImageData* input, vtkUnstructuredGrid* output);

  std::string MaterialTable;
  std::string MaterialTableFile;
  double LabelSpacingMm = 0;
  double CellSizeMm = 4;
  int NumberOfTriangles = 0;
  bool ForMechanics = false;
  bool AcceptUnusual = false;
};

#endif
