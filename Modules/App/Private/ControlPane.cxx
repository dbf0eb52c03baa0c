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
#include <cmath>

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

// Pixels.
constexpr int StatusLines = 4;
constexpr int StatusLineHeight = 15;
constexpr int RowHeight = 26;
constexpr int SliderHeight = 40;
constexpr int Border = 10;
constexpr int LeastSliderWidth = 230;
/// Share of a slider's place that its title has.
constexpr double TitleShare = 0.42;
}

ControlPane::ControlPane()
  : Status(vtkSmartPointer<vtkTextActor>::New())
{
  this->Front->SetLayer(1);
  this->Front->InteractiveOff();
  this->View->SetBackground(0.16, 0.17, 0.20);
  this->Status->GetPositionCoordinate()->SetCoordinateSystemToViewport();
  this->Status->GetTextProperty()->SetFontSize(12);
  this->Status->GetTextProperty()->SetColor(0.85, 0.87, 0.90);
  this->Status->GetTextProperty()->SetVerticalJustificationToTop();
  this->View->AddActor(this->Status);
}

ControlPane::~ControlPane() = default;

int ControlPane::AddSlider(const std::string& title, const char* format, double low, double high,
  double value, std::function<void(double)> changed)
{
  vtkNew<vtkTextActor> name;
  name->SetInput(title.c_str());
  name->GetTextProperty()->SetFontSize(13);
  name->GetTextProperty()->SetVerticalJustificationToCentered();
  name->GetPositionCoordinate()->SetCoordinateSystemToViewport();
  this->View->AddActor(name);
  vtkNew<vtkSliderRepresentation2D> slider;
  slider->SetMinimumValue(low);
  slider->SetMaximumValue(high);
  slider->SetValue(value);
  slider->SetLabelFormat(format);
  slider->GetLabelProperty()->SetShadow(0);
  slider->GetLabelProperty()->BoldOff();
  slider->GetTubeProperty()->SetColor(0.45, 0.48, 0.55);
  slider->GetSliderProperty()->SetColor(0.95, 0.80, 0.25);
  slider->GetSelectedProperty()->SetColor(1, 1, 1);
  for (vtkCoordinate* end : { slider->GetPoint1Coordinate(), slider->GetPoint2Coordinate() })
  {
    end->SetCoordinateSystemToNormalizedViewport();
  }
  vtkNew<vtkSliderWidget> widget;
  widget->SetRepresentation(slider);
  widget->SetAnimationModeToJump();
  widget->KeyPressActivationOff();
  vtkNew<SliderObserver> observer;
  observer->Changed = std::move(changed);
  widget->AddObserver(vtkCommand::InteractionEvent, observer);
  this->Sliders.push_back({ name.Get(), widget.Get() });
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
  label->GetPositionCoordinate()->SetCoordinateSystemToViewport();
  this->View->AddActor(label);
  this->Buttons.push_back({ label.Get(), std::move(pressed) });
}

void ControlPane::AddLegend(const std::string& name, const std::array<double, 3>& color)
{
  this->AddButton(name, {});
  vtkTextProperty* text = this->Buttons.back().Label->GetTextProperty();
  text->FrameOff();
  text->SetBackgroundColor(color[0], color[1], color[2]);
  // Black or white, whichever is told from it.
  const double bright = 0.3 * color[0] + 0.6 * color[1] + 0.1 * color[2];
  const double ink = bright > 0.45 ? 0 : 1;
  text->SetColor(ink, ink, ink);
}

int ControlPane::Lay(int width, int height)
{
  // Buttons in as many rows as they need, from above.
  const auto widthOf = [this](const Button& button)
  {
    double box[4];
    button.Label->GetBoundingBox(this->View, box);
    return static_cast<int>(box[1] - box[0]) + 6;
  };
  int rows = 1;
  int x = Border;
  std::vector<std::array<int, 2>> places;
  for (const Button& button : this->Buttons)
  {
    const int needed = widthOf(button);
    if (x + needed > width - Border && x > Border)
    {
      ++rows;
      x = Border;
    }
    places.push_back({ x, rows });
    x += needed + 4;
  }
  const int columns =
    std::clamp(width / LeastSliderWidth, 1, std::max(1, static_cast<int>(this->Sliders.size())));
  const int sliderRows =
    (static_cast<int>(this->Sliders.size()) + columns - 1) / std::max(columns, 1);
  const int strip = std::min(
    sliderRows * SliderHeight + rows * RowHeight + StatusLines * StatusLineHeight + 10, height);
  this->View->SetViewport(0, 0, 1, static_cast<double>(strip) / height);

  for (std::size_t index = 0; index < this->Sliders.size(); ++index)
  {
    const Slider& slider = this->Sliders[index];
    const double cell = static_cast<double>(width - Border) / columns;
    const double left =
      Border + cell * static_cast<double>(index % static_cast<std::size_t>(columns));
    const double row = std::floor(static_cast<double>(index) / columns);
    const double y = strip - SliderHeight * (row + 1) + 12;
    const double right = left + cell - 2 * Border;
    slider.Title->GetPositionCoordinate()->SetValue(left, y);
    auto* shown = static_cast<vtkSliderRepresentation2D*>(slider.Widget->GetRepresentation());
    shown->GetPoint1Coordinate()->SetValue((left + TitleShare * cell) / width, y / height);
    shown->GetPoint2Coordinate()->SetValue(right / width, y / height);
    shown->SetSliderLength(12.0 / width);
    shown->SetSliderWidth(14.0 / height);
    shown->SetTubeWidth(3.0 / height);
    shown->SetEndCapLength(2.0 / width);
    shown->SetEndCapWidth(10.0 / height);
    shown->SetLabelHeight(11.0 / height);
    shown->BuildRepresentation();
  }
  const int top = strip - sliderRows * SliderHeight;
  for (std::size_t index = 0; index < this->Buttons.size(); ++index)
  {
    this->Buttons[index].Label->GetPositionCoordinate()->SetValue(places[index][0],
      top - RowHeight * (places[index][1] - 0.5));
  }
  this->Status->GetPositionCoordinate()->SetValue(Border, top - RowHeight * rows - 3);
  return strip;
}

void ControlPane::Attach(vtkRenderWindowInteractor* interactor)
{
  for (const Slider& placed : this->Sliders)
  {
    vtkSliderWidget* slider = placed.Widget;
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
    this->Sliders[static_cast<std::size_t>(slider)].Widget->GetRepresentation())
    ->SetValue(value);
}

void ControlPane::SetRange(int slider, double low, double high)
{
  auto* shown = static_cast<vtkSliderRepresentation*>(
    this->Sliders[static_cast<std::size_t>(slider)].Widget->GetRepresentation());
  shown->SetMinimumValue(low);
  shown->SetMaximumValue(high);
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
    if (button.Pressed && inX >= box[0] && inX <= box[1] && inY >= box[2] && inY <= box[3])
    {
      button.Pressed();
      return true;
    }
  }
  return false;
}
}
