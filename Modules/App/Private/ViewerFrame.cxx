// SPDX-License-Identifier: Apache-2.0
#include "Private/ViewerFrame.h"

#include "Private/SceneShapes.h"

#include "vtkCallbackCommand.h"
#include "vtkCommand.h"
#include "vtkTextActor.h"
#include "vtkTextProperty.h"

#include <algorithm>

namespace mammoray
{
namespace
{
/// Without a move for so long things are at rest.
constexpr std::chrono::milliseconds RestTime{ 250 };
constexpr int FrameTickMilliseconds = 10;
}

void ViewerFrame::Open(const std::string& title, const std::string& help,
  const ViewerOptions& options)
{
  this->Help = AddText(this->HelpView, help, 0.5, 0.5, 14);
  vtkTextProperty* text = this->Help->GetTextProperty();
  text->SetFontFamilyToCourier();
  this->Help->GetPositionCoordinate()->SetCoordinateSystemToViewport();
  text->SetBackgroundColor(0.05, 0.06, 0.08);
  text->SetBackgroundOpacity(1);
  text->FrameOn();
  text->SetFrameColor(0.55, 0.58, 0.65);
  this->Help->VisibilityOff();

  this->Window->SetWindowName(title.c_str());
  this->Window->SetOffScreenRendering(options.OffScreen ? 1 : 0);
  this->Window->SetSize(options.Width, options.Height);
  this->Window->SetMultiSamples(0); // software OpenGL draws every sample by itself
  this->Window->SetNumberOfLayers(3);
  this->Window->AddRenderer(this->Controls.Renderer());
  this->Window->AddRenderer(this->Controls.SliderRenderer());
  this->HelpView->SetLayer(2);
  this->HelpView->InteractiveOff();
  this->Window->AddRenderer(this->HelpView);
  this->Interactor = vtkSmartPointer<vtkRenderWindowInteractor>::New();
  this->Interactor->SetRenderWindow(this->Window);
  this->Style->Target = this;
  this->Interactor->SetInteractorStyle(this->Style);
  // Events come faster than frames: all of them are taken first, then one frame is drawn (Tick).
  this->Interactor->EnableRenderOff();
  vtkNew<vtkCallbackCommand> wantsFrame;
  wantsFrame->SetClientData(this);
  wantsFrame->SetCallback([](vtkObject*, unsigned long, void* self, void*)
    { static_cast<ViewerFrame*>(self)->Dirty = true; });
  this->Interactor->AddObserver(vtkCommand::RenderEvent, wantsFrame);
  this->Interactor->AddObserver(vtkCommand::ConfigureEvent, wantsFrame);
  this->Interactor->AddObserver(vtkCommand::ExposeEvent, wantsFrame);
  this->Controls.Attach(this->Interactor);
}

void ViewerFrame::Close()
{
  this->Controls.Attach(nullptr);
  this->Interactor->RemoveAllObservers();
  this->Interactor->SetInteractorStyle(nullptr);
  this->Interactor->SetRenderWindow(nullptr);
  this->Window->SetInteractor(nullptr);
  this->Window->Finalize();
}

void ViewerFrame::Run(const std::function<void()>& tick)
{
  vtkNew<vtkCallbackCommand> timer;
  timer->SetClientData(const_cast<std::function<void()>*>(&tick));
  timer->SetCallback([](vtkObject*, unsigned long, void* called, void*)
    { (*static_cast<std::function<void()>*>(called))(); });
  this->Interactor->AddObserver(vtkCommand::TimerEvent, timer);
  // Not before: VTK's event loop goes through all interactors that were ever initialised and did
  // not run, also those that are gone.
  this->Interactor->Initialize();
  this->Interactor->CreateRepeatingTimer(FrameTickMilliseconds);
  tick();
  this->Interactor->Start();
}

std::optional<double> ViewerFrame::LayControls()
{
  const int* size = this->Window->GetSize();
  if (this->Size == std::array{ size[0], size[1] })
  {
    return {};
  }
  this->Size = { size[0], size[1] };
  // In the middle, its lines beginning below each other.
  double box[4];
  this->Help->GetBoundingBox(this->HelpView, box);
  this->Help->GetPositionCoordinate()->SetValue(0.5 * (size[0] - (box[1] - box[0])),
    0.5 * (size[1] + (box[3] - box[2])));
  return static_cast<double>(this->Controls.Lay(size[0], size[1])) / std::max(size[1], 1);
}

bool ViewerFrame::TakesPress(int x, int y)
{
  if (this->Help->GetVisibility() != 0)
  {
    this->ToggleHelp();
    return true;
  }
  if (In(this->Controls.Renderer(), x, y))
  {
    this->Controls.Press(x, y);
    return true;
  }
  return false;
}

Vector3 ViewerFrame::WorldUnder(vtkRenderer* view, int x, int y, const Vector3& depth)
{
  view->SetWorldPoint(depth[0], depth[1], depth[2], 1);
  view->WorldToDisplay();
  double display[3];
  view->GetDisplayPoint(display);
  view->SetDisplayPoint(x, y, display[2]);
  view->DisplayToWorld();
  double world[4];
  view->GetWorldPoint(world);
  return { world[0] / world[3], world[1] / world[3], world[2] / world[3] };
}

void ViewerFrame::ToggleHelp()
{
  this->Help->SetVisibility(this->Help->GetVisibility() != 0 ? 0 : 1);
  this->Dirty = true;
}

void ViewerFrame::Moved()
{
  this->Moving = true;
  this->Dirty = true;
  this->LastMove = std::chrono::steady_clock::now();
}

bool ViewerFrame::ComesToRest()
{
  if (!this->Moving || std::chrono::steady_clock::now() - this->LastMove <= RestTime)
  {
    return false;
  }
  this->Moving = false;
  this->Dirty = true;
  return true;
}
}
