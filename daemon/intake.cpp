// SPDX-License-Identifier: Apache-2.0
#include "daemon/intake.hpp"

#include <spdlog/spdlog.h>

#include <utility>

namespace kinemap {
namespace {

/// Longer than the gaps after which the tracker ends a trace or a sitting, so that telling it changes nothing that
/// frames could still.
constexpr double kSilenceS = 3.0;

}  // namespace

Intake::Intake(const AssemblerConfig& config, SuitSink sink) : sink_(std::move(sink)), assembler_(config) {}

double Intake::now_s() const {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - epoch_).count();
}

void Intake::take(std::span<const std::byte> datagram, const std::string& sender) {
  const double arrival_s = now_s();
  if (sink_.on_datagram) sink_.on_datagram(datagram, sender);
  bool any = false;
  assembler_.add(datagram, arrival_s, sender, [&](const SuitFrame& frame) {
    any = true;
    sink_.on_frame(frame);
  });
  if (any) {
    counts_.last_frame_s = arrival_s;
    streaming_ = true;
  }
  update_wearer();
  update_news(any ? sender : news_.sender);
}

void Intake::check_silence() {
  if (streaming_ && now_s() - counts_.last_frame_s > kSilenceS && sink_.on_silence()) streaming_ = false;
}

void Intake::update_wearer() {
  const auto revision = assembler_.wearer_revision();
  if (revision == wearer_offered_) return;
  if (sink_.on_wearer(assembler_.wearer())) wearer_offered_ = revision;
}

void Intake::update_news(const std::string& sender) {
  const bool new_wearer = assembler_.wearer_revision() != wearer_shown_;
  const bool new_refusal = assembler_.refusal() != news_.refusal;
  const bool new_sender = sender != news_.sender;
  if (!new_wearer && !new_refusal && !new_sender) return;
  if (new_sender) spdlog::info("suit: receiving from {}", sender);
  if (new_refusal && assembler_.refusal()) spdlog::warn("suit: {}", *assembler_.refusal());
  if (new_refusal && !assembler_.refusal()) spdlog::info("suit: the stream can be mapped now");
  if (new_wearer && assembler_.wearer().name != news_.wearer.name)
    spdlog::info("suit: worn by {}", assembler_.wearer().name);
  news_ = {sender, assembler_.refusal(), assembler_.wearer()};
  wearer_shown_ = assembler_.wearer_revision();
  shown_news_.set(std::make_shared<const ReceiverNews>(news_));
}

void Intake::publish() {
  counts_.stream = assembler_.stats();
  counts_.rate_hz = assembler_.rate_hz();
  shown_counts_.set(counts_);
}

ReceiverState Intake::state() const { return {shown_counts_.get(), shown_news_.get(), now_s()}; }

}  // namespace kinemap
