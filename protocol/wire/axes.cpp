// SPDX-License-Identifier: Apache-2.0
#include "protocol/wire/axes.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace kinemap::mxtp {

namespace {
constexpr double kDegree = std::numbers::pi / 180.0;
}

EulerItem to_euler(const SegmentItem& item) {
  const auto& [x, y, z] = item.position;
  // The same rotation seen in the y-up axes: the vector part is permuted as positions are.
  const double w = item.orientation[0];
  const double a = item.orientation[2];
  const double b = item.orientation[3];
  const double c = item.orientation[1];
  const double sin_y = std::clamp(2.0 * (w * b - c * a), -1.0, 1.0);
  const double about_x = std::atan2(2.0 * (w * a + b * c), 1.0 - 2.0 * (a * a + b * b));
  const double about_z = std::atan2(2.0 * (w * c + a * b), 1.0 - 2.0 * (b * b + c * c));
  EulerItem out;
  out.position_cm = {100.0F * y, 100.0F * z, 100.0F * x};
  out.angles_deg = {static_cast<float>(about_x / kDegree), static_cast<float>(std::asin(sin_y) / kDegree),
                    static_cast<float>(about_z / kDegree)};
  return out;
}

SegmentItem from_euler(std::int32_t id, const EulerItem& item) {
  const double hx = 0.5 * kDegree * item.angles_deg[0];
  const double hy = 0.5 * kDegree * item.angles_deg[1];
  const double hz = 0.5 * kDegree * item.angles_deg[2];
  const double cx = std::cos(hx), sx = std::sin(hx);
  const double cy = std::cos(hy), sy = std::sin(hy);
  const double cz = std::cos(hz), sz = std::sin(hz);
  // q = qz·qy·qx written out.
  double w = cz * cy * cx + sz * sy * sx;
  double a = cz * cy * sx - sz * sy * cx;
  double b = cz * sy * cx + sz * cy * sx;
  double c = sz * cy * cx - cz * sy * sx;
  if (w < 0.0) w = -w, a = -a, b = -b, c = -c;
  const auto& [u, v, s] = item.position_cm;
  SegmentItem out;
  out.id = id;
  out.position = {s / 100.0F, u / 100.0F, v / 100.0F};
  out.orientation = {static_cast<float>(w), static_cast<float>(c), static_cast<float>(a), static_cast<float>(b)};
  return out;
}

}  // namespace kinemap::mxtp
