// libFuzzer's entry: any bytes are traffic, and every claim about the server that it reaches must hold.
#include <cstdio>
#include <cstdlib>

#include "traffic_claims.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const tumble::test::TrafficVerdict verdict = tumble::test::check_traffic({data, size});
  if (verdict.broken.empty()) return 0;
  std::fprintf(stderr, "%s\n", verdict.broken.c_str());
  std::abort();
}
