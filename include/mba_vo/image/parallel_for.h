#pragma once

#include <cstddef>

#ifdef __SANITIZE_THREAD__
#include <atomic>
#include <thread>
#include <vector>
#else
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#endif

namespace mba_vo {

/// Calls body(i) for all i from 0 to count - 1, on several threads and in any order, and returns when all are done.
template <typename Body>
void parallelFor(std::size_t count, const Body& body) {
#ifdef __SANITIZE_THREAD__
  // libtbb is not instrumented: the thread sanitizer would not see that beginning and ending a loop order memory, and
  // take every access in it for a race. Threads it understands. Relaxed, so as to order nothing between two calls.
  constexpr std::size_t kThreads = 3;
  std::atomic<std::size_t> next{0};
  const auto work = [&] {
    for (std::size_t i = next.fetch_add(1, std::memory_order_relaxed); i < count;) {
      body(i);
      i = next.fetch_add(1, std::memory_order_relaxed);
    }
  };
  std::vector<std::thread> threads;
  for (std::size_t i = 0; i < kThreads; ++i) threads.emplace_back(work);
  for (std::thread& thread : threads) thread.join();
#else
  tbb::parallel_for(std::size_t{0}, count, body);
#endif
}

/// Calls body(); a loop in it that waits for its threads takes up no work from outside.
template <typename Body>
void isolated(const Body& body) {
#ifdef __SANITIZE_THREAD__
  body();
#else
  tbb::this_task_arena::isolate(body);
#endif
}

}  // namespace mba_vo
