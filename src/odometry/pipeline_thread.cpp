#include "mba_vo/odometry/pipeline_thread.h"

#include <exception>
#include <utility>

#include "mba_vo/odometry/background_threads.h"

namespace mba_vo {

PipelineThread::PipelineThread(Work work, Priority priority) : work_(std::move(work)) {
  thread_ = std::thread([this, priority] {
    if (priority == Priority::kOrdinary) return run();
    const BackgroundThreads lower_priority;
    run();
  });
}

void PipelineThread::stop() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    stopped_ = true;
  }
  changed_.notify_one();
  if (thread_.joinable()) thread_.join();
}

void PipelineThread::wake() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    woken_ = true;
  }
  changed_.notify_one();
}

void PipelineThread::run() {
  while (waitUntilWoken()) work();
}

void PipelineThread::work() {
  const auto isStopped = [this] {
    const std::lock_guard<std::mutex> lock(mutex_);
    return stopped_;
  };
  try {
    while (!isStopped() && work_.step()) {
    }
  } catch (const std::exception& error) {
    report(error.what());
  } catch (...) {
    report("unknown exception");
  }
}

void PipelineThread::report(const char* what) {
  try {
    work_.onException(what);
  } catch (...) {  // there is nobody left to be told
  }
  wake();
}

bool PipelineThread::waitUntilWoken() {
  std::unique_lock<std::mutex> lock(mutex_);
  changed_.wait(lock, [this] { return stopped_ || woken_; });
  woken_ = false;
  return !stopped_;
}

}  // namespace mba_vo
