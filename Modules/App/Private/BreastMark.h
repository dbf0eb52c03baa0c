// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_BreastMark_h
#define mammoray_BreastMark_h

#include "Private/BreastScene.h"
#include "mammorayAppModule.h"

#include <array>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace mammoray
{
class RegisteredBreast;
struct OpenedMammogram;

/**
 * What the user marked, a point of the breast at rest or a pixel of a mammogram, and how it is
 * drawn in all views of the window: the points concerned, and ellipses of one and two standard
 * deviations around them; what lies behind a pixel is a line in the other mammograms.
 */
class MAMMORAYAPP_EXPORT BreastMark
{
public:
  /// The views must outlive this.
  BreastMark(BreastScene& atRest, const std::vector<std::unique_ptr<OpenedMammogram>>& mammograms);

  /// Points: volume frame, mm. Pixels: continuous column and row of one of the mammograms, by its
  /// number. Both take effect with Update.
  void Set(const Vector3& point);
  void Set(const std::array<double, 2>& pixel, std::size_t mammogram);
  void Clear();
  /// Finds what is marked in the breast as it stands, and draws it. `moved`: units or breasts have
  /// moved since the last time. Throws InputError beside the breast and the picture.
  void Update(bool moved = true);
  /// What was found, for the user; lines without an end. Empty: nothing is marked.
  const std::string& Text() const { return this->Found; }
  /// The marked point, or the middle of what lies behind the pixel, at rest; nothing where nothing
  /// was found.
  const std::optional<Vector3>& Middle() const { return this->Centre; }
  /// What lies behind a pixel, and ellipses, closed, in the breast at rest.
  const std::vector<std::vector<Vector3>>& RestLines() const { return this->Lines; }

private:
  void UpdatePoint();
  void UpdatePixel();
  void DrawLine(OpenedMammogram& mammogram, const RegisteredBreast& breast,
    const std::vector<Vector3>& places, bool ofPixel);
  void DrawNothing();
  const RegisteredBreast& Breast(const OpenedMammogram& mammogram);
  void DrawAtRest(const std::vector<Vector3>& point, const std::vector<Vector3>& line,
    const std::vector<Loop>& loops);

  BreastScene& AtRest;
  const std::vector<std::unique_ptr<OpenedMammogram>>& Mammograms;
  /// By mammogram, since the last move.
  std::map<const OpenedMammogram*, std::shared_ptr<const RegisteredBreast>> Breasts;
  std::vector<std::vector<Vector3>> Lines;
  std::optional<Vector3> Point;
  std::optional<std::array<double, 2>> Pixel;
  std::size_t PixelOf = 0;
  std::optional<Vector3> Centre;
  std::string Found;
};
}

#endif
