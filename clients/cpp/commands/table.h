// Plain-text tables: columns as wide as their content, numbers to the right, cut to the width of a terminal.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace tumble::client {

class Table {
 public:
  enum class Align { left, right };

  void add_column(std::string title, Align align);
  /// One cell a column.
  void add_row(std::vector<std::string> cells);
  std::size_t rows() const { return rows_.size(); }

  /// Lines with the titles first, each ended by a newline. `width` > 0: columns that don't fit are left out from the
  /// right, and a first column that doesn't fit is cut. `height` > 0: at most so many lines, the last one tells how
  /// many rows are missing.
  std::string format(std::size_t width = 0, std::size_t height = 0) const;

 private:
  struct Column {
    std::string title;
    Align align;
    std::size_t width;
  };
  std::vector<Column> columns_;
  std::vector<std::vector<std::string>> rows_;
};

/// Number of terminal columns the UTF-8 text takes, one for a code point.
std::size_t display_width(std::string_view text);
/// The text cut to `width` columns, with an ellipsis if something was cut.
std::string cut(std::string_view text, std::size_t width);

}  // namespace tumble::client
