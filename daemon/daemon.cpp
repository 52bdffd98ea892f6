// SPDX-License-Identifier: Apache-2.0
#include "daemon/daemon.hpp"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <string_view>
#include <utility>

#include "daemon/service_manager.hpp"

namespace kinemap {
namespace {

constexpr const char* kSuitSocket = "suit";

/// All of api but where it listens.
bool is_reloadable(const std::string& key) {
  return key == "log.level" || (key.starts_with("api.") && key != "api.address" && key != "api.port");
}

/// Null where sessions are not kept.
Result<std::unique_ptr<SessionJournal>> open_journal(const Config::Journal& config) {
  const char* state = std::getenv("STATE_DIRECTORY");  // systemd's StateDirectory=
  const std::string directory = !config.directory.empty() ? config.directory : state != nullptr ? state : "";
  if (!directory.empty()) return SessionJournal::open(directory, config);
  if (config.record) return Error{"journal.record: the suit is recorded beside the journal; set journal.directory too"};
  spdlog::info("journal: none, since journal.directory is not set; a restart begins with an empty map");
  return std::unique_ptr<SessionJournal>();
}

}  // namespace

SuitSink Daemon::suit_sink() {
  return {[this](const SuitFrame& frame) { return pipeline_.offer(frame); },
          [this](const WearerInfo& wearer) { return pipeline_.offer(wearer); },
          [this] { return pipeline_.offer_silence(); },
          [this](std::span<const std::byte> datagram, const std::string& sender) {
            pipeline_.offer(datagram, sender, config_.suit.port);
          }};
}

Sources Daemon::sources() {
  return {[this] { return pipeline_.map(); }, [this] { return pipeline_.live_body(); },
          [this] { return receiver_->state(); }, [this] { return pipeline_.stats(); },
          [this] { return pipeline_.take_notice(); }};
}

Started<Daemon> Daemon::start(const Config& config) {
  spdlog::set_level(spdlog::level::from_str(config.log.level));
  auto journal = open_journal(config.journal);
  if (!journal) return StartError{ExitCode::Config, journal.error()};
  auto daemon = std::unique_ptr<Daemon>(new Daemon(config, *std::move(journal)));
  auto receiver = Receiver::open(config.suit, config.stream, daemon->suit_sink(), take_kept_socket(kSuitSocket));
  if (auto* error = std::get_if<StartError>(&receiver)) return std::move(*error);
  daemon->receiver_ = std::get<0>(std::move(receiver));
  keep_socket(kSuitSocket, daemon->receiver_->udp_socket());
  auto server = Server::open(config.api, daemon->sources(), config.suit, daemon->suit_port());
  if (auto* error = std::get_if<StartError>(&server)) return std::move(*error);
  daemon->server_ = std::get<0>(std::move(server));
  const bool v6 = config.api.address.find(':') != std::string::npos;
  spdlog::info("ready: suit on {} {} port {}, map at {}://{}:{}/", config.suit.transport, config.suit.address,
               daemon->suit_port(), daemon->server_->encrypts() ? "https" : "http",
               v6 ? "[" + config.api.address + "]" : config.api.address, daemon->api_port());
  if (config.api.auth == "none" && !daemon->server_->loopback_only())
    spdlog::warn("api: api.auth is none: everybody who reaches port {} can read the map", daemon->api_port());
  return daemon;
}

void Daemon::reconfigure(const Config& config) {
  Config::Api api = config.api;
  api.address = config_.api.address;
  api.port = config_.api.port;
  if (const auto error = server_->reconfigure(api)) {
    spdlog::error("SIGHUP: the configuration stays as it was: {}", error->message);
    return;
  }
  for (const auto& key : changed_keys(config_, config)) {
    if (is_reloadable(key))
      spdlog::info("SIGHUP: {} has changed", key);
    else
      spdlog::warn("SIGHUP: {} has changed in the file and needs a restart", key);
  }
  spdlog::set_level(spdlog::level::from_str(config.log.level));
  config_.log = config.log;
  config_.api = std::move(api);
  spdlog::info("SIGHUP: the configuration was read again");
}

std::string Daemon::summary() const {
  const auto state = receiver_->state();
  const auto map = pipeline_.map();
  const bool ever = state.counts.last_frame_s >= 0.0;
  const double silence_s = state.now_s - state.counts.last_frame_s;
  const std::string suit = state.news->refusal ? "refused: " + *state.news->refusal
                           : !ever             ? fmt::format("waiting for the suit on port {}", suit_port())
                           : silence_s > 2.0   ? fmt::format("suit silent for {:.0f} s", silence_s)
                                               : fmt::format("receiving {:.0f} Hz", state.counts.rate_hz);
  return fmt::format("{}; {} objects, {} rooms, {} loops closed", suit, map->objects.size(), map->rooms.size(),
                     map->graph.loop_closures);
}

}  // namespace kinemap
