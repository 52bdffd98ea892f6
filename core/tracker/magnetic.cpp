// SPDX-License-Identifier: Apache-2.0
#include "core/tracker/magnetic.hpp"

#include <algorithm>
#include <cmath>

namespace kinemap {
namespace {

double median(const std::vector<MagneticField>& fields, double MagneticField::*value) {
  std::vector<double> values;
  values.reserve(fields.size());
  for (const auto& field : fields) values.push_back(field.*value);
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

std::optional<bool> MagneticFold::step(const SuitFrame& frame) {
  if (frame.field_pelvis) {
    smooth(frame.time_s, *frame.field_pelvis);
    learn(frame[Segment::Pelvis].p.head<2>());
  }
  if (!started_ || frame.time_s - seen_s_ > config_.gap_s || places_.size() < config_.min_places) return std::nullopt;
  // Strength as a ratio: that of the calibration is not that of this building.
  const double norm = std::abs(field_.norm / usual_.norm - 1.0);
  const double dip = std::abs(field_.dip - usual_.dip);
  disturbed_ = norm > (disturbed_ ? config_.norm_off : config_.norm_on) ||
               dip > (disturbed_ ? config_.dip_off_rad : config_.dip_on_rad);
  return disturbed_;
}

void MagneticFold::smooth(double time_s, const MagneticField& field) {
  const double dt = time_s - seen_s_;
  const double gain = started_ && dt <= config_.gap_s ? 1.0 - std::exp(-dt / config_.smoothing_s) : 1.0;
  field_.norm += gain * (field.norm - field_.norm);
  field_.dip += gain * (field.dip - field_.dip);
  started_ = true;
  seen_s_ = time_s;
}

void MagneticFold::learn(const Eigen::Vector2d& place) {
  if (!places_.empty() && (place - place_).norm() < config_.place_m) return;
  place_ = place;
  if (places_.size() < config_.max_places) {
    places_.push_back(field_);
  } else {
    places_[oldest_] = field_;
    oldest_ = (oldest_ + 1) % places_.size();
  }
  usual_ = {median(places_, &MagneticField::norm), median(places_, &MagneticField::dip)};
}

}  // namespace kinemap
