// SPDX-License-Identifier: Apache-2.0
#include "Private/Desktop/SearchPictures.h"

#include "Private/GreyLevel.h"

#include <QPainter>

#include <algorithm>
#include <cmath>
#include <utility>

namespace mammoray
{
namespace
{
constexpr double ShownSigmas = 2;

/// Log attenuation in grey: inside the breast's mask from two standard deviations below the mean to
/// two above it, since the scale of a mammogram for presentation is arbitrary.
QImage GreyOf(const std::vector<float>& values, const RegistrationTarget& target)
{
  const GreyLevel level =
    LevelOf(values, [&](std::size_t pixel) { return target.BreastMask[pixel] != 0; });
  QImage image(target.Grid.Columns, target.Grid.Rows, QImage::Format_Grayscale8);
  for (int row = 0; row < image.height(); ++row)
  {
    uchar* line = image.scanLine(row);
    for (int column = 0; column < image.width(); ++column)
    {
      const double score = (values[target.Grid.Index(column, row)] - level.Mean) / level.Deviation;
      const double share = 0.5 + 0.5 * score / ShownSigmas;
      line[column] = static_cast<uchar>(255 * std::clamp(share, 0.0, 1.0));
    }
  }
  return image;
}
}

SearchPictures::SearchPictures()
{
  this->setObjectName("searchPictures");
  this->setMinimumHeight(120);
}

std::vector<SearchPictures::Pair> SearchPictures::Take(const std::vector<SearchedView>& views)
{
  std::vector<Pair> pairs;
  for (const SearchedView& view : views)
  {
    const ReceptorGrid& grid = view.Target.Grid;
    const SyntheticMammogram synthetic =
      Synthesize(view.Breast, grid, ChestWallCentre(view.Target), 1);
    Pair& pair = pairs.emplace_back();
    pair.Target = GreyOf(view.Target.LogAttenuation, view.Target);
    pair.Synthetic = GreyOf(synthetic.LogAttenuation, view.Target);
    pair.Aspect = grid.RowSpacingMm() / grid.ColumnSpacingMm();
    for (const ReceptorPoint& point : synthetic.Outline)
    {
      const std::array<double, 2> at = grid.IndexOf(point);
      pair.Outline << QPointF(at[0] + 0.5, at[1] + 0.5);
    }
  }
  return pairs;
}

void SearchPictures::SetPairs(std::vector<Pair> pairs)
{
  this->Shown = std::move(pairs);
  this->update();
}

void SearchPictures::paintEvent(QPaintEvent*)
{
  QPainter painter(this);
  painter.setRenderHint(QPainter::Antialiasing);
  painter.setRenderHint(QPainter::SmoothPixmapTransform);
  const double text = this->fontMetrics().height();
  const double width = this->width() / (2.0 * std::max<double>(1, this->Shown.size()));
  double left = 0;
  for (const Pair& pair : this->Shown)
  {
    for (const auto& [image, name] :
      { std::pair{ &pair.Target, tr("Target") }, { &pair.Synthetic, tr("Synthetic") } })
    {
      painter.drawText(QRectF(left, 0, width, text), Qt::AlignCenter, name);
      const double scale = std::min((width - 4) / image->width(),
        (this->height() - text) / (image->height() * pair.Aspect));
      painter.save();
      painter.translate(left + 0.5 * (width - scale * image->width()), text);
      painter.scale(scale, scale * pair.Aspect);
      painter.drawImage(0, 0, *image);
      painter.setClipRect(image->rect());
      QPen pen(QColor(255, 170, 0), 1.5);
      pen.setCosmetic(true);
      painter.setPen(pen);
      painter.drawPolyline(pair.Outline);
      painter.restore();
      left += width;
    }
  }
}
}
