// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_PicturePane_h
#define mammoray_PicturePane_h

#include "Private/PaneOverlay.h"
#include "mammorayAppModule.h"

#include "vtkImageData.h"
#include "vtkNew.h"
#include "vtkRenderer.h"
#include "vtkSmartPointer.h"
#include "vtkTexture.h"

#include <array>

namespace mammoray
{
/// A grey picture on a plane, seen along its normal, with an overlay and a window of grey values.
class MAMMORAYAPP_EXPORT PicturePane
{
public:
  vtkRenderer* Renderer() { return this->View; }
  PaneOverlay& Overlay() { return this->Over; }
  /// Another texture of the picture, row 0 first; a texture belongs to one window.
  vtkSmartPointer<vtkTexture> NewTexture();
  /// Changes grey: window and level by shares of the window.
  void Adjust(double windowFactor, double levelShare);

protected:
  PicturePane();
  virtual ~PicturePane() = default;

  /// Computes the grey values of the picture.
  virtual void Compose() = 0;
  /// Adds the rectangle that shows the picture, with the corners of NewPictureRectangle.
  void AddRectangle(const std::array<Vector3, 4>& corners);
  /// Grey values of a picture of this size, row 0 first, to be filled.
  unsigned char* GreyValues(int columns, int rows);
  /// Looks from `eye` at `middle`; at least `width` x `height` mm are visible.
  void LookAt(const Vector3& middle, const Vector3& eye, const Vector3& up, double width,
    double height);

  /// Values that are black and white.
  double Low = 0;
  double High = 1;
  vtkNew<vtkRenderer> View;
  PaneOverlay Over;
  vtkNew<vtkImageData> Image;
};
}

#endif
