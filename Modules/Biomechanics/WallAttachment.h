// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_WallAttachment_h
#define mammoray_WallAttachment_h

namespace mammoray
{
/// How the breast is attached to the held materials.
enum class ChestWallMode
{
  /// Its nodes there do not move.
  Held,
  /// They glide along the held body's surface and hardly leave it.
  Sliding,
  /// An elastic layer lies between.
  Elastic
};

/// Stiffness of the layer between chest wall and breast, kPa / mm: traction per displacement.
struct WallStiffness
{
  /// Across the wall, against leaving and entering it; positive.
  double Normal = 0;
  /// Along the wall; not negative.
  double Tangential = 0;

  bool operator==(const WallStiffness&) const = default;
};
}

#endif
