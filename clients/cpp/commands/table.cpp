// Formatting of tables, see table.h.
#include "commands/table.h"

#include <algorithm>
#include <stdexcept>

namespace tumble::client {
namespace {

constexpr std::size_t kGap = 2;

bool starts_code_point(char byte) {
  return (static_cast<unsigned char>(byte) & 0xC0) != 0x80;
}

}  // namespace

std::size_t display_width(std::string_view text) {
  return static_cast<std::size_t>(std::count_if(text.begin(), text.end(), starts_code_point));
}

std::string cut(std::string_view text, std::size_t width) {
  if (display_width(text) <= width) return std::string(text);
  if (width == 0) return "";
  std::size_t end = 0;
  for (std::size_t points = 0; end < text.size(); ++end) {
    if (starts_code_point(text[end]) && points++ == width - 1) break;
  }
  return std::string(text.substr(0, end)) + "…";
}

void Table::add_column(std::string title, Align align) {
  const std::size_t width = display_width(title);
  columns_.push_back({std::move(title), align, width});
}

void Table::add_row(std::vector<std::string> cells) {
  if (cells.size() != columns_.size()) throw std::logic_error("Table::add_row: wrong number of cells");
  for (std::size_t i = 0; i < cells.size(); ++i) {
    columns_[i].width = std::max(columns_[i].width, display_width(cells[i]));
  }
  rows_.push_back(std::move(cells));
}

std::string Table::format(std::size_t width, std::size_t height) const {
  std::size_t shown = 0, used = 0;
  for (; shown < columns_.size(); ++shown) {
    const std::size_t more = columns_[shown].width + (shown ? kGap : 0);
    if (width > 0 && shown > 0 && used + more > width) break;
    used += more;
  }
  const auto format_line = [&](auto cell) {
    std::string line;
    for (std::size_t i = 0; i < shown; ++i) {
      const std::size_t room = width > 0 ? std::min(width, columns_[i].width) : columns_[i].width;
      const std::string text = cut(cell(i), room);
      const std::string padding(room - display_width(text), ' ');
      if (i > 0) line.append(kGap, ' ');
      line += columns_[i].align == Align::right ? padding + text : text + padding;
    }
    line.erase(line.find_last_not_of(' ') + 1);
    return line + "\n";
  };

  std::string text = format_line([&](std::size_t i) { return columns_[i].title; });
  std::size_t fit = rows_.size();
  if (height > 0 && rows_.size() + 1 > height) fit = height > 2 ? height - 2 : 0;
  for (std::size_t row = 0; row < fit; ++row) {
    text += format_line([&](std::size_t i) { return rows_[row][i]; });
  }
  if (fit < rows_.size()) {
    const std::string rest = "… and " + std::to_string(rows_.size() - fit) + " more";
    text += (width > 0 ? cut(rest, width) : rest) + "\n";
  }
  return text;
}

}  // namespace tumble::client
