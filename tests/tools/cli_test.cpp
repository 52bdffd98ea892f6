// SPDX-License-Identifier: Apache-2.0
// The real `kinemap` program: what it prints, what it refuses and how it ends.
#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <thread>

#include "protocol/export/exports.hpp"
#include "protocol/map_json.hpp"
#include "tests/protocol/sample_map.hpp"
#include "tests/tools/run_command.hpp"

namespace kinemap {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;
using ::std::string;

class Cli : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    root_ = fs::temp_directory_path() / ("kinemap-cli-test-" + std::to_string(::getpid()));
    fs::create_directories(root_);
    const Ran sim = kinemap({"sim", "--seed", "3", "--rooms", "1", "--rounds", "1", "--out", at("session"), "--json"});
    ASSERT_EQ(sim.code, 0) << sim.err;
    session_ = Json::parse(sim.out);
  }
  static void TearDownTestSuite() { fs::remove_all(root_); }

  static Ran kinemap(std::vector<string> arguments, const string& out_path = {}) {
    arguments.insert(arguments.begin(), KINEMAP_BIN);
    return run_command(arguments, out_path);
  }
  static string at(const string& name) { return (root_ / name).string(); }
  static string pcap() { return at("session/session.pcap"); }
  static string truth() { return at("session/truth.json"); }
  static string slurp(const string& path) {
    std::ostringstream text;
    text << std::ifstream(path, std::ios::binary).rdbuf();
    return text.str();
  }
  static void write(const string& name, const string& text) { std::ofstream(at(name), std::ios::binary) << text; }

  /// Fails with this code, says so on stderr only, and names what it is about.
  static void expect_refusal(std::vector<string> arguments, int code, const string& named) {
    string line;
    for (const string& argument : arguments) line += argument + ' ';
    const Ran ran = kinemap(std::move(arguments));
    EXPECT_EQ(ran.code, code) << line << '\n' << ran.err;
    EXPECT_NE(ran.err.find(named), string::npos) << line << "\nsaid: " << ran.err;
    EXPECT_EQ(ran.out, "") << line;
  }

  static fs::path root_;
  static Json session_;
};
fs::path Cli::root_;
Json Cli::session_;

/// A UDP socket on a free port of this machine.
class Listener {
 public:
  Listener() : socket_(::socket(AF_INET, SOCK_DGRAM, 0)) {
    address_.sin_family = AF_INET;
    address_.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    const int bytes = 1 << 23;
    ::setsockopt(socket_, SOL_SOCKET, SO_RCVBUF, &bytes, sizeof bytes);
    ::bind(socket_, reinterpret_cast<sockaddr*>(&address_), sizeof address_);
    socklen_t length = sizeof address_;
    ::getsockname(socket_, reinterpret_cast<sockaddr*>(&address_), &length);
  }
  ~Listener() { ::close(socket_); }
  Listener(const Listener&) = delete;
  Listener& operator=(const Listener&) = delete;
  [[nodiscard]] string address() const { return "127.0.0.1:" + std::to_string(ntohs(address_.sin_port)); }
  /// Datagrams of MXTP that wait in the socket.
  [[nodiscard]] std::size_t drain() const {
    std::size_t n = 0;
    char buffer[65536];
    ssize_t size = 0;
    while ((size = ::recv(socket_, buffer, sizeof buffer, MSG_DONTWAIT)) > 0)
      n += size >= 4 && string(buffer, 4) == "MXTP" ? 1 : 0;
    return n;
  }

 private:
  int socket_;
  sockaddr_in address_{};
};

TEST_F(Cli, HelpTeaches) {
  EXPECT_EQ(kinemap({"--help"}).code, 0);
  EXPECT_NE(kinemap({"--help"}).out.find("kinemap build session/session.pcap --out map"), string::npos);
  for (const char* command :
       {"sim", "replay", "build", "map", "objects", "export", "status", "watch", "sessions", "optimize", "eval"}) {
    const Ran help = kinemap({command, "--help"});
    EXPECT_EQ(help.code, 0) << command;
    EXPECT_NE(help.out.find("Examples:"), string::npos) << command;
    EXPECT_NE(help.out.find("--json"), string::npos) << command;
  }
  EXPECT_EQ(kinemap({"--version"}).out.substr(0, 8), "kinemap ");
}

