// How often this test program has taken memory from the heap (the operators are replaced in allocation_test.cpp).
#pragma once

#include <cstdint>

namespace tumble::test {

std::uint64_t allocation_count();

}  // namespace tumble::test
