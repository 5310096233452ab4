// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "scene/scene/scene.h"

namespace airtruth::scene {

// Largest number of members of a flock: a choice.
constexpr std::int64_t kMaxFlock = 200;
// Most intruders and distractors of one scene, birds of flocks counted one by one: each takes
// memory and time in every frame. Chosen.
constexpr std::size_t kMaxThings = 1000;

// `count` intruders in place of one bird, multirotor or balloon. All fly the leader's path, each
// displaced within a flat ellipsoid of the radius `spread_m` (a third of that in height), and none
// nearer to another than twice its own size where the ellipsoid has the room. Sizes and stroke
// rates differ by a few percent within the ranges of their keys, and every bird is at another
// moment of its stroke. Ids are ID-1, ID-2 and so on. The seed and the leader's id decide; a flock
// of one is its leader.
std::vector<Intruder> flock_of(const Intruder& leader,
                               std::int64_t count,
                               double spread_m,
                               std::uint64_t seed);

}  // namespace airtruth::scene