TEST_F(Cli, WrongUsageIsTwo) {
  expect_refusal({}, 2, "subcommand is required");
  expect_refusal({"dance"}, 2, "dance");
  expect_refusal({"build"}, 2, "INPUT");
  expect_refusal({"build", pcap()}, 2, "--out");
  expect_refusal({"build", pcap(), "--out", at("x"), "--sped"}, 2, "--sped");
  expect_refusal({"sim"}, 2, "--out DIR or --udp HOST:PORT");
  expect_refusal({"sim", "--out", at("x"), "--udp", "127.0.0.1:1"}, 2, "either");
  expect_refusal({"sim", "--out", at("x"), "--rooms", "9"}, 2, "--rooms");
  expect_refusal({"sim", "--out", at("x"), "--drift", "huge"}, 2, "huge");
  expect_refusal({"sim", "--out", at("x"), "--rate", "1"}, 2, "rate");
  expect_refusal({"sim", "--udp", "127.0.0.1:99999"}, 2, "127.0.0.1:99999");
  expect_refusal({"replay", pcap(), "--speed", "-1"}, 2, "--speed");
  expect_refusal({"status", "--host", "a:b"}, 2, "a:b");
  expect_refusal({"map", "--host", "h:1", "--file", "f"}, 2, "--file");
  expect_refusal({"export", "--url", "h:1", "--file", "f", "plan.svg"}, 2, "--file");
  expect_refusal({"export"}, 2, "--list");
  expect_refusal({"export", "plan.sgv"}, 2, "plan.sgv");
  expect_refusal({"export", "all", "--out", "-"}, 2, "--out -");
  expect_refusal({"status", "--url", "ftp://h"}, 2, "expected http://HOST:PORT or https://HOST:PORT");
  expect_refusal({"objects", "--url", "ftp://h"}, 2, "ftp://");
  EXPECT_FALSE(fs::exists(at("x")));
}

TEST_F(Cli, BuildWritesEverythingAndTheSameTwice) {
  const Ran first = kinemap({"build", pcap(), "--out", at("a")});
  ASSERT_EQ(first.code, 0) << first.err;
  EXPECT_NE(first.out.find("× real time"), string::npos);
  ASSERT_EQ(kinemap({"build", pcap(), "--out", at("b")}).code, 0);
  ASSERT_EQ(kinemap({"build", pcap(), "--out", at("b")}).code, 0) << "over the files of an earlier build";
  for (const Export& file : exports()) {
    const string name = file.name;
    EXPECT_GT(fs::file_size(at("a") + "/" + name), 0U) << name;
    EXPECT_EQ(slurp(at("a") + "/" + name), slurp(at("b") + "/" + name)) << name;
  }
  EXPECT_EQ(std::distance(fs::directory_iterator(at("b")), {}), std::ssize(exports())) << "no temporary file is left";
  const Ran json = kinemap({"build", pcap(), "--out", at("b"), "--json"});
  EXPECT_EQ(Json::parse(json.out)["format"], "pcap");
  EXPECT_EQ(json.err, "") << "no progress bar where stderr is no terminal";
}

TEST_F(Cli, BuildNamesWhatIsWrongWithTheInput) {
  write("empty.pcap", "");
  write("garbage.pcap", string(5000, 'x'));
  write("no_wearer.pcap", slurp(pcap()).substr(0, 24));  // a header, no packet
  expect_refusal({"build", at("none.pcap"), "--out", at("o")}, 1, at("none.pcap"));
  expect_refusal({"build", at("empty.pcap"), "--out", at("o")}, 1, at("empty.pcap"));
  expect_refusal({"build", at("garbage.pcap"), "--out", at("o")}, 1, at("garbage.pcap"));
  expect_refusal({"build", at("no_wearer.pcap"), "--out", at("o")}, 1, at("no_wearer.pcap"));
  fs::create_directory(at("nothing"));
  expect_refusal({"build", at("nothing"), "--out", at("o")}, 1, at("nothing"));
  EXPECT_TRUE(fs::is_empty(at("o"))) << "no map of nothing";
}

