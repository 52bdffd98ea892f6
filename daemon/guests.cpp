// SPDX-License-Identifier: Apache-2.0
#include "daemon/guests.hpp"

#include <map>
#include <optional>
#include <tuple>

namespace kinemap {
namespace {

/// Connections by token; those without one count as of one.
using Holdings = std::map<std::optional<TokenHash>, std::size_t>;

Scope claim_of(const Guest& guest) { return guest.waiting ? Scope::Nothing : guest.scope; }

/// The greater, the sooner it has to go.
auto dispensability(const Guest& guest, const Holdings& holdings) {
  return std::tuple(-static_cast<int>(claim_of(guest)), holdings.at(guest.visit.token), guest.visitor->connections);
}

bool has_less_claim(const Guest& guest, const Guest& newcomer, const Holdings& holdings) {
  const Scope claim = claim_of(newcomer);
  if (claim_of(guest) != claim) return claim_of(guest) < claim;
  if (claim == Scope::Nothing && guest.visitor->local != newcomer.visitor->local) return newcomer.visitor->local;
  if (guest.visit.token != newcomer.visit.token)
    return holdings.at(guest.visit.token) > holdings.at(newcomer.visit.token);
  if (guest.visitor != newcomer.visitor) return guest.visitor->connections > newcomer.visitor->connections;
  return guest.waiting;
}

/// Why the policy does not let the guest stay.
std::optional<ApiError> lost_admission(const Guest& guest, const WebPolicy& policy) {
  if (auto problem = policy.refusal(guest.visit)) return problem;
  if (policy.scope_of(guest.visit) >= guest.scope) return std::nullopt;
  return ApiError{403, "scope_fell", "your token may do less than it could; connect again"};
}

}  // namespace

Guests::Place Guests::take_in(std::shared_ptr<Visitor> visitor) {
  ++counts_.connections;
  ++visitor->connections;
  return guests_.insert(guests_.end(), Guest{.visitor = std::move(visitor), .leave = {}});
}

void Guests::remove(Place place) {
  if (!place->leaving) {
    --counts_.connections;
    --place->visitor->connections;
  }
  guests_.erase(place);
}

void Guests::mark(Place place, bool waiting) {
  place->waiting = waiting;
  guests_.splice(guests_.end(), guests_, place);
}

bool Guests::make_room(const Guest& newcomer, bool same_address) {
  Holdings holdings;
  for (const Guest& guest : guests_)
    if (!guest.leaving) ++holdings[guest.visit.token];
  Guest* found = nullptr;
  for (Guest& guest : guests_) {
    if (&guest == &newcomer || guest.leaving || (same_address && guest.visitor != newcomer.visitor)) continue;
    if (!has_less_claim(guest, newcomer, holdings)) continue;
    if (found == nullptr || dispensability(guest, holdings) > dispensability(*found, holdings)) found = &guest;
  }
  if (found == nullptr) return false;
  ++(found->waiting ? counts_.gave_way : counts_.displaced);
  dismiss(*found, {503, "place_needed", "your place went to somebody who has fewer, or a token that may do more"});
  return true;
}

void Guests::hold_to(const WebPolicy& policy) {
  for (Guest& guest : guests_) {
    if (!guest.stream || guest.leaving) continue;
    const auto why = lost_admission(guest, policy);
    if (!why) continue;
    ++counts_.revoked;
    dismiss(guest, *why);
  }
}

void Guests::dismiss(Guest& guest, const ApiError& why) {
  guest.leaving = true;
  --counts_.connections;
  --guest.visitor->connections;
  guest.leave(why);
}

}  // namespace kinemap
