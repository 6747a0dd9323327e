#include "mba_vo/tracking/residual_gate.h"

#include <gtest/gtest.h>

namespace mba_vo::residual_gate_test {
namespace {

TEST(ResidualGate, TellsWhatIsFarFromTheMedianAndLarge) {
  ResidualGate usual;
  for (int i = 0; i < 19; ++i) usual.add(0.25 + 0.002 * i);
  EXPECT_FALSE(usual.isExceededBy(2.0));  // too few
  for (int i = 0; i < 11; ++i) usual.add(0.25 + 0.002 * i);
  EXPECT_TRUE(usual.isExceededBy(0.9));
  EXPECT_FALSE(usual.isExceededBy(0.7));
  ResidualGate small;
  for (int i = 0; i < 30; ++i) small.add(0.05);
  EXPECT_FALSE(small.isExceededBy(0.45));  // eight times as much, but harmless
  EXPECT_TRUE(small.isExceededBy(0.55));
  small.reset();
  EXPECT_FALSE(small.isExceededBy(0.55));
}

TEST(ResidualGate, WhatLastsBecomesUsual) {
  ResidualGate usual;
  for (int i = 0; i < 60; ++i) usual.add(0.1);
  int told = 0;
  for (int i = 0; i < 60; ++i) {
    told += usual.isExceededBy(0.9) ? 1 : 0;
    usual.add(0.9);
  }
  EXPECT_GT(told, 20);
  EXPECT_LT(told, 40);
}

}  // namespace
}  // namespace mba_vo::residual_gate_test
