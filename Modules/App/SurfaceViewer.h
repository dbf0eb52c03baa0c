// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_SurfaceViewer_h
#define mammoray_SurfaceViewer_h

#include "mammoray/App/BreastViewer.h"
#include "mammoray/XRay/Scene.h"
#include "mammorayAppModule.h"

#include <memory>
#include <string>

class vtkRenderWindow;

namespace mammoray
{
/// A scene to look at. The window shows its primary radiation.
struct MAMMORAYAPP_EXPORT ViewedScene
{
  /// For titles.
  std::string Name;
  mammoray::Scene Scene;
};

/**
 * An interactive window: the samples with beam and detector, and their live X-ray. The samples turn
 * about the line through the middle of their box that goes up in the picture, along the detector's
 * columns of pixels. What each key and button does is in SurfaceViewerHelpText.
 *
 * As of BreastViewer, one of a process may Run, and once. While something moves the picture is
 * projected at half resolution.
 */
class MAMMORAYAPP_EXPORT SurfaceViewer
{
public:
  /// Throws InputError where there is no display (see RequireDisplay) and on an unusable scene, and
  /// DeviceError. Of the options, Blend is not used; Kilovoltage is the tube's, or of a single
  /// energy the photons' in keV; SourceOffset is in the scene's frame. `viewed` must outlive the
  /// viewer.
  SurfaceViewer(const ViewedScene& viewed, const ViewerOptions& options);
  ~SurfaceViewer();

  /// Shows the window until it is closed.
  void Run();
  /// Writes the window's picture (.png). Throws InputError.
  void WriteScreenshot(const std::string& path);
  /// Turns the samples once around in so many frames (positive), all drawn, at half resolution;
  /// frames per second.
  double Benchmark(int frames);

  /// Events, as the window's widgets and keys send them. Angles in degrees, right-handed.
  void SetTurn(double degrees);
  /// keV of a single energy, kV of a tube; kept in the slider's range.
  void SetEnergy(double energy);
  /// Sets the offset of the source from its place, frame of the scene, mm. A parallel beam has no
  /// source to move.
  void MoveSource(const Vector3& offset);
  /// Tells what a pixel sees; false beside the picture.
  bool MarkPixel(double column, double row);
  void Click(int x, int y);
  /// A key by its X name.
  void Key(const std::string& name);
  /// Does what has to be done now and then; true when something new was drawn.
  bool Tick();
  /// The line at the bottom: what is marked.
  std::string Status() const;
  const std::string& Message() const;
  double Turn() const;
  vtkRenderWindow* Window();

private:
  struct Internals;
  std::unique_ptr<Internals> Internal;
};

/// Keys and mouse, a line each.
MAMMORAYAPP_EXPORT std::string SurfaceViewerHelpText();
}

#endif
