// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_SurfaceView_h
#define mammoray_SurfaceView_h

#include "SceneOptions.h"
#include "mammoray/App/SurfaceViewer.h"

namespace mammoray
{
/// The surfaces of 'mammoray view'. Throws InputError.
ViewedScene ReadViewedScene(const SceneArguments& arguments);
}

#endif
