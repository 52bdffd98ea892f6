// SPDX-License-Identifier: Apache-2.0
#include <spdlog/spdlog.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <utility>

#include "daemon/config.hpp"
#include "daemon/daemon.hpp"
#include "daemon/logging.hpp"
#include "daemon/service_manager.hpp"
#include "daemon/signals.hpp"

#ifdef KINEMAP_JEMALLOC
/// jemalloc(3) reads it. Optimising takes tens of megabytes for a moment, again and again; glibc's heap consisted of
/// the holes for two thirds after some hours. What is free goes back to the system after a second, in a thread of its
/// own.
extern "C" {
const char* malloc_conf = "background_thread:true,narenas:2,dirty_decay_ms:1000,muzzy_decay_ms:0";
}
#endif

namespace {

using namespace kinemap;

constexpr const char* kDescription =
    "Kinemap's daemon: listens to an Xsens MVN suit and serves the map of what its wearer walks along, sits on and "
    "touches.\n"
    "Without a suit, `kinemap sim` or `kinemap replay` can feed it.";
constexpr const char* kFooter =
    "Signals: SIGINT and SIGTERM end it, SIGHUP rereads the configuration.\n"
    "Exit codes: 0 ended by a signal, 1 could not start, 2 wrong configuration or arguments, 3 a port is taken.";

constexpr int kLooksAPeriod = 4;    // of the watchdog's
constexpr int kSolverPeriods = 12;  // that the solver may have work and not move: two minutes
constexpr double kLongS = 120.0;    // at one entry, where optimising takes seconds

struct Arguments {
  std::string config_path;
  bool check = false;
  bool print = false;
  std::optional<std::uint16_t> port, suit_port;
};

/// The exit code when the program is to end here (--help, --version, wrong arguments).
std::optional<int> parse_arguments(int argc, char** argv, Arguments& arguments) {
  CLI::App app(kDescription, "kinemapd");
  app.footer(kFooter);
  app.set_version_flag("--version", "kinemapd " KINEMAP_VERSION);
  app.add_option("--config", arguments.config_path, "Configuration file; without it, everything has its default")
      ->type_name("FILE");
  app.add_flag("--check-config", arguments.check, "Check the configuration and end");
  app.add_flag("--print-config", arguments.print, "Print the configuration in force, every key, and end");
  app.add_option("--port", arguments.port, "Port of the API instead of api.port; 0: any free one")->type_name("PORT");
  app.add_option("--suit-port", arguments.suit_port, "Port for the suit instead of suit.port; 0: any free one")
      ->type_name("PORT");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : static_cast<int>(ExitCode::Config);
  }
  return std::nullopt;
}

Result<Config> load(const Arguments& arguments) {
  auto config = arguments.config_path.empty() ? Result<Config>(Config{}) : config_from_file(arguments.config_path);
  if (!config) return config;
  if (arguments.port) config->api.port = *arguments.port;
  if (arguments.suit_port) config->suit.port = *arguments.suit_port;
  return config;
}

void reload(const Arguments& arguments, Daemon& daemon) {
  auto config = load(arguments);
  if (config)
    daemon.reconfigure(*config);
  else
    spdlog::error("SIGHUP: the configuration stays as it was: {}", config.error());
}

int run(const Arguments& arguments, const Config& config) {
  Signals signals;
  auto started = Daemon::start(config);
  if (const auto* error = std::get_if<StartError>(&started)) {
    spdlog::error("{}", error->message);
    return static_cast<int>(error->code);
  }
  Daemon& daemon = *std::get<std::unique_ptr<Daemon>>(started);
  notify_service_manager("READY=1");
  // systemd hears of us as long as detection and solver get on, not as long as this thread does.
  Watchdog watchdog(daemon.pulse(), daemon.solver_progress(), kLooksAPeriod * kSolverPeriods);
  bool is_long = false;
  const auto tick = [&] {
    const bool was_stuck = watchdog.solver_is_stuck();
    if (watchdog.look(daemon.pulse(), daemon.solver_progress())) notify_service_manager("WATCHDOG=1");
    if (watchdog.solver_is_stuck() && !was_stuck)
      spdlog::critical("the solver has work and does not move; the watchdog is not fed any more");
    if (const bool was_long = std::exchange(is_long, daemon.solver_at_entry_s() > kLongS); is_long && !was_long)
      spdlog::warn("the solver has been at one entry for {:.0f} s; the map waits for it, nothing is lost", kLongS);
    daemon.ask_for_pulse();
    notify_service_manager("STATUS=" + daemon.summary());
  };
  const auto period = watchdog_period().value_or(std::chrono::seconds(20)) / kLooksAPeriod;
  tick();
  while (signals.wait(period, tick) == Signal::Reload) {
    notify_service_manager("RELOADING=1");
    reload(arguments, daemon);
    notify_service_manager("READY=1");
  }
  notify_service_manager("STOPPING=1");
  spdlog::info("ending");
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  Arguments arguments;
  if (const auto code = parse_arguments(argc, argv, arguments)) return *code;
  set_up_logging();
  const auto config = load(arguments);
  if (!config) {
    std::fprintf(stderr, "kinemapd: %s\n", config.error().c_str());
    return static_cast<int>(ExitCode::Config);
  }
  if (const auto error = arguments.check ? Server::check(config->api) : std::nullopt) {
    std::fprintf(stderr, "kinemapd: %s\n", error->message.c_str());
    return static_cast<int>(ExitCode::Config);
  }
  if (arguments.print) std::printf("%s\n", to_json(*config).dump(2).c_str());
  if (arguments.check && !arguments.print) std::printf("the configuration is right\n");
  if (arguments.print || arguments.check) return 0;
  return run(arguments, *config);
}
