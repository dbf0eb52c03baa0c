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
  /// What is seen at a place of the window: nothing to move, a scene to turn, a flat picture.
  enum class Kind
  {
    Nothing,
    Scene,
    Picture
  };
  virtual ~MouseTarget() = default;
  virtual Kind KindAt(int x, int y) = 0;
  /// True when the press is taken, and what follows it.
  virtual bool OnPress(int x, int y, bool shift) = 0;
  virtual void OnDrag(int x, int y) = 0;
  virtual void OnRelease() = 0;
  virtual void OnClick(int x, int y) = 0;
  /// The left button is dragged over a picture, by so many pixels.
  virtual void OnWindow(int right, int up) = 0;
  /// True when a step of the wheel is taken; else it zooms.
  virtual bool OnWheel(int x, int y, int steps) = 0;
  virtual void OnKey(const std::string& name) = 0;
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
  void Wheel(int steps);

  std::array<int, 2> Start{ 0, 0 };
  std::array<int, 2> Last{ 0, 0 };
  bool Taken = false;
  /// The left button went down on a picture, whose grey it changes.
  bool Windows = false;
};
}

#endif
