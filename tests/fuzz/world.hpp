// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "daemon/api.hpp"
#include "tests/daemon/support.hpp"
#include "tests/protocol/sample_map.hpp"

namespace kinemap::fuzz {

/// The API over a small map that does not change.
inline Api& api() {
  static const auto map = std::make_shared<const MapSnapshot>(sample_map());
  static const auto news = std::make_shared<const ReceiverNews>();
  static Api api({.map = [] { return map; },
                  .body =
                      [] {
                        return test::body_at(1.5, {1, 2, 1});
                      },
                  .suit =
                      [] {
                        return ReceiverState{{}, news, 10.0};
                      },
                  .pipeline = [] { return PipelineStats{}; },
                  .take_notice = [] { return std::nullopt; }},
                 Config::Suit{}, 9763);
  return api;
}

}  // namespace kinemap::fuzz
