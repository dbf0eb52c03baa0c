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
#include "mammorayAppModule.h"

#include "vtkSmartPointer.h"

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace mammoray
{
/// One mammogram of a breast, with the unit that makes it and all that its views show.
struct MAMMORAYAPP_EXPORT OpenedMammogram
{
  OpenedMammogram(const ViewedBreast& viewed, const ProjectorOptions& projector);

  /// Points the camera of a scene with this breast at it.
  void LookAt(BreastScene& scene) const
  {
    scene.LookFromFront(this->Live.Placed(), this->Viewed.Laterality);
  }
  /// Projects the breast as it stands, and draws the unit around it.
  void Update(int divisor);
  /// Asks the worker for the equilibrium between the plates as they stand. What it knows of it
  /// already is shown and returned.
  std::optional<CompressedAnatomy> Compress();
  /// Shows what the worker has finished, and returns it; if the plates have moved on since, what it
  /// knows of their pose now. After an error nothing is shown.
  std::optional<CompressedAnatomy> TakeEquilibrium();
  /// Shows other points of the anatomy, 3 x pointCount; with the next Update.
  void SetPoints(const std::vector<double>& points);
  /// "cc: " where there are several mammograms, else empty.
  std::string Prefix() const { return this->Viewed.View.empty() ? "" : this->Viewed.View + ": "; }

  const ViewedBreast& Viewed;
  LiveMammogram Live;
  CompressionWorker Worker;
  MammogramPane Pane;
  BreastScene Squeezed;

private:
  vtkSmartPointer<vtkTexture> OnReceptor;
};

/// A breast and what its views show, made beside the window's thread.
struct MAMMORAYAPP_EXPORT OpenedResult
{
  /// `viewed`: of one breast one for each mammogram, at least one.
  OpenedResult(std::vector<ViewedBreast> viewed, const ProjectorOptions& projector,
    const ProgressCallback& progress = {});

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
