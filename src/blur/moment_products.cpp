#include "mba_vo/blur/moment_products.h"

#include <cmath>
#include <cstring>

#include "mba_vo/image/multiversion.h"

namespace mba_vo {
namespace {

template <int Width>
struct Vectors;
template <>
struct Vectors<8> {
  using Floats = float __attribute__((vector_size(32)));
  using Doubles = double __attribute__((vector_size(64)));
};
template <>
struct Vectors<16> {
  using Floats = float __attribute__((vector_size(64)));
  using Doubles = double __attribute__((vector_size(128)));
};

/// Inlined into each of the versions below.
template <int Width>
[[gnu::always_inline]] inline void multiply(const float* __restrict weight, const SparsePixels* const* terms, int count,
                                            int moments, int parameters, MomentProducts<Width>& p) {
  using FloatRow = typename Vectors<Width>::Floats;
  using DoubleRow = typename Vectors<Width>::Doubles;
  alignas(64) float z[kSparsePixels][Width] = {};  // times sqrt(w)
  for (int k = 0; k < kSparsePixels; ++k) {
    const float root = std::sqrt(weight[k]);
    for (int i = 0; i < count; ++i) z[k][i] = root * (*terms[i])[static_cast<std::size_t>(k)];
  }
  for (int i = 0; i < count; ++i) {
    FloatRow sum = {};
    for (const auto& pixel : z) {
      FloatRow row;
      std::memcpy(&row, pixel, sizeof(row));
      sum += pixel[i] * row;
    }
    const DoubleRow S = __builtin_convertvector(sum, DoubleRow);
    DoubleRow SE = {};
    for (int m = 0; m < moments; m += 2) {
      DoubleRow E[2];
      std::memcpy(E, p.E.data() + Width * m, sizeof(E));
      SE += S[m] * E[0] + S[m + 1] * E[1];
    }
    std::memcpy(p.S.data() + Width * i, &S, sizeof(S));
    std::memcpy(p.SE.data() + Width * i, &SE, sizeof(SE));
  }
  for (int q = 0; q < parameters; ++q) {
    DoubleRow ESE = {};
    const double* const E = p.E.data() + q;
    for (int m = 0; m < moments; m += 2) {
      DoubleRow SE[2];
      std::memcpy(SE, p.SE.data() + Width * m, sizeof(SE));
      ESE += E[Width * m] * SE[0] + E[Width * (m + 1)] * SE[1];
    }
    std::memcpy(p.ESE.data() + Width * q, &ESE, sizeof(ESE));
  }
}

MBA_VO_MULTIVERSION
void multiply8(const float* weight, const SparsePixels* const* terms, int count, int moments, int parameters,
               MomentProducts<8>& p) {
  multiply(weight, terms, count, moments, parameters, p);
}

MBA_VO_MULTIVERSION
void multiply16(const float* weight, const SparsePixels* const* terms, int count, int moments, int parameters,
                MomentProducts<16>& p) {
  multiply(weight, terms, count, moments, parameters, p);
}

}  // namespace

void multiplyOut(const SparsePixels& weight, std::initializer_list<const SparsePixels*> terms, int moments,
                 int parameters, MomentProducts<8>& products) {
  multiply8(weight.data(), terms.begin(), static_cast<int>(terms.size()), moments, parameters, products);
}

void multiplyOut(const SparsePixels& weight, std::initializer_list<const SparsePixels*> terms, int moments,
                 int parameters, MomentProducts<16>& products) {
  multiply16(weight.data(), terms.begin(), static_cast<int>(terms.size()), moments, parameters, products);
}

}  // namespace mba_vo
