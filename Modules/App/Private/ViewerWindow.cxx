// SPDX-License-Identifier: Apache-2.0
#include "Private/ViewerWindow.h"

#include "Private/KilovoltageSpectrum.h"
#include "Private/SceneShapes.h"
#include "Private/WindowPicture.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Registration/RegistrationResult.h"

#include "vtkTextActor.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <thread>

namespace mammoray
{
namespace
{
/// How far the slider goes to either side of the spectrum's own voltage, kV.
constexpr double KilovoltageRange = 6;
constexpr double RollRangeDeg = 45;
/// A step of an arrow key.
constexpr double SourceStepMm = 10;
/// A drag across so many pixels takes the grey's window to e times its width.
constexpr double WindowPixels = 250;
/// Share of the left column that the breast between the plates has.
constexpr double SqueezedShare = 0.62;
constexpr int WaitMilliseconds = 10;

std::pair<double, double> ThicknessRange(const ViewedBreast& viewed)
{
  if (!viewed.Series.empty())
  {
    return { viewed.Series.back().ThicknessMm, viewed.Series.front().ThicknessMm };
  }
  return { 0.6 * viewed.Pose.ThicknessMm, 1.4 * viewed.Pose.ThicknessMm };
}
}

ViewedUnit::ViewedUnit(const ViewedBreast& viewed, const ViewerOptions& options)
  : Viewed(viewed)
  , Live(viewed, options.Projector)
  , Worker(viewed)
  , Pane(viewed, this->Live)
  , Squeezed(this->Live, viewed)
{
  this->Live.SetSourceOffset(options.SourceOffset);
  if (options.Kilovoltage)
  {
    this->Live.SetKilovoltage(*options.Kilovoltage);
  }
  this->Pane.SetBlend(options.Blend);
  this->Pane.Overlay().SetTitle((viewed.View.empty() ? "" : viewed.View + ": ") +
    (viewed.Real ? "synthetic and target" : "synthetic"));
  if (viewed.Trust.Level != Trust::Good)
  {
    this->Pane.Overlay().SetWarning(VerdictOf(viewed.Trust.Level));
  }
  this->Squeezed.SetPoints(this->Live.Points());
  this->Squeezed.AddLetters(viewed.Axes, this->Live.Points());
  AddText(this->Squeezed.Renderer(),
    "between the plates" + (viewed.View.empty() ? "" : ", " + viewed.View), 0.012, 0.985, 14);
  this->UnitText = AddText(this->Squeezed.Renderer(), "", 0.012, 0.935, 12);
}

ViewerWindow::ViewerWindow(BreastViewer& viewer, const std::vector<ViewedBreast>& viewed,
  const ViewerOptions& options)
  : Viewer(viewer)
  , Options(options)
  , Units(
      [&]
      {
        std::vector<std::unique_ptr<ViewedUnit>> units;
        units.reserve(viewed.size());
        for (const ViewedBreast& one : viewed)
        {
          units.push_back(std::make_unique<ViewedUnit>(one, options));
        }
        return units;
      }())
  , AtRest(this->Units.front()->Live, viewed.front())
  , Mark(this->AtRest)
{
  const ViewedBreast& first = viewed.front();
  this->AtRest.SetPoints(first.Anatomy.Points);
  this->AtRest.AddLetters(first.Axes, first.Anatomy.Points);
  AddText(this->AtRest.Renderer(), "uncompressed", 0.03, 0.97, 14);
  if (first.Image || first.Tissue)
  {
    this->Slices = std::make_unique<SlicePanes>(first, this->AtRest.TissueColors());
  }
  for (const auto& unit : this->Units)
  {
    const std::string& name = unit->Viewed.View;
    this->Mark.Add({ name.empty() ? "" : name + ": ", &unit->Live, &unit->Squeezed, &unit->Pane });
  }
  const auto add = [this](vtkRenderer* renderer) { this->Window->AddRenderer(renderer); };
  for (const auto& unit : this->Units)
  {
    add(unit->Squeezed.Renderer());
    add(unit->Squeezed.MarkRenderer());
    add(unit->Pane.Renderer());
  }
  add(this->AtRest.Renderer());
  add(this->AtRest.MarkRenderer());
  for (int pane = 0; this->Slices && pane < SlicePanes::Count; ++pane)
  {
    add(this->Slices->Renderer(pane));
  }
  this->AddControls();
  this->Open("mammoray view: " + first.Name, ViewerHelpText(), options);
  for (const auto& unit : this->Units)
  {
    unit->Squeezed.SetUnit(unit->Live, unit->Pane.Picture(), this->ShownSource);
    if (unit->Viewed.PoseDiffers)
    {
      this->Compress(*unit);
    }
  }
  this->Activate(0);
  this->LookAt();
}

ViewerWindow::~ViewerWindow()
{
  this->Close();
}

void ViewerWindow::AddControls()
{
  const ViewedUnit& unit = this->Active();
  const BreastPose& pose = unit.Viewed.Pose;
  const auto [low, high] = ThicknessRange(unit.Viewed);
  this->ThicknessSlider = this->Controls.AddSlider("thickness, mm", "%.1f", low, high,
    pose.ThicknessMm, [this](double value) { this->Viewer.SetThickness(value); });
  this->RollSlider = this->Controls.AddSlider("roll, degrees", "%.1f", pose.RollDeg - RollRangeDeg,
    pose.RollDeg + RollRangeDeg, pose.RollDeg,
    [this](double value) { this->Viewer.SetRoll(value); });
  const double voltage = KilovoltageOf(unit.Viewed.Spectrum);
  this->KilovoltageSlider = this->Controls.AddSlider("tube voltage, kV", "%.1f",
    voltage - KilovoltageRange, voltage + KilovoltageRange, unit.Live.Kilovoltage(),
    [this](double value) { this->Viewer.SetKilovoltage(value); });
  if (std::any_of(this->Units.begin(), this->Units.end(),
        [](const auto& one) { return one->Viewed.Real.has_value(); }))
  {
    this->BlendSlider = this->Controls.AddSlider("synthetic - target", "%.2f", 0, 1,
      this->Options.Blend, [this](double value) { this->Viewer.SetBlend(value); });
  }
  this->Controls.AddButton("help (h)", [this] { this->Viewer.Key("h"); });
  this->Controls.AddButton("save pictures", [this] { this->Viewer.Key("s"); });
  this->Controls.AddButton("views back", [this] { this->Viewer.Key("r"); });
  this->Controls.AddButton("source back", [this] { this->Viewer.Key("Home"); });
  for (const Lesion& lesion : unit.Viewed.LesionList)
  {
    char text[80];
    std::snprintf(text, sizeof text, "lesion %d, %.0f mm3", lesion.Label, lesion.VolumeMm3);
    this->Controls.AddButton(text,
      [this, centre = lesion.Centre] { this->Viewer.MarkPoint(centre); });
  }
  const std::vector<std::array<double, 3>>& colors = this->AtRest.TissueColors();
  for (std::size_t material = 1; material < colors.size(); ++material)
  {
    this->Controls.AddLegend(unit.Viewed.Materials.Materials[material].Name, colors[material]);
  }
}

/// Scenes at the left, then the slices below each other, then the mammograms; controls below all.
void ViewerWindow::Lay()
{
  const bool first = this->Size[0] == 0;
  const std::optional<double> strip = this->LayControls();
  if (!strip)
  {
    return;
  }
  const double bottom = *strip;
  const double left = this->Slices ? 0.29 : 0.46;
  const double middle = this->Slices ? 0.52 : left;
  const double parting = bottom + (1 - SqueezedShare) * (1 - bottom);
  for (const auto& unit : this->Units)
  {
    unit->Squeezed.Renderer()->SetViewport(0, parting, left, 1);
    unit->Squeezed.MarkRenderer()->SetViewport(0, parting, left, 1);
  }
  this->AtRest.Renderer()->SetViewport(0, bottom, left, parting);
  this->AtRest.MarkRenderer()->SetViewport(0, bottom, left, parting);
  for (int pane = 0; this->Slices && pane < SlicePanes::Count; ++pane)
  {
    const double step = (1 - bottom) / SlicePanes::Count;
    this->Slices->Renderer(pane)->SetViewport(left, 1 - (pane + 1) * step, middle, 1 - pane * step);
  }
  const double width = (1 - middle) / static_cast<double>(this->Units.size());
  for (std::size_t unit = 0; unit < this->Units.size(); ++unit)
  {
    this->Units[unit]->Pane.Renderer()->SetViewport(middle + width * static_cast<double>(unit),
      bottom, middle + width * static_cast<double>(unit + 1), 1);
  }
  if (first)
  {
    this->LookAt(); // pictures fill their panes, whose sizes are known only now
  }
}

void ViewerWindow::Activate(std::size_t active)
{
  this->ActiveUnit = active;
  for (std::size_t unit = 0; unit < this->Units.size(); ++unit)
  {
    BreastScene& scene = this->Units[unit]->Squeezed;
    scene.Renderer()->SetDraw(unit == active ? 1 : 0);
    scene.MarkRenderer()->SetDraw(unit == active ? 1 : 0);
    scene.Renderer()->SetInteractive(unit == active ? 1 : 0);
  }
  const ViewedUnit& now = this->Active();
  const BreastPose& pose = now.Viewed.Pose;
  const auto [low, high] = ThicknessRange(now.Viewed);
  this->Controls.SetRange(this->ThicknessSlider, low, high);
  this->Controls.SetRange(this->RollSlider, pose.RollDeg - RollRangeDeg,
    pose.RollDeg + RollRangeDeg);
  this->Controls.SetSlider(this->ThicknessSlider, now.Live.Pose().ThicknessMm);
  this->Controls.SetSlider(this->RollSlider, now.Live.Pose().RollDeg);
  this->Controls.SetSlider(this->KilovoltageSlider, now.Live.Kilovoltage());
  this->Dirty = true;
}

/// The breasts from the front and a little from the side and above; all of the pictures.
void ViewerWindow::LookAt()
{
  const auto look = [](BreastScene& scene, const ViewedUnit& unit)
  { scene.LookFromFront(unit.Live.Placed(), unit.Viewed.Laterality); };
  for (const auto& unit : this->Units)
  {
    look(unit->Squeezed, *unit);
    unit->Pane.Frame();
    unit->Pane.ResetWindow();
    unit->Pane.Overlay().SetRuler({});
  }
  look(this->AtRest, *this->Units.front());
  if (this->Slices)
  {
    this->Slices->Frame();
    this->Slices->ResetWindow();
    for (int pane = 0; pane < SlicePanes::Count; ++pane)
    {
      this->Slices->Overlay(pane).SetRuler({});
    }
  }
  this->Dirty = true;
}

void ViewerWindow::Compress(ViewedUnit& unit)
{
  if (!unit.Viewed.Series.empty())
  {
    const std::vector<double> points = unit.Live.SeriesPoints(unit.Live.Pose().ThicknessMm);
    unit.Live.SetPoints(points);
    unit.Squeezed.SetPoints(points);
    return;
  }
  unit.Worker.Ask(unit.Live.Pose());
  if (const std::optional<CompressedAnatomy> reduced = unit.Worker.Reduced(unit.Live.Pose()))
  {
    this->Show(unit, *reduced);
  }
}

void ViewerWindow::Show(ViewedUnit& unit, const CompressedAnatomy& answer)
{
  char text[160];
  if (answer.ReducedFrom > 0)
  {
    std::snprintf(text, sizeof text,
      "about %.1f N: between %d equilibria, the nearest %.1f mm or deg away; the exact one follows",
      answer.PaddleForceN, answer.ReducedFrom, answer.Nearest);
    unit.Reduced = text;
  }
  else
  {
    std::snprintf(text, sizeof text, "%.1f mm, %.1f N, compressed in %.1f s",
      answer.Pose.ThicknessMm, answer.PaddleForceN, answer.Seconds);
    this->Message = text;
    unit.Reduced.clear();
  }
  unit.Live.SetPoints(answer.Points);
  unit.Squeezed.SetPoints(answer.Points);
}

void ViewerWindow::TakeEquilibria()
{
  for (const auto& unit : this->Units)
  {
    const std::optional<CompressedAnatomy> answer = unit->Worker.Take();
    if (!answer)
    {
      continue;
    }
    if (!answer->Error.empty())
    {
      this->Message = answer->Error;
      this->TellStatus();
      continue;
    }
    // The plates may have moved on while it was being solved.
    const BreastPose& pose = unit->Live.Pose();
    const bool late =
      answer->Pose.ThicknessMm != pose.ThicknessMm || answer->Pose.RollDeg != pose.RollDeg;
    const std::optional<CompressedAnatomy> reduced =
      late ? unit->Worker.Reduced(pose) : std::nullopt;
    this->Show(*unit, reduced ? *reduced : *answer);
    this->Moved();
  }
}

void ViewerWindow::AwaitEquilibria()
{
  while (!this->Stage().empty())
  {
    if (this->Options.Stop && this->Options.Stop())
    {
      throw Interrupted();
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(WaitMilliseconds));
  }
  this->TakeEquilibria();
}

void ViewerWindow::Draw(int divisor)
{
  this->Lay();
  for (const auto& unit : this->Units)
  {
    // Only the active one's unit is being moved.
    const int own = unit.get() == &this->Active() ? divisor : 1;
    unit->Pane.Update(unit->Live, own);
    unit->Pane.Overlay().Update();
    unit->Squeezed.SetUnit(unit->Live, unit->Pane.Picture(), this->ShownSource);
    const Vector3& offset = unit->Live.SourceOffset();
    char near[48] = "";
    if (this->ShownSource < 1)
    {
      std::snprintf(near, sizeof near, ", drawn at %.2g of its way", this->ShownSource);
    }
    char text[320];
    std::snprintf(text, sizeof text,
      "%.1f mm, roll %.1f deg, %.1f kV\nsource %+.0f %+.0f %+.0f mm%s%s%s",
      unit->Live.Pose().ThicknessMm, unit->Live.Pose().RollDeg, unit->Live.Kilovoltage(), offset[0],
      offset[1], offset[2], near, unit->Reduced.empty() ? "" : "\n", unit->Reduced.c_str());
    unit->UnitText->SetInput(text);
    unit->Squeezed.Renderer()->ResetCameraClippingRange();
  }
  this->AtRest.Renderer()->ResetCameraClippingRange();
  if (this->Slices)
  {
    this->Slices->Update();
  }
  this->TellStatus();
  // What stands still keeps its pixels while the rest moves.
  this->AtRest.Renderer()->SetDraw(divisor == 1 ? 1 : 0);
  this->Window->Render();
  this->AtRest.Renderer()->SetDraw(1);
}

std::string ViewerWindow::Stage() const
{
  for (const auto& unit : this->Units)
  {
    if (std::string stage = unit->Worker.Stage(); !stage.empty())
    {
      return stage;
    }
  }
  return "";
}

void ViewerWindow::TellStatus()
{
  const std::string stage = this->Stage();
  this->StatusText = this->Mark.Text();
  const std::string last = stage.empty() ? this->Message : "working: " + stage;
  if (!last.empty())
  {
    this->StatusText += (this->StatusText.empty() ? "" : "\n") + last;
  }
  this->Controls.SetStatus(this->StatusText);
}

std::optional<std::size_t> ViewerWindow::MammogramAt(int x, int y) const
{
  for (std::size_t unit = 0; unit < this->Units.size(); ++unit)
  {
    if (In(this->Units[unit]->Pane.Renderer(), x, y))
    {
      return unit;
    }
  }
  return std::nullopt;
}

std::optional<int> ViewerWindow::SliceAt(int x, int y)
{
  for (int pane = 0; this->Slices && pane < SlicePanes::Count; ++pane)
  {
    if (In(this->Slices->Renderer(pane), x, y))
    {
      return pane;
    }
  }
  return std::nullopt;
}

PaneOverlay* ViewerWindow::PictureAt(int x, int y)
{
  if (const auto mammogram = this->MammogramAt(x, y))
  {
    return &this->Units[*mammogram]->Pane.Overlay();
  }
  const auto slice = this->SliceAt(x, y);
  return slice ? &this->Slices->Overlay(*slice) : nullptr;
}

MouseTarget::Kind ViewerWindow::KindAt(int x, int y)
{
  if (this->PictureAt(x, y))
  {
    return Kind::Picture;
  }
  return In(this->Active().Squeezed.Renderer(), x, y) || In(this->AtRest.Renderer(), x, y)
    ? Kind::Scene
    : Kind::Nothing;
}

bool ViewerWindow::OnPress(int x, int y, bool shift)
{
  if (this->TakesPress(x, y))
  {
    this->Dragging = Drag::Controls;
    return true;
  }
  this->Pressed = this->PictureAt(x, y);
  if (this->Pressed && shift)
  {
    const Vector3 from = this->Pressed->WorldAt(x, y);
    this->Ruled = this->Pressed;
    this->Ruled->SetRuler({ { from, from } });
    this->Dragging = Drag::Ruler;
    this->Dirty = true;
    return true;
  }
  const bool onSource =
    In(this->Active().Squeezed.Renderer(), x, y) && this->Active().Squeezed.OnSource(x, y);
  this->Dragging = onSource ? Drag::Source : Drag::Nothing;
  return onSource;
}

/// The drawn source follows the mouse in the plane across the view; the source moves as it does, as
/// much farther as it is away. A ruler's end follows it on its picture.
void ViewerWindow::OnDrag(int x, int y)
{
  if (this->Dragging == Drag::Ruler)
  {
    this->Ruled->SetRuler({ { (*this->Ruled->RulerEnds())[0], this->Ruled->WorldAt(x, y) } });
    this->Dirty = true;
  }
  if (this->Dragging != Drag::Source)
  {
    return;
  }
  ViewedUnit& unit = this->Active();
  const Vector3 to = WorldUnder(unit.Squeezed.Renderer(), x, y, unit.Squeezed.ShownSource());
  const Vector3& middle = unit.Squeezed.ReceptorMiddle();
  const Vector3 source = middle + (1 / this->ShownSource) * (to - middle);
  const Vector3 gantry = unit.Live.Placed().ToGantry(source);
  this->Viewer.MoveSource(gantry - unit.Viewed.Breast.Unit.FocalSpot());
}

void ViewerWindow::OnWindow(int right, int up)
{
  const double factor = std::exp(right / WindowPixels);
  const double share = -up / WindowPixels; // up is brighter, as a lower level is
  bool mammogram = false;
  for (const auto& unit : this->Units)
  {
    if (this->Pressed == &unit->Pane.Overlay())
    {
      unit->Pane.Adjust(factor, share);
      mammogram = true;
    }
  }
  if (!mammogram && this->Slices)
  {
    this->Slices->Adjust(factor, share);
  }
  this->Dirty = true;
}

bool ViewerWindow::OnWheel(int x, int y, int steps)
{
  const auto slice = this->SliceAt(x, y);
  if (!slice || this->Interactor->GetControlKey() != 0)
  {
    return false;
  }
  this->Slices->Scroll(*slice, steps);
  this->Dirty = true;
  return true;
}

void ViewerWindow::UpdateMark()
{
  this->Mark.Update();
  if (this->Slices)
  {
    this->Slices->SetPoint(this->Mark.Middle());
  }
}

bool ViewerWindow::TryMark()
{
  this->Dirty = true;
  try
  {
    this->UpdateMark();
  }
  catch (const InputError& error)
  {
    this->Mark.Clear();
    this->UpdateMark();
    this->Message = error.what();
    return false;
  }
  this->Message.clear();
  if (this->Options.Marked)
  {
    this->Options.Marked(this->Mark.Text());
  }
  return true;
}

void ViewerWindow::SavePictures()
{
  try
  {
    this->Draw(1);
    const std::string& folder = this->Options.PictureFolder;
    const std::string window = FreePictureName(folder, "mammoray-window");
    WriteWindowPicture(this->Window, window);
    this->Message = "saved " + window;
    for (const auto& unit : this->Units)
    {
      const std::string& view = unit->Viewed.View;
      const std::string mammogram =
        FreePictureName(folder, "mammoray-mammogram" + (view.empty() ? "" : "-" + view));
      unit->Pane.Write(mammogram);
      this->Message += " and " + mammogram;
    }
  }
  catch (const Error& error)
  {
    this->Message = error.what();
  }
  this->Dirty = true;
}

void ViewerWindow::MoveBy(const std::string& key)
{
  const std::map<std::string, Vector3> steps{ { "Left", { SourceStepMm, 0, 0 } },
    { "Right", { -SourceStepMm, 0, 0 } }, { "Up", { 0, SourceStepMm, 0 } },
    { "Down", { 0, -SourceStepMm, 0 } }, { "Prior", { 0, 0, SourceStepMm } },
    { "Next", { 0, 0, -SourceStepMm } } };
  if (const auto step = steps.find(key); step != steps.end())
  {
    this->Viewer.MoveSource(this->Active().Live.SourceOffset() + step->second);
  }
}

void ViewerWindow::NextLesion()
{
  const std::vector<Lesion>& lesions = this->Active().Viewed.LesionList;
  if (!lesions.empty())
  {
    this->Viewer.MarkPoint(lesions[this->LesionNumber % lesions.size()].Centre);
    ++this->LesionNumber;
  }
}
}
