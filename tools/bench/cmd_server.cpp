// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "core/mapper/mapper.hpp"
#include "core/tracker/tracker.hpp"
#include "daemon/latest.hpp"
#include "daemon/server.hpp"
#include "protocol/json_text.hpp"
#include "protocol/recording.hpp"
#include "protocol/text_format.hpp"
#include "tools/bench/commands.hpp"
#include "tools/bench/scenario.hpp"
#include "tools/bench/server_clients.hpp"
#include "tools/bench/temporary_directory.hpp"
#include "tools/kinemap/client.hpp"

namespace kinemap::bench {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kTurns = 4;

struct Options {
  std::string recording;
  double seconds = 60.0;
  double rate_hz = 120.0;
  double revisions_hz = 2.0;
  int clients = 200;
  int sleepers = 20;
  int objects = 10000;
  bool json = false;
};

double seconds_of(Clock::duration duration) { return std::chrono::duration<double>(duration).count(); }
double now_s() { return seconds_of(Clock::now().time_since_epoch()); }
Clock::duration duration_of(double seconds) {
  return std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
}

double resident_mb() {
  std::uint64_t size = 0, resident = 0;
  std::ifstream("/proc/self/statm") >> size >> resident;
  return static_cast<double>(resident) * static_cast<double>(::sysconf(_SC_PAGESIZE)) / 1e6;
}

/// A session: its frames, and the maps that the mapper made of it.
struct Session {
  std::vector<SuitFrame> frames;
  std::vector<std::shared_ptr<const MapSnapshot>> maps;
};

Result<Session> read_session(const std::string& recording) {
  Session session;
  Tracker tracker{TrackerConfig{}};
  Mapper mapper{MapperConfig{}};
  std::vector<Event> events;
  const RecordingSink sink{.on_frame =
                               [&](const SuitFrame& frame) {
                                 session.frames.push_back(frame);
                                 events.clear();
                                 tracker.step(frame, events);
                                 for (const Event& event : events)
                                   if (mapper.add(event)) session.maps.push_back(mapper.snapshot());
                               },
                           .on_wearer = [](const WearerInfo&) {}};
  const auto summary = read_recording(recording, {}, sink);
  if (!summary) return Error{summary.error()};
  return session;
}

/// The suit's side of a daemon: steps a tracker at the suit's pace and publishes bodies and maps, as the pipeline does.
/// The recording and the maps begin anew when they end. Stream time is the steady clock's, so that clients can tell how
/// old a message is.
class Wearer {
 public:
  Wearer(const Session& session, const Options& options) : session_(session), options_(options) {
    thread_ = std::jthread([this](const std::stop_token& stop) { walk(stop); });
  }

  [[nodiscard]] Sources sources() {
    Sources sources;
    sources.map = [this] { return map_.get(); };
    sources.body = [this] { return body_.get(); };
    sources.suit = [] { return ReceiverState{{}, std::make_shared<const ReceiverNews>(), 0.0}; };
    sources.pipeline = [] { return PipelineStats{}; };
    sources.take_notice = [] { return std::nullopt; };
    return sources;
  }
  [[nodiscard]] double epoch_s() const { return epoch_s_; }
  /// To which figures the steps from now on are added.
  void measure(std::vector<double>* step_us) { step_us_ = step_us; }

 private:
  void walk(const std::stop_token& stop) {
    Tracker tracker{TrackerConfig{}};
    std::vector<Event> events;
    const auto begin = Clock::now();
    for (std::size_t i = 0; !stop.stop_requested(); ++i) {
      std::this_thread::sleep_until(begin + duration_of(static_cast<double>(i) / options_.rate_hz));
      if (i > 0 && i % session_.frames.size() == 0) tracker = Tracker{TrackerConfig{}};
      events.clear();
      const SuitFrame& frame = session_.frames[i % session_.frames.size()];
      const auto from = Clock::now();
      LiveBody body = live_body_of(frame, now_s());
      body.time_s = body.arrived_s - epoch_s_;
      body_.set(body);
      tracker.step(frame, events);
      const auto to = Clock::now();
      if (auto* step_us = step_us_.load()) step_us->push_back(seconds_of(to - from) * 1e6);
      const auto per_map = static_cast<std::size_t>(options_.rate_hz / options_.revisions_hz);
      if (i % per_map == 0) publish(i / per_map);
    }
  }

  void publish(std::size_t number) {
    auto map = std::make_shared<MapSnapshot>(*session_.maps[number % session_.maps.size()]);
    map->revision = number + 1;
    map->time_s = now_s() - epoch_s_;
    map_.set(std::move(map));
  }

  const Session& session_;
  const Options& options_;
  double epoch_s_ = now_s();
  LatestValue<LiveBody> body_;
  Latest<MapSnapshot> map_{std::make_shared<const MapSnapshot>()};
  std::atomic<std::vector<double>*> step_us_ = nullptr;
  std::jthread thread_;  // last: joined first
};

/// The most memory of this process while it lives.
class MemoryWatch {
 public:
  MemoryWatch() {
    thread_ = std::jthread([this](const std::stop_token& stop) {
      while (!stop.stop_requested()) {
        most_mb_ = std::max(most_mb_.load(), resident_mb());
        std::this_thread::sleep_for(std::chrono::milliseconds(100));
      }
    });
  }
  [[nodiscard]] double most_mb() const { return most_mb_; }

