// Every class of the accuracy table with fewer poses: nothing missed, invented or on the wrong side, and depth and normal
// exact to rounding. The full table: `./run bench contacts`.
#include "support/contact_accuracy.h"

#include <gtest/gtest.h>

namespace tumble::test {
namespace {

class ContactAccuracy : public testing::TestWithParam<ContactClass> {};

TEST_P(ContactAccuracy, AgreesWithTheExhaustiveSearch) {
  const ContactFigures f = run_class(GetParam(), std::max(50, GetParam().queries / 4000));
  EXPECT_EQ(f.missed, 0);
  EXPECT_EQ(f.invented, 0);
  EXPECT_EQ(f.wrong_side, 0);
  EXPECT_EQ(f.outside, 0);
  EXPECT_EQ(f.bad_truth, 0);
  EXPECT_GE(f.contacts, f.queries / 5);
  EXPECT_LE(f.depth, 1e-13);   // measured 1.4e-14, where a tie of axes is decided by order
  EXPECT_LE(f.normal, 1e-12);  // measured 4e-15
}

std::string name_of(const testing::TestParamInfo<ContactClass>& test) {
  std::string name = test.param.pairs + "_" + test.param.name;
  for (char& c : name) c = std::isalnum(static_cast<unsigned char>(c)) != 0 ? c : '_';
  return name;
}

INSTANTIATE_TEST_SUITE_P(Table, ContactAccuracy, testing::ValuesIn(contact_classes()), name_of);

/// The truth's own shortcut, edges by their arcs, against every pair of edges.
TEST(CoreTruth, ArcsLeaveOutNothing) {
  RandomPose random(2);
  for (const ContactClass& c : contact_classes()) {
    if (c.pairs.find("200") != std::string::npos) continue;
    for (int i = 0; i < 3; ++i) {
      const PlacedPair pair = c.make(random);
      const CoreTruth quick(pair.a, pair.X_WA, pair.b, pair.X_WB),
          brute(pair.a, pair.X_WA, pair.b, pair.X_WB, true);
      EXPECT_NEAR(static_cast<double>(quick.separation()), static_cast<double>(brute.separation()),
                  1e-17 * size_of(pair))
          << c.pairs << ' ' << c.name;
    }
  }
}

}  // namespace
}  // namespace tumble::test
