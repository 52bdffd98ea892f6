// SPDX-License-Identifier: Apache-2.0
#include "core/tracker/unfinished.hpp"

#include <utility>

namespace kinemap {
namespace {

template <class Whole, class List>
void append_piece(std::optional<Whole>& whole, Whole&& piece, List Whole::*list) {
  if (whole && whole->begin_s == piece.begin_s) {
    List all = std::move((*whole).*list);
    all.insert(all.end(), (piece.*list).begin(), (piece.*list).end());
    piece.*list = std::move(all);
  }
  whole = std::move(piece);
}

}  // namespace

void append(std::optional<UnfinishedTrace>& whole, UnfinishedTrace piece) {
  append_piece(whole, std::move(piece), &UnfinishedTrace::contacts);
}

void append(std::optional<UnfinishedSitting>& whole, UnfinishedSitting piece) {
  append_piece(whole, std::move(piece), &UnfinishedSitting::samples);
}

const KeyPose* Interrupted::find(KeyPoseId id) const {
  if (id < key_poses.front().id || id - key_poses.front().id >= key_poses.size()) return nullptr;
  return &key_poses[id - key_poses.front().id];
}

}  // namespace kinemap
