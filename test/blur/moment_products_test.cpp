#include "mba_vo/blur/moment_products.h"

#include <gtest/gtest.h>

#include "support/random.h"

namespace mba_vo::moment_products_test {
namespace {

/// Against the same products in double precision; `count` terms, the first `moments` of which move.
template <int kWidth>
void expectProducts(unsigned seed, int count, int moments, int parameters) {
  test::Random random(seed);
  const Eigen::MatrixXf z = random.matrix(kWidth, kSparsePixels).template cast<float>();
  const Eigen::VectorXf w = random.matrix(kSparsePixels, 1).cwiseAbs().template cast<float>();
  std::array<SparsePixels, 9> terms{};
  SparsePixels weight{};
  for (int k = 0; k < kSparsePixels; ++k) {
    weight[static_cast<std::size_t>(k)] = w(k);
    for (int i = 0; i < count; ++i) terms[static_cast<std::size_t>(i)][static_cast<std::size_t>(k)] = z(i, k);
  }
  MomentProducts<kWidth> products;
  products.E.topLeftCorner(moments, parameters) = random.matrix(moments, parameters);
  products.E.bottomRows(products.kMostMoments - moments).setOnes();  // beyond the moments: not to be used
  if (count == 7) {
    multiplyOut(weight, {&terms[0], &terms[1], &terms[2], &terms[3], &terms[4], &terms[5], &terms[6]}, moments,
                parameters, products);
  } else {
    multiplyOut(weight,
                {&terms[0], &terms[1], &terms[2], &terms[3], &terms[4], &terms[5], &terms[6], &terms[7], &terms[8]},
                moments, parameters, products);
  }
  const Eigen::MatrixXd zd = z.topRows(count).template cast<double>();
  const Eigen::MatrixXd S = zd * w.cast<double>().asDiagonal() * zd.transpose();
  const Eigen::MatrixXd E = products.E.topLeftCorner(moments, parameters);
  const Eigen::MatrixXd SE = S.leftCols(moments) * E;
  const Eigen::MatrixXd ESE = E.transpose() * SE.topRows(moments);
  EXPECT_LT((products.S.topLeftCorner(count, count) - S).norm(), 1e-6 * S.norm());
  EXPECT_EQ(products.S.topLeftCorner(count, count), products.S.topLeftCorner(count, count).transpose());
  EXPECT_LT((products.SE.topLeftCorner(count, parameters) - SE).norm(), 1e-6 * SE.norm());
  EXPECT_LT((products.ESE.topLeftCorner(parameters, parameters) - ESE).norm(), 1e-6 * ESE.norm());
}

TEST(MomentProducts, AreThoseOfMatrices) {
  expectProducts<8>(1, 7, 4, 7);
  expectProducts<8>(2, 7, 2, 7);
  expectProducts<16>(3, 9, 6, 12);
  expectProducts<16>(4, 7, 6, 16);
}

}  // namespace
}  // namespace mba_vo::moment_products_test
