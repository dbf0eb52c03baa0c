// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_PathLengthProjector_h
#define mammoray_PathLengthProjector_h

#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/Meshes.h"
#include "mammoray/Foundation/Vector3.h"
#include "mammorayXRayModule.h"

#include <memory>
#include <string>
#include <vector>

namespace mammoray
{
/// No Vulkan device is usable, or the device failed. The message is one line with the reason, and
/// with the name of the VkResult if there is one, for example "VK_ERROR_OUT_OF_DEVICE_MEMORY".
class DeviceError : public Error
{
public:
  using Error::Error;
};

class Beam;

/// The source of the X-rays, in the frame of the mesh.
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
  /// Parallel beam: direction in which the X-rays travel, of any length from 1e-100 to 1e100.
  Vector3 Direction{ 0, 0, -1 };

  bool operator==(const XRaySource&) const = default;
};

/// A flat pixel grid in any pose; in the frame of the mesh.
struct XRayDetector
{
  /// Centre of pixel (column 0, row 0), mm. Coordinates of a projection are at most 1e12 mm.
  Vector3 Origin{ 0, 0, 0 };
  /// From a pixel's centre to that of the next column, and of the next row; length 1e-9 to 1e12 mm.
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

/// Path lengths along the ray of each pixel.
struct PathLengthImage
{
  int Columns = 0;
  int Rows = 0;
  int Materials = 0;
  /**
   * mm; value[(material * Rows + row) * Columns + column]. Material 0 (air) has 0. With several
   * samples per pixel, this is their mean.
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
  /// A sentence with the number of pixels whose rays crossed surfaces that do not close, and their
  /// range of columns and rows. Empty if there are none.
  std::string InconsistencyWarning() const;
};

/**
 * Derivatives of the path lengths of an image with respect to parameters that move the surface's
 * points while the rays stay fixed. For a hit of a ray of direction d on a triangle with normal n,
 * whose point there moves by v per unit of the parameter, dt/dp = (n . v) / (n . d); these are
 * summed as path lengths are. They are exact almost everywhere, also at silhouettes, where path
 * lengths are continuous.
 *
 * Where a ray grazes a triangle, |n . d| is bounded from below by 1/256, so that no hit contributes
 * more than 256 times the largest speed of the field. Contributions of triangles within 0.22
 * degrees of the ray are therefore too small; seen at this angle, a triangle covers less than 1/256
 * of its area. Rasterisation rounds every contribution to 2^-19 of the field's largest speed (1e-6
 * of it at most).
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
   * 0; samples and inconsistent rays are treated as in PathLengthImage.
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
    /// Ray tracing on hardware that supports it, rasterisation on CPU devices and all others.
    Auto,
    /// VK_KHR_ray_tracing_pipeline.
    RayTracing,
    /// Compute shaders of Vulkan 1.2, which every device supports.
    Rasterisation
  };
  Method Projection = Method::Auto;
  /// Part of the device's name (case-insensitive). Empty: the environment variable MAMMORAY_DEVICE,
  /// or without it the most capable device.
  std::string Device;
  /// Computes in double precision if the device supports it. Single precision keeps about 6 digits
  /// of a path length.
  bool DoublePrecision = true;
  /// Enables the Khronos validation layer, whose messages become DeviceErrors.
  bool Validation = false;
  /**
   * Order in which materials count where parts overlap although their labels say air. Empty:
   * lengths are sums over hits, so that an overlap counts once for each part, and negatively where
   * labels are inside out. Otherwise an overlap counts once, for the material there that is first
   * in this list; other materials follow by index. The rule also holds for derivatives, with both
   * methods.
   *
   * The rule needs the order of hits along a ray. Rays through the boxes in which parts overlap
   * (SurfaceOverlap::Regions) are followed a second time on the host, in 2 to 10 microseconds per
   * ray and core. Overlaps are searched again whenever points move.
   */
  std::vector<int> Priority;
};

/**
 * Sums the length of each source-to-pixel ray in every material of a surface mesh,
 * L_m = sum over hits (t - t_ref) ([front = m] - [back = m]), facing the source: order-free,
 * without a hit list. Only the part of a ray between source and pixel counts; either may lie inside
 * the body.
 *
 * A ray whose crossings do not cancel (a hole, exchanged sides) is traced again up to four times,
 * offset by at most a tenth of a pixel. If this fails, the pixel is marked in
 * PathLengthImage::Inconsistent. It takes the mean of its other samples or, if it has none, of its
 * nearest consistent neighbours, and never becomes a bright streak. If no pixel at all is
 * consistent, the path lengths are 0.
 *
 * Ray tracing uses the driver's intersection test in single precision; a ray through an edge may
 * need to be traced again. Rasterisation has its own test, which assigns every ray to exactly one
 * of the triangles that share an edge or a corner. Its result does not depend on the order of
 * triangles, not even in rounding. In double precision both methods agree to 3e-5 mm on paths of
 * 100 mm.
 *
 * Not thread-safe: one projector per thread. Every method may throw DeviceError.
 */
class MAMMORAYXRAY_EXPORT PathLengthProjector
{
public:
  virtual ~PathLengthProjector() = default;
  /// Replaces the mesh and builds the device's structures. Throws InputError on an unusable mesh,
  /// also with coordinates beyond 1e12 mm.
  virtual void SetSurface(const SurfaceMesh& surface) = 0;
  /// Moves the points of the same triangles (3 x pointCount, mm, up to 1e12) and refits.
  virtual void UpdatePoints(const std::vector<double>& points) = 0;
  /// Path lengths of the current surface, computed in strips of rows if a buffer of the device
  /// cannot hold them all. Throws InputError on a degenerate detector or source, and on an image of
  /// more than 2^30 path lengths.
  virtual PathLengthImage Project(const XRaySource& source, const XRayDetector& detector) = 0;
  /// Project for Transmission alone: path lengths stay on the device, which saves a discrete GPU
  /// the transfer to the host.
  virtual void Render(const XRaySource& source, const XRayDetector& detector)
  {
    this->Project(source, detector);
  }
  /**
   * Project, and in the same pass derivatives with respect to one parameter or more. `velocities`
   * has a field for each: the velocity of every point, mm per unit of the parameter. A pass
   * computes up to 8 fields, or fewer if memory or the number of materials limits it. Reuse
   * `derivatives` between calls to avoid allocation. Throws InputError if sizes do not fit or a
   * velocity exceeds 1e12 mm.
   */
  virtual PathLengthImage Project(const XRaySource& source, const XRayDetector& detector,
    const VectorFields& velocities, PathLengthDerivatives& derivatives) = 0;
  /**
   * The reverse of derivatives: from dLoss / dLength of each pixel and material, 1/mm of any unit
   * of the loss, in the order of PathLengthImage::Lengths, the gradient of the loss with respect to
   * every point, 3 x pointCount. It is the transpose of the derivatives of Project (see
   * PathLengthDerivatives, of whose rounding only that of normals and barycentric coordinates is
   * left), and costs about as much as one to two images, however many points there are. Rays that
   * are inconsistent contribute nothing. Throws InputError if sizes do not fit and on a derivative
   * that is not finite. Transmission needs another Project afterwards.
   */
  virtual std::vector<double> Backward(const XRaySource& source, const XRayDetector& detector,
    const std::vector<float>& lossByLength) = 0;
  /**
   * Transmission I / I0 of each pixel of the last Project or Render by the Beer-Lambert law; Rows *
   * Columns values. It is computed on the device from the path lengths that are still there, so
   * that changing the spectrum or a material needs no tracing, and one image is read back whatever
   * the number of materials. An image made in strips is computed on the host. Single precision: the
   * relative error is about 1e-6 (1 + log attenuation). Throws InputError without a preceding
   * Project or Render of the current mesh and points, and if the beam lacks a material of the
   * surface.
   */
  virtual std::vector<float> Transmission(const Beam& beam) = 0;
  /// Name of the device, for reports.
  virtual std::string DeviceName() const = 0;
  /// The method in use; never Auto.
  virtual ProjectorOptions::Method Method() const = 0;
};

struct DeviceDescription
{
  /// Name that the driver gives the device.
  std::string Name;
  std::string Driver;
  /// "discrete GPU", "integrated GPU", "virtual GPU", "CPU" or "other".
  std::string Type;
  bool RayTracing = false;
};

/// Vulkan devices of this machine, the most capable first. Empty, with a reason, without Vulkan.
MAMMORAYXRAY_EXPORT std::vector<DeviceDescription> ListDevices(std::string* reason = nullptr);

/// "auto", "ray-tracing" or "rasterisation".
MAMMORAYXRAY_EXPORT std::string MethodName(ProjectorOptions::Method method);
/// Inverse of MethodName. Throws InputError with the known names.
MAMMORAYXRAY_EXPORT ProjectorOptions::Method MethodFromName(const std::string& name);

/// A projector with these options. Throws DeviceError with the reason if no device is usable.
MAMMORAYXRAY_EXPORT std::unique_ptr<PathLengthProjector> MakeProjector(
  const ProjectorOptions& options = {});
}

#endif
