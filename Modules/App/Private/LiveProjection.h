// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_LiveProjection_h
#define mammoray_LiveProjection_h

#include "mammoray/XRay/Exposer.h"
#include "mammoray/XRay/ProjectionSeries.h"
#include "mammoray/XRay/Scene.h"
#include "mammorayAppModule.h"

#include <array>
#include <memory>
#include <string>
#include <vector>

namespace mammoray
{
/// The primary radiation of a scene whose samples turn, whose source is moved and whose energy is
/// changed, one ray per pixel. No windows.
class MAMMORAYAPP_EXPORT LiveProjection
{
public:
  /// Throws InputError and DeviceError. `viewed` must outlive this.
  LiveProjection(const Scene& viewed, const ProjectorOptions& options);

  /// Of the samples about the axis, right-handed.
  void SetTurn(double degrees);
  double Turn() const { return this->TurnDeg; }
  /// Ignored of a parallel beam.
  void SetSourceOffset(const Vector3& offset);
  const Vector3& SourceOffset() const { return this->Offset; }
  /// How far the source goes for the shadow of the samples' middle to go 1, at most 20.
  double SourceGain() const;
  /// Other X-rays than the scene's, at their own energy. Throws InputError.
  void SetSpectrum(const Spectrum& spectrum);
  /// keV of a single energy, kV of a tube; kept in EnergyRange.
  void SetEnergy(double energy);
  double Energy() const { return this->EnergyNow; }
  const Spectrum& XRays() const { return this->Current.XRays; }
  bool IsSingleEnergy() const { return this->SingleEnergy; }
  const std::array<double, 2>& EnergyRange() const { return this->Range; }

  /// Where the source is, and the detector, `divisor` (1 or 2) of whose pixels are one; scene.
  const XRaySource& Source() const { return this->SourceNow; }
  const XRayDetector& Detector(int divisor) const { return divisor == 1 ? this->Full : this->Half; }
  /// Through the middle of the samples' box, against the detector's rows.
  const AxisLine& Axis() const { return this->TurnAxis; }
  /// -ln(I / I0) on that grid; the same until something changes.
  const std::vector<float>& Project(int divisor);
  /// What a pixel of the full grid, by its continuous column and row, sees at the resolution of the
  /// last picture: transmission and path lengths, a line. Throws InputError beside the picture.
  std::string Describe(double column, double row);
  /// The samples in the frame of the scene.
  const SurfaceMesh& Surface() const { return *this->Samples; }

private:
  const Scene& Viewed;
  XRayDetector Full;
  XRayDetector Half;
  std::shared_ptr<const SurfaceMesh> Samples;
  AxisLine TurnAxis;
  Exposer Device;
  /// At its own voltage.
  Spectrum Given;
  /// What is exposed now.
  Scene Current;
  double TurnDeg = 0;
  Vector3 Offset{ 0, 0, 0 };
  XRaySource SourceNow;
  bool SingleEnergy = false;
  double EnergyNow = 0;
  std::array<double, 2> Range{ 0, 0 };
  Exposure Picture;
  int PictureDivisor = 0;
  bool IsStale = true;
};
}

#endif
