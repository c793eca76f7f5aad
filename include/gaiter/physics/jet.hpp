// SPDX-License-Identifier: BSD-2-Clause
#pragma once

#include <array>
#include <cmath>

namespace gaiter::physics {

// A number with its first and second derivatives with respect to N variables: a potential written once in
// jets gives residual and tangent that are exact and fit together. The Hessian is packed: entry (i, j), i >=
// j, at i (i+1)/2 + j.
template <int N>
struct Jet {
  static constexpr int size = N;
  static constexpr int packed = N * (N + 1) / 2;

  double value = 0;
  std::array<double, N> gradient{};
  std::array<double, packed> hessian{};

  Jet() = default;
  Jet(double constant) : value(constant) {}  // NOLINT: constants and jets mix freely

  static Jet variable(double value, int index) {
    Jet jet(value);
    jet.gradient[index] = 1;
    return jet;
  }

  double second(int i, int j) const {
    return i >= j ? hessian[i * (i + 1) / 2 + j] : hessian[j * (j + 1) / 2 + i];
  }

  Jet& operator+=(const Jet& other) {
    value += other.value;
    for (int i = 0; i < N; ++i) gradient[i] += other.gradient[i];
    for (int k = 0; k < packed; ++k) hessian[k] += other.hessian[k];
    return *this;
  }
  Jet& operator-=(const Jet& other) {
    value -= other.value;
    for (int i = 0; i < N; ++i) gradient[i] -= other.gradient[i];
    for (int k = 0; k < packed; ++k) hessian[k] -= other.hessian[k];
    return *this;
  }
  Jet& operator*=(double factor) {
    value *= factor;
    for (double& g : gradient) g *= factor;
    for (double& h : hessian) h *= factor;
    return *this;
  }
};

// f(x) from f, f' and f'' at x.value.
template <int N>
Jet<N> compose(const Jet<N>& x, double value, double first, double second) {
  Jet<N> result(value);
  for (int i = 0; i < N; ++i) result.gradient[i] = first * x.gradient[i];
  for (int i = 0, k = 0; i < N; ++i) {
    const double slope = second * x.gradient[i];
    for (int j = 0; j <= i; ++j, ++k) result.hessian[k] = first * x.hessian[k] + slope * x.gradient[j];
  }
  return result;
}

template <int N>
Jet<N> operator*(const Jet<N>& x, const Jet<N>& y) {
  Jet<N> result(x.value * y.value);
  for (int i = 0; i < N; ++i) result.gradient[i] = x.value * y.gradient[i] + y.value * x.gradient[i];
  for (int i = 0, k = 0; i < N; ++i)
    for (int j = 0; j <= i; ++j, ++k)
      result.hessian[k] = x.value * y.hessian[k] + y.value * x.hessian[k] + x.gradient[i] * y.gradient[j] +
                          x.gradient[j] * y.gradient[i];
  return result;
}

template <int N>
Jet<N> operator+(Jet<N> x, const Jet<N>& y) {
  x += y;
  return x;
}
template <int N>
Jet<N> operator-(Jet<N> x, const Jet<N>& y) {
  x -= y;
  return x;
}
template <int N>
Jet<N> operator-(Jet<N> x) {
  x *= -1;
  return x;
}
template <int N>
Jet<N> operator+(Jet<N> x, double y) {
  x.value += y;
  return x;
}
template <int N>
Jet<N> operator+(double x, Jet<N> y) {
  y.value += x;
  return y;
}
template <int N>
Jet<N> operator-(Jet<N> x, double y) {
  x.value -= y;
  return x;
}
template <int N>
Jet<N> operator*(double factor, Jet<N> x) {
  x *= factor;
  return x;
}

template <int N>
Jet<N> reciprocal(const Jet<N>& x) {
  const double r = 1 / x.value;
  return compose(x, r, -r * r, 2 * r * r * r);
}
template <int N>
Jet<N> operator/(const Jet<N>& x, const Jet<N>& y) {
  return x * reciprocal(y);
}
template <int N>
Jet<N> log(const Jet<N>& x) {
  const double r = 1 / x.value;
  return compose(x, std::log(x.value), r, -r * r);
}
template <int N>
Jet<N> exp(const Jet<N>& x) {
  const double e = std::exp(x.value);
  return compose(x, e, e, e);
}
template <int N>
Jet<N> sqrt(const Jet<N>& x) {
  const double root = std::sqrt(x.value);
  return compose(x, root, 0.5 / root, -0.25 / (root * x.value));
}

}  // namespace gaiter::physics
