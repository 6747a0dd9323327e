#include "mba_vo/deblur/deblur_queue.h"

#include <set>
#include <stdexcept>
#include <string>
#include <thread>

#include <gtest/gtest.h>

#include "deblur/fake_deblurrers.h"

namespace mba_vo::test::deblur_queue_test {
namespace {

constexpr std::int64_t kSecond = 1'000'000'000;
constexpr bool kWaits = true;

DeblurQueueConfig configOf(int length) {
  DeblurQueueConfig config;
  config.length = length;
  config.per_second = 1.0;
  return config;
}

DeblurTask task(std::uint32_t keyframe, double blur_px) {
  DeblurTask task;
  task.keyframe = keyframe;
  task.blur_px = blur_px;
  task.input.sequence = keyframe;
  return task;
}

bool all(std::uint32_t /*keyframe*/) { return true; }
bool none(std::uint32_t /*keyframe*/) { return false; }

std::uint64_t accountedFor(const DeblurCounts& c) {
  return c.waiting + c.sharpened + c.unsuited + c.passed_over + c.too_slow + c.forgotten;
}

/// Of a queue that does not wait by itself. The result must be on its way.
DeblurredKeyframe waitFor(DeblurQueue& queue) {
  for (;;) {
    if (const auto done = queue.take(all)) return *done;
    std::this_thread::yield();
  }
}

TEST(DeblurQueue, TheLongestBlurGoesFirst) {
  DeblurQueue queue(configOf(3), std::make_shared<FakeDeblurrer>(copyOf), kWaits);
  queue.offer(task(1, 5.0));
  queue.offer(task(2, 20.0));
  queue.offer(task(3, 10.0));
  std::vector<std::uint32_t> order;
  for (std::int64_t t = 0; t < 3; ++t) {
    queue.begin(t * kSecond, all);
    const auto done = queue.take(all);
    ASSERT_TRUE(done);
    EXPECT_TRUE(done->result.sharpened);
    order.push_back(done->keyframe);
  }
  EXPECT_EQ(order, (std::vector<std::uint32_t>{2, 3, 1}));
  EXPECT_EQ(queue.counts().sharpened, 3U);
}

TEST(DeblurQueue, WhereItIsFullTheLeastBlurGivesWay) {
  const auto deblurrer = std::make_shared<FakeDeblurrer>(copyOf);
  DeblurQueue queue(configOf(2), deblurrer, kWaits);
  queue.offer(task(1, 10.0));
  queue.offer(task(2, 20.0));
  queue.offer(task(3, 15.0));  // the first goes
  queue.offer(task(4, 3.0));   // goes itself
  EXPECT_EQ(queue.counts().waiting, 2U);
  EXPECT_EQ(queue.counts().passed_over, 2U);
  std::set<std::uint64_t> deblurred;
  for (std::int64_t t = 0; t < 4; ++t) {
    queue.begin(t * kSecond, all);
    queue.take(all);
  }
  for (const DeblurInput& input : deblurrer->inputs()) deblurred.insert(input.sequence);
  EXPECT_EQ(deblurred, (std::set<std::uint64_t>{2, 3}));
}

TEST(DeblurQueue, BeginsNoMoreOftenThanAllowed) {
  DeblurQueue queue(configOf(10), std::make_shared<FakeDeblurrer>(copyOf), kWaits);
  for (std::uint32_t i = 0; i < 5; ++i) queue.offer(task(i, 10.0));
  std::vector<std::int64_t> begun;
  for (std::int64_t t = 0; t <= 3 * kSecond; t += kSecond / 10) {
    queue.begin(t, all);
    if (queue.take(all)) begun.push_back(t);
  }
  EXPECT_EQ(begun, (std::vector<std::int64_t>{0, kSecond, 2 * kSecond, 3 * kSecond}));
}

TEST(DeblurQueue, AKeyframeThatIsLeftWithoutATryTakesNoTurn) {
  float residual = 0.0F;
  const auto deblurrer = std::make_shared<FakeDeblurrer>([&](const DeblurInput& input) {
    DeblurResult result;
    result.reason = "reason " + std::to_string(input.sequence);
    result.residual = residual;
    return result;
  });
  DeblurQueue queue(configOf(10), deblurrer, kWaits);
  for (std::uint32_t i = 0; i < 5; ++i) queue.offer(task(i, 10.0 - i));
  const auto step = [&](std::int64_t now_ns) {
    queue.begin(now_ns, all);
    EXPECT_FALSE(queue.take(all));
  };
  step(0);
  step(1);
  EXPECT_EQ(queue.counts().unsuited, 2U);
  EXPECT_EQ(queue.counts().unsuited_reason, "reason 1");
  residual = 3.0F;  // from here on it is tried in vain
  step(2);
  step(3);
  EXPECT_EQ(queue.counts().unsuited, 3U);
  step(2 + kSecond);
  EXPECT_EQ(queue.counts().unsuited, 4U);
}

TEST(DeblurQueue, KeyframesThatHaveLeftTheWindowAreDropped) {
  const auto deblurrer = std::make_shared<FakeDeblurrer>(copyOf);
  DeblurQueue queue(configOf(3), deblurrer, kWaits);
  for (std::uint32_t i = 0; i < 3; ++i) queue.offer(task(i, 10.0 * i));
  queue.begin(0, [](std::uint32_t keyframe) { return keyframe == 1; });
  EXPECT_EQ(queue.counts().passed_over, 2U);
  EXPECT_EQ(queue.take(all)->keyframe, 1U);
  EXPECT_EQ(deblurrer->inputs().size(), 1U);
}

TEST(DeblurQueue, SaysWhenTheCpuIsTooSlow) {
  const auto deblurrer = std::make_shared<SlowDeblurrer>();
  DeblurQueue queue(configOf(2), deblurrer, !kWaits);
  queue.offer(task(1, 30.0));
  queue.begin(0, all);
  queue.offer(task(2, 20.0));
  queue.offer(task(3, 10.0));
  queue.begin(kSecond / 2, all);
  EXPECT_FALSE(queue.take(all));
  queue.begin(kSecond, all);                // would be the turn of 2
  queue.begin(kSecond + kSecond / 2, all);  // not that of 3, which also waits
  EXPECT_FALSE(queue.take(all));
  EXPECT_EQ(queue.counts().waiting, 3U);
  queue.begin(kSecond + kSecond / 2, none);  // both leave the window
  EXPECT_EQ(queue.counts().too_slow, 1U);
  EXPECT_EQ(queue.counts().passed_over, 1U);
  queue.offer(task(4, 20.0));
  deblurrer->letGo();
  EXPECT_EQ(waitFor(queue).keyframe, 1U);
  queue.begin(kSecond + kSecond / 2, all);  // late, and at once
  deblurrer->letGo();
  EXPECT_EQ(waitFor(queue).keyframe, 4U);
  EXPECT_EQ(queue.counts().sharpened, 2U);
}

TEST(DeblurQueue, AResultThatComesTooLateIsNotHandedOut) {
  DeblurQueue queue(configOf(2), std::make_shared<FakeDeblurrer>(copyOf), kWaits);
  queue.offer(task(1, 30.0));
  queue.begin(0, all);
  EXPECT_FALSE(queue.take(none));
  EXPECT_EQ(queue.counts().too_slow, 1U);
  EXPECT_EQ(queue.counts().sharpened, 0U);
}

TEST(DeblurQueue, ClearingForgetsWhatIsBeingWorkedOn) {
  const auto deblurrer = std::make_shared<SlowDeblurrer>();
  DeblurQueue queue(configOf(2), deblurrer, !kWaits);
  queue.offer(task(1, 30.0));
  queue.begin(0, all);
  queue.offer(task(2, 20.0));
  queue.clear();  // does not wait
  EXPECT_EQ(queue.counts().forgotten, 2U);
  EXPECT_EQ(queue.counts().waiting, 0U);
  queue.offer(task(1, 5.0));  // of the next map
  queue.begin(0, all);        // the thread is still busy
  deblurrer->letGo();
  while (deblurrer->inputs().size() < 2) {
    EXPECT_FALSE(queue.take(all)) << "a result for the map before";
    queue.begin(0, all);
    std::this_thread::yield();
  }
  deblurrer->letGo();
  EXPECT_EQ(waitFor(queue).keyframe, 1U);
  EXPECT_EQ(deblurrer->inputs().back().sequence, 1U);
  EXPECT_EQ(accountedFor(queue.counts()), queue.counts().offered);
}

TEST(DeblurQueue, MayBeDestroyedWhileAnImageIsBeingWorkedOn) {
  const auto deblurrer = std::make_shared<SlowDeblurrer>();
  auto queue = std::make_unique<DeblurQueue>(configOf(2), deblurrer, !kWaits);
  queue->offer(task(1, 30.0));
  queue->begin(0, all);
  std::thread other([&] { deblurrer->letGo(); });
  queue.reset();
  other.join();
  EXPECT_EQ(deblurrer->inputs().size(), 1U);
}

TEST(DeblurQueue, AFailureLeavesTheKeyframeAsItIs) {
  const auto deblurrer = std::make_shared<FakeDeblurrer>(
      [](const DeblurInput&) -> DeblurResult { throw std::runtime_error("no such layer"); });
  DeblurQueue queue(configOf(2), deblurrer, kWaits);
  queue.offer(task(1, 30.0));
  queue.begin(0, all);
  EXPECT_FALSE(queue.take(all));
  EXPECT_EQ(queue.counts().unsuited, 1U);
  EXPECT_EQ(queue.counts().unsuited_reason, "no such layer");
}

TEST(DeblurQueue, CountsEveryKeyframeOnce) {
  const auto deblurrer = std::make_shared<FakeDeblurrer>([](const DeblurInput& input) {
    DeblurResult result = copyOf(input);
    result.sharpened = input.sequence % 3 != 0;
    return result;
  });
  DeblurQueue queue(configOf(3), deblurrer, kWaits);
  for (std::uint32_t i = 0; i < 200; ++i) {
    const auto window = [&](std::uint32_t keyframe) { return keyframe + 4 > i && keyframe % 7 != 0; };
    queue.take(window);
    queue.offer(task(i, (i * 37) % 50));
    queue.begin(i * kSecond / 3, window);
    if (i % 50 == 49) queue.clear();
    EXPECT_EQ(accountedFor(queue.counts()), i + 1);
  }
  const DeblurCounts counts = queue.counts();
  for (const std::uint64_t count : {counts.sharpened, counts.unsuited, counts.passed_over, counts.forgotten}) {
    EXPECT_GT(count, 0U);
  }
}

}  // namespace
}  // namespace mba_vo::test::deblur_queue_test
