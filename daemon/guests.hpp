// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <list>
#include <memory>
#include <utility>

#include "daemon/status.hpp"
#include "daemon/visitors.hpp"
#include "daemon/web_policy.hpp"

namespace kinemap {

/// A connection as the others see it: whose it is, and how it ends.
struct Guest {
  std::shared_ptr<Visitor> visitor;
  WebVisit visit{};                            ///< its newest request
  Scope scope = Scope::Nothing;                ///< that it showed
  bool stream = false;                         ///< it has become a WebSocket
  bool waiting = true;                         ///< no request of it is being answered
  bool surplus = false;                        ///< there was no room for it yet
  bool leaving = false;                        ///< it has been told to, and is not counted any more
  std::function<void(const ApiError&)> leave;  ///< tells the client why, where that can be done, and ends it
};

/// All connections, and who has to go when there are more than may be. The server's thread only.
class Guests {
 public:
  using Place = std::list<Guest>::iterator;
  explicit Guests(ApiCounts& counts) : counts_(counts) {}

  Place take_in(std::shared_ptr<Visitor> visitor);
  void remove(Place place);
  /// It has asked for something just now, or begins to wait for the next request.
  void mark(Place place, bool waiting);

  /// Ends one that has less claim to its place than the newcomer; with `same_address` only one of the newcomer's own
  /// address. False when there is none.
  ///
  /// Connections on which nothing is asked, or without a token, have the least claim (of other machines less than of
  /// this one), then scope read, then admin. Among equals the tokens share alike, and under one token the addresses do:
  /// whoever has more than the newcomer loses the one that has been quiet for longest. So nobody keeps others out by
  /// opening many, whatever he shows.
  bool make_room(const Guest& newcomer, bool same_address = false);
  /// Ends WebSockets that the policy would not let in any more, or whose token may do less than when it was let in.
  void hold_to(const WebPolicy& policy);

 private:
  void dismiss(Guest& guest, const ApiError& why);

  ApiCounts& counts_;
  std::list<Guest> guests_;  // who has been quiet for longest first
};

/// The place of one connection, for as long as that lives.
class ConnectionSlot {
 public:
  ConnectionSlot(Guests& guests, std::shared_ptr<Visitor> visitor)
      : guests_(&guests), place_(guests.take_in(std::move(visitor))) {}
  ConnectionSlot(ConnectionSlot&& other) noexcept
      : guests_(std::exchange(other.guests_, nullptr)), place_(other.place_) {}
  ConnectionSlot& operator=(ConnectionSlot&&) = delete;
  ~ConnectionSlot() {
    if (guests_ != nullptr) guests_->remove(place_);
  }
  [[nodiscard]] Guest& guest() const { return *place_; }
  [[nodiscard]] Visitor& visitor() const { return *place_->visitor; }
  /// Nothing once the place has been handed on.
  void mark(bool waiting) {
    if (guests_ != nullptr) guests_->mark(place_, waiting);
  }

 private:
  Guests* guests_;  // null: moved from
  Guests::Place place_;
};

}  // namespace kinemap
