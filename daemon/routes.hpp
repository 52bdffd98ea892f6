// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "daemon/answer.hpp"
#include "daemon/url.hpp"

namespace kinemap {

/// One parameter of a query, as clients are told of it.
struct ParamSpec {
  const char* name;
  const char* schema;   ///< its JSON Schema, as in OpenAPI
  const char* meaning;  ///< one sentence, with the unit
};

/// One question, taken apart.
struct Call {
  const Params& params;  ///< only those that the route has, each once
  std::string_view id;   ///< what stands for the {…} of the path
};

/// A path, what may be asked there, and what answers: this one table is behind HTTP, the stream's queries, the errors
/// and OpenAPI.
struct Route {
  std::string path;          ///< "/api/v1/objects/{id}": {…} stands for one segment
  std::string summary = {};  ///< one sentence
  std::vector<ParamSpec> params = {};
  std::string schema = {};        ///< of a JSON answer: its name in protocol/api.schema.json
  std::string content_type = {};  ///< of any other answer
  bool open = false;              ///< for everybody, without a token
  std::function<Reply(const Call&)> answer;
};

class Routes {
 public:
  void add(Route route) { routes_.push_back(std::move(route)); }
  [[nodiscard]] const std::vector<Route>& all() const { return routes_; }

  struct Match {
    const Route* route;
    std::string_view id;
  };
  [[nodiscard]] std::optional<Match> find(std::string_view path) const;
  /// The answer of the route at `path`; for a path that there is not, 404 with the nearest one.
  [[nodiscard]] Reply answer(std::string_view path, const Params& params) const;
  [[nodiscard]] ApiError unknown(std::string_view path) const;

 private:
  std::vector<Route> routes_;
};

}  // namespace kinemap
