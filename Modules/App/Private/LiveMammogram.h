// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_LiveMammogram_h
#define mammoray_LiveMammogram_h

#include "mammoray/App/ViewedBreast.h"
#include "mammoray/Biomechanics/Plates.h"
#include "mammoray/Foundation/Meshes.h"
#include "mammoray/XRay/PathLengthProjector.h"
#include "mammorayAppModule.h"

#include <memory>
#include <vector>

namespace mammoray
{
/**
 * The synthetic mammogram of a breast whose unit is being moved: pose, source, tube voltage and the
 * breast's points in, log attenuation out. No windows.
 */
class MAMMORAYAPP_EXPORT LiveMammogram
{
public:
  /// Throws InputError and DeviceError.
  LiveMammogram(const ViewedBreast& viewed, const ProjectorOptions& options);

  /// The unit with its plates; thickness, mm, positive, and roll, degrees.
  void SetPose(double thicknessMm, double rollDeg);
  const BreastPose& Pose() const { return this->UnitPose; }
  /// The source beside its place above the chest-wall edge's middle: gantry x, y, z, mm. It is kept
  /// 20 mm above the paddle at least.
  void SetSourceOffset(const Vector3& offset);
  const Vector3& SourceOffset() const { return this->Offset; }
  /// Tube voltage, kV; see AtKilovoltage for its range.
  void SetKilovoltage(double kilovoltage);
  double Kilovoltage() const { return this->Voltage; }
  /// Where the anatomy's points are, 3 x pointCount, mm, volume frame.
  void SetPoints(const std::vector<double>& points);
  const std::vector<double>& Points() const { return this->Moved; }

  /// The picture's grid, `divisor` (1 or 2) of its pixels as one; gantry frame of the unit.
  const ReceptorGrid& Grid(int divisor) const
  {
    return divisor == 1 ? this->FullGrid : this->HalfGrid;
  }
  /**
   * -ln(I / I0) on that grid; the same until something changes. With divisor 2, for pictures that
   * move, energies are taken 2 keV at a time, 1 % of the attenuation.
   */
  const std::vector<float>& Project(int divisor);

  /// Interfaces of the anatomy at rest, and which of its points theirs are.
  const SurfaceMesh& Surface() const { return this->Interfaces; }
  const std::vector<std::int32_t>& SurfacePoints() const { return this->PointIds; }
  /// Where the unit stands, without the source's offset.
  VolumeFromGantry Placed() const;
  PlatePair Plates() const;
  /// Place of the source, volume frame, mm.
  Vector3 SourcePosition() const;
  /**
   * All this as a registration's result, to find points in: the gantry frame is shifted so that the
   * source stands above its origin, and the picture's grid the other way.
   */
  BreastInUnit InUnit() const;

private:
  const ViewedBreast& Viewed;
  BreastPose UnitPose;
  Vector3 Offset{ 0, 0, 0 };
  double Voltage = 0;
  std::vector<double> Moved;
  std::vector<std::int32_t> PointIds;
  SurfaceMesh Interfaces;
  ReceptorGrid FullGrid;
  ReceptorGrid HalfGrid;
  std::unique_ptr<PathLengthProjector> Projector;
  std::optional<Beam> XRays;
  /// Of a few energies, for pictures that move.
  std::optional<Beam> QuickXRays;
  std::vector<float> Picture;
  int PictureDivisor = 0;
  /// What on the device is out of date.
  bool RaysStale = true;
  bool BeamStale = true;
};
}

#endif
