// SPDX-License-Identifier: Apache-2.0
#include "Private/Desktop/Task.h"

#include "mammoray/Foundation/Error.h"

#include <QMetaObject>
#include <QObject>

#include <chrono>
#include <memory>
#include <utility>

namespace mammoray
{
namespace
{
constexpr std::chrono::milliseconds ReportEvery{ 100 };
}

Task::Task(QObject* window)
  : Window(window)
{
}

Task::~Task()
{
  ++this->Number;
  this->Thread.request_stop();
}

void Task::Post(int run, std::function<void()> told)
{
  QMetaObject::invokeMethod(
    this->Window,
    [this, run, told = std::move(told)]
    {
      if (run == this->Number)
      {
        told();
      }
    },
    Qt::QueuedConnection);
}

ProgressCallback Task::Reporter(int run, const std::stop_token& stop)
{
  using Clock = std::chrono::steady_clock;
  auto last = std::make_shared<Clock::time_point>();
  return [this, run, stop, last](double fraction, const char* stage)
  {
    const Clock::time_point now = Clock::now();
    if (now - *last >= ReportEvery)
    {
      *last = now;
      this->Post(run,
        [this, fraction, text = QString::fromUtf8(stage)]
        {
          if (this->Progressed)
          {
            this->Progressed(fraction, text);
          }
        });
    }
    return !stop.stop_requested();
  };
}

void Task::End(const std::function<void()>& told)
{
  this->Running = false;
  if (told)
  {
    told();
  }
  if (!this->Running && this->Ended)
  {
    this->Ended();
  }
}

void Task::Start(Work work)
{
  this->Thread = std::jthread(); // waits for the one before
  const int run = ++this->Number;
  this->Running = true;
  this->Thread = std::jthread(
    [this, run, work = std::move(work)](const std::stop_token& stop)
    {
      try
      {
        const Outcome outcome = work(this->Reporter(run, stop));
        this->Post(run, [this, outcome] { this->End(outcome); });
      }
      catch (const mammoray::Interrupted&)
      {
        this->Post(run, [this] { this->End(this->Interrupted); });
      }
      catch (const std::exception& error)
      {
        this->Post(run,
          [this, complaint = QString::fromStdString(EscapeControls(error.what()))]
          {
            this->End(
              [&]
              {
                if (this->Failed)
                {
                  this->Failed(complaint);
                }
              });
          });
      }
    });
}

void Task::Cancel()
{
  this->Thread.request_stop();
}
}
