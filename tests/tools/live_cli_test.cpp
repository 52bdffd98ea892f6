// SPDX-License-Identifier: Apache-2.0
// `kinemap` against a real kinemapd: a simulated wearer over UDP, then every command that asks the daemon.
#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <thread>

#include "tests/tools/run_command.hpp"

namespace kinemap {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

int free_port(int type) {
  const int probe = ::socket(AF_INET, type, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  ::bind(probe, reinterpret_cast<sockaddr*>(&address), sizeof address);
  socklen_t length = sizeof address;
  ::getsockname(probe, reinterpret_cast<sockaddr*>(&address), &length);
  ::close(probe);
  return ntohs(address.sin_port);
}

bool within(std::chrono::seconds patience, const std::function<bool()>& condition) {
  const auto deadline = std::chrono::steady_clock::now() + patience;
  while (std::chrono::steady_clock::now() < deadline) {
    if (condition()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  }
  return condition();
}

std::string slurp(const std::string& path) {
  std::ostringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

TEST(LiveCli, StatusMapAndWatchFollowAWearer) {
  const fs::path root = fs::temp_directory_path() / ("kinemap-live-test-" + std::to_string(::getpid()));
  fs::create_directories(root);
  const int suit = free_port(SOCK_DGRAM), port = free_port(SOCK_STREAM);
  const std::string api = "127.0.0.1:" + std::to_string(port), config = (root / "config.json").string();
  std::ofstream(config) << Json{{"suit", {{"address", "127.0.0.1"}, {"port", suit}}}, {"api", {{"port", port}}}};
  const auto kinemap = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), KINEMAP_BIN);
    return run_command(arguments);
  };

  Background daemon({KINEMAPD_BIN, "--config", config}, (root / "daemon.log").string());
  ASSERT_TRUE(within(std::chrono::seconds(30), [&] {
    return kinemap({"status", "--url", api}).code == 0;
  })) << slurp((root / "daemon.log").string());
  EXPECT_NE(kinemap({"map", "--url", api}).out.find("0 objects"), std::string::npos);

  const std::string watched = (root / "watch.log").string();
  Background watch({KINEMAP_BIN, "watch", "--url", api, "--json", "--topics", "map,events"}, watched);
  ASSERT_TRUE(
      within(std::chrono::seconds(30), [&] { return slurp(watched).find("\"topic\":\"map\"") != std::string::npos; }));

  const Ran sim = kinemap({"sim", "--seed", "3", "--rooms", "1", "--rounds", "1", "--udp",
                           "127.0.0.1:" + std::to_string(suit), "--speed", "25", "--json"});
  ASSERT_EQ(sim.code, 0) << sim.err;
  EXPECT_EQ(Json::parse(sim.out)["refused"], 0);
  const auto objects = [&] { return Json::parse(kinemap({"map", "--url", api, "--json"}).out)["objects"].size(); };
  EXPECT_TRUE(within(std::chrono::seconds(30), [&] { return objects() >= 4; }));

  const Json status = Json::parse(kinemap({"status", "--url", api, "--json"}).out);
  EXPECT_GT(status["tracker"]["frames"], 1000);
  EXPECT_NE(kinemap({"status", "--url", api}).out.find("port       " + std::to_string(suit)), std::string::npos)
      << "a port is no count";
  EXPECT_EQ(kinemap({"status", "--url", api}).out.substr(0, 8 + api.size()), "http://" + api + ":")
      << "how it is, in a line";
  const Ran map = kinemap({"map", "--url", api, "--svg", (root / "plan.svg").string()});
  EXPECT_NE(map.out.find("chair"), std::string::npos) << map.out;
  EXPECT_NE(slurp((root / "plan.svg").string()).find("class=\"path\""), std::string::npos)
      << "the daemon's trajectory is drawn";

  const Json near = Json::parse(
      kinemap({"objects", "--url", api, "--function", "bound", "--near", "1,2", "--limit", "2", "--json"}).out);
  ASSERT_EQ(near["objects"].size(), 2U);
  EXPECT_LE(near["objects"][0]["distance"], near["objects"][1]["distance"]);
  EXPECT_NE(kinemap({"objects", "--url", api, "--near", "1,2"}).out.find("distance m"), std::string::npos);
  const Ran bad = kinemap({"objects", "--url", api, "--near", "1;2"});
  EXPECT_EQ(bad.code, 1);
  EXPECT_NE(bad.err.find("near"), std::string::npos) << "the daemon's words: " << bad.err;

  const Ran files = kinemap({"export", "all", "--url", "http://" + api + "/", "--out", (root / "files").string()});
  ASSERT_EQ(files.code, 0) << files.err;
  EXPECT_EQ(slurp((root / "files/plan.svg").string()).substr(0, 4), "<svg");
  EXPECT_EQ(slurp((root / "files/scene.glb").string()).substr(0, 4), "glTF");
  EXPECT_EQ(kinemap({"map", "--file", (root / "files").string()}).code, 0) << "as 'kinemap build' would have left it";
  EXPECT_TRUE(within(std::chrono::seconds(30),
                     [&] { return slurp(watched).find("\"event\":\"trace\"") != std::string::npos; }));
  EXPECT_EQ(watch.stop(SIGINT), 0);

  const Ran wrong = run_command({KINEMAP_BIN, "watch", "--once", "--url", "127.0.0.1:" + std::to_string(suit)});
  EXPECT_EQ(wrong.code, 1) << "the suit's port is not the API's";
  EXPECT_EQ(daemon.stop(SIGTERM), 0);
  fs::remove_all(root);
}

/// Holds a UDP port of this machine, or sends to one.
class UdpSocket {
 public:
  explicit UdpSocket(int port) {
    address_.sin_family = AF_INET;
    address_.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    address_.sin_port = htons(static_cast<std::uint16_t>(port));
  }
  ~UdpSocket() { ::close(socket_); }
  UdpSocket(const UdpSocket&) = delete;
  UdpSocket& operator=(const UdpSocket&) = delete;
  void hold() { ASSERT_EQ(::bind(socket_, reinterpret_cast<sockaddr*>(&address_), sizeof address_), 0); }
  void send(const std::string& text) {
    ::sendto(socket_, text.data(), text.size(), 0, reinterpret_cast<sockaddr*>(&address_), sizeof address_);
  }