TEST_F(Cli, BuildOfATruncatedRecordingTellsAndBuildsTheRest) {
  const string whole = slurp(pcap());
  write("cut.pcap", whole.substr(0, whole.size() / 2 + 7));
  const Ran ran = kinemap({"build", at("cut.pcap"), "--out", at("cut")});
  EXPECT_EQ(ran.code, 0) << ran.err;
  EXPECT_NE(ran.err.find("warning"), string::npos) << ran.err;
  EXPECT_TRUE(fs::exists(at("cut/map.json")));
}

TEST_F(Cli, BuildRefusesABadConfiguration) {
  write("unknown.json", R"({"tracker": {"key_poses": {"distanz_m": 1}}})");
  write("type.json", R"({"api": {"port": "http"}})");
  expect_refusal({"build", pcap(), "--out", at("o"), "--config", at("unknown.json")}, 2, "tracker.key_poses.distanz_m");
  expect_refusal({"build", pcap(), "--out", at("o"), "--config", at("type.json")}, 2, "api.port");
  expect_refusal({"build", pcap(), "--out", at("o"), "--config", at("none.json")}, 2, at("none.json"));
}

TEST_F(Cli, BuildNeedsADirectoryItCanWriteTo) {
  write("file", "x");
  expect_refusal({"build", pcap(), "--out", at("file")}, 1, at("file"));
  expect_refusal({"build", pcap(), "--out", at("file/below")}, 1, at("file/below"));
  expect_refusal({"build", pcap(), "--out", "/proc/kinemap"}, 1, "/proc/kinemap");
}

TEST_F(Cli, AFullDiskIsSaidAndLeavesTheOldMap) {
  ASSERT_EQ(kinemap({"build", pcap(), "--out", at("full")}).code, 0);
  const string before = slurp(at("full/map.json"));
  const string limited = "ulimit -f 4; exec " KINEMAP_BIN " build " + pcap() + " --out " + at("full");
  const Ran ran = run_command({"/bin/bash", "-c", limited});
  EXPECT_EQ(ran.code, 1) << ran.err;
  EXPECT_NE(ran.err.find("cannot be written: File too large"), string::npos) << ran.err;
  EXPECT_EQ(slurp(at("full/map.json")), before);
  EXPECT_EQ(std::distance(fs::directory_iterator(at("full")), {}), std::ssize(exports()))
      << "no temporary file is left";
}

TEST_F(Cli, AFullStandardOutputIsSaid) {
  if (!fs::exists("/dev/full")) GTEST_SKIP() << "no /dev/full here";
  write("map.json", map_text(sample_map()));
  const Ran ran = kinemap({"map", "--file", at("map.json")}, "/dev/full");
  EXPECT_EQ(ran.code, 1);
  EXPECT_NE(ran.err.find("No space left on device"), string::npos) << ran.err;
}

TEST_F(Cli, EvalMeasures) {
  ASSERT_EQ(kinemap({"build", pcap(), "--out", at("e")}).code, 0);
  const Ran text = kinemap({"eval", at("e"), "--truth", truth(), "--objects"});
  ASSERT_EQ(text.code, 0) << text.err;
  EXPECT_NE(text.out.find("trajectory RMSE"), string::npos);
  const Ran ran = kinemap({"eval", at("e"), "--truth", truth(), "--json"});
  ASSERT_EQ(ran.code, 0) << ran.err;
  const Json json = Json::parse(ran.out);
  EXPECT_EQ(json["all"]["truth"], session_["objects"]);
  EXPECT_GT(json["session"]["poses"], 100);
  EXPECT_LT(json["session"]["rmse_optimised_m"], json["session"]["rmse_open_loop_m"]);
}

