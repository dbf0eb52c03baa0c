// SPDX-License-Identifier: Apache-2.0
#include "mammoray/Viewer/BreastViewer.h"

#include "Private/BreastScene.h"
#include "Private/CompressionWorker.h"
#include "Private/ControlPane.h"
#include "Private/MammogramPane.h"
#include "mammoray/Case/RegisteredBreast.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Registration/TargetImage.h"
#include "mammoray/Viewer/KilovoltageSpectrum.h"
#include "mammoray/Viewer/LiveMammogram.h"
#include "mammoray/Viewer/RequireDisplay.h"

#include "vtkCallbackCommand.h"
#include "vtkCamera.h"
#include "vtkCommand.h"
#include "vtkInteractorStyleTrackballCamera.h"
#include "vtkObjectFactory.h"
#include "vtkPNGWriter.h"
#include "vtkRenderWindow.h"
#include "vtkRenderWindowInteractor.h"
#include "vtkTextActor.h"
#include "vtkTextProperty.h"
#include "vtkWindowToImageFilter.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
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
/// A button released within so many pixels of where it was pressed is a click.
constexpr int ClickPixels = 3;
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

/// What the viewer wants of the mouse; everything else is the trackball's.
struct MouseTarget
{
  virtual ~MouseTarget() = default;
  /// True when the press is taken, and what follows it.
  virtual bool OnPress(int x, int y) = 0;
  virtual void OnDrag(int x, int y) = 0;
  virtual void OnRelease() = 0;
  virtual void OnClick(int x, int y) = 0;
  virtual void OnKey(const std::string& name) = 0;
  /// Whether the camera there may be turned; shifted and zoomed.
  virtual bool Turns(int x, int y) = 0;
  virtual bool Moves(int x, int y) = 0;
};

class ViewerStyle : public vtkInteractorStyleTrackballCamera
{
public:
  static ViewerStyle* New();
  vtkTypeMacro(ViewerStyle, vtkInteractorStyleTrackballCamera);

  void OnLeftButtonDown() override
  {
    const int* at = this->Interactor->GetEventPosition();
    this->Start = { at[0], at[1] };
    this->Taken = this->Target->OnPress(at[0], at[1]);
    if (!this->Taken && this->Target->Turns(at[0], at[1]))
    {
      this->Superclass::OnLeftButtonDown();
    }
  }
  void OnMouseMove() override
  {
    const int* at = this->Interactor->GetEventPosition();
    if (this->Taken)
    {
      this->Target->OnDrag(at[0], at[1]);
      return;
    }
    this->Superclass::OnMouseMove();
  }
  void OnLeftButtonUp() override
  {
    const int* at = this->Interactor->GetEventPosition();
    if (this->Taken)
    {
      this->Taken = false;
      this->Target->OnRelease();
      return;
    }
    this->Superclass::OnLeftButtonUp();
    if (std::abs(at[0] - this->Start[0]) <= ClickPixels &&
      std::abs(at[1] - this->Start[1]) <= ClickPixels)
    {
      this->Target->OnClick(at[0], at[1]);
    }
  }
  void OnMiddleButtonDown() override
  {
    if (this->MovesHere())
    {
      this->Superclass::OnMiddleButtonDown();
    }
  }
  void OnRightButtonDown() override
  {
    if (this->MovesHere())
    {
      this->Superclass::OnRightButtonDown();
    }
  }
  void OnMouseWheelForward() override
  {
    if (this->MovesHere())
    {
      this->Superclass::OnMouseWheelForward();
    }
  }
  void OnMouseWheelBackward() override
  {
    if (this->MovesHere())
    {
      this->Superclass::OnMouseWheelBackward();
    }
  }
  void OnKeyPress() override { this->Target->OnKey(this->Interactor->GetKeySym()); }
  /// VTK's own keys (wireframe, stereo, exit) are none here.
  void OnChar() override {}

  MouseTarget* Target = nullptr;

private:
  bool MovesHere()
  {
    const int* at = this->Interactor->GetEventPosition();
    return this->Target->Moves(at[0], at[1]);
  }

  std::array<int, 2> Start{ 0, 0 };
  bool Taken = false;
};
vtkStandardNewMacro(ViewerStyle);

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