 private:
  int socket_ = ::socket(AF_INET, SOCK_DGRAM, 0);
  sockaddr_in address_{};
};

/// A configuration of its own, and what `kinemap doctor` finds with it.
struct Doctor {
  fs::path root = fs::temp_directory_path() / ("kinemap-doctor-test-" + std::to_string(::getpid()));
  int suit = free_port(SOCK_DGRAM), port = free_port(SOCK_STREAM);
  std::string config = (root / "config.json").string();
  Json settings = {{"suit", {{"address", "127.0.0.1"}, {"port", suit}}},
                   {"api", {{"port", port}}},
                   {"journal", {{"directory", (root / "journal").string()}}}};

  Doctor() {
    fs::create_directories(root);
    save();
  }
  ~Doctor() { fs::remove_all(root); }
  Doctor(const Doctor&) = delete;
  Doctor& operator=(const Doctor&) = delete;
  void save() const { std::ofstream(config) << settings; }
  /// The findings by subject; and the exit code as "code".
  [[nodiscard]] Json ask(const std::string& listen_s) const {
    const Ran ran = run_command({KINEMAP_BIN, "doctor", "--config", config, "--listen", listen_s, "--json"});
    Json by_subject = {{"code", ran.code}};
    const Json findings = Json::parse(ran.out)["findings"];
    for (const Json& finding : findings) by_subject[finding["subject"].get<std::string>()] = finding;
    return by_subject;
  }
};

bool says(const Json& finding, const std::string& verdict, const std::string& text) {
  return finding["verdict"] == verdict && finding.dump().find(text) != std::string::npos;
}

TEST(Doctor, WithoutADaemonItListensItself) {
  const Doctor doctor;
  const Json silent = doctor.ask("0.2");
  EXPECT_EQ(silent["code"], 1);
  EXPECT_TRUE(says(silent["config"], "ok", doctor.config)) << silent;
  EXPECT_TRUE(says(silent["daemon"], "problem", "systemctl start kinemapd")) << silent;
  EXPECT_TRUE(says(silent["suit"], "problem", "port " + std::to_string(doctor.suit))) << silent;
  EXPECT_TRUE(says(silent["suit"], "problem", "Network Streamer")) << silent;
  EXPECT_TRUE(says(silent["disk"], "ok", "GiB free")) << silent;
  for (const char* subject : {"access", "service", "firewall", "buffer", "clock"})
    EXPECT_TRUE(silent.contains(subject));

  {
    const std::jthread sender([&](const std::stop_token& stop) {
      for (UdpSocket socket(doctor.suit); !stop.stop_requested();
           std::this_thread::sleep_for(std::chrono::milliseconds(20)))
        socket.send("not the suit's stream, whatever it is");
    });
    EXPECT_TRUE(says(doctor.ask("30")["suit"], "problem", "not MVN's stream"));
  }
  {
    UdpSocket other(doctor.suit);
    other.hold();
    EXPECT_TRUE(says(doctor.ask("0.2")["suit"], "problem", "ss -lunp"));
  }
  const Background sim({KINEMAP_BIN, "sim", "--udp", "127.0.0.1:" + std::to_string(doctor.suit)},
                       (doctor.root / "sim.log").string());
  EXPECT_TRUE(says(doctor.ask("30")["suit"], "ok", "MVN's stream comes"));
}

TEST(Doctor, LetsTheDaemonStartWhileItListens) {
  if (::geteuid() != 0) GTEST_SKIP() << "only root can listen beside others";
  const Doctor doctor;
  const Background listens({KINEMAP_BIN, "doctor", "--config", doctor.config, "--listen", "60"},
                           (doctor.root / "doctor.log").string());
  std::this_thread::sleep_for(std::chrono::milliseconds(300));  // it may be slower: then it is no test of anything
  const Background daemon({KINEMAPD_BIN, "--config", doctor.config}, (doctor.root / "daemon.log").string());
  EXPECT_TRUE(within(std::chrono::seconds(30), [&] {
    return run_command({KINEMAP_BIN, "status", "--url", "127.0.0.1:" + std::to_string(doctor.port)}).code == 0;
  })) << slurp((doctor.root / "daemon.log").string());
}

TEST(Doctor, WhoMayNotListenBesideOthersSaysThatItHoldsThePort) {
  const Doctor doctor;
  const std::vector<std::string> ask{KINEMAP_BIN, "doctor", "--config", doctor.config, "--listen", "0.2"};
  std::vector<std::string> line = ask;
  if (::geteuid() == 0) line.insert(line.begin(), {"/usr/bin/setpriv", "--bounding-set=-net_raw"});
  const Ran ran = run_command(line);
  EXPECT_NE(ran.err.find("holds UDP port " + std::to_string(doctor.suit)), std::string::npos) << ran.err;
  EXPECT_NE(ran.out.find("nothing came to UDP port"), std::string::npos) << ran.out;
}

TEST(Doctor, ShowsTheDaemonWhatItsConfigurationAsksFor) {
  Doctor doctor;
  ASSERT_EQ(run_command({KINEMAP_BIN, "pair", "--config", doctor.config, "--host", "127.0.0.1"}).code, 0);
  doctor.settings["api"]["auth"] = "always";
  doctor.save();
  const Background daemon({KINEMAPD_BIN, "--config", doctor.config}, (doctor.root / "daemon.log").string());
  EXPECT_TRUE(within(std::chrono::seconds(30), [&] { return says(doctor.ask("0.1")["daemon"], "ok", "https://"); }))
      << slurp((doctor.root / "daemon.log").string()) << doctor.ask("0.1");
  EXPECT_TRUE(says(doctor.ask("0.1")["access"], "ok", "token and TLS"));
  fs::permissions(doctor.root / "kinemap.tokens", fs::perms::others_read, fs::perm_options::add);
  EXPECT_TRUE(says(doctor.ask("0.1")["access"], "problem", "others may read"));
  fs::remove(doctor.root / "conf.d/remote.json");
  EXPECT_TRUE(says(doctor.ask("0.1")["access"], "problem", "wants a token"));
}

TEST(Doctor, AsksTheRunningDaemon) {
  const Doctor doctor;
  const Background daemon({KINEMAPD_BIN, "--config", doctor.config}, (doctor.root / "daemon.log").string());
  // Not by asking the doctor: while there is no daemon, it holds the suit's port itself.
  const auto answers = [&] {
    return run_command({KINEMAP_BIN, "status", "--url", "127.0.0.1:" + std::to_string(doctor.port)}).code == 0;
  };
  ASSERT_TRUE(within(std::chrono::seconds(30), answers)) << slurp((doctor.root / "daemon.log").string());
  EXPECT_TRUE(says(doctor.ask("0.1")["daemon"], "ok", "kinemapd"));
  const Json silent = doctor.ask("0.1");
  EXPECT_EQ(silent["code"], 1);
  EXPECT_TRUE(says(silent["suit"], "problem", "nothing has come")) << silent;
  const Background sim({KINEMAP_BIN, "sim", "--udp", "127.0.0.1:" + std::to_string(doctor.suit)},
                       (doctor.root / "sim.log").string());
  EXPECT_TRUE(
      within(std::chrono::seconds(30), [&] { return says(doctor.ask("0.1")["suit"], "ok", "frames a second"); }));
  EXPECT_EQ(doctor.ask("0.1")["code"], 0) << "notes are no problems";
}

TEST(Doctor, ConfigurationAndDisk) {
  Doctor doctor;
  doctor.settings["journal"]["min_free_mb"] = 1e9;
  doctor.save();
  EXPECT_TRUE(says(doctor.ask("0.1")["disk"], "problem", "journal.min_free_mb"));
  doctor.settings["suit"]["prot"] = 1;
  doctor.save();
  EXPECT_TRUE(says(doctor.ask("0.1")["config"], "problem", "suit.prot"));
}

}  // namespace
}  // namespace kinemap