TEST_F(Cli, EvalNamesWhatIsWrong) {
  ASSERT_EQ(kinemap({"build", pcap(), "--out", at("e")}).code, 0);
  write("map.json", map_text(sample_map()));
  write("bad_truth.json", R"({"format": "kinemap/truth", "version": 1})");
  expect_refusal({"eval", at("e"), "--truth", at("none.json")}, 1, at("none.json"));
  expect_refusal({"eval", at("none"), "--truth", truth()}, 1, at("none"));
  expect_refusal({"eval", at("map.json"), "--truth", truth()}, 1, "no trajectory");
  expect_refusal({"eval", at("e"), "--truth", at("bad_truth.json")}, 1, "objects: missing");
}

TEST_F(Cli, MapListsAndDraws) {
  fs::create_directories(root_ / "lone");
  write("lone/map.json", map_text(sample_map()));
  const Ran ran = kinemap({"map", "--file", at("lone/map.json"), "--svg", at("plan.svg")});
  ASSERT_EQ(ran.code, 0) << ran.err;
  EXPECT_NE(ran.out.find("4 objects: 1 wall, 1 table, 1 screen, 1 chair"), string::npos) << ran.out;
  EXPECT_EQ(ran.out.find('\033'), string::npos) << "no colours in a file";
  EXPECT_EQ(slurp(at("plan.svg")).substr(0, 4), "<svg");
  const Ran json = kinemap({"map", "--file", at("lone/map.json"), "--json"});
  EXPECT_EQ(json.out, map_text(sample_map()));
  EXPECT_EQ(kinemap({"map", "--file", at("lone/map.json"), "--no-plan"}).out.find("⠤"), string::npos);
  expect_refusal({"map", "--file", at("none.json")}, 1, at("none.json"));
  expect_refusal({"map", "--file", at("lone/map.json"), "--svg", at("no/such/plan.svg")}, 1, at("no/such/plan.svg"));
}

TEST_F(Cli, NoDaemonIsSaid) {
  // Port 1 of this machine: nobody listens there.
  for (const char* command : {"map", "status", "objects"})
    expect_refusal({command, "--url", "127.0.0.1:1"}, 1, "is kinemapd running");
  expect_refusal({"watch", "--once", "--url", "127.0.0.1:1"}, 1, "is kinemapd running");
}

TEST_F(Cli, ExportWritesWhatTheFilesHold) {
  fs::create_directories(root_ / "lone");
  write("lone/map.json", map_text(sample_map()));
  const Ran all = kinemap({"export", "all", "--file", at("lone"), "--out", at("files")});
  EXPECT_EQ(all.code, 1) << "a directory must be whole";
  const Ran some = kinemap({"export", "all", "--file", at("lone/map.json"), "--out", at("files"), "--json"});
  ASSERT_EQ(some.code, 0) << some.err;
  EXPECT_NE(some.err.find("left out: " + at("lone/map.json") + ": trajectory.tum needs"), string::npos) << some.err;
  EXPECT_EQ(static_cast<std::ptrdiff_t>(Json::parse(some.out)["written"].size()),
            std::distance(fs::directory_iterator(at("files")), {}));
  EXPECT_EQ(kinemap({"export", "objects.csv", "--file", at("lone/map.json"), "--out", "-"}).out,
            slurp(at("files/objects.csv")));
  EXPECT_EQ(kinemap({"export", "plan.svg", "--file", at("lone/map.json"), "--out", at("named.svg")}).code, 0);
  EXPECT_EQ(slurp(at("named.svg")), slurp(at("files/plan.svg")));
  EXPECT_NE(kinemap({"export", "--list"}).out.find("floor.pgm"), string::npos);
  expect_refusal({"export", "graph.g2o", "--file", at("lone/map.json"), "--out", at("files")}, 1, "graph.g2o needs");
}

