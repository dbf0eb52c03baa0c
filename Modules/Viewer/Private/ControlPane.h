// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_ControlPane_h
#define mammoray_ControlPane_h

#include "vtkNew.h"
#include "vtkRenderer.h"
#include "vtkSmartPointer.h"

#include <functional>
#include <string>
#include <vector>

class vtkRenderWindowInteractor;
class vtkSliderWidget;
class vtkTextActor;

namespace mammoray
{
/// Sliders, buttons and a line of text, from top to bottom.
class ControlPane
{
public:
  ControlPane();
  ~ControlPane();

  vtkRenderer* Renderer() { return this->View; }
  /// Sliders and buttons are added before Attach.
  int AddSlider(const std::string& title, const char* format, double low, double high,
    double value, std::function<void(double)> changed);
  void AddButton(const std::string& title, std::function<void()> pressed);
  /// Makes the sliders listen.
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
  vtkNew<vtkRenderer> View;
  std::vector<vtkSmartPointer<vtkSliderWidget>> Sliders;
  std::vector<Button> Buttons;
  vtkSmartPointer<vtkTextActor> Status;
};
}

#endif
