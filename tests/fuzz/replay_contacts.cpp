// The fuzz test without a fuzzer: replays kept inputs, then random bytes from a fixed seed.
//   replay_contacts INPUTS [--save FOLDER] [FILE|FOLDER...]    exit status 1 if a claim is broken
// A broken input is printed in hex and, with --save, written to the folder, which is where a finding is kept.
#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "contact_claims.h"
#include "kept_inputs.h"

namespace {

using namespace tumble::test;
using Bytes = std::vector<std::uint8_t>;

struct Tally {
  int inputs = 0, skipped = 0, broken = 0;
  std::map<Outcome, int> outcomes;
};

void replay(const Bytes& bytes, const std::string& name, const std::string& folder, Tally& tally) {
  ++tally.inputs;
  const auto pair = decode_shape_pair(bytes);
  if (!pair) {
    ++tally.skipped;
    return;
  }
  const Verdict verdict = check_contact(*pair);
  ++tally.outcomes[verdict.outcome];
  if (verdict.broken.empty()) return;
  ++tally.broken;
  fmt::print("{}: {} against {}: {}\n", name, shape_name(pair->a), shape_name(pair->b), verdict.broken);
  print_input(bytes);
  if (folder.empty()) return;
  std::ofstream(std::filesystem::path(folder) / name, std::ios::binary)
      .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<std::string> arguments(argv + 1, argv + argc);
  std::string folder;
  if (arguments.size() >= 3 && arguments[1] == "--save") {
    folder = arguments[2];
    arguments.erase(arguments.begin() + 1, arguments.begin() + 3);
  }
  if (arguments.empty()) {
    fmt::print(stderr, "usage: replay_contacts INPUTS [--save FOLDER] [FILE|FOLDER...]\n");
    return 2;
  }
  Tally tally;
  for (std::size_t i = 1; i < arguments.size(); ++i) {
    for (const auto& path : files_below(arguments[i]))
      replay(read_input(path), path.filename().string(), "", tally);
  }
  const int kept = tally.inputs, random = std::stoi(arguments[0]);
  std::mt19937 engine(1);
  for (int i = 0; i < random; ++i) {
    Bytes bytes(400);
    for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(engine() >> 24);
    replay(bytes, fmt::format("random{}", i), folder, tally);
  }
  fmt::print("{} kept and {} random inputs: {} apart, {} touching, {} overlapping, {} no hull; {} broken\n",
             kept, random, tally.outcomes[Outcome::apart], tally.outcomes[Outcome::touching],
             tally.outcomes[Outcome::overlapping], tally.skipped, tally.broken);
  // A test that sees too few contacts proves nothing.
  const bool blind = random > 100 && tally.outcomes[Outcome::overlapping] < random / 4;
  return tally.broken > 0 || blind ? 1 : 0;
}