/// Answers one HTTP request on a free port and keeps it.
class OneAnswer {
 public:
  explicit OneAnswer(string answer) : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t length = sizeof address;
    ::bind(socket_, reinterpret_cast<sockaddr*>(&address), length);
    ::listen(socket_, 1);
    ::getsockname(socket_, reinterpret_cast<sockaddr*>(&address), &length);
    port_ = ntohs(address.sin_port);
    thread_ = std::thread([this, answer = std::move(answer)] {
      const int client = ::accept(socket_, nullptr, nullptr);
      char buffer[4096];
      while (request_.find("\r\n\r\n") == string::npos) {
        const ssize_t n = ::recv(client, buffer, sizeof buffer, 0);
        if (n <= 0) break;
        request_.append(buffer, static_cast<std::size_t>(n));
      }
      ::send(client, answer.data(), answer.size(), 0);
      ::close(client);
    });
  }
  ~OneAnswer() { ::close(socket_); }
  OneAnswer(const OneAnswer&) = delete;
  OneAnswer& operator=(const OneAnswer&) = delete;
  [[nodiscard]] string url() const { return "http://127.0.0.1:" + std::to_string(port_); }
  string request() {
    thread_.join();
    return request_;
  }

 private:
  int socket_;
  int port_ = 0;
  string request_;
  std::thread thread_;
};

TEST_F(Cli, TheTokenIsShownAndAPathKept) {
  OneAnswer daemon(
      "HTTP/1.1 401 Unauthorized\r\nContent-Length: 38\r\n\r\n{\"error\": {\"message\": \"who is there\"}}");
  const Ran ran = run_command({"/usr/bin/env", "KINEMAP_TOKEN=s3cret", "KINEMAP_URL=" + daemon.url() + "/kinemap/",
                               KINEMAP_BIN, "objects", "--near", "1,-2", "--function", "a b"});
  const string request = daemon.request();
  EXPECT_EQ(request.substr(0, request.find('\r')), "GET /kinemap/api/v1/objects?function=a%20b&near=1,-2 HTTP/1.1");
  EXPECT_NE(request.find("Authorization: Bearer s3cret\r\n"), string::npos) << request;
  EXPECT_EQ(ran.code, 1);
  EXPECT_NE(ran.err.find("KINEMAP_TOKEN is not the right one"), string::npos) << ran.err;
}

TEST_F(Cli, ReplaySendsEveryDatagram) {
  const Listener listener;
  write("short.pcap", slurp(pcap()).substr(0, 200000));
  const Ran ran = kinemap({"replay", at("short.pcap"), "--to", listener.address(), "--speed", "50", "--json"});
  // The last packet of the file is cut: all before it are sent, and it is said.
  EXPECT_EQ(ran.code, 0);
  EXPECT_GT(listener.drain(), 100U) << ran.err;
  EXPECT_NE(ran.err.find(at("short.pcap")), string::npos) << ran.err;
}

TEST_F(Cli, ReplayOfAnMvnxSendsType02) {
  const Ran sim =
      kinemap({"sim", "--seed", "3", "--rooms", "1", "--rounds", "1", "--format", "mvnx", "--out", at("mvnx")});
  ASSERT_EQ(sim.code, 0) << sim.err;
  const Listener listener;
  const std::vector<string> command = {KINEMAP_BIN, "replay", at("mvnx/session.mvnx"), "--to", listener.address(),
                                       "--speed",   "4"};
  Background replay(command, at("replay.log"));
  std::size_t received = 0;
  for (int i = 0; i < 100 && received < 100; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    received += listener.drain();
  }
  EXPECT_GE(received, 100U) << slurp(at("replay.log"));
  EXPECT_EQ(replay.stop(SIGINT), 0) << "Ctrl-C ends it cleanly";
  EXPECT_EQ(slurp(at("replay.log")).substr(0, 8), "stopped;") << slurp(at("replay.log"));
}

TEST_F(Cli, ReplayNamesWhatIsWrong) {
  write("empty.pcap", "");
  write("no_wearer.pcap", slurp(pcap()).substr(0, 24));
  expect_refusal({"replay", at("none.pcap")}, 1, at("none.pcap"));
  expect_refusal({"replay", at("empty.pcap")}, 1, at("empty.pcap"));
  expect_refusal({"replay", at("no_wearer.pcap")}, 1, "no MXTP datagram");
  expect_refusal({"replay", pcap(), "--to", "no.such.host.invalid:9"}, 1, "no.such.host.invalid:9");
}

