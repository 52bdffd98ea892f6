// SPDX-License-Identifier: Apache-2.0
#include <nlohmann/json.hpp>

#include "protocol/json_text.hpp"
#include "tools/kinemap/command.hpp"
#include "tools/kinemap/files.hpp"
#include "tools/kinemap/progress.hpp"
#include "tools/kinemap/stop_signal.hpp"
#include "tools/kinemap/text_table.hpp"
#include "tools/kinemap/udp_sender.hpp"
#include "tools/sim/scene.hpp"
#include "tools/sim/simulate.hpp"

namespace kinemap::cli {
namespace {

struct Options {
  sim::SimOptions sim;
  std::string drift = "default";
  std::string format = "pcap";
  std::string shell = "auto";
  std::string scene = "auto";
  std::string out;
  std::string udp;
  std::string truth;
  std::vector<double> room_size;
  double replay_speed = 1.0;
  bool no_distractors = false;
  bool json = false;
  // CLI11 2.1 knows no std::optional of our kind here: 0 stands for "drawn from the seed" and is refused as a value.
  int rooms = 0, rounds = 0;
  std::uint64_t wearer_seed = 0;
  double stature_m = 0.0, closure_spacing_m = 0.0, packet_loss = -1.0;
};

sim::SimOptions sim_options(const Options& options) {
  sim::SimOptions sim = options.sim;
  sim.drift = *sim::severity_from(options.drift);
  sim.scene = *sim::scene_from(options.scene);
  sim.format = options.format == "mvnx" ? sim::Format::Mvnx : sim::Format::Pcap;
  sim.shell = options.shell == "rectangle" ? sim::Shell::Rectangle
              : options.shell == "l"       ? sim::Shell::LShape
                                           : sim::Shell::Auto;
  if (options.room_size.size() == 2) sim.room_size = {options.room_size[0], options.room_size[1]};
  if (options.wearer_seed) sim.wearer_seed = options.wearer_seed;
  if (options.rooms) sim.rooms = options.rooms;
  if (options.rounds) sim.rounds = options.rounds;
  if (options.stature_m > 0.0) sim.stature_m = options.stature_m;
  if (options.closure_spacing_m > 0.0) sim.closure_spacing_m = options.closure_spacing_m;
  if (options.packet_loss >= 0.0) sim.packet_loss = options.packet_loss;
  sim.distractors = !options.no_distractors;
  sim.out_dir = options.out;
  return sim;
}

std::string describe(const sim::SimReport& report) {
  return format(
      "%.0f s, %d room%s, %zu objects to be found, %zu traces, %zu sittings, %zu distractors\n"
      "walked %.0f m; the suit ends %.2f m from where it is\n%s samples, %s lost\n",
      report.duration_s, report.rooms, report.rooms == 1 ? "" : "s", report.objects, report.traces, report.sittings,
      report.distractors, report.walked_m, report.end_error_m, grouped(report.samples).c_str(),
      grouped(report.samples_lost).c_str());
}

nlohmann::ordered_json json_report(const sim::SimReport& report) {
  return {{"duration_s", report.duration_s}, {"rooms", report.rooms},
          {"objects", report.objects},       {"traces", report.traces},
          {"sittings", report.sittings},     {"distractors", report.distractors},
          {"walked_m", report.walked_m},     {"end_error_m", report.end_error_m},
          {"samples", report.samples},       {"samples_lost", report.samples_lost},
          {"session", report.session_path},  {"truth", report.truth_path}};
}

int to_directory(const Options& options, const sim::SimOptions& sim) {
  if (auto error = make_output_directory(options.out)) return fail("sim", error->message + "; choose another --out");
  const auto report = [&] {
    ProgressBar bar("sim");
    return sim::simulate_to_directory(sim, [&](double part) { bar.update(part); });
  }();
  if (!report) return fail("sim", report.error());
  if (options.json) return print("sim", pretty_text(json_report(*report)));
  return print("sim", describe(*report) + "wrote " + report->session_path + ", " + report->truth_path + '\n');
}

/// Sends the session; false when it was stopped or cannot be sent.
bool send_all(sim::LiveSource& source, PacedSender& sender) {
  ProgressBar bar("sim");
  const double total = source.report().duration_s;
  while (const auto packets = source.next()) {
    for (const mxtp::Bytes& datagram : packets->datagrams)
      if (!sender.send(packets->time_s, datagram)) return false;
    bar.update(packets->time_s / total, format("%.0f of %.0f s", packets->time_s, total));
  }
  return true;
}

int to_udp(const Options& options, const sim::SimOptions& sim) {
  const auto to = parse_endpoint(options.udp, "127.0.0.1", mxtp::kDefaultPort);
  if (!to) return fail("sim", to.error(), kUsage);
  auto source = sim::LiveSource::create(sim);
  if (!source) return fail("sim", source.error());
  auto sender = PacedSender::create(*to, options.replay_speed);
  if (!sender) return fail("sim", sender.error());
  catch_stop_signals();
  const bool complete = send_all(*source, *sender);
  if (sender->error()) return fail("sim", sender->error()->message);
  if (!options.truth.empty())
    if (auto error = write_file(options.truth, source->truth() + '\n')) return fail("sim", error->message);
  if (options.json) {
    nlohmann::ordered_json json = json_report(source->report());
    json["to"] = to->text();
    json["datagrams_sent"] = sender->sent();
    json["refused"] = sender->refused();
    json["stopped"] = !complete;
    return print("sim", pretty_text(json));
  }
  return print("sim",
               (complete ? describe(source->report()) : std::string("stopped; ")) + sending_report(*sender, *to));
}

int simulate(const Options& options) {
  if (options.out.empty() == options.udp.empty())
    return fail("sim", "give either --out DIR or --udp HOST:PORT", kUsage);
  const sim::SimOptions sim = sim_options(options);
  if (const auto wrong = sim::check(sim)) return fail("sim", *wrong, kUsage);
  return options.out.empty() ? to_udp(options, sim) : to_directory(options, sim);
}

void add_where_to(CLI::App& command, Options& options) {
  command.add_option("--out", options.out, "Write session.pcap (or .mvnx) and truth.json there")->type_name("DIR");
  command.add_option("--udp", options.udp, "Send live instead, as MVN does")->type_name("HOST:PORT");
  command.add_option("--speed", options.replay_speed, "With --udp: times real time; 0: as fast as possible")
      ->capture_default_str()
      ->check(CLI::Range(0.0, 1e6));
  command.add_option("--truth", options.truth, "With --udp: also write truth.json when done")->type_name("FILE");
  command.add_option("--format", options.format, "With --out: pcap or mvnx")
      ->capture_default_str()
      ->check(CLI::IsMember({"pcap", "mvnx"}));
  command.add_flag("--json", options.json, "Print the summary as JSON");
}

void add_what(CLI::App& command, Options& options) {
  command.add_option("--seed", options.sim.seed, "All that is not given below is drawn from it")->capture_default_str();
  command
      .add_option("--wearer-seed", options.wearer_seed,
                  "Another wearer in the same building, drawn from this seed; 0: of --seed")
      ->capture_default_str();
  command.add_option("--drift", options.drift, "How bad the suit is: good, default (a 2015 office) or bad")
      ->capture_default_str()
      ->check(CLI::IsMember({"good", "default", "bad"}));
  command.add_option("--rooms", options.rooms, "Number of rooms")->check(CLI::Range(1, 3));
  command.add_option("--shape", options.shell, "Shape of rooms: auto, rectangle or l")
      ->capture_default_str()
      ->check(CLI::IsMember({"auto", "rectangle", "l"}));
  command.add_option("--scene", options.scene, "What is hard to tell apart in it; auto: now and then something")
      ->capture_default_str()
      ->check(CLI::IsMember(sim::scene_names()));
  command.add_option("--room-size", options.room_size, "Length and width of every room, m")
      ->expected(2)
      ->check(CLI::Range(3.0, 9.0));
  command.add_option("--rounds", options.rounds, "Times round; more than 4 are a session of hours")
      ->check(CLI::Range(1, 500));
  command.add_option("--rate", options.sim.rate_hz, "Samples a second")->capture_default_str()->type_name("HZ");
  command.add_option("--stature", options.stature_m, "Body height, m")->check(CLI::Range(1.55, 1.95));
  command.add_option("--pace", options.sim.speed, "Factor on walking and tracing speed")
      ->capture_default_str()
      ->check(CLI::Range(0.5, 2.0));
  command
      .add_option("--closure-spacing", options.closure_spacing_m,
                  "Metres walked at least between touches of something known")
      ->check(CLI::Range(5.0, 30.0));
  command.add_option("--sloppiness", options.sim.sloppiness, "0 careful to 1 careless tracing")
      ->capture_default_str()
      ->check(CLI::Range(0.0, 1.0));
  command.add_option("--packet-loss", options.packet_loss, "Part of the samples lost")->check(CLI::Range(0.0, 0.9));
  command.add_flag("--send-tracker", options.sim.send_tracker,
                   "Also send what the sensors measure (type 23), with the magnetic field");
  command.add_flag("!--slipping-feet", options.sim.hold_feet,
                   "Standing feet slip along with the body; without, the suit holds them in place as MVN does");
  command.add_flag("--no-distractors", options.no_distractors, "No gestures that mean nothing");
}

}  // namespace

void add_sim(CLI::App& app, Run& run) {
  auto options = std::make_shared<Options>();
  CLI::App* command = add_command(
      app, run, "sim", "A simulated wearer with known truth: to a recording, or live over UDP",
      "  kinemap sim --seed 7 --out session                    session.pcap and truth.json\n"
      "  kinemap sim --seed 7 --out session --drift bad --rooms 2 --format mvnx\n"
      "  kinemap sim --seed 7 --udp 127.0.0.1:9763 --speed 4   to a running kinemapd, four times real time\n"
      "\nThe wearer walks round one to three rooms two or three times, traces walls, tables and screens, sits down, "
      "and does\n"
      "things that mean nothing. The suit drifts as --drift says. The same options give the same bytes.",
      options, simulate);
  add_where_to(*command, *options);
  add_what(*command, *options);
}

}  // namespace kinemap::cli
