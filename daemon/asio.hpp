// SPDX-License-Identifier: Apache-2.0
#pragma once

// Boost 1.74's Asio uses std::exchange in C++20 mode without including its header.
#include <utility>
// clang-format off
#include <boost/asio.hpp>
// clang-format on

namespace kinemap {
namespace net = boost::asio;
using ErrorCode = boost::system::error_code;
}  // namespace kinemap
