// SPDX-License-Identifier: Apache-2.0
#include "Private/VolumePlacement.h"

#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/Numbers.h"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <limits>
#include <numbers>
#include <optional>

namespace mammoray
{
namespace
{
using Axes = std::array<Vector3, 3>;

/// The place of voxel (0, 0, 0) and the steps to its neighbours, mm.
struct Placement
{
  Axes Steps{};
  Vector3 Origin{ 0, 0, 0 };

  double Determinant() const { return Dot(this->Steps[0], Cross(this->Steps[1], this->Steps[2])); }
  double SmallestStep() const
  {
    return std::min({ Norm(this->Steps[0]), Norm(this->Steps[1]), Norm(this->Steps[2]) });
  }
};

/// How far apart two placements put a corner of the grid, mm.
double LargestDistance(const Placement& a, const Placement& b, const std::array<int, 3>& size)
{
  double most = 0;
  for (unsigned corner = 0; corner < 8; ++corner)
  {
    Vector3 apart = a.Origin - b.Origin;
    for (unsigned axis = 0; axis < 3; ++axis)
    {
      const double index = (corner >> axis & 1U) != 0 ? size[axis] - 1 : 0;
      apart = apart + index * (a.Steps[axis] - b.Steps[axis]);
    }
    most = std::max(most, Norm(apart));
  }
  return most;
}

/// Absent if its code is 0. Offsets are those of nifti1.h; NIfTI's axes.
std::optional<Placement> SformOf(const NiftiHeader& header)
{
  if (header.At<std::int16_t>(254) <= 0)
  {
    return {};
  }
  Placement sform;
  for (std::size_t row = 0; row < 3; ++row)
  {
    for (std::size_t axis = 0; axis < 3; ++axis)
    {
      sform.Steps[axis][row] = header.Number(280 + 16 * row + 4 * axis);
    }
    sform.Origin[row] = header.Number(280 + 16 * row + 12);
  }
  return sform;
}

Vector3 VoxelSize(const NiftiHeader& header)
{
  return { header.Number(80), header.Number(84), header.Number(88) };
}

/// Absent if its code is 0. The rotation is that of a unit quaternion whose first part is left out.
std::optional<Placement> QformOf(const NiftiHeader& header)
{
  if (header.At<std::int16_t>(252) <= 0)
  {
    return {};
  }
  Vector3 part{ header.Number(256), header.Number(260), header.Number(264) };
  const double square = Dot(part, part);
  part = square > 1 ? (1 / std::sqrt(square)) * part : part;
  const auto [b, c, d] = part;
  const double a = std::sqrt(std::max(0.0, 1 - square));
  Placement qform;
  qform.Steps = { { { a * a + b * b - c * c - d * d, 2 * (b * c + a * d), 2 * (b * d - a * c) },
    { 2 * (b * c - a * d), a * a + c * c - b * b - d * d, 2 * (c * d + a * b) },
    { 2 * (b * d + a * c), 2 * (c * d - a * b), a * a + d * d - b * b - c * c } } };
  const Vector3 size = VoxelSize(header);
  for (std::size_t axis = 0; axis < 3; ++axis)
  {
    const double side = axis == 2 && header.Number(76) < 0 ? -1 : 1;
    qform.Steps[axis] = side * size[axis] * qform.Steps[axis];
    qform.Origin[axis] = header.Number(268 + 4 * axis);
  }
  return qform;
}

/// Millimetres of the header's unit of length (xyzt_units); those of none.
double UnitMm(const NiftiHeader& header, const std::string& path)
{
  constexpr double units[] = { 1, 1000, 1, 1e-3 };
  const auto unit = static_cast<std::size_t>(header.At<char>(123) & 7);
  if (unit >= std::size(units))
  {
    throw InputError(path +
      ": xyzt_units: expected m (1), mm (2), micrometres (3) or none (0), found " +
      std::to_string(unit));
  }
  return units[unit];
}

void Scale(Placement& placement, double factor)
{
  placement.Origin = factor * placement.Origin;
  for (Vector3& step : placement.Steps)
  {
    step = factor * step;
  }
}

std::string SizeText(const Vector3& size)
{
  return NumberText(size[0]) + " x " + NumberText(size[1]) + " x " + NumberText(size[2]) + " mm";
}

/// Notes what the header contradicts of the placement that is taken, or throws.
void Compare(const std::string& path, const Placement& taken, const Placement& other,
  const char* name, const char* otherName, const std::array<int, 3>& size)
{
  if (taken.Determinant() * other.Determinant() < 0)
  {
    throw InputError(path +
      ": expected qform and sform to place the volume alike, found one that is the mirror image of "
      "the other: left and right are not known");
  }
  const double apart = LargestDistance(taken, other, size);
  if (apart > 0.5 * taken.SmallestStep())
  {
    Note({ path,
      std::string("its ") + otherName + " places the volume up to " + NumberText(apart, 3) +
        " mm from where its " + name + " does; the " + name + " is taken" });
  }
}

/// The axes at right angles that are nearest to given ones, of lengths about 1: the rotation of
/// their polar decomposition, by Newton's iteration (Higham 1986).
Axes RightAngled(Axes axes)
{
  for (int step = 0; step < 20; ++step)
  {
    const Axes cofactors{ Cross(axes[1], axes[2]), Cross(axes[2], axes[0]),
      Cross(axes[0], axes[1]) };
    const double determinant = Dot(axes[0], cofactors[0]);
    for (std::size_t axis = 0; axis < 3; ++axis)
    {
      axes[axis] = 0.5 * (axes[axis] + (1 / determinant) * cofactors[axis]);
    }
  }
  return axes;
}

/// The largest cosine between two axes.
double LargestCosine(const Axes& axes)
{
  return std::max({ std::abs(Dot(axes[0], axes[1])), std::abs(Dot(axes[1], axes[2])),
    std::abs(Dot(axes[2], axes[0])) });
}

/// A grid of the same steps at right angles that holds all voxels of a sheared one; absent if it
/// would have more than eight times as many.
std::optional<VolumeGrid> StraightGrid(const VolumeGrid& sheared)
{
  VolumeGrid straight = sheared;
  straight.Direction = RightAngled(sheared.Direction);
  Vector3 low{ 0, 0, 0 };
  Vector3 high{ 0, 0, 0 };
  for (unsigned corner = 0; corner < 8; ++corner)
  {
    const auto at = [&](unsigned axis)
    { return (corner >> axis & 1U) != 0 ? sheared.Size[axis] - 1.0 : 0.0; };
    const Vector3 index = straight.ContinuousIndex(sheared.PointAt(at(0), at(1), at(2)));
    for (std::size_t axis = 0; axis < 3; ++axis)
    {
      low[axis] = std::min(low[axis], std::floor(index[axis] + 0.5));
      high[axis] = std::max(high[axis], std::floor(index[axis] + 0.5));
    }
  }
  double growth = 1;
  for (std::size_t axis = 0; axis < 3; ++axis)
  {
    growth *= (high[axis] - low[axis] + 1) / sheared.Size[axis];
  }
  if (!(growth <= 8))
  {
    return {};
  }
  straight.Origin = straight.PointAt(low[0], low[1], low[2]);
  for (std::size_t axis = 0; axis < 3; ++axis)
  {
    straight.Size[axis] = static_cast<int>(high[axis] - low[axis]) + 1;
  }
  return straight;
}

template <typename Volume, typename ValueAt>
void StraightenBy(const std::string& path, Volume& volume, const ValueAt& valueAt)
{
  // As VolumeGrid::ValidateGrid, which refuses what is left as it is.
  const double cosine = LargestCosine(volume.Direction);
  const std::optional<VolumeGrid> straight =
    cosine >= 1e-3 && cosine <= 0.3 ? StraightGrid(volume) : std::nullopt;
  if (!straight)
  {
    return;
  }
  Note({ path,
    "its axes are up to " + NumberText(std::asin(cosine) * 180 / std::numbers::pi, 2) +
      " degrees off right angles; resampled to axes at right angles" });
  // Its indices as places, which ValueAt and LabelAt interpolate between.
  const VolumeGrid sheared = volume;
  Volume indexed = std::move(volume);
  static_cast<VolumeGrid&>(indexed) = {};
  indexed.Size = sheared.Size;
  volume = {};
  static_cast<VolumeGrid&>(volume) = *straight;
  const Axes& axes = sheared.Direction;
  const Axes cofactors{ Cross(axes[1], axes[2]), Cross(axes[2], axes[0]), Cross(axes[0], axes[1]) };
  const double determinant = Dot(axes[0], cofactors[0]);
  volume.Voxels.reserve(volume.Index(0, 0, volume.Size[2]));
  volume.ForEachVoxel(
    [&](int i, int j, int k, std::size_t)
    {
      const Vector3 offset = volume.PointAt(i, j, k) - sheared.Origin;
      Vector3 index;
      for (std::size_t axis = 0; axis < 3; ++axis)
      {
        index[axis] = Dot(offset, cofactors[axis]) / (determinant * sheared.Spacing[axis]);
      }
      volume.Voxels.push_back(valueAt(indexed, index));
    });
}
}

NiftiHeader::NiftiHeader(const std::string& path)
{
  int count = 0;
  if (const gzFile file = gzopen(path.c_str(), "rb"))
  {
    count = std::max(gzread(file, this->Bytes.data(), Length), 0);
    this->Packed = gzdirect(file) == 0;
    gzclose(file);
  }
  if (count < Length)
  {
    throw InputError(path + ": expected NIfTI-1 with a header of " + std::to_string(Length) +
      " bytes, found " +
      (this->Packed ? "compressed data that is too short or damaged"
                    : std::to_string(count) + " bytes"));
  }
  this->IsSwapped = this->At<std::int32_t>(0) != Length;
  if (this->At<std::int32_t>(0) != Length || std::memcmp(&this->Bytes[344], "n+1", 4) != 0)
  {
    throw InputError(path + ": expected NIfTI-1 in one file (magic n+1), found another form");
  }
}

void TakeNiftiPlacement(const std::string& path, const NiftiHeader& header, VolumeGrid& grid)
{
  // ITK turns spacings of other units into mm, but not the origin.
  const double unitMm = UnitMm(header, path);
  std::optional<Placement> sform = SformOf(header);
  std::optional<Placement> qform = QformOf(header);
  for (std::optional<Placement>* const form : { &sform, &qform })
  {
    if (*form)
    {
      Scale(**form, unitMm);
    }
  }
  // A matrix of zeros places nothing.
  const bool isUsable = sform && std::abs(sform->Determinant()) > 0;
  const bool takesSform = sform && (!qform || (isUsable && header.At<std::int16_t>(254) == 1));
  if (!sform && !qform)
  {
    Note({ path,
      std::string("its qform_code and sform_code are 0 (Analyze, MATLAB): ") + AxesNotSaid });
    return;
  }
  Placement taken = takesSform ? *sform : *qform;
  if (isUsable && qform)
  {
    Compare(path, taken, takesSform ? *qform : *sform, takesSform ? "sform" : "qform",
      takesSform ? "qform" : "sform", grid.Size);
  }
  const Vector3 said = unitMm * VoxelSize(header);
  const Vector3 size{ Norm(taken.Steps[0]), Norm(taken.Steps[1]), Norm(taken.Steps[2]) };
  const bool isOther = std::abs(size[0] - said[0]) > 0.01 * size[0] ||
    std::abs(size[1] - said[1]) > 0.01 * size[1] || std::abs(size[2] - said[2]) > 0.01 * size[2];
  if (takesSform && !qform && isOther)
  {
    Note({ path,
      "its pixdim says voxels of " + SizeText(said) + ", its sform " + SizeText(size) +
        "; those of the sform are taken" });
  }
  // From NIfTI's RAS to LPS.
  Placement byItk{ grid.Direction, grid.Origin };
  for (std::size_t axis = 0; axis < 2; ++axis)
  {
    taken.Origin[axis] = -taken.Origin[axis];
    for (Vector3& step : taken.Steps)
    {
      step[axis] = -step[axis];
    }
  }
  for (std::size_t axis = 0; axis < 3; ++axis)
  {
    byItk.Steps[axis] = grid.Spacing[axis] * byItk.Steps[axis];
  }
  // Where they agree, ITK's numbers are rounded once less.
  if (LargestDistance(taken, byItk, grid.Size) <= 1e-3 * taken.SmallestStep())
  {
    return;
  }
  grid.Origin = taken.Origin;
  grid.Spacing = size;
  for (std::size_t axis = 0; axis < 3; ++axis)
  {
    grid.Direction[axis] = (1 / size[axis]) * taken.Steps[axis];
  }
}

void Straighten(const std::string& path, LabelVolume& volume)
{
  StraightenBy(path, volume,
    [](const LabelVolume& indexed, const Vector3& index) { return indexed.LabelAt(index); });
}

void Straighten(const std::string& path, IntensityVolume& volume)
{
  StraightenBy(path, volume,
    [](const IntensityVolume& indexed, const Vector3& index)
    { return indexed.ValueAt(index).value_or(0); });
}
}
