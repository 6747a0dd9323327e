#include "mba_vo/odometry/background_threads.h"

#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

namespace mba_vo {
namespace {

constexpr int kNiceness = 5;  // about a third of the share of a thread of ordinary priority, if both want the core

/// Of the calling thread alone: on Linux a niceness belongs to a thread. It may always be raised.
void lowerPriority() {
  const auto thread = static_cast<id_t>(syscall(SYS_gettid));
  if (getpriority(PRIO_PROCESS, thread) < kNiceness) setpriority(PRIO_PROCESS, thread, kNiceness);
}

}  // namespace

BackgroundThreads::BackgroundThreads() {
  lowerPriority();
  observe(true);
}

BackgroundThreads::~BackgroundThreads() { observe(false); }

void BackgroundThreads::on_scheduler_entry(bool is_worker) {
  if (is_worker) {
    lowerPriority();
  }
}

}  // namespace mba_vo
