// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_PriorityProjector_h
#define mammoray_PriorityProjector_h

#include "mammoray/Foundation/SurfaceOverlap.h"
#include "mammoray/Foundation/TriangleTree.h"
#include "mammoray/XRay/PathLengthProjector.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

namespace mammoray
{
/**
 * Counts overlapping parts once, by ProjectorOptions::Priority. Another projector computes the
 * image. Rays through the boxes in which parts overlap are then followed on the host, with their
 * hits sorted.
 */
class PriorityProjector : public PathLengthProjector
{
public:
  PriorityProjector(std::unique_ptr<PathLengthProjector> projector, std::vector<int> priority);

  void SetSurface(const SurfaceMesh& surface) override;
  void UpdatePoints(const std::vector<double>& points) override;
  PathLengthImage Project(const XRaySource& source, const XRayDetector& detector) override;
  PathLengthImage Project(const XRaySource& source, const XRayDetector& detector,
    const VectorFields& velocities, PathLengthDerivatives& derivatives) override;
  std::vector<double> Backward(const XRaySource& source, const XRayDetector& detector,
    const std::vector<float>& lossByLength) override;
  std::vector<float> Transmission(const Beam& beam) override;
  std::string DeviceName() const override { return this->Projector->DeviceName(); }
  ProjectorOptions::Method Method() const override { return this->Projector->Method(); }

private:
  /// A ray; hits before From and behind To (mm along it) count as if they lay there.
  struct Ray
  {
    Vector3 Begin{ 0, 0, 0 };
    /// A unit vector.
    Vector3 Direction{ 0, 0, 1 };
    double From = 0;
    double To = 0;
  };
  /// Sums over rays.
  struct RaySums
  {
    /// By material, mm.
    std::vector<double> Lengths;
    /// [field * materials + material].
    std::vector<double> Rates;
    /// Contributions of the hits to the gradient with respect to points.
    std::vector<std::pair<std::uint32_t, Vector3>> Gradient;
  };
  struct Work
  {
    const VectorFields* Velocities = nullptr;
    PathLengthDerivatives* Derivatives = nullptr;
    /// Losses by material, for the gradient.
    const double* Losses = nullptr;

    std::size_t Fields() const { return this->Velocities ? this->Velocities->Count() : 0; }
  };

  void FindOverlaps();
  Ray RayOf(const XRaySource& source, const XRayDetector& detector, double column,
    double row) const;
  bool PassesRegion(const Ray& ray) const;
  /// Adds the lengths and rates of a ray. Returns false if its crossings do not cancel.
  bool AddRay(const Ray& ray, const Work& work, std::vector<LineHit>& hits, RaySums& sums) const;
  void AddRates(const Ray& ray, const LineHit& hit, int left, int entered, const Work& work,
    RaySums& sums) const;
  Vector3 SlopeAt(const Ray& ray, const LineHit& hit) const;
  void AddGradient(const Ray& ray, const LineHit& hit, double loss, RaySums& sums) const;
  int OwnerOf(const std::vector<int>& insides) const;
  /// Sums over the consistent samples of a pixel. Returns their number, 0 if none passes a region.
  int SumPixel(const XRaySource& source, const XRayDetector& detector, std::size_t pixel,
    const Work& work, std::vector<LineHit>& hits, RaySums& sums) const;
  void Correct(const XRaySource& source, const XRayDetector& detector, const Work& work,
    PathLengthImage& image) const;

  std::unique_ptr<PathLengthProjector> Projector;
  std::vector<int> Priority;
  SurfaceMesh Surface;
  std::optional<TriangleTree> Tree;
  SurfaceOverlap Overlap;
  /// All materials of the surface except air, the first has priority.
  std::vector<int> Order;
  /// The last image of this surface.
  std::optional<PathLengthImage> LastImage;
};
}

#endif