 private:
  std::atomic<double> most_mb_ = 0.0;
  std::jthread thread_;
};

struct Figures {
  std::vector<double> idle_us, busy_us;  ///< steps of the tracker
  ClientsReport clients;
  double before_mb = 0.0, most_mb = 0.0;
  nlohmann::json status;  ///< "clients" of the daemon's status at the end
};

std::unique_ptr<Server> open_server(Sources sources) {
  Config::Api config;
  config.port = 0;
  config.max_clients = 1000;
  auto started = Server::open(config, std::move(sources), Config::Suit{}, 0);
  return started.index() == 0 ? std::get<0>(std::move(started)) : nullptr;
}

cli::DaemonAddress address_of(const Server& server) {
  cli::DaemonAddress address;
  address.endpoint = {"127.0.0.1", server.port()};
  return address;
}

/// Without and with clients by turns, so that a drift of the machine does not count.
Result<Figures> measure(const Session& session, const Options& options) {
  Figures figures;
  for (auto* list : {&figures.idle_us, &figures.busy_us})
    list->reserve(static_cast<std::size_t>(options.rate_hz * options.seconds * 1.5));
  Wearer wearer(session, options);
  const auto server = open_server(wearer.sources());
  if (!server) return Error{"no port for the server"};
  for (int turn = 0; turn < kTurns; ++turn) {
    std::this_thread::sleep_for(std::chrono::seconds(2));
    wearer.measure(&figures.idle_us);
    std::this_thread::sleep_for(duration_of(options.seconds / kTurns));
    wearer.measure(nullptr);
    if (turn == 0) figures.before_mb = resident_mb();

    const MemoryWatch memory;
    wearer.measure(&figures.busy_us);
    const auto clients = run_clients_apart({.port = server->port(),
                                            .readers = options.clients - options.sleepers,
                                            .sleepers = options.sleepers,
                                            .seconds = options.seconds / kTurns,
                                            .epoch_s = wearer.epoch_s()});
    wearer.measure(nullptr);
    if (!clients) return Error{clients.error()};
    figures.clients.connected = clients->connected;
    figures.clients.lost += clients->lost;
    for (const auto& [topic, values] : clients->delivery_ms) {
      auto& all = figures.clients.delivery_ms[topic];
      all.insert(all.end(), values.begin(), values.end());
    }
    figures.most_mb = std::max(figures.most_mb, memory.most_mb());
  }
  const auto status = cli::http_get(address_of(*server), "/api/v1/status");
  if (!status) return Error{status.error()};
  figures.status = nlohmann::json::parse(*status).at("clients");
  return figures;
}

/// Milliseconds that each of these questions takes over HTTP with so many objects in the map, connection and all.
Result<std::map<std::string, std::vector<double>>> ask_large_map(const Session& session, const Options& options) {
  auto map = std::make_shared<MapSnapshot>(*session.maps.back());
  const auto objects = map->objects;
  map->objects.clear();
  for (std::size_t i = 0; i < static_cast<std::size_t>(options.objects); ++i) {
    MapObject object = objects[i % objects.size()];
    object.id = static_cast<std::uint32_t>(i + 1);
    const Eigen::Vector3d shift(static_cast<double>(i / objects.size() % 40) * 10.0,
                                static_cast<double>(i / objects.size() / 40) * 10.0, 0.0);
    object.pose.p += shift;
    if (object.corners)
      for (auto& corner : *object.corners) corner += shift;
    map->objects.push_back(std::move(object));
  }
  map->revision = 1;
  const std::shared_ptr<const MapSnapshot> large = std::move(map);
  Sources sources;
  sources.map = [large] { return large; };
  sources.body = [] { return LiveBody{}; };
  sources.suit = [] { return ReceiverState{{}, std::make_shared<const ReceiverNews>(), 0.0}; };
  sources.pipeline = [] { return PipelineStats{}; };
  sources.take_notice = [] { return std::nullopt; };
  const auto server = open_server(std::move(sources));
  if (!server) return Error{"no port for the server"};
  std::map<std::string, std::vector<double>> times_ms;
  for (const char* question : {"near=55,25&limit=10", "near=55,25&within=5", "near=55,25"})
    for (int i = 0; i < (std::string(question) == "near=55,25" ? 20 : 200); ++i) {
      const auto from = Clock::now();
      const auto answer = cli::http_get(address_of(*server), std::string("/api/v1/objects?") + question);
      if (!answer) return Error{answer.error()};
      times_ms[question].push_back(seconds_of(Clock::now() - from) * 1e3);
    }
  return times_ms;
}

nlohmann::ordered_json ranks(std::vector<double>& values) {
  nlohmann::ordered_json json = {{"count", values.size()}};
  for (const auto& [name, part] : {std::pair("50", 0.5), {"99", 0.99}, {"99.9", 0.999}, {"100", 1.0}})
    json[name] = percentile(values, part);
  return json;
}

std::string row(const std::string& name, const nlohmann::ordered_json& r) {
  return format("| %s | %llu | %.2f | %.2f | %.2f | %.2f |\n", name.c_str(), r.at("count").get<unsigned long long>(),
                r.at("50").get<double>(), r.at("99").get<double>(), r.at("99.9").get<double>(),
                r.at("100").get<double>());
}

int server(const Options& options) {
  const TemporaryDirectory directory;
  const auto scenario = make_scenario(directory.path(), options.recording);
  if (!scenario) return cli::fail("server", scenario.error());
  const auto session = read_session(scenario->recording);
  if (!session) return cli::fail("server", session.error());
  if (session->maps.empty() || session->maps.back()->objects.empty())
    return cli::fail("server", scenario->recording + ": nothing is mapped in it");
  auto figures = measure(*session, options);
  if (!figures) return cli::fail("server", figures.error());
  auto questions = ask_large_map(*session, options);
  if (!questions) return cli::fail("server", questions.error());

  nlohmann::ordered_json json = {
      {"scenario", scenario->name}, {"clients", figures->clients.connected}, {"lost", figures->clients.lost}};
  std::string text = format(
      "%s; %d clients for %.0f s, %d of which want bodies too and never read, 10 poses and %g revisions a second "
      "each\n\n"
      "| | count | p50 | p99 | p99.9 | most |\n|---|---|---|---|---|---|\n",
      scenario->name.c_str(), figures->clients.connected, options.seconds, options.sleepers, options.revisions_hz);
  for (auto& [topic, values] : figures->clients.delivery_ms)
    text += row("delivery of " + topic + ", ms", json["delivery_ms"][topic] = ranks(values));
  text += row("step of the tracker, idle server, µs", json["step_us"]["idle"] = ranks(figures->idle_us));
  text += row("step of the tracker, with clients, µs", json["step_us"]["busy"] = ranks(figures->busy_us));
  for (auto& [question, values] : *questions)
    text += row(format("objects?%s of %d, ms", question.c_str(), options.objects),
                json["objects_ms"][question] = ranks(values));
  const double ratio = json["step_us"]["busy"]["99.9"].get<double>() / json["step_us"]["idle"]["99.9"].get<double>();
  json["step_ratio_p99.9"] = ratio;
  json["memory_mb"] = {{"before", figures->before_mb}, {"most", figures->most_mb}};
  json["status"] = figures->status;
  text += format(
      "\np99.9 of the tracker's step, with clients to idle: %.2f\nmemory: %.1f MB before, at most %.1f MB with "
      "clients\nclients: %s\n",
      ratio, figures->before_mb, figures->most_mb, figures->status.dump().c_str());
  return cli::print("server", options.json ? pretty_text(json) : text);
}

int clients(const ClientsPlan& plan) {
  const ClientsReport report = run_clients(plan);
  return cli::print(
      "server-clients",
      nlohmann::json{{"delivery_ms", report.delivery_ms}, {"connected", report.connected}, {"lost", report.lost}}
          .dump());
}

}  // namespace

