// SPDX-License-Identifier: Apache-2.0
#include <cstring>
#include <nlohmann/json.hpp>

#include "protocol/json_text.hpp"
#include "protocol/recording.hpp"
#include "protocol/wire/pcap.hpp"
#include "tools/kinemap/command.hpp"
#include "tools/kinemap/frame_encoder.hpp"
#include "tools/kinemap/progress.hpp"
#include "tools/kinemap/stop_signal.hpp"
#include "tools/kinemap/text_table.hpp"
#include "tools/kinemap/udp_sender.hpp"

namespace kinemap::cli {
namespace {

struct Options {
  std::string file;
  std::string to = "127.0.0.1:9763";
  double speed = 1.0;
  bool json = false;
};

bool is_mxtp(std::span<const std::byte> payload) {
  return payload.size() >= 4 && std::memcmp(payload.data(), "MXTP", 4) == 0;
}

bool going_on(const PacedSender& sender) { return !stop_requested() && !sender.error(); }

std::string note(const PacedSender& sender) { return format("%.0f s", sender.stream_s()); }

/// Sends every MXTP datagram of a capture; the number of other packets, or why it ended early.
Result<std::uint64_t> replay_pcap(PcapReader& reader, PacedSender& sender) {
  ProgressBar bar("replay");
  std::uint64_t others = 0;
  while (going_on(sender)) {
    auto packet = reader.next();
    if (!packet && sender.sent() == 0) return Error{packet.error()};
    if (!packet) {  // as in a build, what came before the damage counts
      fail("replay", "warning: " + packet.error() + "; sent what came before");
      break;
    }
    if (!*packet) break;
    if (is_mxtp((*packet)->payload))
      sender.send((*packet)->time_s, (*packet)->payload);
    else
      ++others;
    bar.update(static_cast<double>(reader.stats().bytes_read) /
                   static_cast<double>(std::max<std::uint64_t>(1, reader.file_size())),
               note(sender));
  }
  return others;
}

/// Sends the frames of an .mvnx as type 02.
std::optional<Error> replay_mvnx(const std::string& path, PacedSender& sender) {
  ProgressBar bar("replay");
  const RecordingSink sink{.on_frame =
                               [&](const SuitFrame& frame) {
                                 for (const mxtp::Bytes& datagram : encode_frame(frame))
                                   if (going_on(sender)) sender.send(frame.time_s, datagram);
                               },
                           .on_wearer = [](const WearerInfo&) {}};
  const auto summary = read_recording(path, {}, sink, [&](double part) { bar.update(part, note(sender)); });
  if (!summary) return Error{summary.error()};
  return std::nullopt;
}

int replay(const Options& options) {
  const auto to = parse_endpoint(options.to, "127.0.0.1", mxtp::kDefaultPort);
  if (!to) return fail("replay", to.error(), kUsage);
  const auto mvnx = is_xml_file(options.file);
  if (!mvnx) return fail("replay", mvnx.error());
  auto sender = PacedSender::create(*to, options.speed);
  if (!sender) return fail("replay", sender.error());
  catch_stop_signals();

  std::optional<Error> error;
  std::uint64_t others = 0;
  if (*mvnx) {
    error = replay_mvnx(options.file, *sender);
  } else if (auto reader = PcapReader::open(options.file); !reader) {
    error = Error{reader.error()};
  } else if (const auto counted = replay_pcap(*reader, *sender); counted) {
    others = *counted;
  } else {
    error = Error{counted.error()};
  }
  if (!error) error = sender->error();
  if (error) return fail("replay", error->message);
  if (sender->sent() == 0 && !stop_requested())
    return fail("replay", options.file + ": no MXTP datagram in it (nothing sent)");

  if (options.json)
    return print("replay", pretty_text({{"to", to->text()},
                                        {"datagrams", sender->sent()},
                                        {"bytes", sender->bytes()},
                                        {"refused", sender->refused()},
                                        {"other_packets", others},
                                        {"stream_s", sender->stream_s()},
                                        {"stopped", stop_requested()}}));
  return print("replay", (stop_requested() ? "stopped; " : "") + sending_report(*sender, *to) +
                             (others ? grouped(others) + " packets that are not MXTP were left out\n" : ""));
}

}  // namespace

void add_replay(CLI::App& app, Run& run) {
  auto options = std::make_shared<Options>();
  CLI::App* command = add_command(
      app, run, "replay", "A recording to UDP, with its own timing, as if the suit were there",
      "  kinemap replay session.pcap                          to kinemapd on this machine, in real time\n"
      "  kinemap replay session.pcap --to 10.0.0.7:9763 --speed 4\n"
      "  kinemap replay take-003.mvnx --speed 10\n"
      "\nA .pcap is sent datagram by datagram as it was captured; an .mvnx is encoded as MXTP type 02. Ctrl-C stops.\n"
      "At --speed 0 nothing slows the sender down: expect the receiver to lose datagrams, and count them.",
      options, replay);
  command->add_option("FILE", options->file, "Recording: .pcap or .mvnx, told apart by content")->required();
  command->add_option("--to", options->to, "Where to send to")->capture_default_str()->type_name("HOST:PORT");
  command->add_option("--speed", options->speed, "Times real time; 0: as fast as possible")
      ->capture_default_str()
      ->check(CLI::Range(0.0, 1e6));
  command->add_flag("--json", options->json, "Print the counts as JSON");
}

}  // namespace kinemap::cli
