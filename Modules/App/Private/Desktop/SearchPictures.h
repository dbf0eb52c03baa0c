// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_SearchPictures_h
#define mammoray_SearchPictures_h

#include "mammoray/Registration/Registration.h"

#include <QCoreApplication>
#include <QImage>
#include <QPolygonF>
#include <QWidget>

#include <vector>

namespace mammoray
{
/// Each mammogram of a search beside the synthetic one of the last accepted step, whose outline is
/// drawn on both.
class SearchPictures : public QWidget
{
  Q_DECLARE_TR_FUNCTIONS(SearchPictures)
public:
  struct Pair
  {
    QImage Target;
    QImage Synthetic;
    /// Pixels of the images.
    QPolygonF Outline;
    /// Height of a pixel over its width.
    double Aspect = 1;
  };

  SearchPictures();
  /// X-rays the breasts of a step, beside the window's thread.
  static std::vector<Pair> Take(const std::vector<SearchedView>& views);
  void SetPairs(std::vector<Pair> pairs);
  const std::vector<Pair>& Pairs() const { return this->Shown; }

protected:
  void paintEvent(QPaintEvent* event) override;

private:
  std::vector<Pair> Shown;
};
}

#endif
