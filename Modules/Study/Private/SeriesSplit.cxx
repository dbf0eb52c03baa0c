// SPDX-License-Identifier: Apache-2.0
#include "Private/HeaderRules.h"

#include "mammoray/Foundation/Error.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <map>
#include <numeric>
#include <set>
#include <type_traits>

namespace mammoray
{
namespace
{
using Slices = std::vector<DicomHeader>;

std::string Rounded(double value, double step)
{
  return std::to_string(std::lround(value / step)) + ';';
}

/// What slices of one volume share.
std::string KindOf(const DicomHeader& header)
{
  std::string key;
  for (const std::string& value : header.ImageType)
  {
    key += value + '\\';
  }
  key += ';' + std::to_string(header.Rows) + ';' + std::to_string(header.Columns) + ';';
  key += Rounded(header.EchoTimeMs.value_or(0), 0.05);
  key += header.Position ? "placed;" : "nowhere;";
  for (const Vector3& axis : { header.AlongRow, header.AlongColumn })
  {
    for (const double component : axis)
    {
      key += Rounded(component, 0.01);
    }
  }
  return key + Rounded(header.RowSpacingMm, 1e-3) + Rounded(header.ColumnSpacingMm, 1e-3);
}

double HeightOf(const DicomHeader& slice)
{
  return slice.Position ? Dot(*slice.Position, Cross(slice.AlongRow, slice.AlongColumn)) : 0;
}

bool IsLower(const DicomHeader& a, const DicomHeader& b)
{
  return HeightOf(a) < HeightOf(b);
}

/// Places along the normal, to a hundredth of a millimetre; slices without a place share one.
long LayerOf(const DicomHeader& slice)
{
  return std::lround(HeightOf(slice) * 100);
}

/// Slices with the same key, in the order of the keys.
template <typename KeyOf>
auto GroupBy(const Slices& slices, const KeyOf& keyOf)
{
  std::map<std::decay_t<decltype(keyOf(slices.front()))>, Slices> groups;
  for (const DicomHeader& slice : slices)
  {
    groups[keyOf(slice)].push_back(slice);
  }
  return groups;
}

std::string NumberKey(const std::optional<double>& number)
{
  char text[32];
  std::snprintf(text, sizeof text, "%016.4f", number.value_or(0));
  return text;
}

/// What may tell phases apart, the surest first; texts that sort in the order of time.
const std::function<std::string(const DicomHeader&)> PhaseKeys[] = {
  [](const DicomHeader& slice) { return NumberKey(slice.TemporalPosition); },
  [](const DicomHeader& slice) { return NumberKey(slice.AcquisitionNumber); },
  [](const DicomHeader& slice) { return NumberKey(slice.TriggerTimeMs); },
  [](const DicomHeader& slice) { return slice.AcquisitionDate + slice.AcquisitionTime; },
  [](const DicomHeader& slice) { return slice.ContentTime; },
  [](const DicomHeader& slice) { return NumberKey(slice.DiffusionBValue); },
};

/// The phases of slices of one kind, the first first.
std::vector<Slices> SplitPhases(const Slices& slices)
{
  auto places = GroupBy(slices, LayerOf);
  // Fewer make no volume, whatever they are.
  if (places.size() < FewestSlicesOfBreast || places.size() == slices.size())
  {
    return { slices };
  }
  std::size_t most = 0;
  for (const auto& [place, here] : places)
  {
    most = std::max(most, here.size());
  }
  for (const auto& key : PhaseKeys)
  {
    auto parts = GroupBy(slices, key);
    // As many as lie at one place: otherwise the key tells something else.
    if (parts.size() == most &&
      std::all_of(parts.begin(), parts.end(),
        [](const auto& part)
        { return GroupBy(part.second, LayerOf).size() == part.second.size(); }))
    {
      std::vector<Slices> phases;
      phases.reserve(parts.size());
      for (auto& [value, part] : parts)
      {
        phases.push_back(std::move(part));
      }
      return phases;
    }
  }
  // In the order in which they were numbered, where every place has as many.
  std::vector<Slices> phases(most);
  for (auto& [place, here] : places)
  {
    if (here.size() != most)
    {
      return { slices };
    }
    std::stable_sort(here.begin(), here.end(),
      [](const DicomHeader& a, const DicomHeader& b)
      { return a.InstanceNumber.value_or(0) < b.InstanceNumber.value_or(0); });
    for (std::size_t phase = 0; phase < most; ++phase)
    {
      phases[phase].push_back(here[phase]);
    }
  }
  return phases;
}

/// Why slices in the order of their heights make no grid.
std::string WhyIrregular(const Slices& slices, const std::string& otherwise)
{
  std::vector<double> gaps;
  for (std::size_t n = 1; n < slices.size(); ++n)
  {
    gaps.push_back(HeightOf(slices[n]) - HeightOf(slices[n - 1]));
  }
  const auto doubled = static_cast<std::size_t>(
    std::count_if(gaps.begin(), gaps.end(), [](double gap) { return gap < 1e-3; }));
  char text[160];
  if (doubled > 0)
  {
    std::snprintf(text, sizeof text,
      "doubled slices (%zu of %zu lie where another one does: duplicates, or phases that nothing "
      "tells apart)",
      doubled, slices.size());
    return text;
  }
  if (gaps.size() < 2)
  {
    return otherwise;
  }
  std::vector<double> sorted = gaps;
  std::sort(sorted.begin(), sorted.end());
  const double usual = sorted[sorted.size() / 2];
  long missing = 0;
  double where = 0;
  for (std::size_t n = 0; n < gaps.size(); ++n)
  {
    const double steps = gaps[n] / usual;
    if (std::abs(steps - std::round(steps)) > 0.05 * std::round(steps))
    {
      std::snprintf(text, sizeof text, "slices at uneven distances (%.2f to %.2f mm)",
        sorted.front(), sorted.back());
      return text;
    }
    const long lost = std::lround(steps) - 1;
    where = lost > 0 && missing == 0 ? static_cast<double>(n) + 1 : where;
    missing += lost;
  }
  if (missing == 0)
  {
    return otherwise;
  }
  std::snprintf(text, sizeof text,
    "missing slices (%ld, the first after slice %.0f; %zu slices, %.2f mm apart on average)",
    missing, where, slices.size(),
    (HeightOf(slices.back()) - HeightOf(slices.front())) / static_cast<double>(gaps.size()));
  return text;
}

StudySeries VolumeOf(Slices slices)
{
  StudySeries series;
  std::stable_sort(slices.begin(), slices.end(), IsLower);
  // The first in time speaks for all.
  series.Header = *std::min_element(slices.begin(), slices.end(),
    [](const DicomHeader& a, const DicomHeader& b) { return MomentOf(a) < MomentOf(b); });
  if (slices.size() > 1 && slices.front().Position)
  {
    const double last = HeightOf(slices.back()) - HeightOf(slices.front());
    series.SliceSpacingMm = last / static_cast<double>(slices.size() - 1);
  }
  std::vector<std::size_t> order(slices.size());
  std::iota(order.begin(), order.end(), std::size_t{ 0 });
  try
  {
    SliceOrder found = FindSliceOrder(slices);
    series.Grid = found.Grid;
    order = std::move(found.Order);
  }
  catch (const InputError& error)
  {
    series.WhyNoGrid = slices.front().Position ? WhyIrregular(slices, error.what()) : "";
    series.DoubledFiles = series.WhyNoGrid.starts_with("doubled") ? error.what() : "";
  }
  std::set<std::string> known;
  for (const std::size_t index : order)
  {
    const DicomHeader& slice = slices[index];
    series.Slices.push_back({ slice.Path, slice.Frame });
    if (known.insert(slice.Path).second)
    {
      series.Files.push_back(slice.Path);
    }
  }
  return series;
}

/// Slabs of slices that are apart by more than three of their distances, each a volume of its own:
/// sagittal slices of both breasts in one series. One where there are no such slabs.
std::vector<Slices> SplitSlabs(Slices slices)
{
  std::stable_sort(slices.begin(), slices.end(), IsLower);
  std::vector<double> gaps;
  for (std::size_t n = 1; n < slices.size(); ++n)
  {
    gaps.push_back(HeightOf(slices[n]) - HeightOf(slices[n - 1]));
  }
  if (gaps.size() < 2 * FewestSlicesOfBreast)
  {
    return { slices };
  }
  std::vector<double> sorted = gaps;
  std::nth_element(sorted.begin(), sorted.begin() + sorted.size() / 2, sorted.end());
  const double usual = sorted[sorted.size() / 2];
  std::vector<Slices> slabs{ { slices.front() } };
  for (std::size_t n = 1; n < slices.size(); ++n)
  {
    if (gaps[n - 1] > 3 * usual)
    {
      slabs.emplace_back();
    }
    slabs.back().push_back(slices[n]);
  }
  // Of what misses slices here and there, no part is a breast.
  const bool whole = std::all_of(slabs.begin(), slabs.end(),
    [](const Slices& slab) { return slab.size() >= FewestSlicesOfBreast; });
  return whole && usual > 0 ? slabs : std::vector<Slices>{ slices };
}

/// Directions of the slices of a series, as far as planes of a body differ.
std::set<std::string> DirectionsOf(const Slices& slices)
{
  std::set<std::string> directions;
  for (const DicomHeader& slice : slices)
  {
    const Vector3 normal = Cross(slice.AlongRow, slice.AlongColumn);
    if (slice.Position)
    {
      directions.insert(Rounded(std::abs(normal[0]), 0.5) + Rounded(std::abs(normal[1]), 0.5) +
        Rounded(std::abs(normal[2]), 0.5));
    }
  }
  return directions;
}
}

std::vector<StudySeries> SplitIntoVolumes(const std::vector<DicomHeader>& slices)
{
  const auto seriesOf = [](const DicomHeader& slice) { return slice.SeriesInstanceUid; };
  std::vector<StudySeries> volumes;
  for (const auto& [uid, members] : GroupBy(slices, seriesOf))
  {
    if (DirectionsOf(members).size() > 1)
    {
      // Made to plan the others.
      volumes.push_back(VolumeOf(members));
      volumes.back().LeftOut = "localizer (slices in several directions)";
      continue;
    }
    for (const auto& [kind, alike] : GroupBy(members, KindOf))
    {
      const std::vector<Slices> phases = SplitPhases(alike);
      for (std::size_t phase = 0; phase < phases.size(); ++phase)
      {
        for (Slices& slab : SplitSlabs(phases[phase]))
        {
          volumes.push_back(VolumeOf(std::move(slab)));
          volumes.back().Phase = static_cast<int>(phase) + 1;
          volumes.back().Phases = static_cast<int>(phases.size());
        }
      }
    }
  }
  return volumes;
}
}
