// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_CompressionWorker_h
#define mammoray_CompressionWorker_h

#include "Private/ReducedEquilibria.h"
#include "mammoray/App/ViewedBreast.h"
#include "mammorayAppModule.h"

#include <condition_variable>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

namespace mammoray
{
/// An equilibrium that was asked for, or why there is none.
struct CompressedAnatomy
{
  BreastPose Pose;
  /// 3 x pointCount, mm, volume frame; empty where Error says why.
  std::vector<double> Points;
  double PaddleForceN = 0;
  double Seconds = 0;
  /// Of how many equilibria it was made without solving; 0: it was solved for.
  int ReducedFrom = 0;
  std::string Error;
};

/**
 * Compresses a breast beside the window's thread. The simulation is made when it is first needed;
 * of several poses asked for while it works, the last one counts. While poses near known equilibria
 * come one after the other it waits for the last, since those equilibria answer at once.
 */
class MAMMORAYAPP_EXPORT CompressionWorker
{
public:
  explicit CompressionWorker(const ViewedBreast& viewed);
  /// Stops the work.
  ~CompressionWorker();

  void Ask(const BreastPose& pose);
  /// What the equilibria found so far say of the pose, in some milliseconds; nothing where they are
  /// too far. Of the window's thread.
  std::optional<CompressedAnatomy> Reduced(const BreastPose& pose) const;
  /// What was finished since the last call.
  std::optional<CompressedAnatomy> Take();
  /// What it does, for the user; empty when it rests.
  std::string Stage() const;

private:
  void Run();
  std::optional<BreastPose> NextPose();
  void Remember(const BreastPose& pose);
  CompressedAnatomy Compress(const BreastPose& pose);
  CompressionState Equilibrium(const BreastPose& pose, const ProgressCallback& progress);
  bool GoesOn(const char* stage);

  const ViewedBreast& Viewed;
  // Of the worker's thread only.
  std::optional<BreastModel> Model;
  std::optional<CompressionState> State;

  mutable std::mutex Mutex;
  std::condition_variable Wake;
  std::optional<BreastPose> Asked;
  /// How often was asked.
  long Asks = 0;
  std::optional<CompressedAnatomy> Finished;
  ReducedEquilibria Known;
  /// The anatomy in the Model, once something is known.
  const Embedding* Anatomy = nullptr;
  std::string Doing;
  bool Ending = false;
  std::thread Thread;
};
}

#endif
