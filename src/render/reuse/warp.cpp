#include "src/render/reuse/warp.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace sightline::render {
namespace {

bool isFinite(const Warp& warp) {
  return std::all_of(warp.m.begin(), warp.m.end(), [](double v) { return std::isfinite(v); });
}

PicturePoint meanOf(std::span<const PicturePoint> points) {
  PicturePoint sum;
  for (const PicturePoint& p : points) {
    sum = {sum.x + p.x, sum.y + p.y};
  }
  const auto count = static_cast<double>(points.size());
  return {sum.x / count, sum.y / count};
}

// Takes points to coordinates of about 1 around their middle, in which sums of squares are well conditioned.
struct Normalisation {
  PicturePoint middle;
  double scale = 1.0;

  explicit Normalisation(std::span<const PicturePoint> points) : middle(meanOf(points)) {
    double sum = 0.0;
    for (const PicturePoint& p : points) {
      sum += std::hypot(p.x - middle.x, p.y - middle.y);
    }
    scale = sum > 0.0 ? static_cast<double>(points.size()) / sum : 1.0;
  }
  PicturePoint operator()(PicturePoint p) const {
    return {(p.x - middle.x) * scale, (p.y - middle.y) * scale};
  }
  Warp forward() const { return {{scale, 0, -scale * middle.x, 0, scale, -scale * middle.y, 0, 0, 1}}; }
  Warp backward() const { return {{1 / scale, 0, middle.x, 0, 1 / scale, middle.y, 0, 0, 1}}; }
};

constexpr std::size_t kUnknowns = 8;  // a projective map's elements, the last one being 1

// Normal equations of linear least squares, solved by elimination with pivots.
struct LeastSquares {
  std::array<std::array<double, kUnknowns + 1>, kUnknowns> sums{};

  // Adds the equation row . unknowns = value.
  void add(const std::array<double, kUnknowns>& row, double value) {
    for (std::size_t i = 0; i < kUnknowns; ++i) {
      for (std::size_t j = 0; j < kUnknowns; ++j) {
        sums[i][j] += row[i] * row[j];
      }
      sums[i][kUnknowns] += row[i] * value;
    }
  }

  // Adds the equations unknowns = wished with this weight, to settle what the rows leave open.
  void prefer(const std::array<double, kUnknowns>& wished, double weight) {
    for (std::size_t i = 0; i < kUnknowns; ++i) {
      sums[i][i] += weight;
      sums[i][kUnknowns] += weight * wished[i];
    }
  }

  std::array<double, kUnknowns> solve() {
    for (std::size_t k = 0; k < kUnknowns; ++k) {
      std::size_t pivot = k;
      for (std::size_t i = k + 1; i < kUnknowns; ++i) {
        pivot = std::abs(sums[i][k]) > std::abs(sums[pivot][k]) ? i : pivot;
      }
      std::swap(sums[k], sums[pivot]);
      for (std::size_t i = k + 1; i < kUnknowns; ++i) {
        const double factor = sums[i][k] / sums[k][k];
        for (std::size_t j = k; j <= kUnknowns; ++j) {
          sums[i][j] -= factor * sums[k][j];
        }
      }
    }
    std::array<double, kUnknowns> unknowns{};
    for (std::size_t k = kUnknowns; k-- > 0;) {
      double rest = sums[k][kUnknowns];
      for (std::size_t j = k + 1; j < kUnknowns; ++j) {
        rest -= sums[k][j] * unknowns[j];
      }
      unknowns[k] = rest / sums[k][k];
    }
    return unknowns;
  }
};

// Multiplied by its divisor, x' = (a x + b y + c) / (g x + h y + 1) is linear in the unknowns. Divided by the
// divisor of the round before, the residual is the distance in the picture, up to the change of the divisor.
LeastSquares projectiveEquations(std::span<const PicturePoint> from, std::span<const PicturePoint> to,
                                 const Normalisation& from_unit, const Normalisation& to_unit,
                                 const Warp& before) {
  LeastSquares equations;
  for (std::size_t i = 0; i < from.size(); ++i) {
    const PicturePoint p = from_unit(from[i]), q = to_unit(to[i]);
    const double weight = 1.0 / before.divisor(p);
    const double x = p.x * weight, y = p.y * weight;
    equations.add({x, y, weight, 0, 0, 0, -x * q.x, -y * q.x}, q.x * weight);
    equations.add({0, 0, 0, x, y, weight, -x * q.y, -y * q.y}, q.y * weight);
  }
  return equations;
}

bool hasPositiveDivisors(const Warp& warp, std::span<const PicturePoint> points) {
  return isFinite(warp) && std::all_of(points.begin(), points.end(),
                                       [&](const PicturePoint& p) { return warp.divisor(p) > 1e-9; });
}

}  // namespace

Warp operator*(const Warp& after, const Warp& before) {
  Warp product;
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t column = 0; column < 3; ++column) {
      double sum = 0.0;
      for (std::size_t k = 0; k < 3; ++k) {
        sum += after.m[3 * row + k] * before.m[3 * k + column];
      }
      product.m[3 * row + column] = sum;
    }
  }
  return product;
}

