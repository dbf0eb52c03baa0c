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
/// A strip along the window's lower edge: a row of sliders, rows of buttons, lines of text.
class ControlPane
{
public:
  ControlPane();
  ~ControlPane();

  vtkRenderer* Renderer() { return this->View; }
  /// Lies over the whole window, in layer 1: sliders of VTK 9.1 are drawn at the wrong place in a
  /// renderer that does not begin at the window's corner.
  vtkRenderer* SliderRenderer() { return this->Front; }
  /// Sliders and buttons are added before Attach.
  int AddSlider(const std::string& title, const char* format, double low, double high, double value,
    std::function<void(double)> changed);
  void AddButton(const std::string& title, std::function<void()> pressed);
  /// A name on its colour, beside the buttons.
  void AddLegend(const std::string& name, const std::array<double, 3>& color);
  /// Places all of it in a window of this size, pixels; answers the strip's height.
  int Lay(int width, int height);
  /// Makes the sliders listen; null: no longer.
  void Attach(vtkRenderWindowInteractor* interactor);
  /// Moves a slider without telling anyone; within its range.
  void SetSlider(int slider, double value);
  void SetRange(int slider, double low, double high);
  void SetStatus(const std::string& text);
  /// Presses the button at a place of the window, pixels; false where there is none.
  bool Press(int x, int y);

private:
  struct Slider
  {
    vtkSmartPointer<vtkTextActor> Title;
    vtkSmartPointer<vtkSliderWidget> Widget;
  };
  struct Button
  {
    vtkSmartPointer<vtkTextActor> Label;
    /// Nothing: a legend.
    std::function<void()> Pressed;
  };
  vtkNew<vtkRenderer> View;
  vtkNew<vtkRenderer> Front;
  std::vector<Slider> Sliders;
  std::vector<Button> Buttons;
  vtkSmartPointer<vtkTextActor> Status;
};
}

#endif
