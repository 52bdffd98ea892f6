// SPDX-License-Identifier: Apache-2.0
#include "daemon/checkpoints.hpp"

#include <spdlog/spdlog.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <system_error>
#include <utility>

#include "core/archive.hpp"

namespace kinemap {
namespace {

namespace fs = std::filesystem;

constexpr double kEveryS = 300.0;  // of the session; so much is mapped again at most

/// What has to be the same for a checkpoint to count.
std::string maker(const MapperConfig& mapper) {
  Config config;
  config.mapper = mapper;
  return "kinemap-checkpoint " KINEMAP_VERSION " " + to_json(config).at("mapper").dump();
}

std::uint32_t checksum(std::string_view bytes) {
  boost::crc_32_type crc;
  crc.process_bytes(bytes.data(), bytes.size());
  return crc.checksum();
}

struct Content {
  std::string maker;
  std::uint64_t entries = 0;
  std::uint32_t crc = 0;  // of their records
  std::string state;
  void fields(Archive& a) { a(maker, entries, crc, state); }
};

std::optional<Content> read(const fs::path& path) {
  std::ostringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  const std::string bytes = std::move(text).str();
  std::uint32_t sum = 0;
  Content content;
  if (bytes.size() < sizeof sum) return std::nullopt;
  const std::string_view body = std::string_view(bytes).substr(sizeof sum);
  std::memcpy(&sum, bytes.data(), sizeof sum);
  if (sum != checksum(body)) return std::nullopt;
  Archive archive(body);
  archive(content);
  if (!archive.whole()) return std::nullopt;
  return content;
}

}  // namespace

void Checkpoints::begin(const journal::SessionStart& start) {
  std::error_code error;
  const fs::path path = journal_->checkpoint_of(start.id);
  if (!path_.empty() && path != path_) fs::remove(path_, error);  // only the session under way goes on
  path_ = path;
  entries_ = 0;
  crc_.reset();
  taken_s_ = 0.0;
}

void Checkpoints::add(const journal::Entry& entry) {
  if (journal_ == nullptr) return;
  if (const auto* start = std::get_if<journal::SessionStart>(&entry)) begin(*start);
  if (std::holds_alternative<journal::Announced>(entry)) return;  // the mapper is not told when it is the first time
  const std::string record = journal::record(entry);
  crc_.process_bytes(record.data(), record.size());
  ++entries_;
}

std::optional<Checkpoints::Restored> Checkpoints::restore(const std::vector<journal::Entry>& stored) {
  if (journal_ == nullptr || stored.empty()) return std::nullopt;
  const auto* start = std::get_if<journal::SessionStart>(&stored.front());
  if (start == nullptr) return std::nullopt;
  auto content = read(journal_->checkpoint_of(start->id));
  if (!content || content->maker != maker(config_)) return std::nullopt;
  std::size_t next = 0;
  while (next < stored.size() && (next == 0 || entries_ < content->entries)) add(stored[next++]);
  if (entries_ != content->entries || crc_.checksum() != content->crc) return std::nullopt;
  auto mapper = Mapper::restore(config_, content->state);
  if (!mapper) return std::nullopt;
  taken_s_ = mapper->snapshot()->time_s;
  return Restored{*std::move(mapper), next};
}

void Checkpoints::keep(const journal::Entry& entry, const Mapper& mapper) {
  // With these the map has just been published whole.
  const bool good_moment = std::holds_alternative<Trace>(entry) || std::holds_alternative<Sitting>(entry) ||
                           std::holds_alternative<journal::StreamSilence>(entry);
  const double time_s = mapper.snapshot()->time_s;
  if (path_.empty() || !good_moment || time_s < taken_s_ + kEveryS) return;
  taken_s_ = time_s;
  if (!write(mapper)) spdlog::debug("journal: no checkpoint could be written to {}", path_.string());
}

bool Checkpoints::write(const Mapper& mapper) const {
  Content content{maker(config_), entries_, crc_.checksum(), mapper.checkpoint()};
  Archive archive;
  archive(content);
  const std::string& body = archive.bytes();
  const std::uint32_t sum = checksum(body);
  std::error_code error;
  const auto space = fs::space(path_.parent_path(), error);
  if (error || space.available < journal_->min_free_bytes() + body.size()) return false;
  // A name that begins with a dot is of something that is being made.
  const fs::path being_made = path_.parent_path() / ".checkpoint";
  {
    std::ofstream file(being_made, std::ios::binary | std::ios::trunc);
    file.write(reinterpret_cast<const char*>(&sum), sizeof sum);
    file.write(body.data(), static_cast<std::streamsize>(body.size()));
    if (!file.flush()) {
      fs::remove(being_made, error);
      return false;
    }
  }
  fs::rename(being_made, path_, error);
  return !error;
}

}  // namespace kinemap
