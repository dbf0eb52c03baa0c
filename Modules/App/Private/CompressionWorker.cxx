// SPDX-License-Identifier: Apache-2.0
#include "Private/CompressionWorker.h"

#include "mammoray/Foundation/Error.h"

#include <chrono>

namespace mammoray
{
namespace
{
/// A pose that stays for so long is at rest.
constexpr std::chrono::milliseconds PoseRestTime{ 150 };
/// Farther from known equilibria, mm or degrees, one is solved for on the way, too.
constexpr double FarFromKnown = 5;
}

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
    ++this->Asks;
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

/// The pose to solve for; nothing at the end.
std::optional<BreastPose> CompressionWorker::NextPose()
{
  std::unique_lock lock(this->Mutex);
  this->Wake.wait(lock, [this] { return this->Asked || this->Ending; });
  while (!this->Ending && this->Known.Distance(*this->Asked) < FarFromKnown)
  {
    const long before = this->Asks;
    const bool moves =
      this->Wake.wait_for(lock, PoseRestTime, [&] { return this->Asks != before || this->Ending; });
    if (!moves)
    {
      break;
    }
  }
  std::optional<BreastPose> pose;
  if (!this->Ending)
  {
    pose.swap(this->Asked);
  }
  return pose;
}

void CompressionWorker::Run()
{
  while (const std::optional<BreastPose> pose = this->NextPose())
  {
    CompressedAnatomy answer = this->Compress(*pose);
    const bool found = answer.Error.empty();
    {
      const std::lock_guard lock(this->Mutex);
      this->Finished = std::move(answer);
      this->Doing = this->Asked ? "compression" : "";
    }
    if (found)
    {
      this->Remember(*pose); // after the answer, which need not wait for it
    }
  }
}

/// Adds the State, of that pose, to what is known.
void CompressionWorker::Remember(const BreastPose& pose)
{
  try
  {
    const UnitPlacement placement{ this->Viewed.Frame, this->Viewed.Breast.Unit };
    const std::vector<PlatePairVelocity> all = placement.PlateVelocitiesAt(pose);
    const std::vector<PlatePairVelocity> moved{ all[ThicknessParameter], all[RollParameter] };
    CompressionSimulation& simulation = this->Model->Body().Simulation();
    KnownEquilibrium known;
    known.Pose = pose;
    known.State = *this->State;
    const VectorFields rates = simulation.Sensitivities(*this->State, moved);
    for (int p = 0; p < 2; ++p)
    {
      known.PositionRates[p].assign(rates[p].begin(), rates[p].end());
      known.ForceRates[p] = simulation.PaddleForceDerivative(*this->State, moved[p]);
    }
    const std::lock_guard lock(this->Mutex);
    this->Known.Add(std::move(known));
    this->Anatomy = &this->Model->AnatomyPoints();
  }
  catch (const ConvergenceError&)
  {
    // An equilibrium about to snap has no rates, and foretells nothing.
  }
}

std::optional<CompressedAnatomy> CompressionWorker::Reduced(const BreastPose& pose) const
{
  const auto begin = std::chrono::steady_clock::now();
  std::optional<ReducedEquilibrium> reduced;
  const Embedding* anatomy = nullptr;
  {
    const std::lock_guard lock(this->Mutex);
    reduced = this->Known.At(pose);
    anatomy = this->Anatomy;
  }
  if (!reduced)
  {
    return std::nullopt;
  }
  CompressedAnatomy answer;
  answer.Pose = pose;
  answer.Points = anatomy->Map(reduced->Positions);
  answer.PaddleForceN = reduced->PaddleForceN;
  answer.ReducedFrom = reduced->From;
  answer.Seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  return answer;
}

CompressionState CompressionWorker::Equilibrium(const BreastPose& pose,
  const ProgressCallback& progress)
{
  const UnitPlacement placement{ this->Viewed.Frame, this->Viewed.Breast.Unit };
  BreastBody& body = this->Model->Body();
  // What is known changes in this thread only. From what it says of the pose itself, a hair inside
  // the plates, the way is longer than from the nearest one (1.6 to 2.0 s, 1.3).
  if (const KnownEquilibrium* nearest = this->Known.Nearest(pose))
  {
    try
    {
      return body.Compress(placement, pose, &nearest->State, progress);
    }
    catch (const ConvergenceError&)
    {
      // The way from there is blocked; the one from outside may not be.
    }
  }
  return body.Compress(placement, pose, nullptr, progress);
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
    this->State = this->Equilibrium(pose, progress);
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
