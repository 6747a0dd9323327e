#pragma once

#include <tbb/task_scheduler_observer.h>

namespace mba_vo {

/// Gives the calling thread, and those that share its parallel loops from now on, a lower priority than that of the
/// other threads of the process: where cores are scarce, it works in the time that they leave.
class BackgroundThreads : public tbb::task_scheduler_observer {
 public:
  BackgroundThreads();
  ~BackgroundThreads() override;

  void on_scheduler_entry(bool is_worker) override;
};

}  // namespace mba_vo
