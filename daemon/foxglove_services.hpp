// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "daemon/api.hpp"
#include "daemon/foxglove_protocol.hpp"

namespace kinemap::foxglove {

/// The API's JSON queries as services: /api/v1/objects is "/kinemap/objects", /api/v1/objects/{id} is
/// "/kinemap/objects/by_id" with the member "id". The request is a JSON object of the query's parameters (or nothing),
/// the response what HTTP answers.
class Services {
 public:
  explicit Services(Api& api);

  [[nodiscard]] std::string advertise_text() const;
  /// An error for an unknown service, another encoding, or a request that is no JSON object of parameters.
  Reply call(const ServiceCall& call);

 private:
  struct Service {
    std::string name;
    const Route* route;
  };

  Api& api_;
  std::vector<Service> services_;  // id: index + 1
};

}  // namespace kinemap::foxglove
