// SPDX-License-Identifier: Apache-2.0
#include "protocol/wire/ip_fragments.hpp"

#include <algorithm>

namespace kinemap::ip {

namespace {

constexpr std::size_t kLargest = 65535;

bool same_datagram(const Packet& a, const Packet& b) {
  return a.version == b.version && a.fragment_id == b.fragment_id && a.source == b.source &&
         a.destination == b.destination && (a.version == 6 || a.protocol == b.protocol);
}

}  // namespace

FragmentTable::Pending& FragmentTable::pending_for(const Packet& fragment, double time_s) {
  while (!pending_.empty() && (time_s - pending_.front().since_s > kLongestS)) {
    pending_.pop_front();
    ++unfinished_;
  }
  const auto it = std::find_if(pending_.begin(), pending_.end(),
                               [&](const Pending& p) { return same_datagram(p.first, fragment); });
  if (it != pending_.end()) return *it;
  if (pending_.size() == kMost) {
    pending_.pop_front();
    ++unfinished_;
  }
  Pending fresh;
  fresh.first = fragment;
  fresh.since_s = time_s;
  pending_.push_back(std::move(fresh));
  return pending_.back();
}

void FragmentTable::place(Pending& p, const Packet& f) {
  const Part part{f.fragment_offset, f.fragment_offset + f.body.size()};
  // Only the last fragment's length may be other than a multiple of 8.
  if (f.body.empty() || part.end > kLargest || (f.more_fragments && f.body.size() % 8 != 0)) p.spoilt = true;
  if (!f.more_fragments && p.length && *p.length != part.end) p.spoilt = true;
  if (p.spoilt) return;
  const auto at = std::lower_bound(p.parts.begin(), p.parts.end(), part,
                                   [](const Part& a, const Part& b) { return a.begin < b.begin; });
  if (at != p.parts.end() && at->begin == part.begin && at->end == part.end) return;
  const bool overlaps =
      (at != p.parts.end() && at->begin < part.end) || (at != p.parts.begin() && std::prev(at)->end > part.begin);
  if (overlaps) {
    p.spoilt = true;
    return;
  }
  if (!f.more_fragments) p.length = part.end;
  if (p.bytes.size() < part.end) p.bytes.resize(part.end);
  std::copy(f.body.begin(), f.body.end(), p.bytes.begin() + static_cast<std::ptrdiff_t>(part.begin));
  p.parts.insert(at, part);
  if (f.fragment_offset == 0) p.first = f;
}

bool FragmentTable::is_whole(const Pending& p) {
  if (p.spoilt || !p.length) return false;
  std::size_t end = 0;
  for (const Part& part : p.parts) {
    if (part.begin != end) return false;
    end = part.end;
  }
  return end == *p.length;
}

std::optional<FragmentTable::Whole> FragmentTable::add(const Packet& fragment, double time_s) {
  Pending& p = pending_for(fragment, time_s);
  if (!p.spoilt) place(p, fragment);
  if (!is_whole(p)) return std::nullopt;
  Whole out{p.first, std::move(p.bytes)};
  out.packet.body = {};
  const auto same = [&p](const Pending& q) { return &q == &p; };
  pending_.erase(std::find_if(pending_.begin(), pending_.end(), same));
  return out;
}

void FragmentTable::clear() {
  unfinished_ += pending_.size();
  pending_.clear();
}

}  // namespace kinemap::ip
