// SPDX-License-Identifier: Apache-2.0
#include "Private/Picture.h"
#include "mammoray/Foundation/Error.h"
#include "mammoray/Foundation/Numbers.h"
#include "mammoray/IO/AtomicFile.h"
#include "mammoray/Study/StudyPictures.h"

#include <algorithm>
#include <cmath>

namespace mammoray
{
namespace
{
constexpr int PanelWidth = 560;
constexpr int PictureHeight = 420;
constexpr int HistogramLeft = 90;
constexpr int HistogramRight = 20;
constexpr int HistogramTop = 44;
constexpr int HistogramBottom = 70;
constexpr int HistogramLegendWidth = 190;

void DrawPanel(Picture& picture, const HistogramPanel& panel, int offset)
{
  const std::size_t bins = panel.Groups.front().Counts.size();
  std::vector<double> totals(bins, 0.0);
  for (const HistogramPanel::Group& group : panel.Groups)
  {
    for (std::size_t bin = 0; bin < bins; ++bin)
    {
      totals[bin] += static_cast<double>(group.Counts[bin]);
    }
  }
  const double most = std::max(1.0, *std::max_element(totals.begin(), totals.end()));
  const int x0 = offset + HistogramLeft;
  const double width = PanelWidth - HistogramLeft - HistogramRight;
  const double height = PictureHeight - HistogramTop - HistogramBottom;
  const auto up = [&](double count) { return HistogramBottom + height * std::sqrt(count / most); };
  for (std::size_t bin = 0; bin < bins; ++bin)
  {
    // The scale holds for the bar as a whole; its parts are shares of its height.
    const double full = totals[bin] > 0 ? (up(totals[bin]) - HistogramBottom) / totals[bin] : 0;
    double below = 0;
    for (std::size_t group = 0; group < panel.Groups.size(); ++group)
    {
      const double above = below + static_cast<double>(panel.Groups[group].Counts[bin]);
      picture.Box(x0 + width * static_cast<double>(bin) / bins + 1, HistogramBottom + full * below,
        x0 + width * static_cast<double>(bin + 1) / bins - 1, HistogramBottom + full * above,
        GroupColor(group));
      below = above;
    }
  }
  picture.Box(x0 - 2, HistogramBottom - 2, x0 + width, HistogramBottom, PictureInk);
  picture.Box(x0 - 2, HistogramBottom - 2, x0, HistogramBottom + height, PictureInk);
  const double range = panel.Step * static_cast<double>(bins);
  const double step = TickStep(range, 8);
  for (double value = 0; value <= range * (1 + 1e-9); value += step)
  {
    const double x = x0 + width * value / range;
    picture.Box(x - 1, HistogramBottom - 7, x + 1, HistogramBottom, PictureInk);
    picture.Text(x, HistogramBottom - 18, 0.5, NumberText(value));
  }
  for (const double share : { 0.01, 0.1, 0.5, 1.0 })
  {
    const double count = std::floor(share * most);
    if (count >= 1 && (share == 1 || up(most) - up(count) > 20))
    {
      picture.Box(x0 - 7, up(count) - 1, x0, up(count) + 1, PictureInk);
      picture.Text(x0 - 12, up(count), 1, NumberText(count));
    }
  }
  picture.Text(x0 + width / 2, 18, 0.5, panel.Title);
  picture.Text(offset + 8, PictureHeight - 18, 0,
    "count (square-root scale; colours: shares of a bar)");
}
}

void WriteHistogramPicture(const std::vector<HistogramPanel>& panels, const std::string& path)
{
  if (panels.empty() || panels.front().Groups.empty() ||
    panels.front().Groups.front().Counts.empty())
  {
    throw InputError(path + ": expected cells to draw a histogram of, found none");
  }
  Picture picture(static_cast<int>(panels.size()) * PanelWidth + HistogramLegendWidth,
    PictureHeight);
  for (std::size_t index = 0; index < panels.size(); ++index)
  {
    DrawPanel(picture, panels[index], static_cast<int>(index) * PanelWidth);
  }
  const std::vector<HistogramPanel::Group>& groups = panels.front().Groups;
  PictureLegend legend;
  for (const HistogramPanel::Group& group : groups)
  {
    legend.emplace_back(group.Name, GroupColor(legend.size()));
  }
  picture.Legend(static_cast<double>(panels.size()) * PanelWidth, PictureHeight - HistogramTop,
    legend);
  WriteAtomicFile(path, picture.Png());
}
}
