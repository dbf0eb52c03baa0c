// SPDX-License-Identifier: Apache-2.0
#include "Private/Desktop/Unattended.h"

#include "Private/Desktop/MainWindow.h"

#include "vtkCamera.h"
#include "vtkGenericOpenGLRenderWindow.h"
#include "vtkRenderer.h"
#include "vtkRendererCollection.h"

#include <QApplication>
#include <QElapsedTimer>
#include <QThread>

#include <cmath>
#include <cstdio>
#include <optional>

namespace mammoray
{
namespace
{
constexpr int Frames = 60;
constexpr int LongestWaitMs = 300000;

/// Handles events until `done`, which is not asked again; false if it took too long.
template <typename Condition>
bool Await(const Condition& done)
{
  QElapsedTimer clock;
  clock.start();
  while (!done())
  {
    if (clock.elapsed() > LongestWaitMs)
    {
      return false;
    }
    QApplication::processEvents();
    QThread::msleep(1);
  }
  return true;
}

int Refuse(const QString& complaint)
{
  std::fprintf(stderr, "mammoray app: %s\n", complaint.toUtf8().constData());
  return 1;
}

/// False, after a line, where something could not be opened.
bool AwaitOpened(MainWindow& window)
{
  const bool ended = Await([&] { return !window.IsBusy(); });
  if (!ended || !window.Complaint().isEmpty())
  {
    Refuse(ended ? window.Complaint() : "it was not opened in time");
  }
  return ended && window.Complaint().isEmpty();
}

/// Mean time of a step, ms, each drawn before the next.
template <typename Step>
double MeanMs(ViewWidget* view, const Step& step)
{
  step(0);
  view->Draw();
  view->renderWindow()->WaitForCompletion();
  QElapsedTimer clock;
  clock.start();
  for (int frame = 1; frame <= Frames; ++frame)
  {
    step(frame);
    view->Draw();
  }
  view->renderWindow()->WaitForCompletion();
  return static_cast<double>(clock.nsecsElapsed()) / 1e6 / Frames;
}
}

int RunBenchmark(MainWindow& window)
{
  QElapsedTimer clock;
  clock.start();
  if (!AwaitOpened(window))
  {
    return 1;
  }
  ResultPage& page = window.Result();
  if (!page.IsOpen())
  {
    return Refuse("expected a result to measure with, found none");
  }
  const double openSeconds = static_cast<double>(clock.elapsed()) / 1000;
  const OpenedResult& result = *page.Opened();
  OpenedMammogram& first = *result.Mammograms.front();
  ViewWidget* squeezed = page.View("squeezed");
  const double turn = MeanMs(squeezed,
    [&](int)
    {
      first.Squeezed.Renderer()->GetActiveCamera()->Azimuth(6);
      first.Squeezed.Renderer()->ResetCameraClippingRange();
    });
  std::printf("opened in %.1f s\n", openSeconds);
  std::printf("turning the breast: %.1f frames per second (interfaces of %zu triangles)\n",
    1000 / turn, first.Live.Surface().Triangles.size() / 3);
  if (result.Slices)
  {
    const double slice = MeanMs(page.View("axial"),
      [&](int frame) { result.Slices->Scroll(0, frame % 2 == 0 ? 1 : -1); });
    std::printf("a slice moved: %.0f ms\n", slice);
  }
  constexpr double WayMm = 40;
  const double picture = MeanMs(page.View("mammogram1"),
    [&](int frame)
    {
      first.Live.SetSourceOffset({ WayMm * frame / Frames, 0, 0 });
      first.Pane.Update(first.Live, 2);
    });
  std::printf("live X-ray, half resolution: %.1f per second\n", 1000 / picture);
  first.Live.SetSourceOffset({ 0, 0, 0 });
  BreastPose pose = first.Live.Pose();
  CompressionWorker worker(first.Viewed); // the page takes what its own one finds
  const double closed = pose.ThicknessMm;
  double seconds = 0;
  for (const double change : { 0.0, 1.0, -1.0, 0.5 }) // the first makes the simulation
  {
    pose.ThicknessMm = closed + change;
    clock.restart();
    worker.Ask(pose);
    std::optional<CompressedAnatomy> answer;
    if (!Await([&] { return (answer = worker.Take()).has_value(); }) || !answer->Error.empty())
    {
      return Refuse(
        answer ? QString::fromStdString(answer->Error) : "the equilibrium was not found in time");
    }
    seconds = static_cast<double>(clock.elapsed()) / 1000;
  }
  std::printf("the paddle's exact equilibrium: %.2f s\n", seconds);
  const double moved = MeanMs(page.View("mammogram1"),
    [&](int frame)
    {
      pose.ThicknessMm = closed + std::sin(0.2 * frame);
      if (const std::optional<CompressedAnatomy> known = worker.Reduced(pose))
      {
        first.SetPoints(known->Points);
      }
      first.Live.SetPose(pose.ThicknessMm, pose.RollDeg);
      first.Update(2);
      squeezed->Draw();
    });
  std::printf("a moving paddle, between known equilibria: %.1f per second\n", 1000 / moved);
  return 0;
}

int RunScreenshot(MainWindow& window, const QString& path,
  const std::optional<std::array<double, 2>>& pixel)
{
  if (!AwaitOpened(window))
  {
    return 1;
  }
  if (pixel)
  {
    window.Result().MarkPixel(0, *pixel);
  }
  QElapsedTimer clock;
  clock.start();
  constexpr int DrawnMs = 500; // views are drawn one after the other
  Await([&] { return clock.elapsed() > DrawnMs; });
  window.WriteScreenshot(path, window.size());
  return window.Complaint().isEmpty() ? 0 : Refuse(window.Complaint());
}
}
