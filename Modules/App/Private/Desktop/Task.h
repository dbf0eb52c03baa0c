// SPDX-License-Identifier: Apache-2.0
#ifndef mammoray_Task_h
#define mammoray_Task_h

#include "mammoray/Foundation/Progress.h"

#include <QString>

#include <functional>
#include <thread>

class QObject;

namespace mammoray
{
/**
 * Long work beside the window's thread, one at a time. The functions below are called in the
 * window's thread; none is called after the task's end.
 */
class Task
{
public:
  /// What the window does with the outcome.
  using Outcome = std::function<void()>;
  /// Runs beside the window's thread.
  using Work = std::function<Outcome(const ProgressCallback& progress)>;

  /// `window`: the object whose thread is the window's; it must outlive this.
  explicit Task(QObject* window);
  /// Cancels and waits.
  ~Task();

  bool Runs() const { return this->Running; }
  /// Cancels what runs, and waits for that.
  void Start(Work work);
  /// The work sees it at its next report of progress.
  void Cancel();

  /// A fraction in [0, 1] and the stage, at most ten times a second.
  std::function<void(double fraction, const QString& stage)> Progressed;
  /// One line.
  std::function<void(const QString& complaint)> Failed;
  std::function<void()> Interrupted;
  /// After each of the three ends.
  std::function<void()> Ended;

private:
  ProgressCallback Reporter(int run, const std::stop_token& stop);
  void Post(int run, std::function<void()> told);
  void End(const std::function<void()>& told);

  QObject* Window;
  bool Running = false;
  /// Number of the run; what earlier ones still have to tell is dropped.
  int Number = 0;
  std::jthread Thread;
};
}

#endif
