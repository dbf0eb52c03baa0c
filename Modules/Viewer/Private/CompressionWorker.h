// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_CompressionWorker_h
#define mammoray_CompressionWorker_h

#include "mammoray/Viewer/ViewedBreast.h"

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
  std::string Error;
};

/**
 * Compresses a breast beside the window's thread. The simulation is made when it is first needed;
 * of several poses asked for while it works, the last one counts.
 */
class CompressionWorker
{
public:
  explicit CompressionWorker(const ViewedBreast& viewed);
  /// Stops the work.
  ~CompressionWorker();

  void Ask(const BreastPose& pose);
  /// What was finished since the last call.
  std::optional<CompressedAnatomy> Take();
  /// What it does, for the user; empty when it rests.
  std::string Stage() const;

private:
  void Run();
  CompressedAnatomy Compress(const BreastPose& pose);
  bool GoesOn(const char* stage);

  const ViewedBreast& Viewed;
  // Of the worker's thread only.
  std::optional<BreastModel> Model;
  std::optional<CompressionState> State;

  mutable std::mutex Mutex;
  std::condition_variable Wake;
  std::optional<BreastPose> Asked;
  std::optional<CompressedAnatomy> Finished;
  std::string Doing;
  bool Ending = false;
  std::thread Thread;
};
}

#endif
