// A world as bytes, and a world from them that goes on with the same bits: everything that the next steps depend on,
// caches included. Hulls and surfaces of triangles are constant and big: they are named by the geometry of the scene's
// world that holds them. Counters are not state: they start anew.
#pragma once

#include <string>
#include <string_view>

#include "world/world.h"

namespace tumble {

/// Handles also stand in lists outside of the world.
template <typename Archive>
void serialize(Archive& archive, BodyId& id) {
  auto& [index, generation] = id;
  archive(index, generation);
}

/// `start`: the world that the scene describes, before its first step; it has every hull and surface of `world`.
/// Overwrites `bytes`, whose memory it uses again.
void write_world(const World& world, const World& start, std::string& bytes);
/// Throws std::runtime_error if the bytes are no world's.
World read_world(const World& start, std::string_view bytes);

}  // namespace tumble
