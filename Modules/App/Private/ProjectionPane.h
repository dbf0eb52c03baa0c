// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_ProjectionPane_h
#define mammoray_ProjectionPane_h

#include "Private/LiveProjection.h"
#include "Private/PicturePane.h"
#include "mammorayAppModule.h"

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace mammoray
{
/**
 * The log attenuation on the detector, bright where much is absorbed, row 0 on top; drawn on the
 * detector, mm: x along columns, y against rows from the middle of the first pixel.
 */
class MAMMORAYAPP_EXPORT ProjectionPane : public PicturePane
{
public:
  explicit ProjectionPane(LiveProjection& live);

  /// Takes the picture that `live` has now.
  void Update(LiveProjection& live, int divisor);
  /// Black is air, white the most that is absorbed but for a thousandth of the pixels.
  void ResetWindow();
  /// All of the picture.
  void Frame();
  /// A cross at a continuous column and row; nothing: none.
  void SetMark(const std::optional<std::array<double, 2>>& pixel);
  /// Continuous column and row at a place of the window, pixels; false beside the picture.
  bool PixelAt(int x, int y, double& column, double& row) const;
  /// Of the nearest pixels along the overlay's ruler, as far as it lies on the picture.
  struct Profile
  {
    std::vector<double> Mm;
    std::vector<double> LogAttenuation;
  };
  Profile AlongRuler() const;

private:
  void Compose() override;
  bool IsOnPicture(double column, double row) const;

  XRayDetector Grid;
  double ColumnMm;
  double RowMm;
  std::vector<float> Values;
  int Columns = 0;
  int Rows = 0;
};
}

#endif
