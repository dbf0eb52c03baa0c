// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_PicturePane_h
#define mammoray_PicturePane_h

#include "Private/PaneOverlay.h"
#include "mammorayAppModule.h"

#include "vtkImageData.h"
#include "vtkNew.h"
#include "vtkRenderer.h"
#include "vtkTexture.h"

#include <array>
#include <string>

namespace mammoray
{
/// A grey picture on a plane, seen along its normal, with an overlay and a window of grey values.
class MAMMORAYAPP_EXPORT PicturePane
{
public:
  vtkRenderer* Renderer() { return this->View; }
  PaneOverlay& Overlay() { return this->Over; }
  /// The picture as it is drawn, row 0 first.
  vtkTexture* Picture() { return this->Texture; }
  /// Changes grey: window and level by shares of the window.
  void Adjust(double windowFactor, double levelShare);
  /// The picture at its own resolution as .png, row 0 on top. Throws InputError.
  void Write(const std::string& path) const;

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
  vtkNew<vtkTexture> Texture;
};
}

#endif
