// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_SampleScene_h
#define mammoray_SampleScene_h

#include "Private/LiveProjection.h"
#include "Private/SceneShapes.h"
#include "mammorayAppModule.h"

#include "vtkNew.h"
#include "vtkRenderer.h"
#include "vtkSmartPointer.h"
#include "vtkTransform.h"

#include <vector>

class vtkTexture;

namespace mammoray
{
/**
 * The samples in a renderer, with beam, source, and the detector with its picture; frame of the
 * scene, mm. Source and detector may be far away: then the source is drawn nearer on its ray
 * through the samples' middle, and of the detector the plane nearer the samples on which the same
 * rays make the same, smaller picture.
 */
class MAMMORAYAPP_EXPORT SampleScene
{
public:
  SampleScene(const MaterialTable& materials, const LiveProjection& live, vtkTexture* picture);

  vtkRenderer* Renderer() { return this->View; }
  /// A colour for each material of the table.
  const std::vector<Color>& Colors() const { return this->MaterialColors; }
  void Update(const LiveProjection& live);
  /// The samples from beside the beam.
  void LookAt(const LiveProjection& live);
  /// True at the drawn source.
  bool OnSource(int x, int y);
  const Vector3& ShownSource() const { return this->SourceShown; }
  /// By so much less than the source the drawn one is moved: as far as its shadow where it is drawn
  /// nearer, else 1.
  double SourceShare() const { return this->Share; }

private:
  void AddSamples(const LiveProjection& live);

  Vector3 Middle{ 0, 0, 0 };
  double Diagonal = 1;
  std::vector<Color> MaterialColors;
  vtkNew<vtkRenderer> View;
  vtkNew<vtkTransform> Turned;
  vtkSmartPointer<vtkPolyData> Detector;
  vtkSmartPointer<vtkPolyData> BeamEdges;
  vtkSmartPointer<vtkPolyData> AxisLine;
  vtkSmartPointer<vtkActor> Source;
  Vector3 SourceShown{ 0, 0, 0 };
  double Share = 1;
};
}

#endif
