// SPDX-License-Identifier: Apache-2.0
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>

#include "protocol/export/exports.hpp"
#include "protocol/foxglove/session.hpp"
#include "protocol/json_text.hpp"
#include "tools/kinemap/batch.hpp"
#include "tools/kinemap/command.hpp"
#include "tools/kinemap/files.hpp"
#include "tools/kinemap/map_files.hpp"
#include "tools/kinemap/object_table.hpp"
#include "tools/kinemap/progress.hpp"
#include "tools/kinemap/text_table.hpp"

namespace kinemap::cli {
namespace {

struct Options {
  std::vector<std::string> inputs;
  std::string out;
  std::string config;
  double body_hz = 0.0;  // 0: only at the key poses
  bool json = false;
};

/// What the stream's counters say went missing, in words; empty when nothing did.
std::string losses(const AssemblerStats& stream) {
  std::string text;
  const auto add = [&](std::uint64_t n, const char* what) {
    if (n) text += (text.empty() ? "" : ", ") + grouped(n) + " " + what;
  };
  add(stream.lost_samples, "samples lost");
  add(stream.incomplete, "incomplete");
  add(stream.duplicates, "duplicates");
  add(stream.late, "late");
  add(stream.other_character, "of other wearers");
  add(stream.other_sender, "of other senders");
  add(stream.not_a_person, "not of a person");
  add(stream.refused_pinned, "of an UpperBody or No-Level stream");
  add(stream.restarts, "restarts");
  for (std::size_t i = 0; i < stream.faults.size(); ++i)
    add(stream.faults[i], mxtp::to_string(static_cast<mxtp::Fault>(i)));
  return text;
}

std::string hand_line(const MapSnapshot& map, const TrackerStats& tracker) {
  if (!map.hand) return "";
  const TouchingHand& hand = *map.hand;
  const char* name = hand.part == HandPart::Palm ? "the palm" : "the finger tips";
  std::string text = format("touches with %s (%.0f %%), %.3f m", name, 100.0 * hand.probability, -hand.p_hand.y());
  if (hand.sigma_m.y() > 0.0) text += format(" ± %.3f", hand.sigma_m.y());
  text += " from the wrist";
  if (tracker.pivots) text += format("; %llu pivot gestures", static_cast<unsigned long long>(tracker.pivots));
  return text + '\n';
}

std::string report(const BatchResult& result) {
  const RecordingSummary& recording = result.recording;
  const GraphSummary& graph = result.map->graph;
  std::string text = format("%s, %.1f s at %.0f Hz, %s frames", recording.format.c_str(), recording.duration_s,
                            recording.rate_hz, grouped(recording.stream.frames).c_str());
  if (!recording.wearer.name.empty()) text += ", wearer \"" + recording.wearer.name + "\"";
  text += '\n';
  if (const std::string lost = losses(recording.stream); !lost.empty()) text += "stream: " + lost + '\n';
  text += format("path %.0f m · %zu key poses · %llu traces (%llu rejected, %zu unresolved) · %llu sittings\n",
                 result.tracker.path_m, graph.key_poses, static_cast<unsigned long long>(result.tracker.traces),
                 static_cast<unsigned long long>(result.tracker.traces_rejected), result.map->unresolved.size(),
                 static_cast<unsigned long long>(result.tracker.sittings));
  text += format("loop closures %zu (%zu taken back) · optimisations %zu (%zu failed)\n", graph.loop_closures,
                 graph.loop_closures_revoked, graph.optimisations, graph.optimisations_failed);
  text += hand_line(*result.map, result.tracker) + '\n';
  if (result.map->objects.empty())
    text += "no objects: nobody sat down, or traced anything with the left hand on the hip\n";
  return text;
}

nlohmann::ordered_json json_report(const BatchResult& result, const std::string& out) {
  const RecordingSummary& recording = result.recording;
  nlohmann::ordered_json counts = nlohmann::ordered_json::object();
  for (const MapObject& object : result.map->objects) {
    auto& n = counts[to_string(object.type)];
    n = n.is_null() ? 1 : n.get<int>() + 1;
  }
  return {{"out", out},
          {"format", recording.format},
          {"duration_s", recording.duration_s},
          {"rate_hz", recording.rate_hz},
          {"frames", recording.stream.frames},
          {"lost_samples", recording.stream.lost_samples},
          {"path_m", result.tracker.path_m},
          {"key_poses", result.map->graph.key_poses},
          {"traces", result.tracker.traces},
          {"unresolved", result.map->unresolved.size()},
          {"sittings", result.tracker.sittings},
          {"loop_closures", result.map->graph.loop_closures},
          {"loop_closures_revoked", result.map->graph.loop_closures_revoked},
          {"objects", std::move(counts)},
          {"warnings", recording.warnings},
          {"seconds", {{"read", result.times.read_s}, {"track", result.times.track_s}, {"map", result.times.map_s}}}};
}

/// The map, and the files in the output directory, with the whole body in session.mcap when that was asked for.
Result<BatchResult> build_files(const Options& options, const Config& config) {
  std::optional<NewFile> session;
  std::optional<foxglove::SessionRecorder> recorder;
  Observer observer;
  if (options.body_hz > 0.0) {
    session.emplace((std::filesystem::path(options.out) / "session.mcap").string());
    recorder.emplace([&](std::string_view bytes) { session->append(bytes); }, options.body_hz);
    observer = [&](const SuitFrame& frame, const MapSnapshot& map) { recorder->add(frame, map); };
  }
  auto result = [&] {
    ProgressBar bar("build");
    return build_map(
        options.inputs, config, [&](double part) { bar.update(part); }, observer);
  }();
  if (!result) return result;
  if (auto error = write_map_files(options.out, *result->map)) return *error;
  if (!recorder) return result;
  recorder->finish(*result->map);
  if (auto error = session->commit()) return *error;  // over the one with the key poses
  return result;
}

int build(const Options& options) {
  Config config;
  if (!options.config.empty()) {
    auto loaded = config_from_file(options.config);
    if (!loaded) return fail("build", loaded.error(), kUsage);
    config = *loaded;
  }
  if (auto error = make_output_directory(options.out)) return fail("build", error->message + "; choose another --out");

  const auto result = build_files(options, config);
  if (!result) return fail("build", result.error());
  for (const std::string& warning : result->recording.warnings) fail("build", "warning: " + warning);

  if (options.json) return print("build", pretty_text(json_report(*result, options.out)));
  const double total = result->times.total_s();
  std::string names;
  for (const Export& file : exports()) names += std::string(names.empty() ? "" : ", ") + file.name;
  return print("build", report(*result) + object_table(result->map->objects) + '\n' + object_counts(*result->map) +
                            format("\n%.2f s: %.0f × real time (read %.2f s, track %.2f s, map %.2f s)\n", total,
                                   result->recording.duration_s / total, result->times.read_s, result->times.track_s,
                                   result->times.map_s) +
                            "wrote " + options.out + "/: " + names + '\n');
}

}  // namespace

void add_build(CLI::App& app, Run& run) {
  auto options = std::make_shared<Options>();
  CLI::App* command = add_command(
      app, run, "build", "A recording to a map, as fast as it goes (the daemon's own pipeline, deterministic)",
      "  kinemap build session.pcap --out map          a capture: tcpdump -w session.pcap udp port 9763\n"
      "  kinemap build take-003.mvnx --out map         an export of MVN Analyze\n"
      "  kinemap build /var/lib/kinemap/sessions/20261122T103303Z --out map     what kinemapd recorded "
      "(journal.record)\n"
      "  kinemap build session.pcap --out map --json | jq .objects\n"
      "\nWrites DIR/map.json (the objects) and every other file that 'kinemap export --list' names: plan.svg, "
      "scene.glb,\n"
      "floor.pgm, world.sdf, … Files of an earlier build are replaced.",
      options, build);
  command
      ->add_option(
          "INPUT", options->inputs,
          "Recording: .pcap (classic libpcap) or .mvnx, told apart by content; several .pcap, or a directory of "
          "them, follow on each other")
      ->required();
  command->add_option("--out", options->out, "Directory for the results, made where missing")
      ->required()
      ->type_name("DIR");
  command->add_option("--config", options->config, "Configuration as for kinemapd; default: every key at its default")
      ->type_name("FILE");
  command
      ->add_option(
          "--body-hz", options->body_hz,
          "The whole body in session.mcap so many times a second (4.5 kB each); without, the pelvis at the key poses")
      ->check(CLI::Range(0.1, 240.0));
  command->add_flag("--json", options->json, "Print the summary as JSON");
}

}  // namespace kinemap::cli
