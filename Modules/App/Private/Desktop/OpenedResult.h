// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_OpenedResult_h
#define mammoray_OpenedResult_h

#include "Private/BreastMark.h"
#include "Private/BreastScene.h"
#include "Private/CompressionWorker.h"
#include "Private/LiveMammogram.h"
#include "Private/MammogramPane.h"
#include "Private/SlicePanes.h"
#include "mammoray/Foundation/Progress.h"
#include "mammoray/Study/ResultFile.h"

#include "vtkNew.h"
#include "vtkTexture.h"

#include <memory>
#include <string>
#include <vector>

namespace mammoray
{
/// One mammogram of a result, with all that its views show.
struct OpenedMammogram
{
  OpenedMammogram(const ViewedBreast& viewed, const ProjectorOptions& projector);

  /// Points the camera of a scene with this breast at it.
  void LookAt(BreastScene& scene) const
  {
    scene.LookFromFront(this->Live.Placed(), this->Viewed.Laterality);
  }

  const ViewedBreast& Viewed;
  LiveMammogram Live;
  CompressionWorker Worker;
  MammogramPane Pane;
  BreastScene Squeezed;
  /// The picture on the receptor; a texture belongs to one window.
  vtkNew<vtkTexture> OnReceptor;
  /// Empty of meshes that no registration made.
  std::optional<ExpectedError> Expected;
};

/// A result and what its views show, made beside the window's thread.
struct OpenedResult
{
  OpenedResult(const ViewInput& input, const ProjectorOptions& projector,
    const ProgressCallback& progress);

  ViewInput Input;
  std::vector<ViewedBreast> Viewed;
  std::vector<std::unique_ptr<OpenedMammogram>> Mammograms;
  std::unique_ptr<BreastScene> AtRest;
  /// Null where there is neither MRI nor tissue.
  std::unique_ptr<SlicePanes> Slices;
  std::unique_ptr<BreastMark> Mark;
};
}

#endif
