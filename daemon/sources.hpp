// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <optional>

#include "daemon/pipeline.hpp"
#include "daemon/receiver.hpp"

namespace kinemap {

/// Where the server's answers come from. All are called on the server's thread and return at once.
struct Sources {
  std::function<std::shared_ptr<const MapSnapshot>()> map;  ///< never null
  std::function<LiveBody()> body;
  std::function<ReceiverState()> suit;
  std::function<PipelineStats()> pipeline;
  std::function<std::optional<Notice>()> take_notice;
};

}  // namespace kinemap
