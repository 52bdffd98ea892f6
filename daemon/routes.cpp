// SPDX-License-Identifier: Apache-2.0
#include "daemon/routes.hpp"

#include <algorithm>
#include <limits>
#include <numeric>

#include "daemon/params.hpp"

namespace kinemap {
namespace {

constexpr std::size_t kShownPath = 80;

/// What of `path` stands for the {…} of the pattern; nullopt when they do not match.
std::optional<std::string_view> match(std::string_view pattern, std::string_view path) {
  const auto open = pattern.find('{');
  if (open == std::string_view::npos) return pattern == path ? std::optional<std::string_view>("") : std::nullopt;
  const auto tail = pattern.substr(pattern.find('}') + 1);
  if (!path.starts_with(pattern.substr(0, open)) || !path.ends_with(tail)) return std::nullopt;
  if (path.size() < open + tail.size()) return std::nullopt;
  const auto id = path.substr(open, path.size() - open - tail.size());
  return id.empty() || id.find('/') != std::string_view::npos ? std::nullopt : std::optional(id);
}

/// Levenshtein's distance: characters to put in, to leave out or to change.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = std::exchange(row[0], i + 1);
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t change = diagonal + (a[i] != b[j]);
      diagonal = row[j + 1];
      row[j + 1] = std::min({change, row[j] + 1, diagonal + 1});
    }
  }
  return row.back();
}

}  // namespace

std::optional<Routes::Match> Routes::find(std::string_view path) const {
  for (const Route& route : routes_)
    if (const auto id = match(route.path, path)) return Match{&route, *id};
  return std::nullopt;
}

ApiError Routes::unknown(std::string_view path) const {
  const auto shown = path.substr(0, kShownPath);
  std::string nearest;
  std::size_t least = std::numeric_limits<std::size_t>::max();
  for (const Route& route : routes_) {
    const std::size_t distance = edit_distance(shown, route.path);
    if (distance < least) {
      least = distance;
      nearest = route.path;
    }
  }
  return {.status = 404,
          .code = "not_found",
          .message = "there is no " + std::string(shown) + "; the nearest path is " + nearest,
          .nearest = nearest};
}

Reply Routes::answer(std::string_view path, const Params& params) const {
  const auto found = find(path);
  if (!found) return error_reply(unknown(path));
  if (const auto error = check_params(params, found->route->params)) return error_reply(*error);
  return found->route->answer({params, found->id});
}

}  // namespace kinemap
