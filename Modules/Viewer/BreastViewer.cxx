// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Viewer/BreastViewer.h"

#include "Private/BreastMark.h"
#include "Private/BreastScene.h"
#include "Private/CompressionWorker.h"
#include "Private/ControlPane.h"
#include "Private/KilovoltageSpectrum.h"
#include "Private/LiveMammogram.h"
#include "Private/MammogramPane.h"
#include "Private/RequireDisplay.h"
#include "Private/ViewerStyle.h"
#include "Private/WindowPicture.h"
#include "mammoray/Foundation/Error.h"

#include "vtkCallbackCommand.h"
#include "vtkCamera.h"
#include "vtkCommand.h"
#include "vtkRenderWindow.h"
#include "vtkRenderWindowInteractor.h"
#include "vtkTextActor.h"
#include "vtkTextProperty.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <map>
#include <numbers>
#include <thread>

namespace mammoray
{
namespace
{
using Clock = std::chrono::steady_clock;

/// Without a move for so long things are at rest, s.
constexpr double RestSeconds = 0.25;
constexpr int TickMilliseconds = 10;
constexpr double SourceStepMm = 10;
/// Share of the way to the source at which it is drawn beside the breast.
constexpr double NearSource = 0.3;
/// How far the slider goes to either side of the spectrum's own voltage, kV.
constexpr double KilovoltageRange = 6;

// Borders of the window's parts, of 1.
constexpr double PaneLeft = 0.55;
constexpr double ControlsTop = 0.34;
constexpr double RestRight = 0.22;

double SecondsSince(Clock::time_point begin)
{
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

vtkSmartPointer<vtkTextActor> AddText(vtkRenderer* renderer, const std::string& text, double x,
  double y, int size)
{
  vtkNew<vtkTextActor> actor;
  actor->SetInput(text.c_str());
  actor->GetTextProperty()->SetFontSize(size);
  actor->GetTextProperty()->SetVerticalJustificationToTop();
  actor->GetPositionCoordinate()->SetCoordinateSystemToNormalizedViewport();
  actor->GetPositionCoordinate()->SetValue(x, y);
  renderer->AddActor(actor);
  return actor.Get();
}

}

struct BreastViewer::Internals : MouseTarget
{
  Internals(BreastViewer& viewer, const ViewedBreast& viewed, const ViewerOptions& options);
  ~Internals() override;

  bool OnPress(int x, int y) override;
  void OnDrag(int x, int y) override;
  void OnRelease() override { this->Dragging = false; }
  void OnClick(int x, int y) override { this->Viewer.Click(x, y); }
  void OnKey(const std::string& name) override { this->Viewer.Key(name); }
  bool Turns(int x, int y) override
  {
    return this->In(this->Squeezed.Renderer(), x, y) || this->In(this->AtRest.Renderer(), x, y);
  }
  bool Moves(int x, int y) override { return !this->In(this->Controls.Renderer(), x, y); }
  bool In(vtkRenderer* renderer, int x, int y) const
  {
    return renderer->GetRenderWindow() && renderer->IsInViewport(x, y) != 0;
  }

  void Lay();
  void AddControls();
  void LookAt();
  /// Something that the picture shows has changed.
  void Moved();
  void Draw(int divisor);
  void Compress();
  void TakeEquilibrium();
  /// False, with the reason as message, where there is nothing to mark.
  bool SetMark(const auto& place);
  void TellStatus();
  void SavePictures();

  BreastViewer& Viewer;
  const ViewedBreast& Viewed;
  ViewerOptions Options;
  LiveMammogram Live;
  CompressionWorker Worker;
  MammogramPane Pane;
  BreastScene Squeezed;
  BreastScene AtRest;
  BreastMark Mark;
  ControlPane Controls;
  vtkNew<vtkRenderWindow> Window;
  vtkSmartPointer<vtkRenderWindowInteractor> Interactor;
  vtkNew<ViewerStyle> Style;
  vtkSmartPointer<vtkTextActor> Help;
  vtkSmartPointer<vtkTextActor> UnitText;
  int ThicknessSlider = 0;
  int RollSlider = 0;
  int BlendSlider = 0;
  int KilovoltageSlider = 0;

