// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Benchmarks_SceneFile_h
#define mammoray_Benchmarks_SceneFile_h

#include "mammoray/XRay/ExampleScenes.h"

#include <string>

namespace mammoray::benchmarks
{
/// A scene as raw arrays of this machine behind a line of JSON: what a program that holds its mesh
/// in memory starts from, to be read by a process of its own.
void WriteScene(const ExampleScene& scene, const std::string& path);
ExampleScene ReadScene(const std::string& path);
}

#endif
