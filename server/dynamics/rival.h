// A table of rival methods: one line each, in the order of their enum, looked up by the enum or by the user's word.
#pragma once

#include <array>
#include <cassert>
#include <optional>
#include <string_view>

namespace tumble {

template <typename Kind, typename Function>
struct Rival {
  Kind kind;
  const char* name;
  Function function;
};

template <typename Kind, typename Function, std::size_t n>
const Rival<Kind, Function>& rival(const std::array<Rival<Kind, Function>, n>& rivals, Kind kind) {
  const Rival<Kind, Function>& found = rivals[static_cast<std::size_t>(kind)];
  assert(found.kind == kind);
  return found;
}

template <typename Kind, typename Function, std::size_t n>
std::optional<Kind> kind_from_name(const std::array<Rival<Kind, Function>, n>& rivals,
                                   std::string_view name) {
  for (const Rival<Kind, Function>& rival : rivals) {
    if (name == rival.name) return rival.kind;
  }
  return std::nullopt;
}

}  // namespace tumble
