// SPDX-License-Identifier: Apache-2.0
#include <nlohmann/json.hpp>

#include "tools/kinemap/client.hpp"
#include "tools/kinemap/command.hpp"
#include "tools/kinemap/news.hpp"
#include "tools/kinemap/stop_signal.hpp"

namespace kinemap::cli {
namespace {

using namespace std::chrono_literals;

struct Options {
  DaemonOptions daemon;
  std::vector<std::string> topics = {"map", "events"};
  bool once = false;
  bool json = false;
};

/// Prints what comes until the connection or the program ends; why, unless it was asked to.
std::optional<Error> follow(StreamClient& stream, const Options& options, int& exit_code) {
  News news;
  while (!stop_requested()) {
    const auto message = stream.next(200ms);
    if (!message) return Error{message.error()};
    if (!*message) continue;
    const std::string text = options.json ? **message + '\n' : news.lines(**message);
    exit_code = print("watch", text);
    if (exit_code != kOk) return std::nullopt;
  }
  return std::nullopt;
}

int watch(const Options& options) {
  const auto daemon = daemon_of(options.daemon);
  if (!daemon) return fail("watch", daemon.error(), kUsage);
  const std::string subscribe = nlohmann::json{{"op", "subscribe"}, {"topics", options.topics}}.dump();
  catch_stop_signals();

  int exit_code = kOk;
  auto pause = 500ms;
  while (!stop_requested() && exit_code == kOk) {
    auto stream = StreamClient::connect(*daemon, subscribe);
    std::optional<Error> error = stream ? std::nullopt : std::optional(Error{stream.error()});
    if (stream) {
      std::fprintf(stderr, "watching %s; Ctrl-C ends\n", daemon->text().c_str());
      pause = 500ms;
      error = follow(*stream, options, exit_code);
    }
    if (!error) continue;
    if (options.once) return fail("watch", error->message);
    fail("watch", error->message + "; trying again");
    sleep_until(std::chrono::steady_clock::now() + pause);
    pause = std::min(pause * 2, std::chrono::milliseconds(5000));
  }
  return exit_code;
}

}  // namespace

void add_watch(CLI::App& app, Run& run) {
  auto options = std::make_shared<Options>();
  CLI::App* command =
      add_command(app, run, "watch", "Follow a running kinemapd: objects and gestures as they come",
                  "  kinemap watch\n"
                  "  kinemap watch --topics map,events,status --url http://wearable.local:8765\n"
                  "  kinemap watch --topics pose --json | jq .data.position\n"
                  "\n+ is new, ~ has changed by 2 cm or more, - is gone. The connection is made again when it is lost.",
                  options, watch);
  add_daemon_options(*command, options->daemon);
  command->add_option("--topics", options->topics, "map, events, status, pose")
      ->capture_default_str()
      ->delimiter(',')
      ->check(CLI::IsMember({"map", "events", "status", "pose"}));
  command->add_flag("--once", options->once, "End with an error when the connection fails, instead of trying again");
  command->add_flag("--json", options->json, "Print each message as one line of JSON");
}

}  // namespace kinemap::cli
