// SPDX-License-Identifier: Apache-2.0
// What libFuzzer is where there is no clang: runs a target over all files of the given folders, and then over mutations
// of them, the same ones each time.
//
// Usage: fuzz_NAME [-runs=N] FOLDER_OR_FILE…    N mutations of each file (default 200)
#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace {

using Bytes = std::vector<std::uint8_t>;

const Bytes* under_test = nullptr;  // for the signal handler

/// Leaves the input behind on which the target died.
void keep_input(int signal) {
  const int file = ::open("crash-input", O_CREAT | O_WRONLY | O_TRUNC | O_CLOEXEC, 0644);
  if (file >= 0 && under_test != nullptr) {
    [[maybe_unused]] const auto written = ::write(file, under_test->data(), under_test->size());
    constexpr char kText[] = "the input is in ./crash-input\n";
    [[maybe_unused]] const auto said = ::write(STDERR_FILENO, kText, sizeof kText - 1);
  }
  std::signal(signal, SIG_DFL);
  std::raise(signal);
}

void run(const Bytes& input) {
  under_test = &input;
  LLVMFuzzerTestOneInput(input.data(), input.size());
}

/// One change of the kinds that break parsers.
void mutate(Bytes& bytes, const Bytes& other, std::mt19937& random) {
  constexpr std::array<std::uint8_t, 10> kOdd{0, 1, 0x7f, 0x80, 0xff, '"', '{', '[', '<', '-'};
  const auto below = [&random](std::size_t n) { return random() % n; };
  if (bytes.empty()) bytes.push_back(0);
  const auto from = bytes.begin() + static_cast<std::ptrdiff_t>(below(bytes.size()));
  const auto length =
      static_cast<std::ptrdiff_t>(below(1 + std::min<std::size_t>(64, static_cast<std::size_t>(bytes.end() - from))));
  switch (below(7)) {
    case 0:
      *from ^= static_cast<std::uint8_t>(1U << below(8));
      break;
    case 1:
      *from = kOdd[below(kOdd.size())];
      break;
    case 2:
      bytes.erase(from, from + length);
      break;
    case 3: {
      const Bytes piece(from, from + length);
      bytes.insert(bytes.begin() + static_cast<std::ptrdiff_t>(below(bytes.size())), piece.begin(), piece.end());
      break;
    }
    case 4:
      std::fill(from, from + std::min<std::ptrdiff_t>(length, 4), kOdd[below(5)]);
      break;
    case 5:
      bytes.resize(static_cast<std::size_t>(from - bytes.begin()));
      break;
    default:
      if (other.empty()) break;
      bytes.erase(from, bytes.end());
      bytes.insert(bytes.end(), other.begin() + static_cast<std::ptrdiff_t>(below(other.size())), other.end());
  }
}

void read_seeds(const std::filesystem::path& path, std::vector<Bytes>& seeds) {
  if (!std::filesystem::is_directory(path)) {
    std::ifstream file(path, std::ios::binary);
    seeds.emplace_back(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
    return;
  }
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(path)) files.push_back(entry.path());
  std::sort(files.begin(), files.end());  // the same order on every machine
  for (const auto& file : files) read_seeds(file, seeds);
}

}  // namespace

int main(int argc, char** argv) {
  unsigned runs = 200;
  std::vector<Bytes> seeds;
  for (int i = 1; i < argc; ++i) {
    const std::string argument = argv[i];
    if (argument.starts_with("-runs="))
      runs = static_cast<unsigned>(std::stoul(argument.substr(6)));
    else
      read_seeds(argument, seeds);
  }
  if (seeds.empty()) {
    std::fprintf(stderr, "no seeds\n");
    return 1;
  }
  for (const int signal : {SIGABRT, SIGSEGV, SIGBUS, SIGFPE, SIGILL}) std::signal(signal, keep_input);
  for (const Bytes& seed : seeds) run(seed);
  std::mt19937 random(1);
  for (const Bytes& seed : seeds) {
    for (unsigned n = 0; n < runs; ++n) {
      Bytes bytes = seed;
      for (unsigned changes = 1 + random() % 8; changes > 0; --changes)
        mutate(bytes, seeds[random() % seeds.size()], random);
      run(bytes);
    }
  }
  std::printf("%zu seeds, %zu mutations\n", seeds.size(), seeds.size() * runs);
  return 0;
}
