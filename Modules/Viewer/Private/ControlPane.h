// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_ControlPane_h
#define mammoray_ControlPane_h

#include "vtkNew.h"
#include "vtkRenderer.h"
#include "vtkSmartPointer.h"

#include <array>
#include <functional>
#include <string>
#include <vector>

class vtkRenderWindowInteractor;
class vtkSliderWidget;
class vtkTextActor;

namespace mammoray
{
/// Sliders, buttons and lines of text, from top to bottom, in a part of the window.
class ControlPane
{
public:
  /// `viewport`: left, bottom, right and top in the window, of 1.
  explicit ControlPane(const std::array<double, 4>& viewport);
  ~ControlPane();

  vtkRenderer* Renderer() { return this->View; }
  /// Lies over the whole window, in layer 1: sliders of VTK 9.1 are drawn at the wrong place in a
  /// renderer that does not begin at the window's corner.
  vtkRenderer* SliderRenderer() { return this->Front; }
  /// Sliders and buttons are added before Attach.
  int AddSlider(const std::string& title, const char* format, double low, double high, double value,
    std::function<void(double)> changed);
  void AddButton(const std::string& title, std::function<void()> pressed);
  /// Makes the sliders listen; null: no longer.
  void Attach(vtkRenderWindowInteractor* interactor);
  /// Moves a slider without telling anyone; within its range.
  void SetSlider(int slider, double value);
  void SetStatus(const std::string& text);
  /// Presses the button at a place of the window, pixels; false where there is none.
  bool Press(int x, int y);

private:
  struct Button
  {
    vtkSmartPointer<vtkTextActor> Label;
    std::function<void()> Pressed;
  };
  std::array<double, 4> Viewport;
  vtkNew<vtkRenderer> View;
  vtkNew<vtkRenderer> Front;
  std::vector<vtkSmartPointer<vtkSliderWidget>> Sliders;
  std::vector<Button> Buttons;
  vtkSmartPointer<vtkTextActor> Status;
};
}

#endif