/// Points of the ellipse on the receptor, `deviations` of its standard deviations large; gantry x,
/// y.
std::vector<ReceptorPoint> LoopOf(const UncertaintyEllipse& ellipse, const ReceptorPoint& middle,
  const RegistrationTarget& grid, double deviations)
{
  constexpr int Steps = 48;
  const double columnLength = std::hypot(grid.ColumnStep[0], grid.ColumnStep[1]);
  const double rowLength = std::hypot(grid.RowStep[0], grid.RowStep[1]);
  const double turn = ellipse.AngleDeg * std::numbers::pi / 180;
  std::vector<ReceptorPoint> loop;
  for (int step = 0; step < Steps; ++step)
  {
    const double angle = 2 * std::numbers::pi * step / Steps;
    const double major = deviations * ellipse.MajorMm * std::cos(angle);
    const double minor = deviations * ellipse.MinorMm * std::sin(angle);
    const double alongColumns = major * std::cos(turn) - minor * std::sin(turn);
    const double alongRows = major * std::sin(turn) + minor * std::cos(turn);
    loop.push_back({ middle[0] + alongColumns * grid.ColumnStep[0] / columnLength +
        alongRows * grid.RowStep[0] / rowLength,
      middle[1] + alongColumns * grid.ColumnStep[1] / columnLength +
        alongRows * grid.RowStep[1] / rowLength });
  }
  return loop;
}

std::string UncertaintyText(const std::optional<UncertaintyEllipse>& uncertainty)
{
  if (!uncertainty)
  {
    return "uncertainty unknown";
  }
  char text[80];
  std::snprintf(text, sizeof text, "+- %.2f x %.2f mm (1 sd)", uncertainty->MajorMm,
    uncertainty->MinorMm);
  return text;
}