  double ShownSource = NearSource;
  bool Dragging = false;
  bool Moving = false;
  bool Dirty = true;
  Clock::time_point LastMove = Clock::now();
  std::string Message;
  std::string StatusText;
};

BreastViewer::Internals::Internals(BreastViewer& viewer, const ViewedBreast& viewed,
  const ViewerOptions& options)
  : Viewer(viewer)
  , Viewed(viewed)
  , Options(options)
  , Live(viewed, options.Projector)
  , Worker(viewed)
  , Pane(viewed, this->Live)
  , Squeezed(this->Live, viewed)
  , AtRest(this->Live, viewed)
  , Mark(this->Live, this->Squeezed, this->AtRest, this->Pane)
  , Controls({ RestRight, 0, PaneLeft, ControlsTop })
{
  this->Live.SetSourceOffset(options.SourceOffset);
  if (options.Kilovoltage)
  {
    this->Live.SetKilovoltage(*options.Kilovoltage);
  }
  this->Pane.SetBlend(options.Blend);
  this->Squeezed.SetPoints(this->Live.Points());
  this->AtRest.SetPoints(viewed.Anatomy.Points);

  this->Window->SetWindowName(("mammoray view: " + viewed.Name).c_str());
  this->Window->SetOffScreenRendering(options.OffScreen ? 1 : 0);
  this->Window->SetSize(options.Width, options.Height);
  this->Window->SetMultiSamples(0); // software OpenGL draws every sample by itself
  this->Lay();
  this->AddControls();
  this->Interactor = vtkSmartPointer<vtkRenderWindowInteractor>::New();
  this->Interactor->SetRenderWindow(this->Window);
  this->Style->Target = this;
  this->Interactor->SetInteractorStyle(this->Style);
  // Events come faster than frames: all of them are taken first, then one frame is drawn (Tick).
  this->Interactor->EnableRenderOff();
  vtkNew<vtkCallbackCommand> wantsFrame;
  wantsFrame->SetClientData(this);
  wantsFrame->SetCallback([](vtkObject*, unsigned long, void* self, void*)
    { static_cast<Internals*>(self)->Dirty = true; });
  this->Interactor->AddObserver(vtkCommand::RenderEvent, wantsFrame);
  this->Interactor->AddObserver(vtkCommand::ConfigureEvent, wantsFrame);
  this->Interactor->AddObserver(vtkCommand::ExposeEvent, wantsFrame);
  this->Controls.Attach(this->Interactor);
  this->Squeezed.SetUnit(this->Live, this->Pane.Picture(), this->ShownSource);
  this->LookAt();
  if (viewed.PoseDiffers)
  {
    this->Compress();
  }
}

/// Window and interactor hold each other.
BreastViewer::Internals::~Internals()
{
  this->Controls.Attach(nullptr);
  this->Interactor->RemoveAllObservers();
  this->Interactor->SetInteractorStyle(nullptr);
  this->Interactor->SetRenderWindow(nullptr);
  this->Window->SetInteractor(nullptr);
  this->Window->Finalize();
}

/// Divides the window among the renderers.
void BreastViewer::Internals::Lay()
{
  this->Window->SetNumberOfLayers(2);
  this->Pane.Renderer()->SetViewport(PaneLeft, 0, 1, 1);
  for (vtkRenderer* renderer : { this->Squeezed.Renderer(), this->Squeezed.MarkRenderer() })
  {
    renderer->SetViewport(0, ControlsTop, PaneLeft, 1);
    this->Window->AddRenderer(renderer);
  }
  this->Window->AddRenderer(this->Controls.Renderer());
  this->Window->AddRenderer(this->Controls.SliderRenderer());
  this->Window->AddRenderer(this->Pane.Renderer());
  for (vtkRenderer* renderer : { this->AtRest.Renderer(), this->AtRest.MarkRenderer() })
  {
    renderer->SetViewport(0, 0, RestRight, ControlsTop);
    this->Window->AddRenderer(renderer);
  }
  AddText(this->AtRest.Renderer(), "uncompressed", 0.03, 0.97, 14);
  AddText(this->Squeezed.Renderer(), "between the plates      h: help", 0.012, 0.985, 14);
  this->UnitText = AddText(this->Squeezed.Renderer(), "", 0.012, 0.935, 12);
  AddText(this->Pane.Renderer(), this->Viewed.Real ? "synthetic and real" : "synthetic", 0.02,
    0.985, 14);
  this->Help = AddText(this->Squeezed.Renderer(), ViewerHelpText(), 0.03, 0.90, 13);
  this->Help->GetTextProperty()->SetBackgroundColor(0.05, 0.06, 0.08);
  this->Help->GetTextProperty()->SetBackgroundOpacity(0.9);
  this->Help->VisibilityOff();
}

void BreastViewer::Internals::AddControls()
{
  const BreastPose& pose = this->Viewed.Pose;
  double low = 0.6 * pose.ThicknessMm;
  double high = 1.4 * pose.ThicknessMm;
  if (!this->Viewed.Series.empty())
  {
    low = this->Viewed.Series.back().ThicknessMm;
    high = this->Viewed.Series.front().ThicknessMm;
  }
  this->ThicknessSlider = this->Controls.AddSlider("thickness, mm", "%.1f", low, high,
    pose.ThicknessMm, [this](double value) { this->Viewer.SetThickness(value); });
  this->RollSlider = this->Controls.AddSlider("roll, degrees", "%.1f", pose.RollDeg - 45,
    pose.RollDeg + 45, pose.RollDeg, [this](double value) { this->Viewer.SetRoll(value); });
  const double voltage = KilovoltageOf(this->Viewed.Spectrum);
  this->KilovoltageSlider = this->Controls.AddSlider("tube voltage, kV", "%.1f",
    voltage - KilovoltageRange, voltage + KilovoltageRange, this->Live.Kilovoltage(),
    [this](double value) { this->Viewer.SetKilovoltage(value); });
  if (this->Viewed.Real)
  {
    this->BlendSlider = this->Controls.AddSlider("synthetic - real", "%.2f", 0, 1,
      this->Pane.Blend(), [this](double value) { this->Viewer.SetBlend(value); });
  }
  this->Controls.AddButton("save pictures", [this] { this->Viewer.Key("s"); });
  this->Controls.AddButton("source back", [this] { this->Viewer.Key("Home"); });
  this->Controls.AddButton("help", [this] { this->Viewer.Key("h"); });
}

/// Both breasts from the front and a little from the side and above; all of the picture.
void BreastViewer::Internals::LookAt()
{
  const VolumeFromGantry placed = this->Live.Placed();
  const double side = this->Viewed.Laterality == 'R' ? -1 : 1;
  for (BreastScene* scene : { &this->Squeezed, &this->AtRest })
  {
    vtkRenderer* renderer = scene->Renderer();
    const Vector3 from = placed.Direction({ 0.75 * side, 0.62, 0.22 });
    vtkCamera* camera = renderer->GetActiveCamera();
    camera->SetFocalPoint(0, 0, 0);
    camera->SetPosition(from.data());
    const Vector3 up = placed.Z;
    camera->SetViewUp(up.data());
    renderer->ResetCamera();
    renderer->ResetCameraClippingRange();
  }
  this->Pane.Frame();
  this->Dirty = true;
}

void BreastViewer::Internals::Moved()
{
  this->Moving = true;
  this->Dirty = true;
  this->LastMove = Clock::now();
}

void BreastViewer::Internals::Compress()
{
  if (!this->Viewed.Series.empty())
  {
    const std::vector<double> points = this->Live.SeriesPoints(this->Live.Pose().ThicknessMm);
    this->Live.SetPoints(points);
    this->Squeezed.SetPoints(points);
    return;
  }
  this->Worker.Ask(this->Live.Pose());
}

void BreastViewer::Internals::TakeEquilibrium()
{
  const std::optional<CompressedAnatomy> answer = this->Worker.Take();
  if (!answer)
  {
    return;
  }
  if (!answer->Error.empty())
  {
    this->Message = answer->Error;
    this->TellStatus();
    return;
  }
  char text[120];
  std::snprintf(text, sizeof text, "%.1f mm, %.1f N, compressed in %.1f s",
    answer->Pose.ThicknessMm, answer->PaddleForceN, answer->Seconds);
  this->Message = text;
  this->Live.SetPoints(answer->Points);
  this->Squeezed.SetPoints(answer->Points);
  this->Moved();
}

void BreastViewer::Internals::Draw(int divisor)
{
  this->Pane.Update(this->Live, divisor);
  this->Squeezed.SetUnit(this->Live, this->Pane.Picture(), this->ShownSource);
  const Vector3& offset = this->Live.SourceOffset();
  char text[160];
  std::snprintf(text, sizeof text, "%.1f mm, roll %.1f deg, %.1f kV, source %+.0f %+.0f %+.0f mm%s",
    this->Live.Pose().ThicknessMm, this->Live.Pose().RollDeg, this->Live.Kilovoltage(), offset[0],
    offset[1], offset[2], this->ShownSource < 1 ? ", drawn at 0.3 of its distance" : "");
  this->UnitText->SetInput(text);
  for (BreastScene* scene : { &this->Squeezed, &this->AtRest })
  {
    scene->Renderer()->ResetCameraClippingRange();
  }
  this->TellStatus();
  // What stands still keeps its pixels while the rest moves.
  this->AtRest.Renderer()->SetDraw(divisor == 1 ? 1 : 0);
  this->Window->Render();
}

void BreastViewer::Internals::TellStatus()
{
  const std::string stage = this->Worker.Stage();
  this->StatusText = this->Mark.Text();
  const std::string second = stage.empty() ? this->Message : "working: " + stage;
  if (!second.empty())
  {
    this->StatusText += (this->StatusText.empty() ? "" : "\n") + second;
  }
  this->Controls.SetStatus(this->StatusText);
}

bool BreastViewer::Internals::OnPress(int x, int y)
{
  if (this->In(this->Controls.Renderer(), x, y))
  {
    this->Controls.Press(x, y);
    return true;
  }
  this->Dragging = this->In(this->Squeezed.Renderer(), x, y) && this->Squeezed.OnSource(x, y);
  return this->Dragging;
}

/// The drawn source follows the mouse in the plane across the view; the source moves as it does, as
/// much farther as it is away.
void BreastViewer::Internals::OnDrag(int x, int y)
{
  if (!this->Dragging)
  {
    return;
  }
  vtkRenderer* view = this->Squeezed.Renderer();
  const Vector3& shown = this->Squeezed.ShownSource();
  view->SetWorldPoint(shown[0], shown[1], shown[2], 1);
  view->WorldToDisplay();
  double display[3];
  view->GetDisplayPoint(display);
  view->SetDisplayPoint(x, y, display[2]);
  view->DisplayToWorld();
  double world[4];
  view->GetWorldPoint(world);
  const Vector3 to{ world[0] / world[3], world[1] / world[3], world[2] / world[3] };
  const Vector3& middle = this->Squeezed.ReceptorMiddle();
  const Vector3 source = middle + (1 / this->ShownSource) * (to - middle);
  const Vector3 gantry = this->Live.Placed().ToGantry(source);
  this->Viewer.MoveSource(gantry - Vector3{ 0, 0, this->Viewed.Breast.Unit.SourceToDetectorMm });
}

void BreastViewer::Internals::SavePictures()
{
  try
  {
    this->Draw(1);
    const std::string window = FreePictureName(this->Options.PictureFolder, "mammoray-window");
    const std::string mammogram =
      FreePictureName(this->Options.PictureFolder, "mammoray-mammogram");
    WriteWindowPicture(this->Window, window);
    this->Pane.Write(mammogram);
    this->Message = "saved " + window + " and " + mammogram;
  }
  catch (const Error& error)
  {
    this->Message = error.what();
  }
  this->Dirty = true;
}

BreastViewer::BreastViewer(const ViewedBreast& viewed, const ViewerOptions& options)
{
  RequireDisplay();
  this->Internal = std::make_unique<Internals>(*this, viewed, options);
}

BreastViewer::~BreastViewer() = default;

void BreastViewer::Run()
{
  vtkNew<vtkCallbackCommand> tick;
  tick->SetClientData(this);
  tick->SetCallback(
    [](vtkObject*, unsigned long, void* self, void*) { static_cast<BreastViewer*>(self)->Tick(); });
  this->Internal->Interactor->AddObserver(vtkCommand::TimerEvent, tick);
  // Not before: VTK's event loop goes through all interactors that were ever initialised and did
  // not run, also those that are gone.
  this->Internal->Interactor->Initialize();
  this->Internal->Interactor->CreateRepeatingTimer(TickMilliseconds);
  this->Tick();
  this->Internal->Interactor->Start();
}

bool BreastViewer::Tick()
{
  Internals& internal = *this->Internal;
  if (internal.Options.Stop && internal.Options.Stop())
  {
    internal.Interactor->TerminateApp();
    return false;
  }
  internal.TakeEquilibrium();
  if (internal.Moving && SecondsSince(internal.LastMove) > RestSeconds)
  {
    internal.Moving = false;
    internal.Mark.Update();
    internal.Dirty = true;
  }
  const std::string before = internal.StatusText;
  internal.TellStatus();
  if (!internal.Dirty && before == internal.StatusText)
  {
    return false;
  }
  internal.Dirty = false;
  internal.Draw(internal.Moving ? 2 : 1);
  return true;
}

void BreastViewer::WriteScreenshot(const std::string& path)
{
  Internals& internal = *this->Internal;
  while (!internal.Worker.Stage().empty())
  {
    if (internal.Options.Stop && internal.Options.Stop())
    {
      throw Interrupted();
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(TickMilliseconds));
  }
  internal.TakeEquilibrium();
  internal.Moving = false;
  internal.Mark.Update();
  internal.Draw(1);
  WriteWindowPicture(internal.Window, path);
}

double BreastViewer::Benchmark(int frames)
{
  Internals& internal = *this->Internal;
  constexpr double RadiusMm = 60;
  constexpr int FramesPerTurn = 60;
  internal.Draw(2); // what is made once
  const auto begin = Clock::now();
  for (int frame = 0; frame < frames; ++frame)
  {
    const double angle = 2 * std::numbers::pi * frame / FramesPerTurn;
    internal.Live.SetSourceOffset({ RadiusMm * std::cos(angle), RadiusMm * std::sin(angle), 0 });
    internal.Draw(2);
  }
  internal.Window->WaitForCompletion();
  return frames / SecondsSince(begin);
}

void BreastViewer::SetThickness(double thicknessMm)
{
  Internals& internal = *this->Internal;
  internal.Live.SetPose(thicknessMm, internal.Live.Pose().RollDeg);
  internal.Controls.SetSlider(internal.ThicknessSlider, thicknessMm);
  internal.Compress();
  internal.Moved();
}

void BreastViewer::SetRoll(double rollDeg)
{
  Internals& internal = *this->Internal;
  internal.Live.SetPose(internal.Live.Pose().ThicknessMm, rollDeg);
  internal.Controls.SetSlider(internal.RollSlider, rollDeg);
  internal.Moved();
}

void BreastViewer::SetKilovoltage(double kilovoltage)
{
  Internals& internal = *this->Internal;
  internal.Live.SetKilovoltage(kilovoltage);
  internal.Controls.SetSlider(internal.KilovoltageSlider, kilovoltage);
  internal.Moved();
}

void BreastViewer::SetBlend(double real)
{
  Internals& internal = *this->Internal;
  internal.Pane.SetBlend(real);
  if (internal.Viewed.Real)
  {
    internal.Controls.SetSlider(internal.BlendSlider, real);
  }
  internal.Dirty = true;
}

void BreastViewer::MoveSource(const Vector3& offset)
{
  this->Internal->Live.SetSourceOffset(offset);
  this->Internal->Moved();
}

bool BreastViewer::Internals::SetMark(const auto& place)
{
  this->Mark.Set(place);
  this->Dirty = true;
  try
  {
    this->Mark.Update();
  }
  catch (const InputError& error)
  {
    this->Mark.Clear();
    this->Mark.Update();
    this->Message = error.what();
    return false;
  }
  return true;
}

bool BreastViewer::MarkPoint(const Vector3& point)
{
  return this->Internal->SetMark(point);
}

bool BreastViewer::MarkPixel(double column, double row)
{
  return this->Internal->SetMark(std::array<double, 2>{ column, row });
}

void BreastViewer::ClearMark()
{
  this->Internal->Mark.Clear();
  this->Internal->Dirty = true;
  this->Internal->Mark.Update();
}

void BreastViewer::Click(int x, int y)
{
  Internals& internal = *this->Internal;
  if (internal.In(internal.Pane.Renderer(), x, y))
  {
    double column = 0;
    double row = 0;
    if (internal.Pane.PixelAt(x, y, column, row))
    {
      this->MarkPixel(column, row);
    }
    return;
  }
  for (BreastScene* scene : { &internal.Squeezed, &internal.AtRest })
  {
    Vector3 point;
    std::array<std::int32_t, 3> corners{};
    std::array<double, 3> weights{};
    if (internal.In(scene->Renderer(), x, y) && scene->Pick(x, y, point, corners, weights))
    {
      // The same material point at rest.
      Vector3 rest{ 0, 0, 0 };
      for (std::size_t corner = 0; corner < 3; ++corner)
      {
        rest = rest +
          weights[corner] *
            internal.Viewed.Anatomy.Point(static_cast<std::size_t>(corners[corner]));
      }
      this->MarkPoint(rest);
    }
  }
}

void BreastViewer::Key(const std::string& name)
{
  Internals& internal = *this->Internal;
  const Vector3 offset = internal.Live.SourceOffset();
  const std::map<std::string, Vector3> steps{ { "Left", { SourceStepMm, 0, 0 } },
    { "Right", { -SourceStepMm, 0, 0 } }, { "Up", { 0, SourceStepMm, 0 } },
    { "Down", { 0, -SourceStepMm, 0 } }, { "Prior", { 0, 0, SourceStepMm } },
    { "Next", { 0, 0, -SourceStepMm } } };
  if (const auto step = steps.find(name); step != steps.end())
  {
    this->MoveSource(offset + step->second);
  }
  else if (name == "Home")
  {
    this->MoveSource({ 0, 0, 0 });
  }
  else if (name == "plus" || name == "KP_Add")
  {
    this->SetThickness(internal.Live.Pose().ThicknessMm + 1);
  }
  else if ((name == "minus" || name == "KP_Subtract") && internal.Live.Pose().ThicknessMm > 2)
  {
    this->SetThickness(internal.Live.Pose().ThicknessMm - 1);
  }
  else if (name == "b")
  {
    this->SetBlend(internal.Pane.Blend() < 0.5 ? 1 : 0);
  }
  else if (name == "w")
  {
    internal.ShownSource = internal.ShownSource < 1 ? 1 : NearSource;
    internal.Squeezed.SetUnit(internal.Live, internal.Pane.Picture(), internal.ShownSource);
    internal.LookAt();
  }
  else if (name == "r")
  {
    internal.LookAt();
  }
  else if (name == "c")
  {
    internal.Compress();
    internal.Moved();
  }
  else if (name == "s")
  {
    internal.SavePictures();
  }
  else if (name == "h")
  {
    internal.Help->SetVisibility(internal.Help->GetVisibility() != 0 ? 0 : 1);
    internal.Dirty = true;
  }
  else if (name == "Escape")
  {
    this->ClearMark();
  }
  else if (name == "q")
  {
    internal.Interactor->TerminateApp();
  }
}

std::string BreastViewer::Status() const
{
  return this->Internal->StatusText;
}

const std::string& BreastViewer::Message() const
{
  return this->Internal->Message;
}

vtkRenderWindow* BreastViewer::Window()
{
  return this->Internal->Window;
}

const BreastPose& BreastViewer::Pose() const
{
  return this->Internal->Live.Pose();
}

const std::vector<double>& BreastViewer::Points() const
{
  return this->Internal->Live.Points();
}

std::string ViewerHelpText()
{
  return "click                     mark a point, or what lies behind a pixel\n"
         "drag the yellow ball      move the X-ray source\n"
         "arrows, Page up and down  move it by 10 mm; Home: back\n"
         "drag, wheel, middle       turn, zoom, shift a view\n"
         "+ and -                   thickness by 1 mm\n"
         "c                         compress between the plates as they stand\n"
         "b                         synthetic or real mammogram\n"
         "w                         whole unit, or the breast\n"
         "r                         views back\n"
         "s                         save pictures\n"
         "Escape                    remove the mark\n"
         "h, q                      this help, quit";
}
}
