// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <optional>
#include <vector>

#include "core/body.hpp"
#include "protocol/wire/mxtp.hpp"

namespace kinemap {

/// What a scale message (or the points of an MVNX file) says of the wearer: finger tip, palm, stature
/// (protocol/README.md, WearerInfo). Leaves `info.name` alone; what cannot be told, or lies outside what a body can
/// have, becomes absent.
void describe_body(const mxtp::Scale& scale, WearerInfo& info);

/// Collects one character's types 12 and 13. Memory is bounded.
class WearerCollector {
 public:
  void add(const mxtp::MetaData& meta);
  /// The fault of the whole message, once its last missing part has come.
  std::optional<mxtp::Fault> add(const mxtp::Header& header, const mxtp::ScaleFragment& fragment);

  [[nodiscard]] const WearerInfo& info() const { return info_; }

 private:
  WearerInfo info_;
  std::map<std::uint8_t, std::vector<std::byte>> parts_;  ///< of type 13, by datagram index
  std::optional<std::uint8_t> last_;
};

bool operator==(const WearerInfo& a, const WearerInfo& b);

}  // namespace kinemap
