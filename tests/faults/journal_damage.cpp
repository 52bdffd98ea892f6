// SPDX-License-Identifier: Apache-2.0
// The journal of a simulated session, cut, flipped and overwritten: the daemon's own reader opens it, loses only what
// was hit, puts the damaged file into quarantine and never crashes.
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <random>
#include <sstream>

#include "core/tracker/tracker.hpp"
#include "daemon/session_store.hpp"
#include "protocol/assembler.hpp"
#include "protocol/journal_map.hpp"
#include "tools/sim/simulate.hpp"

namespace kinemap {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kTail = 64 * 1024;
const std::string kId = "20260101T000000Z";

struct Counts {
  std::uint64_t files = 0, quarantined = 0, mapped = 0, wrong = 0;
};

/// Prints what is wrong, and counts it.
bool expect(bool good, Counts& counts, const char* what, std::size_t where) {
  if (good) return true;
  ++counts.wrong;
  std::fprintf(stderr, "byte %zu: %s\n", where, what);
  return false;
}

std::string text_of(const fs::path& path) {
  std::ostringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return std::move(text).str();
}

void write_file(const fs::path& path, const std::string& bytes) { std::ofstream(path, std::ios::binary) << bytes; }

/// What a daemon writes of a simulated session.
std::vector<journal::Entry> simulated_entries(std::uint64_t seed) {
  sim::SimOptions options;
  options.seed = seed;
  options.rooms = 1;
  options.rounds = 1;
  auto source = sim::LiveSource::create(options);
  Assembler assembler{AssemblerConfig{}};
  Tracker tracker{TrackerConfig{}};
  std::vector<journal::Entry> entries{journal::SessionStart{kId, 1767225600000, "test", journal::kVersion}};
  std::vector<Event> events;
  double next_mark_s = 0.0;
  const auto on_frame = [&](const SuitFrame& frame) {
    events.clear();
    tracker.step(frame, events);
    for (const auto& event : events) entries.push_back(journal::entry_of(event));
    if (frame.time_s < next_mark_s) return;
    entries.push_back(journal::StreamMark{frame.time_s, frame.counter, 1767225600000, frame.time_code_ms, {}, {}, {}});
    next_mark_s = frame.time_s + 1.0;
  };
  while (const auto packets = source->next())
    for (const auto& datagram : packets->datagrams) assembler.add(datagram, packets->time_s, "sim:1", on_frame);
  assembler.flush(on_frame);
  return entries;
}

/// A journal, and where its records end: ends[i] is the end of the first line and i records.
struct Journal {
  std::string bytes = journal::header();
  std::vector<std::size_t> ends{bytes.size()};
  std::vector<std::string> records;

  explicit Journal(const std::vector<journal::Entry>& entries) {
    for (const auto& entry : entries) {
      records.push_back(journal::record(entry));
      bytes += records.back();
      ends.push_back(bytes.size());
    }
  }
  /// Records of which no byte is in [begin, end).
  [[nodiscard]] std::size_t untouched(std::size_t begin, std::size_t end) const {
    std::size_t count = 0;
    for (std::size_t i = 0; i < records.size(); ++i) count += ends[i + 1] <= begin || ends[i] >= end;
    return count;
  }
};

class Campaign {
 public:
  Campaign(Journal journal, fs::path directory)
      : journal_(std::move(journal)), directory_(std::move(directory)), path_(files().journal_of(kId)) {
    fs::create_directories(path_.parent_path());
  }

  /// Cut at every `step`th byte of the last 64 KiB.
  Counts truncations(std::size_t step) {
    Counts counts;
    write_file(path_, journal_.bytes);
    auto store = SessionStore::open(directory_);
    const std::size_t size = journal_.bytes.size();
    std::size_t mapped = 0;
    for (std::size_t cut = 0; cut <= std::min(kTail, size - journal_.ends[0]); cut += step) {
      const std::size_t length = size - cut;
      fs::resize_file(path_, length);
      const auto whole = static_cast<std::size_t>(std::upper_bound(journal_.ends.begin(), journal_.ends.end(), length) -
                                                  journal_.ends.begin() - 1);
      const auto session = store->last();
      ++counts.files;
      if (!expect(session.has_value(), counts, "is not opened", length)) continue;
      expect(session->entries.size() == whole, counts, "other entries than those before the cut", length);
      expect(session->bytes == journal_.ends[whole], counts, "would go on at another place", length);
      if (std::exchange(mapped, whole) != whole) map(session->entries, counts);
    }
    expect(!fs::exists(files().quarantine()), counts, "a torn end is no damage", 0);
    return counts;
  }