std::optional<Warp> inverseOf(const Warp& warp) {
  const auto& m = warp.m;
  Warp adjugate{{m[4] * m[8] - m[5] * m[7], m[2] * m[7] - m[1] * m[8], m[1] * m[5] - m[2] * m[4],
                 m[5] * m[6] - m[3] * m[8], m[0] * m[8] - m[2] * m[6], m[2] * m[3] - m[0] * m[5],
                 m[3] * m[7] - m[4] * m[6], m[1] * m[6] - m[0] * m[7], m[0] * m[4] - m[1] * m[3]}};
  const double determinant = m[0] * adjugate.m[0] + m[1] * adjugate.m[3] + m[2] * adjugate.m[6];
  for (double& element : adjugate.m) {
    element /= determinant;
  }
  if (!isFinite(adjugate) || determinant == 0.0) {
    return std::nullopt;
  }
  return adjugate;
}

std::optional<Warp> fitAffine(std::span<const PicturePoint> from, std::span<const PicturePoint> to) {
  if (from.empty()) {
    return std::nullopt;
  }
  const PicturePoint from_middle = meanOf(from), to_middle = meanOf(to);
  // Solves for what must be added to the identity.
  double xx = 0, xy = 0, yy = 0;              // sums of products of `from`
  double dxx = 0, dxy = 0, dyx = 0, dyy = 0;  // sums of products of `to - from` with `from`
  for (std::size_t i = 0; i < from.size(); ++i) {
    const double x = from[i].x - from_middle.x, y = from[i].y - from_middle.y;
    const double dx = to[i].x - to_middle.x - x, dy = to[i].y - to_middle.y - y;
    xx += x * x;
    xy += x * y;
    yy += y * y;
    dxx += dx * x;
    dxy += dx * y;
    dyx += dy * x;
    dyy += dy * y;
  }
  // Keeps points within a thousandth of a pixel from determining the map.
  const double ridge = 1e-6 + 1e-12 * (xx + yy);
  xx += ridge;
  yy += ridge;
  const double determinant = xx * yy - xy * xy;
  const double a = 1.0 + (dxx * yy - dxy * xy) / determinant, b = (dxy * xx - dxx * xy) / determinant;
  const double c = (dyx * yy - dyy * xy) / determinant, d = 1.0 + (dyy * xx - dyx * xy) / determinant;
  const Warp warp{{a, b, to_middle.x - a * from_middle.x - b * from_middle.y, c, d,
                   to_middle.y - c * from_middle.x - d * from_middle.y, 0, 0, 1}};
  return isFinite(warp) ? std::optional(warp) : std::nullopt;
}

std::optional<Warp> fitProjective(std::span<const PicturePoint> from, std::span<const PicturePoint> to) {
  constexpr std::size_t kMinPoints = 4;
  constexpr int kRounds = 3;
  constexpr double kPreference = 1e-12;
  const std::optional<Warp> affine = fitAffine(from, to);
  if (from.size() < kMinPoints || !affine) {
    return std::nullopt;
  }
  const Normalisation from_unit(from), to_unit(to);
  Warp unit_warp = to_unit.forward() * *affine * from_unit.backward();
  const auto& m = unit_warp.m;
  const std::array<double, kUnknowns> start{m[0], m[1], m[2], m[3], m[4], m[5], 0.0, 0.0};
  for (int round = 0; round < kRounds; ++round) {
    LeastSquares equations = projectiveEquations(from, to, from_unit, to_unit, unit_warp);
    equations.prefer(start, kPreference * static_cast<double>(from.size()));
    const std::array<double, kUnknowns> u = equations.solve();
    unit_warp = {{u[0], u[1], u[2], u[3], u[4], u[5], u[6], u[7], 1.0}};
    const auto divisor_at = [&](const PicturePoint& p) { return unit_warp.divisor(from_unit(p)); };
    if (!isFinite(unit_warp) || std::any_of(from.begin(), from.end(),
                                            [&](const PicturePoint& p) { return !(divisor_at(p) > 1e-3); })) {
      return std::nullopt;
    }
  }
  const Warp warp = to_unit.backward() * unit_warp * from_unit.forward();
  return hasPositiveDivisors(warp, from) ? std::optional(warp) : std::nullopt;
}

double largestDeviation(const Warp& warp, std::span<const PicturePoint> from,
                        std::span<const PicturePoint> to) {
  double largest = 0.0;
  for (std::size_t i = 0; i < from.size(); ++i) {
    const PicturePoint p = warp(from[i]);
    const double deviation = std::hypot(p.x - to[i].x, p.y - to[i].y);
    // NaN counts as infinitely far.
    largest = deviation <= largest       ? largest
              : std::isfinite(deviation) ? std::max(largest, deviation)
                                         : std::numeric_limits<double>::infinity();
  }
  return largest;
}

double largestStretch(const Warp& warp, PicturePoint at) {
  const double w = warp.divisor(at);
  const PicturePoint p = warp(at);
  const auto& m = warp.m;
  const double a = (m[0] - p.x * m[6]) / w, b = (m[1] - p.x * m[7]) / w;
  const double c = (m[3] - p.y * m[6]) / w, d = (m[4] - p.y * m[7]) / w;
  // The sum and the difference of the singular values of (a b; c d).
  const double sum = std::hypot(a + d, c - b), difference = std::hypot(a - d, b + c);
  const double largest = 0.5 * (sum + difference), smallest = 0.5 * std::abs(sum - difference);
  const double stretch = std::max(largest, 1.0 / smallest);
  return std::isfinite(stretch) ? stretch : std::numeric_limits<double>::infinity();
}

}  // namespace sightline::render
