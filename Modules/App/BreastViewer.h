// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_BreastViewer_h
#define mammoray_BreastViewer_h

#include "mammoray/App/ViewedBreast.h"
#include "mammoray/XRay/PathLengthProjector.h"
#include "mammorayAppModule.h"

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

class vtkRenderWindow;

namespace mammoray
{
struct ViewerOptions
{
  ProjectorOptions Projector;
  /// Size of the window, pixels.
  int Width = 1280;
  int Height = 800;
  /// Nothing is shown: for pictures from scripts.
  bool OffScreen = false;
  /// Share of the real mammogram, [0, 1].
  double Blend = 0.5;
  /// Tube voltage, kV; none: the spectrum's.
  std::optional<double> Kilovoltage;
  /// Offset of the source from its place, gantry frame, mm.
  Vector3 SourceOffset{ 0, 0, 0 };
  /// Where the key s saves pictures.
  std::string PictureFolder = ".";
  /// Called with what was found whenever something is marked.
  std::function<void(const std::string&)> Marked;
  /// Asked many times a second; true closes the window.
  std::function<bool()> Stop;
};

/// What a moving paddle shows, and how near the truth that is.
struct PaddleMotion
{
  /// Equilibria shown a second.
  double PerSecond = 0;
  /// From the last motion until the exact equilibrium is there.
  double ExactSeconds = 0;
  /// Distance of the anatomy's points shown last from those of the exact one, mm.
  double MedianMm = 0;
  double PercentileMm95 = 0;
};

/**
 * An interactive window: the breast with plates and source, the breast at rest, three slices of the
 * MRI or its tissues, and the mammograms, synthetic and real. What each key and button does is in
 * ViewerHelpText.
 *
 * One viewer of a process may Run, and once: VTK's event loop for X keeps every interactor that was
 * initialised, also after its end, and crashes on it in the next loop (VTK 9.1). Any number may
 * draw without it.
 *
 * While something moves the mammogram is projected at half resolution, at rest at the full one; a
 * moved thickness asks for a new equilibrium beside the window's thread. Near others found before
 * these tell at once about how it will be, and the window says that it is so; the exact one follows
 * when the plates have come to rest.
 */
class MAMMORAYAPP_EXPORT BreastViewer
{
public:
  /// Throws InputError where there is no display (see RequireDisplay), and DeviceError.
  /// `viewed`: one for each mammogram, of one breast; at least one. It must outlive the viewer.
  BreastViewer(const std::vector<ViewedBreast>& viewed, const ViewerOptions& options);
  ~BreastViewer();

  /// Shows the window until it is closed.
  void Run();
  /// Waits for an equilibrium under way and writes the window's picture (.png). Throws InputError.
  void WriteScreenshot(const std::string& path);
  /// Moves the source on a circle for so many frames (positive), all drawn, at half resolution;
  /// frames per second.
  double Benchmark(int frames);
  /// Moves the paddle up and down by 6 mm for so many frames (positive), all drawn, at half
  /// resolution, and lets it come to rest. Nothing for a series, whose equilibria are given.
  std::optional<PaddleMotion> BenchmarkPaddle(int frames);

  /// Events, as the window's widgets and keys send them.
  void SetThickness(double thicknessMm);
  void SetRoll(double rollDeg);
  void SetKilovoltage(double kilovoltage);
  void SetBlend(double real);
  void MoveSource(const Vector3& offset);
  /// Marks a point of the breast at rest, mm, volume frame; false where there is no breast.
  bool MarkPoint(const Vector3& point);
  /// Marks what lies behind a pixel of the active mammogram (the first, or the last one clicked),
  /// continuous position; false beside the breast.
  bool MarkPixel(double column, double row);
  void ClearMark();
  /// A click at a place of the window, pixels from its lower left corner.
  void Click(int x, int y);
  /// A key by its X name: "h", "q", "Left", ...
  void Key(const std::string& name);
  /// Does what has to be done now and then; true when something new was drawn.
  bool Tick();
  /// The line at the bottom: what is marked, what is being done.
  std::string Status() const;
  /// The last thing that went wrong or was done, a line; empty: nothing yet.
  const std::string& Message() const;
  /// It and its interactor, which live as long as this.
  vtkRenderWindow* Window();
  /// The unit's pose and the anatomy's points as shown.
  const BreastPose& Pose() const;
  const std::vector<double>& Points() const;

private:
  struct Internals;
  std::unique_ptr<Internals> Internal;
};

/// Keys and mouse, a line each.
MAMMORAYAPP_EXPORT std::string ViewerHelpText();
}

#endif
