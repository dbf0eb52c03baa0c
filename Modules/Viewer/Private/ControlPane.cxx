// SPDX-License-Identifier: Apache-2.0
#include "Private/ControlPane.h"

#include "vtkCommand.h"
#include "vtkCoordinate.h"
#include "vtkProperty2D.h"
#include "vtkRenderWindowInteractor.h"
#include "vtkSliderRepresentation2D.h"
#include "vtkSliderWidget.h"
#include "vtkTextActor.h"
#include "vtkTextProperty.h"

#include <algorithm>

namespace mammoray
{
namespace
{
/// Calls a function when the slider is moved.
class SliderObserver : public vtkCommand
{
public:
  static SliderObserver* New() { return new SliderObserver; }
  void Execute(vtkObject* caller, unsigned long, void*) override
  {
    auto* widget = static_cast<vtkSliderWidget*>(caller);
    this->Changed(static_cast<vtkSliderRepresentation*>(widget->GetRepresentation())->GetValue());
  }
  std::function<void(double)> Changed;
};

// Heights in the pane, of 1.
constexpr double FirstSlider = 0.88;
constexpr double SliderStep = 0.165;
constexpr double ButtonHeight = 0.20;
constexpr double StatusHeight = 0.03;

void Place(vtkCoordinate* coordinate, double x, double y)
{
  coordinate->SetCoordinateSystemToNormalizedViewport();
  coordinate->SetValue(x, y);
}
}

ControlPane::ControlPane(const std::array<double, 4>& viewport)
  : Viewport(viewport)
  , Status(vtkSmartPointer<vtkTextActor>::New())
{
  this->View->SetViewport(viewport[0], viewport[1], viewport[2], viewport[3]);
  this->Front->SetLayer(1);
  this->Front->InteractiveOff();
  this->View->SetBackground(0.16, 0.17, 0.20);
  Place(this->Status->GetPositionCoordinate(), 0.03, StatusHeight);
  this->Status->GetTextProperty()->SetFontSize(12);
  this->Status->GetTextProperty()->SetColor(0.85, 0.87, 0.90);
  this->View->AddActor(this->Status);
}

ControlPane::~ControlPane() = default;

int ControlPane::AddSlider(const std::string& title, const char* format, double low, double high,
  double value, std::function<void(double)> changed)
{
  const double y = FirstSlider - SliderStep * static_cast<double>(this->Sliders.size());
  vtkNew<vtkTextActor> name;
  name->SetInput(title.c_str());
  name->GetTextProperty()->SetFontSize(13);
  name->GetTextProperty()->SetVerticalJustificationToCentered();
  Place(name->GetPositionCoordinate(), 0.03, y);
  this->View->AddActor(name);
  vtkNew<vtkSliderRepresentation2D> slider;
  slider->SetMinimumValue(low);
  slider->SetMaximumValue(high);
  slider->SetValue(value);
  slider->SetLabelFormat(format);
  const auto inWindow = [this](double share, int axis)
  { return this->Viewport[axis] + share * (this->Viewport[axis + 2] - this->Viewport[axis]); };
  Place(slider->GetPoint1Coordinate(), inWindow(0.36, 0), inWindow(y, 1));
  Place(slider->GetPoint2Coordinate(), inWindow(0.97, 0), inWindow(y, 1));
  slider->SetSliderLength(0.012);
  slider->SetSliderWidth(0.018);
  slider->SetTubeWidth(0.004);
  slider->SetEndCapLength(0.002);
  slider->SetEndCapWidth(0.012);
  slider->SetLabelHeight(0.014);
  slider->GetLabelProperty()->SetShadow(0);
  slider->GetLabelProperty()->BoldOff();
  slider->GetTubeProperty()->SetColor(0.45, 0.48, 0.55);
  slider->GetSliderProperty()->SetColor(0.95, 0.80, 0.25);
  slider->GetSelectedProperty()->SetColor(1, 1, 1);
  vtkNew<vtkSliderWidget> widget;
  widget->SetRepresentation(slider);
  widget->SetAnimationModeToJump();
  widget->KeyPressActivationOff();
  vtkNew<SliderObserver> observer;
  observer->Changed = std::move(changed);
  widget->AddObserver(vtkCommand::InteractionEvent, observer);
  this->Sliders.push_back(widget.Get());
  return static_cast<int>(this->Sliders.size()) - 1;
}

void ControlPane::AddButton(const std::string& title, std::function<void()> pressed)
{
  vtkNew<vtkTextActor> label;
  label->SetInput((" " + title + " ").c_str());
  vtkTextProperty* text = label->GetTextProperty();
  text->SetFontSize(13);
  text->SetBackgroundColor(0.30, 0.33, 0.40);
  text->SetBackgroundOpacity(1);
  text->FrameOn();
  text->SetFrameColor(0.55, 0.58, 0.65);
  text->SetVerticalJustificationToCentered();
  Place(label->GetPositionCoordinate(), 0.03 + 0.25 * static_cast<double>(this->Buttons.size()),
    ButtonHeight);
  this->View->AddActor(label);
  this->Buttons.push_back({ label.Get(), std::move(pressed) });
}

void ControlPane::Attach(vtkRenderWindowInteractor* interactor)
{
  for (vtkSliderWidget* slider : this->Sliders)
  {
    if (!interactor)
    {
      slider->EnabledOff();
      slider->SetInteractor(nullptr);
      continue;
    }
    slider->SetInteractor(interactor);
    slider->SetDefaultRenderer(this->Front);
    slider->SetCurrentRenderer(this->Front);
    slider->EnabledOn();
  }
}

void ControlPane::SetSlider(int slider, double value)
{
  static_cast<vtkSliderRepresentation*>(
    this->Sliders[static_cast<std::size_t>(slider)]->GetRepresentation())
    ->SetValue(value);
}

void ControlPane::SetStatus(const std::string& text)
{
  this->Status->SetInput(text.c_str());
}

bool ControlPane::Press(int x, int y)
{
  const int* origin = this->View->GetOrigin();
  for (const Button& button : this->Buttons)
  {
    double box[4];
    button.Label->GetBoundingBox(this->View, box);
    const int* at = button.Label->GetPositionCoordinate()->GetComputedViewportValue(this->View);
    const double inX = x - origin[0] - at[0];
    const double inY = y - origin[1] - at[1];
    if (inX >= box[0] && inX <= box[1] && inY >= box[2] && inY <= box[3])
    {
      button.Pressed();
      return true;
    }
  }
  return false;
}
}
