// The table of the narrow phase's errors against ground truth, as Markdown. `contacts_accuracy [SHARE [NAME]]`: SHARE of
// the full number of poses, 1 by default, which takes hours where hulls have 200 vertices; only of classes or pairs of that
// name.
#include <cstdio>
#include <cstdlib>

#include "support/contact_accuracy.h"

int main(int argc, char** argv) {
  using namespace tumble::test;
  const double share = argc > 1 ? std::atof(argv[1]) : 1.0;
  std::puts("| pairs | class | queries | contacts | wrong | depth error / size | normal error |");
  std::puts("|---|---|---|---|---|---|---|");
  int wrong = 0;
  for (const ContactClass& c : contact_classes()) {
    if (argc > 2 && c.name != argv[2] && c.pairs != argv[2]) continue;
    const ContactFigures f = run_class(c, std::max(1, static_cast<int>(c.queries * share)));
    std::printf("| %s | %s | %d | %d | %d | %.1e | %.1e |\n", c.pairs.c_str(), c.name.c_str(), f.queries,
                f.contacts, f.wrong(), f.depth, f.normal);
    if (f.wrong() > 0) {
      std::fprintf(
          stderr, "%s %s: missed %d, invented %d, wrong side %d, point outside %d, truth unsure %d\n",
          c.pairs.c_str(), c.name.c_str(), f.missed, f.invented, f.wrong_side, f.outside, f.bad_truth);
    }
    std::fflush(stdout);
    wrong += f.wrong();
  }
  return wrong > 0;
}
