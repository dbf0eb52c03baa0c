// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_ViewerStyle_h
#define mammoray_ViewerStyle_h

#include "vtkInteractorStyleTrackballCamera.h"

#include <array>
#include <functional>
#include <string>

namespace mammoray
{
/// What the viewer wants of the mouse; everything else is the trackball's.
struct MouseTarget
{
  virtual ~MouseTarget() = default;
  /// True when the press is taken, and what follows it.
  virtual bool OnPress(int x, int y) = 0;
  virtual void OnDrag(int x, int y) = 0;
  virtual void OnRelease() = 0;
  virtual void OnClick(int x, int y) = 0;
  virtual void OnKey(const std::string& name) = 0;
  /// Whether the camera there may be turned; shifted and zoomed.
  virtual bool Turns(int x, int y) = 0;
  virtual bool Moves(int x, int y) = 0;
};

/// The trackball with what MouseTarget takes for itself, and without VTK's own keys (wireframe,
/// stereo, exit).
class ViewerStyle : public vtkInteractorStyleTrackballCamera
{
public:
  static ViewerStyle* New();
  vtkTypeMacro(ViewerStyle, vtkInteractorStyleTrackballCamera);

  void OnLeftButtonDown() override;
  void OnMouseMove() override;
  void OnLeftButtonUp() override;
  void OnMiddleButtonDown() override;
  void OnRightButtonDown() override;
  void OnMouseWheelForward() override;
  void OnMouseWheelBackward() override;
  void OnKeyPress() override;
  void OnChar() override {}
  /// The viewer's timer is not the style's: VTK would move the camera on at every tick, for as long
  /// as a button is held.
  void OnTimer() override {}

  /// Required; must outlive the style.
  MouseTarget* Target = nullptr;

private:
  /// Where the mouse is, pixels from the window's lower left corner.
  std::array<int, 2> Place() const;
  bool MovesHere() const;

  std::array<int, 2> Start{ 0, 0 };
  bool Taken = false;
};
}

#endif
