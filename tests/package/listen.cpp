// A client of a server that is not there, on a bus inside the process.
#include <tumble/world.h>

#include <cstdio>
#include <lcm/lcm-cpp.hpp>

int main() {
  tumble::client::World world(std::make_shared<lcm::LCM>("memq://"), {});
  try {
    world.wait_for_server(0.01);
  } catch (const tumble::client::NoServer& problem) {
    std::printf("%s\n", problem.what());
    return 0;
  }
  return 1;
}