TEST_F(Cli, SimSendsLiveAndSaysWhenNobodyListens) {
  string closed;
  const auto begin = std::chrono::steady_clock::now();
  {
    const Listener listener;
    closed = listener.address();
    const std::vector<string> command = {KINEMAP_BIN, "sim", "--udp", listener.address()};
    Background sim(command, at("sim.log"));
    std::size_t received = 0;
    for (int i = 0; i < 100 && received < 50; ++i) {
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
      received += listener.drain();
    }
    EXPECT_GE(received, 50U);
    EXPECT_EQ(sim.stop(SIGTERM), 0);
  }
  // As long as it took to hear from the first one, and as much again: a sanitizer makes the program slow to start.
  const auto until_sending = std::chrono::steady_clock::now() - begin;
  Background sim({KINEMAP_BIN, "sim", "--udp", closed}, at("sim.log"));
  std::this_thread::sleep_for(2 * until_sending);
  EXPECT_EQ(sim.stop(SIGINT), 0);
  EXPECT_NE(slurp(at("sim.log")).find("nobody listened on " + closed), string::npos) << slurp(at("sim.log"));
}

TEST_F(Cli, OptimizeConvergesOnASquare) {
  // A square walked round, its closing edge exact, its last corner put wrong by the odometry.
  write("square.g2o",
        "VERTEX_SE3:QUAT 0 0 0 0 0 0 0 1\nVERTEX_SE3:QUAT 1 1 0 0 0 0 0 1\nVERTEX_SE3:QUAT 2 1 1.3 0 0 0 0 1\n"
        "EDGE_SE3:QUAT 0 1 1 0 0 0 0 0 1 1 0 0 0 0 0 1 0 0 0 0 1 0 0 0 1 0 0 1 0 1\n"
        "EDGE_SE3:QUAT 1 2 0 1 0 0 0 0 1 1 0 0 0 0 0 1 0 0 0 0 1 0 0 0 1 0 0 1 0 1\n"
        "EDGE_SE3:QUAT 0 2 1 1 0 0 0 0 1 1 0 0 0 0 0 1 0 0 0 0 1 0 0 0 1 0 0 1 0 1\n");
  const Ran ran = kinemap({"optimize", at("square.g2o"), "--out", at("done.g2o"), "--json"});
  ASSERT_EQ(ran.code, 0) << ran.err;
  const Json json = Json::parse(ran.out);
  EXPECT_NEAR(json["initial_cost"], 2 * 0.09, 1e-9);
  EXPECT_NEAR(json["final_cost"], 0.0, 1e-9);
  EXPECT_NE(slurp(at("done.g2o")).find("VERTEX_SE3:QUAT 2 1 1"), string::npos) << slurp(at("done.g2o"));
}

TEST_F(Cli, OptimizeNamesWhatIsWrong) {
  write("bad.g2o", "VERTEX_SE3:QUAT 0 0 0 0 0 0 0 1\nVERTEX_SE3:QUAT 1 zero\n");
  expect_refusal({"optimize", at("none.g2o"), "--out", at("o.g2o")}, 1, at("none.g2o"));
  expect_refusal({"optimize", at("bad.g2o"), "--out", at("o.g2o")}, 1, at("bad.g2o") + ":2");
  write("fine.g2o",
        "VERTEX_SE3:QUAT 0 0 0 0 0 0 0 1\nVERTEX_SE3:QUAT 1 1 0 0 0 0 0 1\n"
        "EDGE_SE3:QUAT 0 1 1 0 0 0 0 0 1 1 0 0 0 0 0 1 0 0 0 0 1 0 0 0 1 0 0 1 0 1\n");
  expect_refusal({"optimize", at("fine.g2o"), "--out", at("no/such/o.g2o")}, 1, at("no/such/o.g2o"));
}

TEST_F(Cli, OptimizeReachesTheBestKnownCost) {
  const string sphere = KINEMAP_SHARED_DATA "/sphere2500.g2o";
  if (!fs::exists(sphere)) GTEST_SKIP() << sphere << " is not here";
  const Ran ran = kinemap({"optimize", sphere, "--out", at("sphere.g2o"), "--json"});
  ASSERT_EQ(ran.code, 0) << ran.err;
  EXPECT_NEAR(Json::parse(ran.out)["final_cost"], 727.14967, 0.01);
}

}  // namespace
}  // namespace kinemap
