// SPDX-License-Identifier: Apache-2.0
#include "Private/CompressionWorker.h"

#include "mammoray/Foundation/Error.h"

#include <chrono>

namespace mammoray
{
CompressionWorker::CompressionWorker(const ViewedBreast& viewed)
  : Viewed(viewed)
  , Thread([this] { this->Run(); })
{
}

CompressionWorker::~CompressionWorker()
{
  {
    const std::lock_guard lock(this->Mutex);
    this->Ending = true;
  }
  this->Wake.notify_one();
  this->Thread.join();
}

void CompressionWorker::Ask(const BreastPose& pose)
{
  {
    const std::lock_guard lock(this->Mutex);
    this->Asked = pose;
    this->Doing = this->Doing.empty() ? "compression" : this->Doing;
  }
  this->Wake.notify_one();
}

std::optional<CompressedAnatomy> CompressionWorker::Take()
{
  const std::lock_guard lock(this->Mutex);
  std::optional<CompressedAnatomy> taken;
  taken.swap(this->Finished);
  return taken;
}

std::string CompressionWorker::Stage() const
{
  const std::lock_guard lock(this->Mutex);
  return this->Doing;
}

bool CompressionWorker::GoesOn(const char* stage)
{
  const std::lock_guard lock(this->Mutex);
  this->Doing = stage;
  return !this->Ending;
}

void CompressionWorker::Run()
{
  for (;;)
  {
    BreastPose pose;
    {
      std::unique_lock lock(this->Mutex);
      this->Wake.wait(lock, [this] { return this->Asked || this->Ending; });
      if (this->Ending)
      {
        return;
      }
      pose = *this->Asked;
      this->Asked.reset();
    }
    CompressedAnatomy answer = this->Compress(pose);
    const std::lock_guard lock(this->Mutex);
    this->Finished = std::move(answer);
    this->Doing = this->Asked ? "compression" : "";
  }
}

CompressedAnatomy CompressionWorker::Compress(const BreastPose& pose)
{
  const auto begin = std::chrono::steady_clock::now();
  const ProgressCallback progress = [this](double, const char* stage)
  { return this->GoesOn(stage); };
  CompressedAnatomy answer;
  answer.Pose = pose;
  try
  {
    if (!this->Model)
    {
      this->Model.emplace(this->Viewed.Anatomy, this->Viewed.Materials, this->Viewed.Mechanics,
        progress);
    }
    BreastBody& body = this->Model->Body();
    const UnitPlacement placement{ this->Viewed.Axes, this->Viewed.Anchor,
      this->Viewed.Breast.Unit };
    std::optional<CompressionState> start;
    start.swap(this->State);
    try
    {
      this->State = body.Compress(placement, pose, start ? &*start : nullptr, progress);
    }
    catch (const ConvergenceError&)
    {
      if (!start)
      {
        throw;
      }
      // The way from there was blocked; the one from outside may not be.
      this->State = body.Compress(placement, pose, nullptr, progress);
    }
    answer.Points = this->Model->AnatomyPoints().Map(this->State->Positions);
    answer.PaddleForceN = this->State->PaddleForceN;
  }
  catch (const std::exception& error) // also Interrupted; nothing may leave the thread
  {
    answer.Error = error.what();
  }
  answer.Seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return answer;
}
}