/// The first of name-1, name-2, ... that no file has yet.
std::string FreeName(const std::string& folder, const std::string& name)
{
  for (int number = 1;; ++number)
  {
    const auto path =
      std::filesystem::path(folder) / (name + "-" + std::to_string(number) + ".png");
    if (!std::filesystem::exists(path))
    {
      return path.string();
    }
  }
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
  void UpdateMark();
  void MarkImaged(const RegisteredBreast& breast, const std::vector<Vector3>& atRest,
    const std::vector<double>& column, const std::vector<double>& row);
  void TellStatus();
  void SavePictures();
  void WriteWindow(const std::string& path);

  BreastViewer& Viewer;
  const ViewedBreast& Viewed;
  ViewerOptions Options;
  LiveMammogram Live;
  CompressionWorker Worker;
  MammogramPane Pane;
  BreastScene Squeezed;
  BreastScene AtRest;
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
  /// What is marked: a point at rest, or a pixel.
  std::optional<Vector3> Point;
  std::optional<std::array<double, 2>> Pixel;
  std::string MarkText;
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
  this->StatusText = this->MarkText;
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

/// Draws points of the breast at rest, given with their pixels, in all views.
void BreastViewer::Internals::MarkImaged(const RegisteredBreast& breast,
  const std::vector<Vector3>& atRest, const std::vector<double>& column,
  const std::vector<double>& row)
{
  constexpr double Deviations[] = { 1, 2 };
  const RegistrationTarget& grid = this->Live.Grid(1);
  const VolumeFromGantry placed = this->Live.Placed();
  const Vector3 source = placed.ToGantry(this->Live.SourcePosition());
  std::vector<Vector3> squeezed;
  std::vector<Loop> squeezedLoops;
  std::vector<Loop> restLoops;
  std::vector<std::vector<ReceptorPoint>> receptorLoops;
  const std::size_t middle = atRest.size() / 2;
  for (std::size_t index = 0; index < atRest.size(); ++index)
  {
    const ImagedPoint imaged = breast.ToMammogram(atRest[index]);
    squeezed.push_back(imaged.Compressed);
    if (!imaged.Uncertainty)
    {
      continue;
    }
    const ReceptorPoint at = PixelPosition(grid, imaged.Column, imaged.Row);
    // From the receptor back to the point's height.
    const double share = 1 - placed.ToGantry(imaged.Compressed)[2] / source[2];
    for (const double deviations : Deviations)
    {
      const std::vector<ReceptorPoint> loop = LoopOf(*imaged.Uncertainty, at, grid, deviations);
      Loop there;
      Loop before;
      for (const auto& [x, y] : loop)
      {
        there.push_back(placed.Point(source + share * (Vector3{ x, y, 0 } - source)));
        // As far from the point as between the plates; the tissue's turn and stretch left out.
        before.push_back(atRest[index] + there.back() - imaged.Compressed);
      }
      squeezedLoops.push_back(there);
      restLoops.push_back(before);
      if (index == middle)
      {
        receptorLoops.push_back(loop);
      }
    }
  }
  const bool single = atRest.size() == 1;
  this->Squeezed.SetMark(single ? squeezed : std::vector<Vector3>{}, squeezed, squeezedLoops);
  this->AtRest.SetMark(single ? atRest : std::vector<Vector3>{}, atRest, restLoops);
  this->Pane.SetMark({ PixelPosition(grid, column[0], row[0]) }, receptorLoops);
}

void BreastViewer::Internals::UpdateMark()
{
  this->MarkText.clear();
  if (!this->Point && !this->Pixel)
  {
    this->Squeezed.SetMark({}, {}, {});
    this->AtRest.SetMark({}, {}, {});
    this->Pane.SetMark({}, {});
    return;
  }
  const RegisteredBreast breast(this->Live.InUnit());
  char text[240];
  if (this->Point)
  {
    const ImagedPoint imaged = breast.ToMammogram(*this->Point);
    std::snprintf(text, sizeof text, "(%.1f, %.1f, %.1f) mm in %s; pixel (%.1f, %.1f)%s\n%s",
      (*this->Point)[0], (*this->Point)[1], (*this->Point)[2], imaged.Material.c_str(),
      imaged.Column, imaged.Row, imaged.InImage ? "" : ", beside the picture",
      UncertaintyText(imaged.Uncertainty).c_str());
    this->MarkImaged(breast, { *this->Point }, { imaged.Column }, { imaged.Row });
    this->MarkText = text;
    return;
  }
  const auto [column, row] = *this->Pixel;
  const std::vector<TissueStretch> stretches = breast.ToVolume(column, row, 1.0);
  std::snprintf(text, sizeof text, "pixel (%.1f, %.1f): ", column, row);
  this->MarkText = text;
  std::map<std::string, double> lengths;
  std::vector<Vector3> curve;
  for (const TissueStretch& stretch : stretches)
  {
    lengths[stretch.Material] += stretch.LengthMm;
    curve.insert(curve.end(), stretch.Uncompressed.begin(), stretch.Uncompressed.end());
  }
  if (curve.empty())
  {
    this->MarkText += "the X-ray misses the breast";
    this->Squeezed.SetMark({}, {}, {});
    this->AtRest.SetMark({}, {}, {});
    this->Pane.SetMark({ PixelPosition(this->Live.Grid(1), column, row) }, {});
    return;
  }
  for (const auto& [material, length] : lengths)
  {
    std::snprintf(text, sizeof text, "%s %.1f, ", material.c_str(), length);
    this->MarkText += text;
  }
  this->MarkText.replace(this->MarkText.size() - 2, 2, " mm");
  // Some places along the X-ray; the middle one's uncertainty is told.
  constexpr std::size_t Places = 9;
  std::vector<Vector3> places;
  for (std::size_t place = 0; place < std::min(Places, curve.size()); ++place)
  {
    places.push_back(curve[place * (curve.size() - 1) / std::max<std::size_t>(Places - 1, 1)]);
  }
  this->MarkText +=
    "\n" + UncertaintyText(breast.ToMammogram(places[places.size() / 2]).Uncertainty);
  this->MarkImaged(breast, places, { column }, { row });
}

void BreastViewer::Internals::WriteWindow(const std::string& path)
{
  vtkNew<vtkWindowToImageFilter> capture;
  capture->SetInput(this->Window);
  capture->ReadFrontBufferOff();
  capture->ShouldRerenderOff();
  vtkNew<vtkPNGWriter> writer;
  writer->SetInputConnection(capture->GetOutputPort());
  writer->SetFileName(path.c_str());
  writer->Write();
  if (writer->GetErrorCode() != 0)
  {
    throw InputError(path + ": cannot be written");
  }
}

void BreastViewer::Internals::SavePictures()
{
  try
  {
    this->Draw(1);
    const std::string window = FreeName(this->Options.PictureFolder, "mammoray-window");
    const std::string mammogram = FreeName(this->Options.PictureFolder, "mammoray-mammogram");
    this->WriteWindow(window);
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
    internal.UpdateMark();
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
  internal.UpdateMark();
  internal.Draw(1);
  internal.WriteWindow(path);
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

bool BreastViewer::MarkPoint(const Vector3& point)
{
  this->ClearMark();
  this->Internal->Point = point;
  try
  {
    this->Internal->UpdateMark();
  }
  catch (const InputError& error)
  {
    this->ClearMark();
    this->Internal->Message = error.what();
    return false;
  }
  return true;
}

bool BreastViewer::MarkPixel(double column, double row)
{
  this->ClearMark();
  this->Internal->Pixel = { column, row };
  try
  {
    this->Internal->UpdateMark();
  }
  catch (const InputError& error)
  {
    this->ClearMark();
    this->Internal->Message = error.what();
    return false;
  }
  return true;
}

void BreastViewer::ClearMark()
{
  this->Internal->Point.reset();
  this->Internal->Pixel.reset();
  this->Internal->Dirty = true;
  this->Internal->UpdateMark();
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
