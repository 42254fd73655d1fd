// The fuzz test of traffic without a fuzzer: replays kept inputs, then sound traffic in which some bytes were changed,
// from a fixed seed.
//   replay_traffic INPUTS [FILE|FOLDER...]    exit status 1 if a claim is broken
//   replay_traffic --seed FILE                writes the sound traffic, where a fuzzer starts from
#include <fmt/format.h>

#include <fstream>
#include <random>
#include <string_view>

#include "kept_inputs.h"
#include "traffic_claims.h"

namespace {

using namespace tumble::test;
using Input = std::vector<std::uint8_t>;

struct Tally {
  int inputs = 0, broken = 0;
  std::int64_t decoded = 0, applied = 0;
};

void replay(const Input& input, const std::string& name, Tally& tally) {
  const TrafficVerdict verdict = check_traffic(input);
  ++tally.inputs;
  tally.decoded += verdict.decoded;
  tally.applied += verdict.applied;
  if (verdict.broken.empty()) return;
  ++tally.broken;
  fmt::print("{}: {}\n", name, verdict.broken);
  print_input(input);
}

/// Bytes changed, cut out and doubled at one to eight places.
Input mutated(Input input, std::mt19937& engine) {
  for (std::uint32_t changes = 1 + engine() % 8; changes > 0; --changes) {
    const auto at = input.begin() + static_cast<std::ptrdiff_t>(engine() % input.size());
    const std::uint32_t how = engine() % 8;
    if (how < 6) {
      *at = how < 3 ? static_cast<std::uint8_t>(engine() >> 24)
                    : static_cast<std::uint8_t>(*at ^ 1u << engine() % 8);
    } else if (how == 6) {
      input.erase(at);
    } else {
      const std::uint8_t byte = *at;
      input.insert(at, byte);
    }
  }
  return input;
}

int write_seed(const char* path) {
  const Input seed = sound_traffic();
  std::ofstream(path, std::ios::binary)
      .write(reinterpret_cast<const char*>(seed.data()), static_cast<std::streamsize>(seed.size()));
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc == 3 && std::string_view(argv[1]) == "--seed") return write_seed(argv[2]);
  if (argc < 2) {
    fmt::print(stderr, "usage: replay_traffic INPUTS [FILE|FOLDER...] | --seed FILE\n");
    return 2;
  }
  Tally tally;
  for (int i = 2; i < argc; ++i) {
    for (const auto& path : files_below(argv[i])) replay(read_input(path), path.filename().string(), tally);
  }
  const int kept = tally.inputs, random = std::stoi(argv[1]);
  const Input sound = sound_traffic();
  std::mt19937 engine(1);
  for (int i = 0; i < random; ++i) replay(mutated(sound, engine), fmt::format("mutated{}", i), tally);
  fmt::print("{} kept and {} mutated inputs: {} sound messages, {} commands applied; {} broken\n", kept,
             random, tally.decoded, tally.applied, tally.broken);
  // A test in which little takes effect proves nothing.
  return tally.broken > 0 || tally.applied < 5 * random ? 1 : 0;
}
