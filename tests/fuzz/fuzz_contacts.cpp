// libFuzzer's entry: any bytes are a pair of shapes, and every claim about their contact must hold.
#include <cstdio>
#include <cstdlib>

#include "contact_claims.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto pair = tumble::test::decode_shape_pair({data, size});
  if (!pair) return -1;  // not worth keeping
  const tumble::test::Verdict verdict = tumble::test::check_contact(*pair);
  if (verdict.broken.empty()) return 0;
  std::fprintf(stderr, "%s against %s: %s\n", shape_name(pair->a), shape_name(pair->b),
               verdict.broken.c_str());
  std::abort();
}
