// SPDX-License-Identifier: Apache-2.0
#include "Private/ViewerStyle.h"

#include "vtkObjectFactory.h"
#include "vtkRenderWindowInteractor.h"

#include <cstdlib>

namespace mammoray
{
namespace
{
/// A button released within so many pixels of where it was pressed is a click.
constexpr int ClickPixels = 3;
}

vtkStandardNewMacro(ViewerStyle);

void ViewerStyle::OnLeftButtonDown()
{
  this->Start = this->Place();
  this->Last = this->Start;
  const auto [x, y] = this->Start;
  this->Taken = this->Target->OnPress(x, y, this->Interactor->GetShiftKey() != 0);
  const MouseTarget::Kind kind = this->Target->KindAt(x, y);
  this->Windows = !this->Taken && kind == MouseTarget::Kind::Picture;
  if (!this->Taken && kind == MouseTarget::Kind::Scene)
  {
    this->Superclass::OnLeftButtonDown();
  }
}

void ViewerStyle::OnMouseMove()
{
  const auto [x, y] = this->Place();
  if (this->Taken)
  {
    this->Target->OnDrag(x, y);
    return;
  }
  if (this->Windows)
  {
    // A click that trembles is not to change the grey.
    if (std::abs(x - this->Start[0]) > ClickPixels || std::abs(y - this->Start[1]) > ClickPixels ||
      this->Last != this->Start)
    {
      this->Target->OnWindow(x - this->Last[0], y - this->Last[1]);
      this->Last = { x, y };
    }
    return;
  }
  this->Superclass::OnMouseMove();
}

void ViewerStyle::OnLeftButtonUp()
{
  if (this->Taken)
  {
    this->Taken = false;
    this->Target->OnRelease();
    return;
  }
  this->Windows = false;
  this->Superclass::OnLeftButtonUp();
  const auto [x, y] = this->Place();
  if (std::abs(x - this->Start[0]) <= ClickPixels && std::abs(y - this->Start[1]) <= ClickPixels)
  {
    this->Target->OnClick(x, y);
  }
}

void ViewerStyle::OnMiddleButtonDown()
{
  if (this->MovesHere())
  {
    this->Superclass::OnMiddleButtonDown();
  }
}

void ViewerStyle::OnRightButtonDown()
{
  if (this->MovesHere())
  {
    this->Superclass::OnRightButtonDown();
  }
}

void ViewerStyle::OnMouseWheelForward()
{
  this->Wheel(1);
}

void ViewerStyle::OnMouseWheelBackward()
{
  this->Wheel(-1);
}

void ViewerStyle::Wheel(int steps)
{
  const auto [x, y] = this->Place();
  if (!this->MovesHere() || this->Target->OnWheel(x, y, steps))
  {
    return;
  }
  if (steps > 0)
  {
    this->Superclass::OnMouseWheelForward();
  }
  else
  {
    this->Superclass::OnMouseWheelBackward();
  }
}

void ViewerStyle::OnKeyPress()
{
  this->Target->OnKey(this->Interactor->GetKeySym());
}

std::array<int, 2> ViewerStyle::Place() const
{
  const int* at = this->Interactor->GetEventPosition();
  return { at[0], at[1] };
}

bool ViewerStyle::MovesHere() const
{
  const auto [x, y] = this->Place();
  return this->Target->KindAt(x, y) != MouseTarget::Kind::Nothing;
}
}
