// SPDX-License-Identifier: Apache-2.0
#include "mammoray/App/SurfaceViewer.h"

#include "Private/LiveProjection.h"
#include "Private/ProjectionPane.h"
#include "Private/RequireDisplay.h"
#include "Private/SampleScene.h"
#include "Private/ViewerFrame.h"
#include "Private/WindowPicture.h"
#include "mammoray/Foundation/Error.h"

#include "vtkTextActor.h"

#include <chrono>
#include <cmath>
#include <cstdio>
#include <map>

namespace mammoray
{
namespace
{
/// A drag across so many pixels takes the grey's window to e times its width.
constexpr double GreyWindowPixels = 250;
constexpr double TurnStepDeg = 5;
/// A step of an arrow key moves the shadow by this share of the picture's height.
constexpr double SourceStep = 0.05;
/// Share of the window's width that the scene has.
constexpr double SceneShare = 0.46;

double InTurn(double degrees)
{
  return degrees - 360 * std::floor(degrees / 360);
}
}

struct SurfaceViewer::Internals : ViewerFrame
{
  Internals(SurfaceViewer& viewer, const ViewedScene& viewed, const ViewerOptions& options)
    : Viewer(viewer)
    , Viewed(viewed)
    , Options(options)
    , Live(viewed, options.Projector)
    , Pane(Live)
    , Scene(viewed, Live, Pane.Picture())
  {
    this->Live.SetSourceOffset(options.SourceOffset);
    this->Live.SetEnergy(options.Kilovoltage.value_or(this->Live.Energy()));
    AddText(this->Scene.Renderer(), "samples", 0.012, 0.985, 14);
    this->StateText = AddText(this->Scene.Renderer(), "", 0.012, 0.935, 12);
    this->Window->AddRenderer(this->Scene.Renderer());
    this->Window->AddRenderer(this->Pane.Renderer());
    this->AddControls();
    this->Open("mammoray view: " + viewed.Name, SurfaceViewerHelpText(), options);
    this->LookAt();
  }
  ~Internals() override { this->Close(); }

  Kind KindAt(int x, int y) override
  {
    return In(this->Pane.Renderer(), x, y) ? Kind::Picture
      : In(this->Scene.Renderer(), x, y)   ? Kind::Scene
                                           : Kind::Nothing;
  }
  bool OnPress(int x, int y, bool shift) override;
  void OnDrag(int x, int y) override;
  void OnRelease() override { this->Dragging = Drag::Nothing; }
  void OnClick(int x, int y) override { this->Viewer.Click(x, y); }
  void OnWindow(int right, int up) override
  {
    this->Pane.Adjust(std::exp(right / GreyWindowPixels), -up / GreyWindowPixels);
    this->Dirty = true;
  }
  bool OnWheel(int, int, int) override { return false; }
  void OnKey(const std::string& name) override { this->Viewer.Key(name); }

  void AddControls();
  void LookAt();
  void Draw(int divisor);
  void TellStatus();
  void SavePictures();

  enum class Drag
  {
    Nothing,
    Source,
    Ruler,
    Controls
  };

