// SPDX-License-Identifier: Apache-2.0
#include "tools/kinemap/consistency.hpp"

#include <cmath>

namespace kinemap::eval {
namespace {

void add_ratio(double error, double sigma, std::vector<double>& out) {
  if (sigma > 0.0 && std::isfinite(sigma)) out.push_back(error / sigma);
}

void add_position(const Shape& truth, const Shape& estimate, double sigma, std::vector<double>& out) {
  const Eigen::Vector2d error = (estimate.centre - truth.centre).head<2>();
  if (truth.type == ObjectType::Wall)
    return add_ratio(error.dot(Eigen::Vector2d(std::cos(truth.heading), std::sin(truth.heading))), sigma, out);
  add_ratio(error.x(), sigma, out);
  add_ratio(error.y(), sigma, out);
}

}  // namespace

void NormalisedErrors::add(const NormalisedErrors& other) {
  const auto append = [](std::vector<double>& to, const std::vector<double>& from) {
    to.insert(to.end(), from.begin(), from.end());
  };
  append(size, other.size);
  append(position, other.position);
  append(heading, other.heading);
  append(aligned_position, other.aligned_position);
  append(aligned_heading, other.aligned_heading);
}

NormalisedErrors normalised_errors(const Shape& truth, const MapObject& object, const Gauges& T_truth_map) {
  const ObjectSigma& sigma = object.sigma;
  const Shape start = shape_of(object, T_truth_map.from_start), aligned = shape_of(object, T_truth_map.aligned);
  NormalisedErrors errors;
  const std::size_t edges = edge_count(truth.type);
  // The map gives the longer side first, as the truth does; its sigmas are in the order of its sizes.
  for (std::size_t i = 0; object.size && i < edges; ++i)
    add_ratio((*object.size)[i] - truth.size[i], sigma.size_m[i], errors.size);
  add_position(truth, start, sigma.position_m, errors.position);
  add_position(truth, aligned, sigma.position_m, errors.aligned_position);
  add_ratio(heading_difference(truth, start), sigma.heading_rad, errors.heading);
  add_ratio(heading_difference(truth, aligned), sigma.heading_rad, errors.aligned_heading);
  return errors;
}

Consistency consistency_of(const std::vector<double>& normalised) {
  Consistency result;
  result.n = normalised.size();
  if (normalised.empty()) return result;
  for (const double e : normalised) {
    result.within_1 += std::abs(e) <= 1.0 ? 1.0 : 0.0;
    result.within_2 += std::abs(e) <= 2.0 ? 1.0 : 0.0;
    result.mean += e;
    result.rms += e * e;
  }
  const double n = static_cast<double>(result.n);
  result.within_1 /= n;
  result.within_2 /= n;
  result.mean /= n;
  result.rms = std::sqrt(result.rms / n);
  return result;
}

}  // namespace kinemap::eval
