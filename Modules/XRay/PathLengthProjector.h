// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_PathLengthProjector_h
#define mammoray_PathLengthProjector_h

#include "mammoray/Foundation/SurfaceMesh.h"
#include "mammoray/Foundation/Vector3.h"
#include "mammorayXRayModule.h"

#include <memory>
#include <string>
#include <vector>

namespace mammoray
{
class Beam;

/// Where the X-rays come from; in the frame of the mesh.
struct XRaySource
{
  enum class Kind
  {
    Point,
    Parallel
  };
  Kind Type = Kind::Point;
  /// Point source: its position, mm.
  Vector3 Position{ 0, 0, 650 };
  /// Parallel beam: direction in which the X-rays travel; of any length from 1e-100 to 1e100.
  Vector3 Direction{ 0, 0, -1 };

  bool operator==(const XRaySource&) const = default;
};

/// A flat pixel grid in any pose; in the frame of the mesh.
struct XRayDetector
{
  /// Centre of pixel (column 0, row 0), mm; coordinates up to 1e12 mm, as all of a projection.
  Vector3 Origin{ 0, 0, 0 };
  /// Lead from a pixel's centre to that of the next column, and of the next row; 1e-9 to 1e12 mm
  /// long.
  Vector3 ColumnStep{ 0.1, 0, 0 };
  Vector3 RowStep{ 0, 0.1, 0 };
  int Columns = 1;
  int Rows = 1;
  /// Rays per pixel: a centred Samples x Samples grid. Projectors average their path lengths,
  /// Expose their transmissions. 1 to 16.
  int Samples = 1;

  std::size_t NumberOfPixels() const
  {
    return static_cast<std::size_t>(this->Columns) * this->Rows;
  }
  bool operator==(const XRayDetector&) const = default;
};

/// A straight ray between two points, in the frame of the mesh, mm.
struct XRayLine
{
  Vector3 Begin{ 0, 0, 0 };
  Vector3 End{ 0, 0, 0 };
};

/// Path lengths along the ray of each pixel.
struct PathLengthImage
{
  int Columns = 0;
  int Rows = 0;
  int Materials = 0;
  /**
   * mm; value[(material * Rows + row) * Columns + column]. Material 0 (air) is left 0. With several
   * samples per pixel: their mean.
   */
  std::vector<float> Lengths;
  /// 0 where the ray's crossings of every material cancel, else 1; Rows * Columns values.
  std::vector<unsigned char> Inconsistent;

  std::size_t NumberOfPixels() const
  {
    return static_cast<std::size_t>(this->Columns) * this->Rows;
  }
  const float* Material(int material) const
  {
    return this->Lengths.data() + material * this->NumberOfPixels();
  }
  std::size_t NumberOfInconsistentRays() const;
  /// A sentence with the number of pixels whose rays crossed surfaces that do not close, and the
  /// columns and rows where they lie; empty when there are none.
  std::string InconsistencyWarning() const;
};

/**
 * How the path lengths of an image change with parameters that move the surface's points, the rays
 * standing still: for a hit of a ray of direction d on a triangle with normal n, whose point there
 * moves by v per unit of the parameter, dt/dp = (n . v) / (n . d), summed as path lengths are.
 * Exact almost everywhere, silhouettes included, since path lengths are continuous there.
 *
 * Where a ray grazes a triangle, the absolute value of n . d is taken as 1/256 at least: no hit
 * contributes more than 256 times the largest speed of the field. Contributions of triangles within
 * 0.22 degrees of the ray are too small by that; seen so, a triangle covers less than 1/256 of its
 * area. Rasterisation rounds every contribution to 2^-19 of the field's largest speed (1e-6 of it
 * at most).
 */
struct PathLengthDerivatives
{
  int Columns = 0;
  int Rows = 0;
  int Materials = 0;
  int Fields = 0;
  /**
   * mm per unit of the parameter;
   * value[((field * Materials + material) * Rows + row) * Columns + column]. Material 0 (air) is
   * left 0; samples and rays that failed are treated as in PathLengthImage.
   */
  std::vector<float> Lengths;

