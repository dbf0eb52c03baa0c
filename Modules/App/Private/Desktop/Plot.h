// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Plot_h
#define mammoray_Plot_h

#include <QWidget>

#include <vector>

namespace mammoray
{
/// A curve over an axis with a name, as high as its largest value.
class Plot : public QWidget
{
public:
  explicit Plot(const QString& name);
  /// As many of both; x increases. Fewer than two: an empty plot.
  void SetCurve(std::vector<double> x, std::vector<double> y, const QString& axis);
  QSize sizeHint() const override;

protected:
  void paintEvent(QPaintEvent* event) override;

private:
  std::vector<double> X;
  std::vector<double> Y;
  QString Axis;
};
}

#endif
