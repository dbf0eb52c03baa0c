// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_MammogramPane_h
#define mammoray_MammogramPane_h

#include "Private/LiveMammogram.h"
#include "Private/PicturePane.h"
#include "mammorayAppModule.h"

#include <array>
#include <vector>

namespace mammoray
{
/**
 * The synthetic mammogram blended with the real one, as mammograms are hung: chest wall at the left
 * for the left breast, lateral side or head up. Drawn in the gantry frame's x and y, mm.
 */
class MAMMORAYAPP_EXPORT MammogramPane : public PicturePane
{
public:
  MammogramPane(const ViewedBreast& viewed, LiveMammogram& live);

  /// Takes the picture that `live` has now.
  void Update(LiveMammogram& live, int divisor);
  /// How the two are shown together.
  enum class Comparison
  {
    Blend,        ///< The real one's share.
    Checkerboard, ///< In squares of a centimetre.
    Swipe         ///< The real one as far as its share of the columns.
  };
  void SetComparison(Comparison comparison);
  /// 0: synthetic only, 1: real only.
  void SetBlend(double real);
  void ResetWindow();
  /// Crosses, closed lines and an open one on the receptor, gantry x and y.
  void SetMark(const std::vector<ReceptorPoint>& points,
    const std::vector<std::vector<ReceptorPoint>>& loops,
    const std::vector<ReceptorPoint>& line = {});
  /// All of the breast in its pane.
  void Frame();
  /// Continuous column and row at a place of the window, pixels; false beside the picture.
  bool PixelAt(int x, int y, double& column, double& row) const;

private:
  void Compose() override;
  /// The share of the real mammogram in a pixel, [0, 1].
  float ShareAt(int column, int row) const;

  ReceptorGrid Grid;
  double Right = 1;
  double Up = 1;
  /// Grey of the real mammogram, [0, 1], by divisor; empty without one.
  std::array<std::vector<float>, 2> RealGrey;
  /// Log attenuations that are 0 and 1 of the grey values, of which Low and High are shown.
  double Black = 0;
  double White = 1;
  double Real = 0;
  Comparison Compared = Comparison::Blend;
  std::vector<float> Synthetic;
  /// Pixels of the real breast, not 0; empty without one.
  std::vector<unsigned char> Breast;
  int Divisor = 1;
};
}

#endif
