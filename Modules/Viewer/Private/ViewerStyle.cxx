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
  this->Taken = this->Target->OnPress(this->Start[0], this->Start[1]);
  if (!this->Taken && this->Target->Turns(this->Start[0], this->Start[1]))
  {
    this->Superclass::OnLeftButtonDown();
  }
}

void ViewerStyle::OnMouseMove()
{
  if (this->Taken)
  {
    const auto [x, y] = this->Place();
    this->Target->OnDrag(x, y);
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
  if (this->MovesHere())
  {
    this->Superclass::OnMouseWheelForward();
  }
}

void ViewerStyle::OnMouseWheelBackward()
{
  if (this->MovesHere())
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
  return this->Target->Moves(x, y);
}
}
