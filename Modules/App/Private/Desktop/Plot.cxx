// SPDX-License-Identifier: Apache-2.0
#include "Private/Desktop/Plot.h"

#include <QPainter>
#include <QPolygonF>

#include <algorithm>
#include <utility>

namespace mammoray
{
namespace
{
constexpr int TextLines = 7;
constexpr int Margin = 4;
}

Plot::Plot(const QString& name)
{
  this->setObjectName(name);
  this->setAccessibleName(name);
  this->setMinimumHeight(this->sizeHint().height());
}

QSize Plot::sizeHint() const
{
  return { 220, TextLines * this->fontMetrics().height() };
}

void Plot::SetCurve(std::vector<double> x, std::vector<double> y, const QString& axis)
{
  this->X = std::move(x);
  this->Y = std::move(y);
  this->Axis = axis;
  this->update();
}

void Plot::paintEvent(QPaintEvent*)
{
  QPainter painter(this);
  painter.setRenderHint(QPainter::Antialiasing);
  const int text = this->fontMetrics().height();
  const QRectF frame = this->rect().adjusted(Margin, Margin, -Margin, -Margin - text);
  painter.fillRect(frame, this->palette().base());
  painter.setPen(this->palette().color(QPalette::WindowText));
  painter.drawText(this->rect().adjusted(Margin, 0, -Margin, 0), Qt::AlignBottom | Qt::AlignHCenter,
    this->Axis);
  if (this->X.size() < 2 || this->X.back() <= this->X.front())
  {
    return;
  }
  painter.drawText(this->rect().adjusted(Margin, 0, -Margin, 0), Qt::AlignBottom | Qt::AlignLeft,
    QString::number(this->X.front(), 'g', 3));
  painter.drawText(this->rect().adjusted(Margin, 0, -Margin, 0), Qt::AlignBottom | Qt::AlignRight,
    QString::number(this->X.back(), 'g', 3));
  const double top = std::max(*std::max_element(this->Y.begin(), this->Y.end()), 1e-300);
  QPolygonF curve;
  for (std::size_t index = 0; index < this->X.size(); ++index)
  {
    const double across = (this->X[index] - this->X.front()) / (this->X.back() - this->X.front());
    curve << QPointF(frame.left() + across * frame.width(),
      frame.bottom() - this->Y[index] / top * (frame.height() - Margin));
  }
  painter.setPen(QPen(this->palette().color(QPalette::Highlight), 1.5));
  painter.drawPolyline(curve);
}
}
