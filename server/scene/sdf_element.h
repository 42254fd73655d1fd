// A tag of an SDF file with its line: hands out children, attributes and values, remembers what was asked for, and
// makes every error and warning of the reader. What nobody asked for is warned about by `finish`.
#pragma once

#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "math/types.h"

namespace tinyxml2 {
class XMLElement;
class XMLAttribute;
}  // namespace tinyxml2

namespace tumble {

/// What belongs to the whole file while it is read.
struct SdfFile {
  std::string name;       ///< As messages show it.
  std::string directory;  ///< Relative paths start here; empty: the working directory.
  std::vector<std::string> warnings;
};

enum class Range { any, non_negative, positive, zero_to_one };

class SdfElement {
 public:
  SdfElement(tinyxml2::XMLElement& xml, SdfFile& file) : xml_(&xml), file_(&file) {}

  std::string_view tag() const;
  SdfFile& file() const { return *file_; }

  /// Throws SceneError "FILE:LINE: <tag>: reason (value)".
  [[noreturn]] void fail(std::string_view reason) const;
  [[noreturn]] void fail(std::string_view reason, std::string_view value) const;
  [[noreturn]] void fail_attribute(std::string_view name, std::string_view reason,
                                   std::string_view value) const;
  /// Notes "FILE:LINE: <tag>: text".
  void warn(std::string_view text) const;
  /// Notes "FILE:LINE: <tag> is ignored: reason".
  void warn_ignored(std::string_view reason) const;
  void warn_attribute_ignored(std::string_view name, std::string_view reason, std::string_view value) const;

  // Children. A child that is asked for is not warned about; one that may stand once and stands twice is an error.
  std::optional<SdfElement> child(std::string_view tag);
  SdfElement required_child(std::string_view tag);
  /// All children with one of the tags, in the order of the file.
  std::vector<SdfElement> children(std::initializer_list<std::string_view> tags);
  /// Fails at the first child of that tag.
  void refuse(std::string_view tag, std::string_view reason);

  // Attributes.
  std::optional<std::string> attribute(std::string_view name);
  std::string required_attribute(std::string_view name);

  /// To be called when everything was asked for: unknown tags, attributes and stray text become warnings; within the
  /// prefix `tumble:`, where a name can only be misspelt, errors.
  void finish();

  // The element's own value: its text and nothing else. Calls finish.
  std::string to_text();
  double to_number(Range range = Range::any);
  /// Exactly `count` numbers, separated by white space.
  std::vector<double> to_numbers(std::size_t count);
  /// Any number of numbers.
  std::vector<double> to_numbers();
  Vec3 to_vector();
  int to_integer(int least, int most);
  bool to_flag();

  // The value of a child, if there is one.
  std::optional<double> number(std::string_view tag, Range range = Range::any);
  std::optional<Vec3> vector(std::string_view tag);
  std::optional<bool> flag(std::string_view tag);
  std::optional<std::string> text(std::string_view tag);

  /// True if both have the same tags, attributes and texts below them (comments aside).
  bool has_same_content(const SdfElement& other) const;

 private:
  std::string where(std::string_view label) const;
  [[noreturn]] void fail_at(std::string_view label, std::string_view message) const;
  void finish_children();
  void finish_attributes();
  double parse_number(std::string_view token) const;

  tinyxml2::XMLElement* xml_;
  SdfFile* file_;
  std::vector<const tinyxml2::XMLAttribute*> known_attributes_;
};

/// Shortest decimal text that reads back as the same bits, whatever the locale.
std::string to_shortest_text(double value);
std::string to_shortest_text(float value);

}  // namespace tumble
