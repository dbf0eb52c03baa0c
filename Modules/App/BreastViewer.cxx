// SPDX-License-Identifier: Apache-2.0
#include "mammoray/App/BreastViewer.h"

#include "Private/RequireDisplay.h"
#include "Private/ViewerWindow.h"
#include "Private/WindowPicture.h"
#include "mammoray/Foundation/Error.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>
#include <thread>

namespace mammoray
{
namespace
{
using Clock = std::chrono::steady_clock;

double SecondsSince(Clock::time_point begin)
{
  return std::chrono::duration<double>(Clock::now() - begin).count();
}
}

struct BreastViewer::Internals : ViewerWindow
{
  using ViewerWindow::ViewerWindow;
};

BreastViewer::BreastViewer(const std::vector<ViewedBreast>& viewed, const ViewerOptions& options)
{
  RequireDisplay("view");
  if (viewed.empty())
  {
    throw InputError("view: expected a breast, found none");
  }
  this->Internal = std::make_unique<Internals>(*this, viewed, options);
}

BreastViewer::~BreastViewer() = default;

void BreastViewer::Run()
{
  this->Internal->Run([this] { this->Tick(); });
}

bool BreastViewer::Tick()
{
  Internals& internal = *this->Internal;
  if (internal.Options.Stop && internal.Options.Stop())
  {
    internal.Interactor->TerminateApp();
    return false;
  }
  internal.TakeEquilibria();
  if (internal.ComesToRest())
  {
    internal.UpdateMark();
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
  internal.AwaitEquilibria();
  internal.Moving = false;
  internal.UpdateMark();
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
    internal.Active().Live.SetSourceOffset(
      { RadiusMm * std::cos(angle), RadiusMm * std::sin(angle), 0 });
    internal.Draw(2);
  }
  internal.Window->WaitForCompletion();
  return frames / SecondsSince(begin);
}

std::optional<PaddleMotion> BreastViewer::BenchmarkPaddle(int frames)
{
  constexpr double WayMm = 6;
  constexpr int FramesPerTurn = 60;
  Internals& internal = *this->Internal;
  ViewedUnit& unit = internal.Active();
  if (!unit.Viewed.Series.empty())
  {
    return std::nullopt;
  }
  const double closed = unit.Live.Pose().ThicknessMm;
  for (const double thickness : { closed, closed + WayMm })
  {
    this->SetThickness(thickness);
    internal.AwaitEquilibria();
    while (!unit.Worker.Waits())
    {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  }
  const auto begin = Clock::now();
  for (int frame = 0; frame < frames; ++frame)
  {
    const double angle = 2 * std::numbers::pi * frame / FramesPerTurn;
    this->SetThickness(closed + 0.5 * WayMm * (1 + std::cos(angle)));
    internal.Draw(2);
  }
  internal.Window->WaitForCompletion();
  PaddleMotion motion;
  motion.PerSecond = frames / SecondsSince(begin);

  this->SetThickness(closed + 0.4 * WayMm);
  const std::vector<double> shown = unit.Live.Points();
  const auto rest = Clock::now();
  internal.AwaitEquilibria();
  motion.ExactSeconds = SecondsSince(rest);
  const std::vector<double>& exact = unit.Live.Points();
  std::vector<double> distances;
  for (std::size_t c = 0; c < exact.size(); c += 3)
  {
    distances.push_back(
      std::hypot(exact[c] - shown[c], exact[c + 1] - shown[c + 1], exact[c + 2] - shown[c + 2]));
  }
  std::sort(distances.begin(), distances.end());
  motion.MedianMm = distances[distances.size() / 2];
  motion.PercentileMm95 = distances[distances.size() * 95 / 100];
  return motion;
}

void BreastViewer::SetThickness(double thicknessMm)
{
  Internals& internal = *this->Internal;
  internal.Active().Live.SetPose(thicknessMm, internal.Active().Live.Pose().RollDeg);
  internal.Controls.SetSlider(internal.ThicknessSlider, thicknessMm);
  internal.Compress(internal.Active());
  internal.Moved();
}

void BreastViewer::SetRoll(double rollDeg)
{
  Internals& internal = *this->Internal;
  internal.Active().Live.SetPose(internal.Active().Live.Pose().ThicknessMm, rollDeg);
  internal.Controls.SetSlider(internal.RollSlider, rollDeg);
  internal.Moved();
}

void BreastViewer::SetKilovoltage(double kilovoltage)
{
  Internals& internal = *this->Internal;
  internal.Active().Live.SetKilovoltage(kilovoltage);
  internal.Controls.SetSlider(internal.KilovoltageSlider, kilovoltage);
  internal.Moved();
}

void BreastViewer::SetBlend(double real)
{
  Internals& internal = *this->Internal;
  for (const auto& unit : internal.Units)
  {
    unit->Pane.SetBlend(real);
  }
  if (internal.BlendSlider >= 0)
  {
    internal.Controls.SetSlider(internal.BlendSlider, real);
  }
  internal.Dirty = true;
}

void BreastViewer::MoveSource(const Vector3& offset)
{
  this->Internal->Active().Live.SetSourceOffset(offset);
  this->Internal->Moved();
}

bool BreastViewer::MarkPoint(const Vector3& point)
{
  this->Internal->Mark.Set(point);
  return this->Internal->TryMark();
}

bool BreastViewer::MarkPixel(double column, double row)
{
  this->Internal->Mark.Set({ column, row }, this->Internal->ActiveUnit);
  return this->Internal->TryMark();
}

void BreastViewer::ClearMark()
{
  this->Internal->Mark.Clear();
  this->Internal->Dirty = true;
  this->Internal->UpdateMark();
}

void BreastViewer::Click(int x, int y)
{
  Internals& internal = *this->Internal;
  if (const auto mammogram = internal.MammogramAt(x, y))
  {
    double column = 0;
    double row = 0;
    internal.Activate(*mammogram);
    if (internal.Active().Pane.PixelAt(x, y, column, row))
    {
      this->MarkPixel(column, row);
    }
    return;
  }
  if (const auto slice = internal.SliceAt(x, y))
  {
    const Vector3 point = internal.Slices->Overlay(*slice).WorldAt(x, y);
    this->MarkPoint(point);
    internal.Slices->SetPoint(point); // also beside the breast
    return;
  }
  for (BreastScene* scene : { &internal.Active().Squeezed, &internal.AtRest })
  {
    Vector3 point;
    std::array<std::int32_t, 3> corners{};
    std::array<double, 3> weights{};
    if (ViewerWindow::In(scene->Renderer(), x, y) && scene->Pick(x, y, point, corners, weights))
    {
      // The same material point at rest.
      Vector3 rest{ 0, 0, 0 };
      for (std::size_t corner = 0; corner < 3; ++corner)
      {
        rest = rest +
          weights[corner] *
            internal.Active().Viewed.Anatomy.Point(static_cast<std::size_t>(corners[corner]));
      }
      this->MarkPoint(rest);
    }
  }
}

void BreastViewer::Key(const std::string& name)
{
  Internals& internal = *this->Internal;
  const double thickness = internal.Active().Live.Pose().ThicknessMm;
  if (name == "Home")
  {
    this->MoveSource({ 0, 0, 0 });
  }
  else if (name == "plus" || name == "KP_Add")
  {
    this->SetThickness(thickness + 1);
  }
  else if ((name == "minus" || name == "KP_Subtract") && thickness > 2)
  {
    this->SetThickness(thickness - 1);
  }
  else if (name == "b")
  {
    this->SetBlend(internal.Active().Pane.Blend() < 0.5 ? 1 : 0);
  }
  else if (name == "w")
  {
    internal.ShownSource = internal.ShownSource < 1 ? 1 : NearSource;
    for (const auto& unit : internal.Units)
    {
      unit->Squeezed.SetUnit(unit->Live, unit->Pane.Picture(), internal.ShownSource);
    }
    internal.LookAt();
  }
  else if (name == "r")
  {
    internal.LookAt();
  }
  else if (name == "c")
  {
    internal.Compress(internal.Active());
    internal.Moved();
  }
  else if (name == "s")
  {
    internal.SavePictures();
  }
  else if (name == "t" && internal.Slices)
  {
    internal.Slices->ToggleTissue();
    internal.Dirty = true;
  }
  else if (name == "n")
  {
    internal.NextLesion();
  }
  else if (name == "Tab")
  {
    internal.Activate((internal.ActiveUnit + 1) % internal.Units.size());
  }
  else if (name == "h")
  {
    internal.ToggleHelp();
  }
  else if (name == "Escape")
  {
    this->ClearMark();
  }
  else if (name == "q")
  {
    internal.Interactor->TerminateApp();
  }
  else
  {
    internal.MoveBy(name);
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
  return this->Internal->Active().Live.Pose();
}

const std::vector<double>& BreastViewer::Points() const
{
  return this->Internal->Active().Live.Points();
}

std::string ViewerHelpText()
{
  return "click                     mark a point, or what lies behind a pixel, in every view\n"
         "drag a scene              turn it; the yellow ball is the X-ray source\n"
         "drag a picture            right: more contrast off; up: brighter\n"
         "Shift and drag            ruler on a picture\n"
         "right or middle drag      zoom, move any view\n"
         "wheel                     zoom; through the slices (with Ctrl: zoom)\n"
         "arrows, Page up and down  move the source by 10 mm; Home: back\n"
         "+ and -                   thickness by 1 mm\n"
         "c                         compress between the plates as they stand\n"
         "b                         synthetic or target mammogram\n"
         "t                         tissues in the slices, or not\n"
         "n                         next lesion\n"
         "Tab                       the other mammogram's plates\n"
         "w                         whole unit, or the breast\n"
         "r                         views, greys and rulers back\n"
         "s                         save pictures\n"
         "Escape                    remove the mark\n"
         "h, q                      this help, quit";
}
}
