// Grayscale images as tables of brightness: what height maps are read from.
#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

namespace tumble {

/// what(): "FILE: reason".
class ImageError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

struct GrayImage {
  std::uint32_t columns = 0, rows = 0;
  std::vector<double>
      brightness;  ///< 0 black .. 1 white, row by row from the top left, as stored: no gamma applied.
  double at(std::uint32_t column, std::uint32_t row) const {
    return brightness[std::size_t{row} * columns + column];
  }
};

/// A PNG of any depth up to 16 bits; colours count by their luminance, transparency is ignored. Throws ImageError.
GrayImage read_gray_image(const std::string& path);

}  // namespace tumble
