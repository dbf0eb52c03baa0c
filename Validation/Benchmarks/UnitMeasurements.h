// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Benchmarks_UnitMeasurements_h
#define mammoray_Benchmarks_UnitMeasurements_h

#include "Measurements.h"

namespace mammoray::benchmarks
{
/**
 * What `mammoray project --unit realistic` adds to a plain picture of a 28 kV beam, and refraction,
 * of one scene in this process: times of each alone and of all together, in turn, and their ratios
 * to the plain picture. Projector and tables are set up before.
 */
Json MeasureUnit(const ExampleScene& scene, ProjectorOptions::Method method, double budget);
}

#endif