  /// `hit(bytes, random)` changes some bytes and says which.
  template <class Hit>
  Counts damage(int times, int map_every, Hit hit) {
    Counts counts;
    std::mt19937_64 random(7);
    auto store = SessionStore::open(directory_);
    for (int i = 0; i < times; ++i) {
      std::string bytes = journal_.bytes;
      const auto [begin, end] = hit(bytes, random);
      write_file(path_, bytes);
      fs::remove_all(files().quarantine());
      const auto read = journal::read(bytes, "journal");
      ++counts.files;
      if (!expect(static_cast<bool>(read), counts, "is not read", begin)) continue;
      expect(read->entries.size() == journal_.untouched(begin, end), counts, "more is lost than was hit", begin);
      check_healed(*store, bytes, read->damage.size(), begin, counts, i % map_every == 0);
    }
    fs::remove_all(files().quarantine());
    return counts;
  }

 private:
  [[nodiscard]] SessionFiles files() const { return SessionFiles(directory_); }

  void check_healed(SessionStore& store, const std::string& damaged, std::size_t places, std::size_t where,
                    Counts& counts, bool with_map) {
    const auto session = store.last();
    if (!expect(session.has_value(), counts, "is not opened", where)) return;
    const bool kept = fs::exists(files().quarantined(kId));
    counts.quarantined += kept;
    expect(kept || places == 0, counts, "is not quarantined", where);
    if (kept) expect(text_of(files().quarantined(kId)) == damaged, counts, "quarantine changed it", where);
    const auto healed = read_journal(path_);
    expect(healed && !healed->damaged(), counts, "is not healed", where);
    expect(healed && healed->contents.entries.size() == session->entries.size(), counts, "healing lost more", where);
    if (with_map) map(session->entries, counts);
  }

  static void map(const std::vector<journal::Entry>& entries, Counts& counts) {
    Mapper mapper{MapperConfig{}};
    for (const auto& entry : entries) journal::tell(mapper, entry);
    mapper.finish();
    ++counts.mapped;
  }

  Journal journal_;
  fs::path directory_;
  fs::path path_;
};

using Hit = std::pair<std::size_t, std::size_t>;

Hit flip_a_bit(std::string& bytes, std::mt19937_64& random) {
  const std::size_t at = random() % bytes.size();
  bytes[at] = static_cast<char>(bytes[at] ^ 1 << random() % 8);
  return {at, at + 1};
}

/// A page that came back from the disk as zeros, or as something else.
Hit lose_a_page(std::string& bytes, std::mt19937_64& random) {
  const std::size_t begin = random() % bytes.size() / 4096 * 4096;
  const std::size_t end = std::min(begin + 4096, bytes.size());
  const bool zeros = random() % 2 == 0;
  for (std::size_t i = begin; i < end; ++i) bytes[i] = zeros ? '\0' : static_cast<char>(random());
  return {begin, end};
}

int report(const char* what, const Counts& counts) {
  std::printf("%s: %llu files, %llu quarantined, %llu mapped, %llu wrong\n", what,
              static_cast<unsigned long long>(counts.files), static_cast<unsigned long long>(counts.quarantined),
              static_cast<unsigned long long>(counts.mapped), static_cast<unsigned long long>(counts.wrong));
  std::fflush(stdout);
  return counts.wrong > 0 ? 1 : 0;
}

int run(std::size_t step, int flips, int pages, std::size_t length) {
  auto entries = simulated_entries(5);
  std::size_t size = 0, count = 0;
  for (; count < entries.size() && size < length; ++count) size += journal::record(entries[count]).size();
  entries.resize(count);
  const auto directory = fs::temp_directory_path() / ("kinemap-damage-" + std::to_string(::getpid()));
  int failed = 0;
  {
    Campaign campaign(Journal(entries), directory);
    std::printf("a journal of %zu entries, %zu bytes\n", count, size);
    failed |= report("cut short", campaign.truncations(step));
    failed |= report("one bit flipped", campaign.damage(flips, 10, flip_a_bit));
    failed |= report("a page lost", campaign.damage(pages, 10, lose_a_page));
  }
  fs::remove_all(directory);
  return failed;
}

}  // namespace
}  // namespace kinemap

int main(int argc, char** argv) {
  CLI::App app("Damaged journals are opened, used as far as they can be read, and quarantined.");
  std::size_t step = 1, length = 160 * 1024;
  int flips = 1000, pages = 200;
  app.add_option("--step", step, "Bytes between two cuts of the last 64 KiB")->capture_default_str();
  app.add_option("--flips", flips, "Places at which one bit is flipped")->capture_default_str();
  app.add_option("--pages", pages, "Pages of 4 KiB that are lost")->capture_default_str();
  app.add_option("--bytes", length, "Length of the journal")->capture_default_str();
  CLI11_PARSE(app, argc, argv);
  spdlog::set_level(spdlog::level::off);
  return kinemap::run(step, flips, pages, length);
}
