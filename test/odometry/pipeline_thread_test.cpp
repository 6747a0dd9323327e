#include "mba_vo/odometry/pipeline_thread.h"

#include <atomic>
#include <future>
#include <stdexcept>
#include <string>
#include <utility>

#include <gtest/gtest.h>

namespace mba_vo::pipeline_thread_test {
namespace {

TEST(PipelineThread, WorksUntilNothingIsLeftAndAgainWhenWoken) {
  std::atomic<int> work{0};
  std::atomic<int> done{0};
  std::promise<void> first, second;
  const auto step = [&] {
    if (work.load() == 0) return false;
    --work;
    if (++done == 3) first.set_value();
    if (done == 5) second.set_value();
    return true;
  };
  PipelineThread thread({step, [](const std::string&) { FAIL(); }});
  work = 3;
  thread.wake();
  first.get_future().wait();
  work = 2;
  thread.wake();
  second.get_future().wait();
  EXPECT_EQ(done, 5);
}

TEST(PipelineThread, WhatIsThrownIsReportedAndWorkGoesOn) {
  std::atomic<int> steps{0};
  std::promise<std::string> reported;
  std::promise<void> went_on;
  const auto step = [&]() -> bool {
    switch (++steps) {
      case 1:
        throw std::runtime_error("out of luck");
      case 2:
        throw 5;  // NOLINT(hicpp-exception-baseclass): anything may be thrown
      case 3:
        went_on.set_value();
        return false;
      default:
        return false;
    }
  };
  std::string all;
  {
    PipelineThread thread({step, [&](const std::string& what) { all += what + "; "; }},
                          PipelineThread::Priority::kBackground);
    thread.wake();
    went_on.get_future().wait();
  }
  EXPECT_EQ(all, "out of luck; unknown exception; ");
}

TEST(PipelineThread, AReportThatFailsEndsNeitherTheProcessNorTheWork) {
  std::atomic<int> steps{0};
  std::promise<void> went_on;
  const auto step = [&]() -> bool {
    if (++steps == 1) throw std::runtime_error("out of luck");
    if (steps == 2) went_on.set_value();
    return false;
  };
  PipelineThread thread({step, [](const std::string& what) { throw std::runtime_error("again " + what); }});
  thread.wake();
  went_on.get_future().wait();
}

TEST(PipelineThread, EndsAfterTheStepThatIsBeingDone) {
  std::promise<void> started;
  std::atomic<bool> ended{false};
  bool first = true;
  {
    PipelineThread thread({[&] {
                             if (std::exchange(first, false)) started.set_value();
                             ended = true;
                             return true;  // there would always be more
                           },
                           [](const std::string&) {}});
    thread.wake();
    started.get_future().wait();
  }
  EXPECT_TRUE(ended);
}

}  // namespace
}  // namespace mba_vo::pipeline_thread_test
