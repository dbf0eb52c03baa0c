// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Benchmarks_Measurements_h
#define mammoray_Benchmarks_Measurements_h

#include "mammoray/XRay/ExampleScenes.h"

#include <nlohmann/json.hpp>

#include <functional>
#include <string>
#include <vector>

namespace mammoray::benchmarks
{
using Json = nlohmann::ordered_json;

/// Milliseconds of one call.
double Milliseconds(const std::function<void()>& run);

/// Median, least, most and number of some times, ms.
Json Summary(std::vector<double> milliseconds);

/**
 * Times the given works in turn, all of them a first time that is not counted, then round by round
 * until `budget` seconds or ten rounds are reached, two at least: ratios between them then share
 * whatever else the machine does. Gives one list of times (ms) per work.
 */
std::vector<std::vector<double>> InTurn(double budget,
  const std::vector<std::function<void()>>& works);

/// Median over the rounds of each round's quotient.
double MedianRatio(const std::vector<double>& numerators, const std::vector<double>& denominators);

/// Everything about one scene and one projector, in this process; see the keys for what.
Json MeasureScene(const std::string& sceneFile, ProjectorOptions::Method method, double budget);

/// What a program does once: reads mesh and tables, makes an image of a 28 kV beam, writes it.
void MakeImageOnce(const std::string& sceneFile, ProjectorOptions::Method method,
  const std::string& imageFile);

/// Times of set-up with a first frame, and of a further frame, for the plots.
Json MeasureRates(const ExampleScene& scene, ProjectorOptions::Method method, double budget);
}

#endif
