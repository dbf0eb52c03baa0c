// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_WallAttachment_h
#define mammoray_WallAttachment_h

namespace mammoray
{
/// How the breast is attached to the fixed materials.
enum class ChestWallMode
{
  /// The nodes at the wall do not move.
  Fixed,
  /// The nodes slide along the surface of the fixed body and hardly leave it.
  Sliding,
  /// An elastic layer connects breast and wall.
  Elastic
};

/// Stiffness of the layer between chest wall and breast: traction per displacement, kPa / mm.
struct WallStiffness
{
  /// Across the wall, for leaving and entering it; positive.
  double Normal = 0;
  /// Along the wall; not negative.
  double Tangential = 0;

  bool operator==(const WallStiffness&) const = default;
};
}

#endif
