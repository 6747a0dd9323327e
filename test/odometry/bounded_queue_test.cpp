#include "mba_vo/odometry/bounded_queue.h"

#include <gtest/gtest.h>

namespace mba_vo::bounded_queue_test {
namespace {

BoundedQueue<int> tenByteQueue() {
  return {10, [](int item) { return static_cast<std::size_t>(item); },
          [](const std::deque<int>& items) { return (items.size() - 1) / 2; }};
}

TEST(BoundedQueue, KeepsOrder) {
  auto queue = tenByteQueue();
  EXPECT_TRUE(queue.push(1).empty());
  EXPECT_TRUE(queue.push(2).empty());
  EXPECT_EQ(queue.bytes(), 3U);
  EXPECT_EQ(queue.pop(), 1);
  EXPECT_EQ(queue.pop(), 2);
  EXPECT_EQ(queue.bytes(), 0U);
}

TEST(BoundedQueue, ShedsWhatItsOwnerChoosesAndHandsItBack) {
  auto queue = tenByteQueue();
  queue.push(3);
  queue.push(4);
  queue.push(2);
  EXPECT_EQ(queue.push(5), std::vector<int>{4});  // 14 bytes: the one in the middle goes
  EXPECT_EQ(queue.bytes(), 10U);
  EXPECT_EQ(queue.pop(), 3);
  EXPECT_EQ(queue.pop(), 2);
  EXPECT_EQ(queue.pop(), 5);
}

TEST(BoundedQueue, NeverExceedsItsBoundUnlessOneItemDoes) {
  auto queue = tenByteQueue();
  for (int i = 1; i <= 9; ++i) {
    queue.push(i);
    EXPECT_LE(queue.bytes(), 10U);
  }
  EXPECT_FALSE(queue.push(50).empty());
  EXPECT_EQ(queue.bytes(), 50U);
  EXPECT_EQ(queue.pop(), 50);
}

TEST(BoundedQueue, AnEmptyOneHasNothing) {
  auto queue = tenByteQueue();
  EXPECT_EQ(queue.pop(), std::nullopt);
  queue.push(1);
  queue.pop();
  EXPECT_EQ(queue.pop(), std::nullopt);
  EXPECT_TRUE(queue.empty());
}

}  // namespace
}  // namespace mba_vo::bounded_queue_test
