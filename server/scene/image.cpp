// See image.h. libpng reports errors by longjmp: nothing with a destructor lives in the functions it leaves.
#include "scene/image.h"

#include <png.h>

#include <csetjmp>
#include <cstdio>
#include <memory>

namespace tumble {
namespace {

constexpr png_uint_32 kMaxSide = 20'000;  // pixels: a larger image is a mistake, not a landscape

struct FileCloser {
  void operator()(std::FILE* file) const { std::fclose(file); }
};

/// libpng's two structs, and the text of its error.
struct PngReader {
  png_structp png = nullptr;
  png_infop info = nullptr;
  std::string error;

  PngReader() {
    png = png_create_read_struct(PNG_LIBPNG_VER_STRING, this, &fail, &ignore_warning);
    if (png != nullptr) info = png_create_info_struct(png);
    if (info == nullptr) throw std::bad_alloc();
  }
  PngReader(const PngReader&) = delete;
  PngReader& operator=(const PngReader&) = delete;
  ~PngReader() { png_destroy_read_struct(&png, &info, nullptr); }

  static void fail(png_structp png, png_const_charp text) {
    static_cast<PngReader*>(png_get_error_ptr(png))->error = text;
    png_longjmp(png, 1);
  }
  static void ignore_warning(png_structp, png_const_charp) {}
};

/// Makes every kind of PNG one channel of 8 or 16 bits. False: reader.error says why.
bool read_header(PngReader& reader, std::FILE* file) {
  if (setjmp(png_jmpbuf(reader.png))) return false;
  png_init_io(reader.png, file);
  png_set_user_limits(reader.png, kMaxSide, kMaxSide);
  png_read_info(reader.png, reader.info);
  png_set_expand(reader.png);
  png_set_strip_alpha(reader.png);
  if (png_get_color_type(reader.png, reader.info) & PNG_COLOR_MASK_COLOR) {
    png_set_rgb_to_gray(reader.png, PNG_ERROR_ACTION_NONE, PNG_RGB_TO_GRAY_DEFAULT, PNG_RGB_TO_GRAY_DEFAULT);
  }
  png_set_interlace_handling(reader.png);
  png_read_update_info(reader.png, reader.info);
  return true;
}

bool read_rows(PngReader& reader, png_bytepp rows) {
  if (setjmp(png_jmpbuf(reader.png))) return false;
  png_read_image(reader.png, rows);
  png_read_end(reader.png, nullptr);
  return true;
}

}  // namespace

GrayImage read_gray_image(const std::string& path) {
  const std::unique_ptr<std::FILE, FileCloser> file(std::fopen(path.c_str(), "rb"));
  if (!file) throw ImageError(path + ": cannot be read");
  PngReader reader;
  if (!read_header(reader, file.get())) throw ImageError(path + ": no readable PNG (" + reader.error + ")");
  GrayImage image;
  image.columns = png_get_image_width(reader.png, reader.info);
  image.rows = png_get_image_height(reader.png, reader.info);
  const bool wide = png_get_bit_depth(reader.png, reader.info) == 16;
  const std::size_t stride = png_get_rowbytes(reader.png, reader.info);
  std::vector<png_byte> bytes(stride * image.rows);
  std::vector<png_bytep> rows;
  for (std::size_t row = 0; row < image.rows; ++row) rows.push_back(&bytes[row * stride]);
  if (!read_rows(reader, rows.data())) throw ImageError(path + ": no readable PNG (" + reader.error + ")");
  for (std::size_t row = 0; row < image.rows; ++row) {
    for (std::size_t column = 0; column < image.columns; ++column) {
      const png_byte* pixel = rows[row] + (wide ? 2 * column : column);
      image.brightness.push_back(wide ? (256.0 * pixel[0] + pixel[1]) / 65535.0 : pixel[0] / 255.0);
    }
  }
  return image;
}

}  // namespace tumble
