// Tables fit the terminal: columns as wide as their content, cut and left out where there is no room.
#include "commands/table.h"

#include <gtest/gtest.h>

namespace tumble::client {
namespace {

Table make_table() {
  Table table;
  table.add_column("NAME", Table::Align::left);
  table.add_column("Z [m]", Table::Align::right);
  table.add_column("MOTION", Table::Align::left);
  table.add_row({"ball", "12.500", "moving"});
  table.add_row({"long plank", "-1.0", "resting"});
  return table;
}

TEST(Table, AlignsTextLeftAndNumbersRight) {
  EXPECT_EQ(make_table().format(),
            "NAME         Z [m]  MOTION\n"
            "ball        12.500  moving\n"
            "long plank    -1.0  resting\n");
}

TEST(Table, LeavesOutColumnsThatDoNotFit) {
  EXPECT_EQ(make_table().format(20),
            "NAME         Z [m]\n"
            "ball        12.500\n"
            "long plank    -1.0\n");
}

TEST(Table, CutsAFirstColumnThatDoesNotFit) {
  EXPECT_EQ(make_table().format(6),
            "NAME\n"
            "ball\n"
            "long …\n");
}

TEST(Table, TellsHowManyRowsAreMissing) {
  Table table = make_table();
  for (int i = 0; i < 8; ++i) table.add_row({"more", "0", "moving"});
  EXPECT_EQ(table.format(0, 4),
            "NAME         Z [m]  MOTION\n"
            "ball        12.500  moving\n"
            "long plank    -1.0  resting\n"
            "… and 8 more\n");
  EXPECT_EQ(table.format(0, 11), table.format());  // all ten rows and the titles fit
}

TEST(Table, CountsCodePointsNotBytes) {
  EXPECT_EQ(display_width("Käfig"), 5u);
  EXPECT_EQ(cut("Käfig", 5), "Käfig");
  EXPECT_EQ(cut("Käfige", 3), "Kä…");
  EXPECT_EQ(cut("abc", 0), "");
}

TEST(Table, RefusesARowOfAnotherWidth) {
  EXPECT_THROW(make_table().add_row({"only one"}), std::logic_error);
}

}  // namespace
}  // namespace tumble::client