  const float* Of(int field, int material) const
  {
    return this->Lengths.data() +
      (static_cast<std::size_t>(field) * this->Materials + material) * this->Rows * this->Columns;
  }
};

struct ProjectorOptions
{
  enum class Method
  {
    /// Ray tracing where hardware offers it, rasterisation on CPU devices and on all others.
    Auto,
    /// VK_KHR_ray_tracing_pipeline.
    RayTracing,
    /// Compute shaders of Vulkan 1.2; every device has them.
    Rasterisation
  };
  Method Projection = Method::Auto;
  /// Part of the wanted device's name (case-insensitive); empty takes the most capable one. The
  /// environment variable MAMMORAY_DEVICE stands in for an empty name.
  std::string Device;
  /// Computes in double precision where the device can; single precision keeps about 6 digits of a
  /// path length and is what devices without 64-bit floats use.
  bool DoublePrecision = true;
  /// Turns the Khronos validation layer on and its messages into DeviceError.
  bool Validation = false;
  /**
   * What counts where parts overlap though their labels say air. Empty: lengths are sums over hits,
   * such a stretch counts once for each part, and negatively where labels are inside out.
   * Otherwise it counts once, for the material inside there that comes first in this list;
   * materials that are not in it follow, the smaller index first. So do path lengths along rays,
   * and derivatives, whichever way of projecting.
   *
   * This needs the order of hits along a ray: rays that pass the boxes in which parts overlap
   * (SurfaceOverlap::Regions) are followed a second time, on the host, at 2 to 10 microseconds
   * each and core; and every new position of the points looks for overlaps anew.
   */
  std::vector<int> Priority;
};

/**
 * Sums the length of each source-to-pixel ray in every material of a surface mesh,
 * L_m = sum over hits (t - t_ref) ([front = m] - [back = m]), facing the source: order-free,
 * without a hit list. Only the part of a ray between source and pixel counts; either may lie inside
 * the body.
 *
 * A ray whose crossings do not cancel (a hole, sides exchanged) is traced again up to four times,
 * at most a tenth of a pixel beside. Where that does not help the pixel is marked in
 * PathLengthImage::Inconsistent and takes the mean of its other samples, or, if it has none, of its
 * nearest consistent neighbours: never a bright streak. Bodies with holes wide enough to leave no
 * consistent pixel at all give zeros.
 *
 * Ray tracing depends on the driver's float test of hits: a ray which touches an edge is traced
 * again in the same way. Rasterisation has its own test, which gives every ray to one of the
 * triangles that share an edge or a corner; its result does not depend on the order of triangles,
 * not even in rounding. In double precision the two agree to 3e-5 mm on paths of 100 mm.
 *
 * Not thread-safe: one projector per thread. Every method may throw DeviceError.
 */
class MAMMORAYXRAY_EXPORT PathLengthProjector
{
public:
  virtual ~PathLengthProjector() = default;
  /// Replaces the mesh; builds what the device needs. Throws InputError on an unusable mesh, as one
  /// with coordinates beyond 1e12 mm.
  virtual void SetSurface(const SurfaceMesh& surface) = 0;
  /// New positions (3 x pointCount, mm, up to 1e12) for the same triangles; refits.
  virtual void UpdatePoints(const std::vector<double>& points) = 0;
  /// Path lengths for the surface as it stands; in strips of rows where a buffer of the device does
  /// not hold them all. Throws InputError on a degenerate detector or source, and on an image of
  /// more than 2^30 path lengths.
  virtual PathLengthImage Project(const XRaySource& source, const XRayDetector& detector) = 0;
  /// The same for Transmission alone: path lengths stay on the device, which spares a discrete one
  /// the way to the host.
  virtual void Render(const XRaySource& source, const XRayDetector& detector)
  {
    this->Project(source, detector);
  }
  /**
   * Project, and in the same pass derivatives with respect to `fields` parameters, at least 1.
   * Velocities are those of every point per unit of the parameter, mm;
   * velocities[(field * pointCount + point) * 3 + axis]. Up to 8 fields are done at once (fewer
   * where memory or many materials ask for it), more in further passes. Keep `derivatives` from one
   * call to the next to spare its allocation. Throws InputError when sizes do not fit or a velocity
   * is beyond 1e12 mm.
   */
  virtual PathLengthImage Project(const XRaySource& source, const XRayDetector& detector,
    const std::vector<double>& velocities, int fields, PathLengthDerivatives& derivatives) = 0;
  /**
   * Path lengths along any rays, from Begin to End; an image of one row with a column for each ray.
   * A ray that fails is traced again at most 0.01 mm beside; one that still fails is marked and its
   * lengths are 0. Ray tracing only: rasterisation throws InputError, as do no rays at all and a
   * ray that is not finite or has no length.
   */
  virtual PathLengthImage ProjectRays(const std::vector<XRayLine>& rays);
  /**
   * Transmission I / I0 of each pixel of the last Project or Render by the Beer-Lambert law,
   * computed on the device from the path lengths that are still there: another spectrum or material
   * traces no ray, and one image is read back whatever the number of materials (of an image made in
   * strips: on the host). Rows * Columns values. Single precision: relative error 1e-6 times 1 +
   * the log attenuation, or so. Throws InputError before the first of them, after another mesh,
   * moved points or a list of rays, and when the beam lacks a material of the surface.
   */
  virtual std::vector<float> Transmission(const Beam& beam) = 0;
  /// Name of the device that does the work, for reports.
  virtual std::string DeviceName() const = 0;
  /// How it is done; never Auto.
  virtual ProjectorOptions::Method Method() const = 0;
};

struct DeviceDescription
{
  /// The device is called so by its driver.
  std::string Name;
  std::string Driver;
  /// "discrete GPU", "integrated GPU", "virtual GPU", "CPU" or "other".
  std::string Type;
  bool RayTracing = false;
};

/// Vulkan devices of this machine, best first; empty, with a reason, where there is no Vulkan.
MAMMORAYXRAY_EXPORT std::vector<DeviceDescription> ListDevices(std::string* reason = nullptr);

/// "auto", "ray-tracing" or "rasterisation".
MAMMORAYXRAY_EXPORT std::string MethodName(ProjectorOptions::Method method);
/// The reverse; throws InputError with the known names.
MAMMORAYXRAY_EXPORT ProjectorOptions::Method MethodFromName(const std::string& name);

/// The projector that the options ask for. Throws DeviceError, in one line with the reason, when no
/// device can.
MAMMORAYXRAY_EXPORT std::unique_ptr<PathLengthProjector> MakeProjector(
  const ProjectorOptions& options = {});

/// MakeProjector with Method::RayTracing.
MAMMORAYXRAY_EXPORT std::unique_ptr<PathLengthProjector> MakeRayTracingProjector(
  const ProjectorOptions& options = {});

/// MakeProjector with Method::Rasterisation.
MAMMORAYXRAY_EXPORT std::unique_ptr<PathLengthProjector> MakeRasterisationProjector(
  const ProjectorOptions& options = {});
}

#endif