void add_server(CLI::App& app, cli::Run& run) {
  auto options = std::make_shared<Options>();
  CLI::App* command = cli::add_command(
      app, run, "server", "Delivery to many clients, some of which never read, and what they cost the tracker",
      "  bench server\n  bench server --seconds 20 --clients 50\n", options, server);
  command->add_option("--recording", options->recording, "Default: a simulated session of about six minutes")
      ->type_name("FILE");
  command->add_option("--seconds", options->seconds, "With clients, and as long without")
      ->capture_default_str()
      ->check(CLI::Range(1.0, 86400.0));
  command->add_option("--clients", options->clients, "WebSocket clients")
      ->capture_default_str()
      ->check(CLI::Range(1, 900));
  command->add_option("--sleepers", options->sleepers, "Of these, how many never read")
      ->capture_default_str()
      ->check(CLI::Range(0, 900));
  command->add_option("--revisions", options->revisions_hz, "Maps a second")
      ->capture_default_str()
      ->check(CLI::Range(0.1, 50.0));
  command->add_option("--objects", options->objects, "In the map that is asked for what is near")
      ->capture_default_str()
      ->check(CLI::Range(1, 1000000));
  command->add_flag("--json", options->json, "Print the figures as JSON");

  auto plan = std::make_shared<ClientsPlan>();
  CLI::App* hidden = cli::add_command(app, run, "server-clients",
                                      "The clients of `bench server`, which starts them itself", "", plan, clients);
  hidden->group("");
  hidden->add_option("--port", plan->port);
  hidden->add_option("--readers", plan->readers);
  hidden->add_option("--sleepers", plan->sleepers);
  hidden->add_option("--rate", plan->rate_hz);
  hidden->add_option("--seconds", plan->seconds);
  hidden->add_option("--epoch", plan->epoch_s);
}

}  // namespace kinemap::bench
