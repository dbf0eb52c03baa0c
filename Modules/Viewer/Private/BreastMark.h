// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_BreastMark_h
#define mammoray_BreastMark_h

#include "Private/BreastScene.h"
#include "Private/LiveMammogram.h"
#include "Private/MammogramPane.h"

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace mammoray
{
class RegisteredBreast;

/**
 * What the user marked, a point of the breast at rest or a pixel, and how it is drawn in all views
 * of the window: the points concerned, and ellipses of one and two standard deviations around
 * them. What it refers to must outlive it.
 */
class BreastMark
{
public:
  BreastMark(LiveMammogram& live, BreastScene& squeezed, BreastScene& atRest, MammogramPane& pane);

  /// Points: volume frame, mm. Pixels: continuous column and row. Both take effect with Update.
  void Set(const Vector3& point);
  void Set(const std::array<double, 2>& pixel);
  void Clear();
  /// Finds what is marked in the breast as it stands, and draws it. Throws InputError beside the
  /// breast and the picture.
  void Update();
  /// What was found, for the user; lines without an end. Empty: nothing is marked.
  const std::string& Text() const { return this->Found; }

private:
  void UpdatePoint(const RegisteredBreast& breast);
  void UpdatePixel(const RegisteredBreast& breast);
  void Draw(const RegisteredBreast& breast, const std::vector<Vector3>& points, double column,
    double row);
  void DrawNothing();

  LiveMammogram& Live;
  BreastScene& Squeezed;
  BreastScene& AtRest;
  MammogramPane& Pane;
  std::optional<Vector3> Point;
  std::optional<std::array<double, 2>> Pixel;
  std::string Found;
};
}

#endif