  SurfaceViewer& Viewer;
  const ViewedScene& Viewed;
  ViewerOptions Options;
  LiveProjection Live;
  ProjectionPane Pane;
  SampleScene Scene;
  vtkSmartPointer<vtkTextActor> StateText;
  int TurnSlider = 0;
  int EnergySlider = 0;
  bool Whole = false;
  Drag Dragging = Drag::Nothing;
  std::optional<std::array<double, 2>> Marked;
  std::string Message;
  std::string StatusText;
};

void SurfaceViewer::Internals::AddControls()
{
  this->TurnSlider = this->Controls.AddSlider("turn, degrees", "%.1f", 0, 360, 0,
    [this](double degrees) { this->Viewer.SetTurn(degrees); });
  const auto& [low, high] = this->Live.EnergyRange();
  this->EnergySlider = this->Controls.AddSlider(
    this->Live.IsSingleEnergy() ? "energy, keV" : "tube voltage, kV", "%.1f", low, high,
    this->Live.Energy(), [this](double energy) { this->Viewer.SetEnergy(energy); });
  for (const auto& [title, key] : { std::pair{ "help (h)", "h" }, std::pair{ "save pictures", "s" },
         std::pair{ "views back", "r" }, std::pair{ "source back", "Home" },
         std::pair{ "whole setup (w)", "w" } })
  {
    this->Controls.AddButton(title, [this, name = std::string(key)] { this->Viewer.Key(name); });
  }
  for (std::size_t material = 1; material < this->Scene.Colors().size(); ++material)
  {
    this->Controls.AddLegend(this->Viewed.Scene.Materials.Materials[material].Name,
      this->Scene.Colors()[material]);
  }
}

void SurfaceViewer::Internals::LookAt()
{
  this->Scene.Update(this->Live, this->Whole);
  this->Scene.LookAt(this->Live);
  this->Pane.Frame();
  this->Pane.ResetWindow();
  this->Pane.Overlay().SetRuler({});
  this->Dirty = true;
}

void SurfaceViewer::Internals::Draw(int divisor)
{
  const bool first = this->Size[0] == 0;
  if (const std::optional<double> bottom = this->LayControls())
  {
    this->Scene.Renderer()->SetViewport(0, *bottom, SceneShare, 1);
    this->Pane.Renderer()->SetViewport(SceneShare, *bottom, 1, 1);
    if (first)
    {
      this->LookAt(); // pictures fill their panes, whose sizes are known only now
    }
  }
  this->Pane.Update(this->Live, divisor);
  this->Pane.SetMark(this->Marked);
  this->Pane.Overlay().Update();
  this->Scene.Update(this->Live, this->Whole);
  const Vector3& offset = this->Live.SourceOffset();
  char text[200];
  std::snprintf(text, sizeof text, "turned %.1f deg, %.1f %s\nsource %+.4g %+.4g %+.4g mm%s",
    this->Live.Turn(), this->Live.Energy(), this->Live.IsSingleEnergy() ? "keV" : "kV", offset[0],
    offset[1], offset[2], this->Whole ? "" : ", setup drawn nearer");
  this->StateText->SetInput(text);
  this->TellStatus();
  this->Window->Render();
}

void SurfaceViewer::Internals::TellStatus()
{
  this->StatusText.clear();
  if (this->Marked)
  {
    const auto& [column, row] = *this->Marked;
    char text[80];
    std::snprintf(text, sizeof text, "pixel (%.1f, %.1f): ", column, row);
    this->StatusText = text +
      this->Live.Describe(static_cast<int>(std::lround(column)),
        static_cast<int>(std::lround(row)));
  }
  if (!this->Message.empty())
  {
    this->StatusText += (this->StatusText.empty() ? "" : "\n") + this->Message;
  }
  this->Controls.SetStatus(this->StatusText);
}

bool SurfaceViewer::Internals::OnPress(int x, int y, bool shift)
{
  this->Dragging = Drag::Nothing;
  if (this->TakesPress(x, y))
  {
    this->Dragging = Drag::Controls;
  }
  else if (shift && In(this->Pane.Renderer(), x, y))
  {
    const Vector3 from = this->Pane.Overlay().WorldAt(x, y);
    this->Pane.Overlay().SetRuler({ { from, from } });
    this->Dragging = Drag::Ruler;
    this->Dirty = true;
  }
  else if (In(this->Scene.Renderer(), x, y) && this->Scene.OnSource(x, y))
  {
    this->Dragging = Drag::Source;
  }
  return this->Dragging != Drag::Nothing;
}

/// The drawn source follows the mouse in the plane across the view; the source moves as much
/// farther as it is away.
void SurfaceViewer::Internals::OnDrag(int x, int y)
{
  if (this->Dragging == Drag::Ruler)
  {
    PaneOverlay& overlay = this->Pane.Overlay();
    overlay.SetRuler({ { (*overlay.RulerEnds())[0], overlay.WorldAt(x, y) } });
    this->Dirty = true;
  }
  if (this->Dragging != Drag::Source)
  {
    return;
  }
  const Vector3 shown = this->Scene.ShownSource();
  const Vector3 to = WorldUnder(this->Scene.Renderer(), x, y, shown);
  this->Viewer.MoveSource(
    this->Live.SourceOffset() + (1 / this->Scene.SourceShare()) * (to - shown));
}

void SurfaceViewer::Internals::SavePictures()
{
  try
  {
    this->Draw(1);
    const std::string& folder = this->Options.PictureFolder;
    const std::string window = FreePictureName(folder, "mammoray-window");
    WriteWindowPicture(this->Window, window);
    const std::string picture = FreePictureName(folder, "mammoray-xray");
    this->Pane.Write(picture);
    this->Message = "saved " + window + " and " + picture;
  }
  catch (const Error& error)
  {
    this->Message = error.what();
  }
  this->Dirty = true;
}

SurfaceViewer::SurfaceViewer(const ViewedScene& viewed, const ViewerOptions& options)
{
  RequireDisplay("view");
  this->Internal = std::make_unique<Internals>(*this, viewed, options);
}

SurfaceViewer::~SurfaceViewer() = default;

void SurfaceViewer::Run()
{
  this->Internal->Run([this] { this->Tick(); });
}

void SurfaceViewer::WriteScreenshot(const std::string& path)
{
  this->Internal->Moving = false;
  this->Internal->Draw(1);
  WriteWindowPicture(this->Internal->Window, path);
}

double SurfaceViewer::Benchmark(int frames)
{
  Internals& internal = *this->Internal;
  internal.Draw(2); // what is made once
  const auto begin = std::chrono::steady_clock::now();
  for (int frame = 1; frame <= frames; ++frame)
  {
    internal.Live.SetTurn(360.0 * frame / frames);
    internal.Draw(2);
  }
  internal.Window->WaitForCompletion();
  return frames / std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

void SurfaceViewer::SetTurn(double degrees)
{
  this->Internal->Live.SetTurn(degrees);
  this->Internal->Controls.SetSlider(this->Internal->TurnSlider, degrees);
  this->Internal->Moved();
}

void SurfaceViewer::SetEnergy(double energy)
{
  this->Internal->Live.SetEnergy(energy);
  this->Internal->Controls.SetSlider(this->Internal->EnergySlider, this->Internal->Live.Energy());
  this->Internal->Moved();
}

void SurfaceViewer::MoveSource(const Vector3& offset)
{
  Internals& internal = *this->Internal;
  if (internal.Viewed.Scene.Source.Type == XRaySource::Kind::Parallel)
  {
    internal.Message = "a parallel beam has no source to move";
  }
  internal.Live.SetSourceOffset(offset);
  internal.Moved();
}

bool SurfaceViewer::MarkPixel(double column, double row)
{
  Internals& internal = *this->Internal;
  const XRayDetector& grid = internal.Viewed.Scene.Detector;
  internal.Dirty = true;
  if (!(column >= -0.5 && row >= -0.5 && column <= grid.Columns - 0.5 && row <= grid.Rows - 0.5))
  {
    internal.Message = "expected a pixel of the picture, " + std::to_string(grid.Columns) + " x " +
      std::to_string(grid.Rows);
    return false;
  }
  internal.Message.clear();
  internal.Marked = { column, row };
  internal.TellStatus();
  if (internal.Options.Marked)
  {
    internal.Options.Marked(internal.StatusText);
  }
  return true;
}

void SurfaceViewer::Click(int x, int y)
{
  double column = 0;
  double row = 0;
  if (ViewerFrame::In(this->Internal->Pane.Renderer(), x, y) &&
    this->Internal->Pane.PixelAt(x, y, column, row))
  {
    this->MarkPixel(column, row);
  }
}

void SurfaceViewer::Key(const std::string& name)
{
  Internals& internal = *this->Internal;
  const XRayDetector& grid = internal.Viewed.Scene.Detector;
  const Vector3 across = (1 / Norm(grid.ColumnStep)) * grid.ColumnStep;
  const Vector3 down = (1 / Norm(grid.RowStep)) * grid.RowStep;
  const double step = SourceStep * Norm(grid.RowStep) * grid.Rows * internal.Live.SourceGain();
  const Vector3 towards = Cross(across, down);
  const std::map<std::string, Vector3> steps{ { "Left", -1.0 * across }, { "Right", across },
    { "Up", -1.0 * down }, { "Down", down }, { "Prior", -1.0 * towards }, { "Next", towards } };
  if (const auto found = steps.find(name); found != steps.end())
  {
    this->MoveSource(internal.Live.SourceOffset() + step * found->second);
  }
  else if (name == "Home")
  {
    this->MoveSource({ 0, 0, 0 });
  }
  else if (name == "plus" || name == "KP_Add" || name == "minus" || name == "KP_Subtract")
  {
    const bool back = name == "minus" || name == "KP_Subtract";
    this->SetTurn(InTurn(internal.Live.Turn() + (back ? -TurnStepDeg : TurnStepDeg)));
  }
  else if (name == "w")
  {
    internal.Whole = !internal.Whole;
    internal.LookAt();
  }
  else if (name == "r")
  {
    internal.LookAt();
  }
  else if (name == "s")
  {
    internal.SavePictures();
  }
  else if (name == "h")
  {
    internal.ToggleHelp();
  }
  else if (name == "Escape")
  {
    internal.Marked.reset();
    internal.Dirty = true;
  }
  else if (name == "q")
  {
    internal.Interactor->TerminateApp();
  }
}

bool SurfaceViewer::Tick()
{
  Internals& internal = *this->Internal;
  if (internal.Options.Stop && internal.Options.Stop())
  {
    internal.Interactor->TerminateApp();
    return false;
  }
  internal.ComesToRest();
  if (!internal.Dirty)
  {
    return false;
  }
  internal.Dirty = false;
  internal.Draw(internal.Moving ? 2 : 1);
  return true;
}

std::string SurfaceViewer::Status() const
{
  return this->Internal->StatusText;
}

const std::string& SurfaceViewer::Message() const
{
  return this->Internal->Message;
}

double SurfaceViewer::Turn() const
{
  return this->Internal->Live.Turn();
}

vtkRenderWindow* SurfaceViewer::Window()
{
  return this->Internal->Window;
}

std::string SurfaceViewerHelpText()
{
  return "click the picture         what its pixel sees: transmission, lengths by material\n"
         "drag the scene            turn the view; the yellow ball is the X-ray source\n"
         "drag the picture          right: more contrast off; up: brighter\n"
         "Shift and drag            ruler on the picture\n"
         "right or middle drag      zoom, move any view\n"
         "wheel                     zoom\n"
         "arrows, Page up and down  move the source; Home: back\n"
         "+ and -                   turn the samples by 5 degrees\n"
         "w                         whole setup, or the samples\n"
         "r                         views, greys and ruler back\n"
         "s                         save pictures\n"
         "Escape                    remove the mark\n"
         "h, q                      this help, quit";
}
}
