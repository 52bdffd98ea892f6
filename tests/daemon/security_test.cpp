// SPDX-License-Identifier: Apache-2.0
// Who is let in: docs/security.md names these tests.
#include "daemon/security.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <boost/beast/websocket.hpp>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "daemon/latest.hpp"
#include "daemon/server.hpp"
#include "daemon/web.hpp"
#include "tests/daemon/client.hpp"
#include "tests/daemon/support.hpp"
#include "tools/kinemap/certificate.hpp"

namespace kinemap {
namespace {

using test::eventually;
using test::HttpClient;
using testing::HasSubstr;
using Headers = std::vector<std::pair<std::string, std::string>>;

const std::string kReader = "reader-0123456789abcdef", kAdmin = "admin-0123456789abcdef0",
                  kOther = "other-0123456789abcdef";
const Headers kUpgrade{{"Connection", "Upgrade"},
                       {"Upgrade", "websocket"},
                       {"Sec-WebSocket-Version", "13"},
                       {"Sec-WebSocket-Key", "dGhlIHNhbXBsZSBub25jZQ=="}};

Headers with(Headers headers, const std::string& name, const std::string& value) {
  headers.emplace_back(name, value);
  return headers;
}

/// A folder with tokens, a certificate and its key.
class SecurityTest : public testing::Test {
 protected:
  void SetUp() override {
    std::filesystem::create_directories(folder_);
    write("tokens", "# who may\nread " + kReader + "\nadmin " + kAdmin + "\n");
    renew_certificate();
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  void write(const std::string& name, const std::string& text, mode_t mode = 0600) {
    std::ofstream(at(name), std::ios::binary) << text;
    ASSERT_EQ(::chmod(at(name).c_str(), mode), 0);
  }
  void renew_certificate() {
    const auto made = cli::make_self_signed({"localhost", "127.0.0.1"}, 60);
    ASSERT_TRUE(made) << made.error();
    write("crt", made->certificate);
    write("key", made->key);
    fingerprint_ = *cli::fingerprint_of(made->certificate);
  }
  [[nodiscard]] std::string at(const std::string& name) const { return folder_ / name; }

  /// Everybody must show a token, so that a client on this machine is like any other.
  [[nodiscard]] Config::Api guarded(const std::string& auth = "always") const {
    Config::Api config;
    config.port = 0;
    config.auth = auth;
    config.tokens = at("tokens");
    return config;
  }
  [[nodiscard]] Config::Api encrypted(const std::string& auth = "always") const {
    Config::Api config = guarded(auth);
    config.certificate = at("crt");
    config.key = at("key");
    return config;
  }

  void start(const Config::Api& config, const ServerLimits& limits = {}) {
    Sources sources{[this] { return map_.get(); }, [] { return LiveBody{}; },
                    [this] {
                      return ReceiverState{{}, news_, 10.0};
                    },
                    [] { return PipelineStats{}; }, [] { return std::optional<Notice>(); }};
    auto started = Server::open(config, std::move(sources), Config::Suit{}, 9763, limits);
    ASSERT_EQ(started.index(), 0U) << std::get<StartError>(started).message;
    server_ = std::move(std::get<0>(started));
    port_ = server_->port();
  }

  /// The status, and the error's code where there is one.
  [[nodiscard]] std::pair<int, std::string> ask(const std::string& method, const std::string& target,
                                                const Headers& headers = {}) const {
    const auto reply = HttpClient(port_).request(method, target, headers);
    const auto json = reply.json();
    return {reply.status, json.is_object() && json.contains("error") ? json["error"]["code"] : ""};
  }
  [[nodiscard]] std::string error_of(const Config::Api& config) const {
    const auto error = Server::check(config);
    return error ? error->message : "no error";
  }

  std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() / ("security_test." + std::to_string(::getpid()));
  std::string fingerprint_;
  Latest<MapSnapshot> map_{std::make_shared<const MapSnapshot>()};
  std::shared_ptr<const ReceiverNews> news_ = std::make_shared<const ReceiverNews>();
  std::unique_ptr<Server> server_;
  std::uint16_t port_ = 0;
};

/// One connection over TLS.
class TlsClient {
 public:
  explicit TlsClient(std::uint16_t port, int lowest = TLS1_2_VERSION, int highest = TLS1_3_VERSION)
      : context_(context_of(lowest, highest)) {
    stream_.next_layer().connect({net::ip::address_v4::loopback(), port});
    stream_.handshake(ssl::stream_base::client, error);
  }

