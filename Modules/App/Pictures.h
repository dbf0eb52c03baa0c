// SPDX-License-Identifier: Apache-2.0
// Pictures of what the desktop application shows, without a window.
#ifndef mammoray_Pictures_h
#define mammoray_Pictures_h

#include "mammoray/App/ViewedBreast.h"
#include "mammoray/Foundation/Progress.h"
#include "mammoray/XRay/PathLengthProjector.h"
#include "mammoray/XRay/Scene.h"
#include "mammorayAppModule.h"

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace mammoray
{
struct PictureOptions
{
  ProjectorOptions Projector;
  /// Of the picture, pixels; at least 400 each.
  int Width = 1280;
  int Height = 800;
  /// Share of the real mammogram, [0, 1].
  double Blend = 0.5;
  /// Tube voltage, kV; of a scene with a single photon energy that energy, keV. Default: the
  /// spectrum's.
  std::optional<double> Energy;
  /// Offset of the source from its place, mm: gantry frame; of a scene its frame.
  Vector3 SourceOffset{ 0, 0, 0 };
  /// What to mark: a point of the breast at rest, mm, volume frame, or a pixel (continuous column
  /// and row) of the first mammogram or of the scene's picture.
  std::optional<Vector3> Point;
  std::optional<std::array<double, 2>> Pixel;
  /// Told of while an equilibrium is solved for, by 0: how long it takes is not known.
  ProgressCallback Progress;
};

/**
 * Writes a picture (.png) of the breast between the plates and at rest, of three slices of the MRI
 * or its tissues, and of the mammograms, synthetic and real. Where the pose is not that of the
 * compressed points, the equilibrium is solved for first. Returns what was found of the mark and
 * the equilibrium; lines without an end. `viewed`: of one breast one for each mammogram, at least
 * one. Throws InputError, also without a display (see RequireDisplay) and for a mark beside the
 * breast or the picture, and DeviceError.
 */
MAMMORAYAPP_EXPORT std::string WriteBreastPicture(std::vector<ViewedBreast> viewed,
  const PictureOptions& options, const std::string& path);

/// The same of a scene: its samples with beam and detector, and their X-ray (primary radiation).
MAMMORAYAPP_EXPORT std::string WriteScenePicture(const Scene& scene, const PictureOptions& options,
  const std::string& path);
}

#endif
