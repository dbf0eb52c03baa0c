// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_MammogramPane_h
#define mammoray_MammogramPane_h

#include "Private/LiveMammogram.h"
#include "Private/PaneOverlay.h"

#include "vtkImageData.h"
#include "vtkNew.h"
#include "vtkRenderer.h"
#include "vtkTexture.h"

#include <array>
#include <vector>

class vtkPolyData;

namespace mammoray
{
/**
 * The synthetic mammogram blended with the real one, as mammograms are hung: chest wall at the left
 * for the left breast, lateral side or head up. Drawn in the gantry frame's x and y, mm.
 */
class MammogramPane
{
public:
  MammogramPane(const ViewedBreast& viewed, LiveMammogram& live);

  vtkRenderer* Renderer() { return this->View; }
  PaneOverlay& Overlay() { return this->Over; }
  /// The blended picture, row 0 first.
  vtkTexture* Picture() { return this->Texture; }
  /// Takes the picture that `live` has now.
  void Update(LiveMammogram& live, int divisor);
  /// 0: synthetic only, 1: real only.
  void SetBlend(double real);
  double Blend() const { return this->Real; }
  /// Changes grey: window and level by shares of the window.
  void Adjust(double windowFactor, double levelShare);
  void ResetWindow();
  /// Crosses, closed lines and an open one on the receptor, gantry x and y.
  void SetMark(const std::vector<ReceptorPoint>& points,
    const std::vector<std::vector<ReceptorPoint>>& loops,
    const std::vector<ReceptorPoint>& line = {});
  /// All of the breast in its pane.
  void Frame();
  /// Continuous column and row at a place of the window, pixels; false beside the picture.
  bool PixelAt(int x, int y, double& column, double& row) const;
  /// The blended picture at its own resolution as .png, row 0 on top. Throws InputError.
  void Write(const std::string& path) const;

private:
  void Compose();

  ReceptorGrid Grid;
  double Right = 1;
  double Up = 1;
  /// Grey of the real mammogram, [0, 1], by divisor; empty without one.
  std::array<std::vector<float>, 2> RealGrey;
  /// Log attenuations that are black and white.
  double Black = 0;
  double White = 1;
  double Real = 0;
  /// Of the grey between them, what is black and white; 0 and 1 at the beginning.
  double Low = 0;
  double High = 1;
  std::vector<float> Synthetic;
  /// Pixels of the real breast, not 0; empty without one.
  std::vector<unsigned char> Breast;
  int Divisor = 1;
  vtkNew<vtkRenderer> View;
  PaneOverlay Over;
  vtkNew<vtkImageData> Image;
  vtkNew<vtkTexture> Texture;
  vtkSmartPointer<vtkPolyData> Marks;
};
}

#endif