  [[nodiscard]] std::string fingerprint() {
    const std::unique_ptr<X509, void (*)(X509*)> peer(SSL_get1_peer_certificate(stream_.native_handle()), X509_free);
    return peer ? cli::fingerprint_of(peer.get()) : "";
  }
  int get(const std::string& target, const std::string& token) {
    http::request<http::empty_body> request(http::verb::get, target, 11);
    request.set(http::field::host, "localhost");
    if (!token.empty()) request.set(http::field::authorization, "Bearer " + token);
    http::write(stream_, request, error);
    http::response<http::string_body> response;
    http::read(stream_, buffer_, response, error);
    return error ? 0 : static_cast<int>(response.result_int());
  }

  ErrorCode error;

 private:
  static ssl::context context_of(int lowest, int highest) {
    ssl::context context(ssl::context::tls_client);
    SSL_CTX* const native = context.native_handle();
    SSL_CTX_set_security_level(native, 0);  // else OpenSSL itself refuses what the server is to refuse
    SSL_CTX_set_min_proto_version(native, lowest);
    SSL_CTX_set_max_proto_version(native, highest);
    return context;
  }

  net::io_context io_;
  ssl::context context_;
  ssl::stream<net::ip::tcp::socket> stream_{io_, context_};
  beast::flat_buffer buffer_;
};

/// A WebSocket of the stream from an address of this machine.
class Watcher {
 public:
  Watcher(std::uint16_t port, const std::string& token, const std::string& address = "127.0.0.1") {
    auto& socket = stream_.next_layer();
    socket.open(net::ip::tcp::v4());
    socket.bind({net::ip::make_address(address), 0});
    socket.connect({net::ip::address_v4::loopback(), port});
    const timeval patience{60, 0};
    ::setsockopt(socket.native_handle(), SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    stream_.handshake("localhost", "/api/v1/stream?token=" + token, refused_);
  }
  /// False: the server has declined.
  [[nodiscard]] bool open() const {
    EXPECT_TRUE(!refused_ || refused_ == beast::websocket::error::upgrade_declined) << refused_.message();
    return !refused_;
  }
  [[nodiscard]] bool answers() {
    ErrorCode error;
    stream_.write(net::buffer(std::string(R"({"op":"query","id":1,"path":"map"})")), error);
    beast::flat_buffer buffer;
    if (!error) stream_.read(buffer, error);
    return !error;
  }
  /// Waits until the server ends it: the code and the reason.
  std::pair<int, std::string> goodbye() {
    ErrorCode error;
    beast::flat_buffer buffer;
    while (!error) stream_.read(buffer, error);
    return {stream_.reason().code, stream_.reason().reason.c_str()};
  }

 private:
  net::io_context io_;
  beast::websocket::stream<net::ip::tcp::socket> stream_{io_};
  ErrorCode refused_;
};

TEST_F(SecurityTest, OtherAddressesWantATokenAndACertificateOrNoneInSoManyWords) {
  for (const char* address : {"0.0.0.0", "::", "192.0.2.7"}) {
    Config::Api config;
    config.address = address;
    EXPECT_THAT(error_of(config), HasSubstr("wants a token and a TLS certificate first: `kinemap pair` makes them"));
    config.tokens = at("tokens");
    EXPECT_THAT(error_of(config), HasSubstr("wants a TLS certificate first"));
    config = encrypted("remote");
    config.address = address;
    EXPECT_EQ(error_of(config), "no error");
    config.tokens.clear();
    EXPECT_THAT(error_of(config), HasSubstr("wants a token first"));
    config = {};
    config.address = address;
    config.auth = "none";
    EXPECT_EQ(error_of(config), "no error");
  }
  EXPECT_EQ(error_of({}), "no error");  // loopback
  Config::Api always;
  always.auth = "always";
  EXPECT_THAT(error_of(always), HasSubstr("api.auth \"always\" wants a token"));
  always.address = "0.0.0.0";
  const auto started = Server::open(always, {}, {}, 0);
  ASSERT_EQ(started.index(), 1U);
  EXPECT_EQ(std::get<StartError>(started).code, ExitCode::Config);
}

TEST_F(SecurityTest, FilesThatOthersMayReadAreRefused) {
  write("tokens", "read " + kReader, 0640);
  EXPECT_THAT(error_of(guarded()), HasSubstr("/tokens: others may read or write it (mode 0640)"));
  write("tokens", "read " + kReader, 0600);
  EXPECT_EQ(error_of(encrypted()), "no error");
  ASSERT_EQ(::chmod(at("key").c_str(), 0604), 0);
  EXPECT_THAT(error_of(encrypted()), HasSubstr("/key: others may read or write it (mode 0604)"));
}

TEST_F(SecurityTest, WrongFilesAreNamedAndTheirSecretsAreNot) {
  for (const std::string& wrong :
       std::vector<std::string>{"read", "write 0123456789abcdefghij", "read short", "read 0123456789abcdef?hij",
                                "0123456789abcdefghijklmnop", "read 0123456789abcdefghij x"}) {
    write("tokens", "\n" + wrong + "\n");
    const auto error = error_of(guarded());
    EXPECT_THAT(error, HasSubstr("/tokens: line 2: expected")) << wrong;
    EXPECT_THAT(error, testing::Not(HasSubstr("0123456789"))) << wrong;
  }
  write("tokens", "# none\n");
  EXPECT_THAT(error_of(guarded()), HasSubstr("there is no token in it"));
  std::filesystem::remove(at("tokens"));
  EXPECT_THAT(error_of(guarded()), HasSubstr("/tokens: cannot be read: No such file"));
  write("tokens", "read " + kReader);
  auto config = encrypted();
  config.key.clear();
  EXPECT_THAT(error_of(config), HasSubstr("api.key is missing"));
  config = encrypted();
  write("crt", "nonsense");
  EXPECT_THAT(error_of(config), HasSubstr("/crt: cannot be used as a certificate"));
  renew_certificate();
  write("key", cli::make_self_signed({"other"}, 1)->key);
  EXPECT_THAT(error_of(config), HasSubstr("/key: cannot be used as the key of "));
}

TEST_F(SecurityTest, CredentialsOfTheServiceAreTakenWithoutBeingNamed) {
  std::filesystem::create_directories(folder_ / "credentials");
  for (const char* name : {"tokens", "crt", "key"})
    std::filesystem::copy_file(at(name), folder_ / "credentials" / (std::string("kinemap.") + name));
  ASSERT_EQ(::chmod(at("credentials/kinemap.tokens").c_str(), 0440), 0);  // as systemd's access list looks
  Config::Api config;
  config.address = "0.0.0.0";
  EXPECT_THAT(error_of(config), HasSubstr("wants a token"));
  ::setenv("CREDENTIALS_DIRECTORY", at("credentials").c_str(), 1);
  EXPECT_EQ(error_of(config), "no error");
  EXPECT_TRUE(load_security(config)->from_credentials) << "a reload cannot bring others";
  ::unsetenv("CREDENTIALS_DIRECTORY");
  EXPECT_FALSE(load_security(guarded())->from_credentials);
}

TEST_F(SecurityTest, EveryPathButThePageWantsAToken) {
  start(guarded());
  for (const char* path : {"/api/v1/map", "/api/v1/status", "/healthz", "/api/v1/openapi.json",
                           "/api/v1/export/plan.svg", "/api/v1/stream", "/api/v1/none", "/%zz"}) {
    const auto reply = HttpClient(port_).get(path);
    EXPECT_EQ(reply.status, 401) << path;
    EXPECT_EQ(reply.header("WWW-Authenticate"), "Bearer realm=\"kinemap\"") << path;
  }
  EXPECT_EQ(ask("GET", "/").first, 200);
  EXPECT_EQ(ask("GET", "/licenses.txt").first, 200);
  const auto map = [&](const std::string& shown) { return ask("GET", "/api/v1/map", {{"Authorization", shown}}); };
  EXPECT_EQ(map("Bearer " + kReader).first, 200);
  EXPECT_EQ(map("bearer " + kAdmin).first, 200);
  const std::vector<std::string> others{"Bearer " + kReader + "x",
                                        "Bearer " + kReader.substr(1),
                                        "Bearer ",
                                        "Basic " + kReader,
                                        "Bearer" + kReader,
                                        "Bearer admin"};
  for (const auto& wrong : others) EXPECT_EQ(map(wrong).first, 401) << wrong;
  EXPECT_EQ(map("Bearer wrong").second, "token_wrong");
  EXPECT_EQ(map("").second, "token_missing");
}

TEST_F(SecurityTest, WhatChangesSomethingWantsTheScopeAdmin) {
  start(guarded());
  const auto post = [&](const std::string& token) {
    return ask("POST", "/api/v1/map", {{"Authorization", "Bearer " + token}});
  };
  EXPECT_EQ(post(kReader), (std::pair<int, std::string>{403, "token_reads_only"}));
  EXPECT_EQ(post(kAdmin).first, 405);  // let in; there is nothing to change
  EXPECT_EQ(ask("POST", "/").first, 401);
}

TEST_F(SecurityTest, TheQueryCarriesATokenForWebSocketsOnly) {
  start(guarded());
  EXPECT_EQ(ask("GET", "/api/v1/map?token=" + kReader).second, "token_in_query");
  EXPECT_EQ(ask("GET", "/?token=" + kReader).second, "token_in_query");
  EXPECT_EQ(ask("GET", "/api/v1/stream", kUpgrade).first, 401);
  EXPECT_EQ(ask("GET", "/api/v1/stream?token=wrong", kUpgrade).first, 401);
  EXPECT_EQ(ask("GET", "/api/v1/stream?token=" + kReader, kUpgrade).first, 101);
  EXPECT_EQ(ask("GET", "/api/v1/stream", with(kUpgrade, "Authorization", "Bearer " + kReader)).first, 101);
  const auto viewer = with(kUpgrade, "Sec-WebSocket-Protocol", "foxglove.sdk.v1");
  EXPECT_EQ(ask("GET", "/", viewer).first, 401);
  EXPECT_EQ(ask("GET", "/?token=" + kReader, viewer).first, 101);
}

TEST_F(SecurityTest, ThisMachineNeedsNoTokenUnlessItIsAskedAlways) {
  start(guarded("remote"));
  EXPECT_EQ(ask("GET", "/api/v1/map").first, 200);
  EXPECT_EQ(ask("GET", "/api/v1/stream", kUpgrade).first, 101);
  // A proxy that passes the name on lets nobody in.
  auto config = guarded("remote");
  config.allowed_hosts = {"map.example"};
  start(config);
  EXPECT_EQ(ask("GET", "/api/v1/map", {{"Host", "map.example"}}).second, "token_missing");
}

TEST_F(SecurityTest, NamesThatArePointedHereAreRefused) {
  const auto policy = [](bool loopback_only, Config::Api config = {}) {
    return WebPolicy(config, {}, loopback_only, false);
  };
  const auto code = [](const WebPolicy& judge, const std::string& host) {
    WebVisit visit;
    visit.host = host;
    visit.local = true;
    const auto error = judge.refusal(visit);
    return error ? error->code : "";
  };
  for (const char* host : {"", "localhost", "LOCALHOST:8765", "127.0.0.1:8765", "127.1.2.3", "[::1]:8765", "[::1]"})
    EXPECT_EQ(code(policy(true), host), "") << host;
  for (const char* host :
       {"example.org", "127.0.0.1.example.org", "localhost.example.org", "10.0.0.1", "[::2]", "[::1"})
    EXPECT_EQ(code(policy(true), host), "forbidden_host") << host;
  // Open to others: its addresses and its own names as well.
  Config::Api open;
  open.auth = "none";
  open.allowed_hosts = {"map.example"};
  std::array<char, 256> name{};
  ::gethostname(name.data(), name.size() - 1);
  const std::string own = name.data();
  const std::vector<std::string> names{"10.0.0.1:8765", "[fe80::1]:8765", "Map.Example", own + ":8765", own + ".local"};
  for (const auto& host : names) EXPECT_EQ(code(policy(false, open), host), "") << host;
  EXPECT_EQ(code(policy(false, open), "evil.example"), "forbidden_host");
}

TEST_F(SecurityTest, PagesOfOtherHostsMayNotOpenWebSockets) {
  Config::Api config;
  config.allowed_origins = {"https://app.foxglove.dev"};
  config.allowed_hosts = {"map.example"};
  config.auth = "none";
  const WebPolicy policy(config, {}, true, false);
  const auto allowed = [&](const std::string& origin, const std::string& host, bool viewer) {
    WebVisit visit;
    visit.upgrade = true;
    visit.viewer = viewer;
    visit.origin = origin;
    visit.host = host;
    return !policy.refusal(visit);
  };
  for (const bool viewer : {false, true}) {
    EXPECT_TRUE(allowed("", "localhost:8765", viewer));
    EXPECT_TRUE(allowed("http://localhost:8765", "localhost:8765", viewer));
    EXPECT_TRUE(allowed("https://Map.example", "map.example", viewer));
    EXPECT_TRUE(allowed("https://app.foxglove.dev", "localhost:8765", viewer));
    for (const char* origin : {"null", "http://evil.example", "http://", "localhost:8765", "http://app.foxglove.dev",
                               "https://app.foxglove.dev.evil.example", "https://localhost.evil.example", "file://x"})
      EXPECT_FALSE(allowed(origin, "localhost:8765", viewer)) << origin;
  }
  // Viewers also come as programs, and from other servers of this machine.
  for (const char* origin : {"file://", "http://localhost:8080", "http://127.0.0.1"}) {
    EXPECT_TRUE(allowed(origin, "localhost:8765", true)) << origin;
    EXPECT_FALSE(allowed(origin, "localhost:8765", false)) << origin;
  }
  EXPECT_FALSE(allowed("http://localhost:8080", "map.example", true));
}

TEST_F(SecurityTest, TlsIsOfVersion12OrNewer) {
  start(encrypted());
  for (const int version : {TLS1_2_VERSION, TLS1_3_VERSION}) {
    TlsClient client(port_, version, version);
    EXPECT_FALSE(client.error) << client.error.message();
    EXPECT_EQ(client.fingerprint(), fingerprint_);
    EXPECT_EQ(client.get("/api/v1/map", ""), 401);
    EXPECT_EQ(client.get("/api/v1/map", kReader), 200);
    EXPECT_EQ(client.get("/api/v1/status", kReader), 200);  // on the same connection
  }
  for (const int version : {TLS1_VERSION, TLS1_1_VERSION}) EXPECT_TRUE(TlsClient(port_, version, version).error);
}

TEST_F(SecurityTest, InTheClearATlsPortSaysWhatItSpeaks) {
  start(encrypted());
  EXPECT_EQ(ask("GET", "/api/v1/map", {{"Authorization", "Bearer " + kReader}}).second, "tls_required");
  EXPECT_EQ(ask("GET", "/").second, "tls_required");
  // This machine's own programs go on as before, where they are trusted.
  start(encrypted("remote"));
  EXPECT_EQ(ask("GET", "/api/v1/map").first, 200);
}

TEST_F(SecurityTest, TheStreamAndFoxgloveSpeakOverTls) {
  start(encrypted());
  for (const auto& [target, subprotocol] :
       {std::pair("/api/v1/stream?token=", ""), std::pair("/?token=", "foxglove.sdk.v1")}) {
    net::io_context io;
    ssl::context context(ssl::context::tls_client);
    beast::websocket::stream<ssl::stream<net::ip::tcp::socket>> stream(io, context);
    stream.next_layer().next_layer().connect({net::ip::address_v4::loopback(), port_});
    stream.next_layer().handshake(ssl::stream_base::client);
    stream.set_option(beast::websocket::stream_base::decorator([subprotocol](beast::websocket::request_type& request) {
      if (*subprotocol != 0) request.set(http::field::sec_websocket_protocol, subprotocol);
    }));
    stream.handshake("localhost", target + kReader);
    if (*subprotocol == 0) stream.write(net::buffer(std::string(R"({"op":"query","id":1,"path":"map"})")));
    beast::flat_buffer buffer;
    stream.read(buffer);
    EXPECT_THAT(beast::buffers_to_string(buffer.data()), HasSubstr(*subprotocol == 0 ? "\"result\"" : "serverInfo"));
    stream.close(beast::websocket::close_code::normal);
  }
}

TEST_F(SecurityTest, ReloadedCertificatesAreForNewConnectionsAndTokensForAll) {
  start(encrypted());
  TlsClient old(port_);
  EXPECT_EQ(old.get("/api/v1/map", kReader), 200);
  const std::string before = fingerprint_, fresh = "fresh-0123456789abcdef";
  renew_certificate();
  write("tokens", "read " + fresh);
  EXPECT_FALSE(server_->reconfigure(encrypted()));
  EXPECT_EQ(TlsClient(port_).fingerprint(), fingerprint_);
  EXPECT_EQ(old.fingerprint(), before);
  EXPECT_EQ(old.get("/api/v1/map", kReader), 401);
  EXPECT_EQ(old.get("/api/v1/map", fresh), 200);
  // What is wrong changes nothing.
  write("key", "nonsense");
  const auto error = server_->reconfigure(encrypted());
  ASSERT_TRUE(error);
  EXPECT_THAT(error->message, HasSubstr("/key: cannot be used"));
  EXPECT_EQ(TlsClient(port_).fingerprint(), fingerprint_);
}

TEST_F(SecurityTest, RequestsOfOneAddressAreThrottled) {
  auto config = guarded();
  config.max_requests_per_s = 1;
  start(config);
  HttpClient client(port_);
  const Headers token{{"Authorization", "Bearer " + kReader}};
  EXPECT_EQ(client.request("GET", "/api/v1/pose", token).status, 503);  // no pose yet
  EXPECT_EQ(client.request("GET", "/api/v1/rooms", token).status, 200);
  test::HttpReply refused;
  for (int i = 0; i < 20 && refused.status != 429; ++i) refused = client.request("GET", "/api/v1/rooms", token);
  EXPECT_EQ(refused.status, 429);
  EXPECT_EQ(refused.header("Retry-After"), "1");
  test::HttpReply status;
  EXPECT_TRUE(eventually([&] { return (status = client.request("GET", "/api/v1/status", token)).status == 200; }));
  EXPECT_GE(status.json()["clients"]["throttled"], 1);
}

TEST_F(SecurityTest, ConnectionsOfOneAddressAreLimited) {
  auto config = guarded();
  config.max_clients_per_address = 2;
  start(config);
  const Headers token{{"Authorization", "Bearer " + kReader}};
  Watcher first(port_, kReader), second(port_, kReader);
  ASSERT_TRUE(first.open());
  ASSERT_TRUE(second.open());
  HttpClient third(port_);
  EXPECT_EQ(third.request("GET", "/api/v1/map", token).json()["error"]["code"], "too_many_of_you");
}

TEST_F(SecurityTest, OpenStreamsWhoseTokenIsGoneOrMayLessAreClosed) {
  const std::string gone = "gone-0123456789abcdef", falls = "falls-0123456789abcdef";
  write("tokens", "read " + kReader + "\nread " + gone + "\nadmin " + falls + "\nadmin " + kAdmin + "\n");
  start(guarded());
  Watcher reader(port_, kReader), without(port_, gone), fallen(port_, falls), admin(port_, kAdmin);
  write("tokens", "read " + kReader + "\nread " + falls + "\nadmin " + kAdmin + "\n");
  EXPECT_FALSE(server_->reconfigure(guarded()));
  const auto [code, reason] = without.goodbye();
  EXPECT_EQ(code, 4401);
  EXPECT_THAT(reason, HasSubstr("token_wrong"));
  EXPECT_EQ(fallen.goodbye().first, 4403);
  EXPECT_TRUE(reader.answers());
  EXPECT_TRUE(admin.answers());
  EXPECT_FALSE(Watcher(port_, gone).open());
  EXPECT_TRUE(Watcher(port_, falls).open());
  const auto status = HttpClient(port_).request("GET", "/api/v1/status", {{"Authorization", "Bearer " + kReader}});
  EXPECT_EQ(status.json()["clients"]["revoked"], 2);
  // What else decides at the door holds for who is inside, too.
  EXPECT_FALSE(server_->reconfigure(encrypted()));
  EXPECT_EQ(reader.goodbye().first, 4400);
}

TEST_F(SecurityTest, SomeAddressesCannotTakeAllPlaces) {
  auto config = guarded();
  config.max_clients = 16;
  config.max_clients_per_address = 4;
  start(config);
  std::vector<std::unique_ptr<Watcher>> many;
  for (int i = 0; i < 16; ++i)
    many.push_back(std::make_unique<Watcher>(port_, kReader, "127.0.0." + std::to_string(2 + i % 4)));
  for (const auto& one : many) ASSERT_TRUE(one->open());
  // Others share alike with them …
  Watcher other(port_, kReader, "127.0.0.9");
  EXPECT_TRUE(other.open());
  EXPECT_TRUE(other.answers());
  EXPECT_EQ(many.front()->goodbye().first, 1013) << "the oldest of those that have the most";
  // … who come back in vain.
  EXPECT_FALSE(Watcher(port_, kReader, "127.0.0.2").open());
  EXPECT_EQ(HttpClient(port_).get("/").status, 200) << "the page is for everybody";
  EXPECT_EQ(ask("GET", "/api/v1/map").first, 401);
  // Who may do more always gets in, also from an address that has its share.
  Watcher admin(port_, kAdmin, "127.0.0.3");
  EXPECT_TRUE(admin.open());
  EXPECT_TRUE(admin.answers());
  EXPECT_TRUE(other.answers());
  const auto status = HttpClient(port_).request("GET", "/api/v1/status", {{"Authorization", "Bearer " + kAdmin}});
  EXPECT_EQ(status.status, 200);
  EXPECT_GE(status.json()["clients"]["displaced"], 3);
}

TEST_F(SecurityTest, OneTokenCannotTakeAllPlacesFromManyAddresses) {
  write("tokens", "read " + kReader + "\nread " + kOther + "\n");
  auto config = guarded();
  config.max_clients = 8;
  start(config);
  std::vector<std::unique_ptr<Watcher>> many;
  for (int i = 0; i < 8; ++i)
    many.push_back(std::make_unique<Watcher>(port_, kReader, "127.0.1." + std::to_string(1 + i)));
  EXPECT_FALSE(Watcher(port_, kReader, "127.0.2.1").open()) << "each of them has one";
  Watcher other(port_, kOther, "127.0.2.1");
  EXPECT_TRUE(other.open());
  EXPECT_TRUE(other.answers());
}

TEST_F(SecurityTest, WhoAsksForNothingGivesWayAndWhoIsSlowIsClosed) {
  Config::Api config;
  config.port = 0;
  config.max_clients = 4;
  ServerLimits limits;
  limits.request = std::chrono::milliseconds(300);
  start(config, limits);
  // Connections that send nothing, or a request that never ends.
  net::io_context io;
  std::vector<net::ip::tcp::socket> stuck;
  for (int i = 0; i < 20; ++i) {
    stuck.emplace_back(io).connect({net::ip::address_v4::loopback(), port_});
    if (i % 2 == 0) net::write(stuck.back(), net::buffer(std::string("GET /api/v1/map HTTP/1.1\r\nHost: loc")));
  }
  EXPECT_TRUE(eventually([&] { return ask("GET", "/api/v1/map").first == 200; }));
  nlohmann::json clients;
  EXPECT_TRUE(eventually([&] {
    clients = HttpClient(port_).get("/api/v1/status").json()["clients"];
    return clients["connections"] == 1;
  }));
  EXPECT_GT(clients["gave_way"], 0);
  EXPECT_GT(clients["slow_requests_closed"], 0);
}

TEST(Visitors, AskAsOftenAsTheRateAllows) {
  Visitors visitors(10);
  auto now = Visitors::Clock::now();
  const auto visitor = visitors.of(*parse_address("10.0.0.1"), now);
  for (int i = 0; i < 20; ++i) EXPECT_EQ(visitors.ask(*visitor, now), Visitors::Clock::duration::zero());
  const auto wait = visitors.ask(*visitor, now);
  EXPECT_EQ(wait, std::chrono::milliseconds(100));
  EXPECT_EQ(visitors.ask(*visitor, now + wait), Visitors::Clock::duration::zero());
  EXPECT_NE(visitors.ask(*visitor, now + wait), Visitors::Clock::duration::zero());
}

TEST(Visitors, AreOneForAnIpv6NetworkAndForgotten) {
  Visitors visitors(10);
  auto now = Visitors::Clock::now();
  EXPECT_EQ(visitors.of(*parse_address("2001:db8::1"), now), visitors.of(*parse_address("2001:db8::2"), now));
  EXPECT_NE(visitors.of(*parse_address("2001:db8::1"), now), visitors.of(*parse_address("2001:db8:0:1::1"), now));
  EXPECT_NE(visitors.of(*parse_address("10.0.0.1"), now), visitors.of(*parse_address("10.0.0.2"), now));
  for (int i = 0; i < 10000; ++i)
    visitors.of(*parse_address("10.1." + std::to_string(i / 256) + "." + std::to_string(i % 256)), now);
  EXPECT_LE(visitors.size(), 128U);
}

}  // namespace
}  // namespace kinemap
