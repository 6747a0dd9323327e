#pragma once

#include <array>
#include <initializer_list>

#include <Eigen/Core>

namespace mba_vo {

/// Pixels of a sparse patch.
inline constexpr int kSparsePixels = 8;
/// One number for each of its pixels.
using SparsePixels = std::array<float, kSparsePixels>;

/// Sums over the pixels of a sparse patch that normal equations are made of. A pixel has up to `Width` terms z, for
/// instance moments of the gradient and a residual; the first ones, the moments, move with up to `Width` parameters.
template <int Width>
struct MomentProducts {
  template <int Count>
  using Rows = Eigen::Matrix<double, Count, Width, Eigen::RowMajor>;
  static constexpr int kMostMoments = 6;

  Rows<kMostMoments> E = Rows<kMostMoments>::Zero();  // d moments / d parameters, zero beyond what there is
  Rows<Width> S;                                      // sum of w z z^T, symmetric to the last bit
  Rows<Width> SE;                                     // terms with parameters
  Rows<Width> ESE;                                    // parameters with parameters
};

/// Fills the rows of S, SE and ESE that there are. S is rounded to single precision, but common to all that follows, so
/// that directions which cannot be observed stay unobserved. `moments` must be even: add one that is zero.
void multiplyOut(const SparsePixels& weight, std::initializer_list<const SparsePixels*> terms, int moments,
                 int parameters, MomentProducts<8>& products);
void multiplyOut(const SparsePixels& weight, std::initializer_list<const SparsePixels*> terms, int moments,
                 int parameters, MomentProducts<16>& products);

}  // namespace mba_vo
