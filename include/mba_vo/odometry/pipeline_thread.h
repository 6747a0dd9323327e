#pragma once

#include <condition_variable>
#include <functional>
#include <mutex>
#include <string>
#include <thread>

namespace mba_vo {

/// A thread that works for one half of the pipeline: it calls `step` as long as there is something to do and sleeps
/// until it is woken. Whatever is thrown there ends the step, never the process: it is reported, and work goes on, also
/// if the report fails.
class PipelineThread {
 public:
  enum class Priority { kOrdinary, kBackground };  // background: it works in the time that others leave
  struct Work {
    std::function<bool()> step;  // false: nothing to do until woken
    std::function<void(const std::string& what)>
        onException;  // called on the thread; does what makes the next step possible
  };

  explicit PipelineThread(Work work, Priority priority = Priority::kOrdinary);
  ~PipelineThread() { stop(); }
  PipelineThread(const PipelineThread&) = delete;
  PipelineThread& operator=(const PipelineThread&) = delete;

  /// There is something to do. May be called from any thread, also when it has been stopped.
  void wake();
  /// Ends it after the step that is being done. Two threads that wake each other are both stopped before either goes.
  void stop();

 private:
  void run();
  void work();
  void report(const char* what);
  bool waitUntilWoken();

  const Work work_;
  std::mutex mutex_;
  std::condition_variable changed_;
  bool woken_ = false;
  bool stopped_ = false;
  std::thread thread_;
};

}  // namespace mba_vo
