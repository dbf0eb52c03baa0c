// SPDX-License-Identifier: Apache-2.0
#include "Private/SeriesSplit.h"

#include "mammoray/Foundation/Error.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <map>
#include <set>

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

/// Places along the normal, to a hundredth of a millimetre; slices that say no place share one.
long PlaceOf(const DicomHeader& slice)
{
  return std::lround(HeightOf(slice) * 100);
}

bool EachAtItsPlace(const Slices& slices)
{
  std::set<long> places;
  return std::all_of(slices.begin(), slices.end(),
    [&](const DicomHeader& slice) { return places.insert(PlaceOf(slice)).second; });
}

std::size_t MostAtOnePlace(const Slices& slices)
{
  std::map<long, std::size_t> counts;
  std::size_t most = 0;
  for (const DicomHeader& slice : slices)
  {
    most = std::max(most, ++counts[PlaceOf(slice)]);
  }
  return most;
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
  std::set<long> distinct;
  for (const DicomHeader& slice : slices)
  {
    distinct.insert(PlaceOf(slice));
  }
  // Fewer make no volume, whatever they are.
  if (distinct.size() < FewestSlicesOfBreast || distinct.size() == slices.size())
  {
    return { slices };
  }
  for (const auto& key : PhaseKeys)
  {
    std::map<std::string, Slices> parts;
    for (const DicomHeader& slice : slices)
    {
      parts[key(slice)].push_back(slice);
    }
    // As many as lie at one place: otherwise the key tells something else.
    bool apart = parts.size() == MostAtOnePlace(slices);
    for (const auto& [value, part] : parts)
    {
      apart = apart && EachAtItsPlace(part);
    }
    if (apart)
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
  std::map<long, Slices> places;
  for (const DicomHeader& slice : slices)
  {
    places[PlaceOf(slice)].push_back(slice);
  }
  std::vector<Slices> phases(places.begin()->second.size());
  for (auto& [place, here] : places)
  {
    std::stable_sort(here.begin(), here.end(),
      [](const DicomHeader& a, const DicomHeader& b)
      { return a.InstanceNumber.value_or(0) < b.InstanceNumber.value_or(0); });
    if (here.size() != phases.size())
    {
      return { slices };
    }
    for (std::size_t phase = 0; phase < here.size(); ++phase)
    {
      phases[phase].push_back(here[phase]);
    }
  }
  return phases;
}

SeriesCandidate CandidateOf(Slices slices)
{
  SeriesCandidate candidate;
  std::stable_sort(slices.begin(), slices.end(),
    [](const DicomHeader& a, const DicomHeader& b) { return HeightOf(a) < HeightOf(b); });
  // The first in time speaks for all.
  candidate.First = *std::min_element(slices.begin(), slices.end(),
    [](const DicomHeader& a, const DicomHeader& b) { return MomentOf(a) < MomentOf(b); });
  for (const DicomHeader& slice : slices)
  {
    candidate.Series.Slices.push_back({ slice.Path, slice.Frame });
  }
  if (slices.size() > 1 && slices.front().Position)
  {
    const double last = HeightOf(slices.back()) - HeightOf(slices.front());
    candidate.Series.SliceSpacingMm = last / static_cast<double>(slices.size() - 1);
  }
  try
  {
    const SliceOrder order = FindSliceOrder(slices);
    candidate.Series.Grid = order.Grid;
    for (std::size_t layer = 0; layer < order.Order.size(); ++layer)
    {
      const DicomHeader& slice = slices[order.Order[layer]];
      candidate.Series.Slices[layer] = { slice.Path, slice.Frame };
    }
  }
  catch (const InputError&)
  {
    candidate.Series.Grid.reset();
  }
  std::set<std::string> known;
  for (const DicomSlice& slice : candidate.Series.Slices)
  {
    if (known.insert(slice.Path).second)
    {
      candidate.Series.Files.push_back(slice.Path);
    }
  }
  return candidate;
}

/// Slabs of slices that are apart by more than three of their distances, each a volume of its own:
/// sagittal slices of both breasts in one series. One where there are no such slabs.
std::vector<Slices> SplitSlabs(Slices slices)
{
  std::stable_sort(slices.begin(), slices.end(),
    [](const DicomHeader& a, const DicomHeader& b) { return HeightOf(a) < HeightOf(b); });
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

std::vector<SeriesCandidate> SplitIntoVolumes(const std::vector<DicomHeader>& slices)
{
  std::map<std::string, Slices> series;
  for (const DicomHeader& slice : slices)
  {
    series[slice.SeriesInstanceUid].push_back(slice);
  }
  std::vector<SeriesCandidate> volumes;
  for (const auto& [uid, members] : series)
  {
    if (DirectionsOf(members).size() > 1)
    {
      // Made to plan the others.
      volumes.push_back(CandidateOf(members));
      volumes.back().Series.LeftOut = "localizer (slices in several directions)";
      continue;
    }
    std::map<std::string, Slices> kinds;
    for (const DicomHeader& slice : members)
    {
      kinds[KindOf(slice)].push_back(slice);
    }
    for (const auto& [kind, alike] : kinds)
    {
      const std::vector<Slices> phases = SplitPhases(alike);
      for (std::size_t phase = 0; phase < phases.size(); ++phase)
      {
        for (Slices& slab : SplitSlabs(phases[phase]))
        {
          volumes.push_back(CandidateOf(std::move(slab)));
          volumes.back().Series.Phase = static_cast<int>(phase) + 1;
          volumes.back().Series.Phases = static_cast<int>(phases.size());
        }
      }
    }
  }
  return volumes;
}
}
