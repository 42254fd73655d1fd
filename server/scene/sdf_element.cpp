// See sdf_element.h. Numbers are read by from_chars: no locale, no leading or trailing garbage, correctly rounded.
#include "scene/sdf_element.h"

#include <tinyxml2.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>

#include "scene/sdf.h"

namespace tumble {
namespace {

constexpr std::string_view kOwnPrefix = "tumble:";
constexpr std::string_view kNotInSubset = "not in the subset of SDF that is read";
constexpr std::string_view kSpace = " \t\r\n";
constexpr std::size_t kLongestShownValue = 60;  // characters of a value that an error repeats

std::string shown(std::string_view value) {
  if (value.size() <= kLongestShownValue) return std::string(value);
  return std::string(value.substr(0, kLongestShownValue)) + "...";
}

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(kSpace);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kSpace) - first + 1);
}

std::vector<std::string_view> split(std::string_view text) {
  std::vector<std::string_view> tokens;
  for (std::size_t begin = text.find_first_not_of(kSpace); begin != std::string_view::npos;) {
    const std::size_t end = std::min(text.find_first_of(kSpace, begin), text.size());
    tokens.push_back(text.substr(begin, end - begin));
    begin = text.find_first_not_of(kSpace, end);
  }
  return tokens;
}

bool is_blank(const tinyxml2::XMLText& text) {
  return trimmed(text.Value()).empty();
}

bool is_same(const tinyxml2::XMLElement& a, const tinyxml2::XMLElement& b) {
  if (std::strcmp(a.Name(), b.Name()) != 0) return false;
  const tinyxml2::XMLAttribute *at = a.FirstAttribute(), *bt = b.FirstAttribute();
  for (; at && bt; at = at->Next(), bt = bt->Next()) {
    if (std::strcmp(at->Name(), bt->Name()) != 0 || std::strcmp(at->Value(), bt->Value()) != 0) return false;
  }
  if (at || bt) return false;
  const char *a_text = a.GetText(), *b_text = b.GetText();
  if (trimmed(a_text ? a_text : "") != trimmed(b_text ? b_text : "")) return false;
  const tinyxml2::XMLElement *ac = a.FirstChildElement(), *bc = b.FirstChildElement();
  for (; ac && bc; ac = ac->NextSiblingElement(), bc = bc->NextSiblingElement()) {
    if (!is_same(*ac, *bc)) return false;
  }
  return !ac && !bc;
}

template <class Number>
std::string shortest(Number value) {
  char buffer[64];
  const std::to_chars_result end = std::to_chars(buffer, buffer + sizeof buffer, value);
  return std::string(buffer, end.ptr);
}

}  // namespace

std::string to_shortest_text(double value) {
  return shortest(value);
}
std::string to_shortest_text(float value) {
  return shortest(value);
}

std::string_view SdfElement::tag() const {
  return xml_->Name();
}

std::string SdfElement::where(std::string_view label) const {
  return file_->name + ":" + std::to_string(xml_->GetLineNum()) + ": <" + shown(label) + ">";
}

void SdfElement::fail_at(std::string_view label, std::string_view message) const {
  throw SceneError(where(label) + ": " + std::string(message));
}

void SdfElement::fail(std::string_view reason) const {
  fail_at(tag(), reason);
}

void SdfElement::fail(std::string_view reason, std::string_view value) const {
  fail_at(tag(), std::string(reason) + " (" + shown(trimmed(value)) + ")");
}

void SdfElement::fail_attribute(std::string_view name, std::string_view reason,
                                std::string_view value) const {
  fail_at(std::string(tag()) + " " + std::string(name), std::string(reason) + " (" + shown(value) + ")");
}

void SdfElement::warn(std::string_view text) const {
  file_->warnings.push_back(where(tag()) + ": " + std::string(text));
}

void SdfElement::warn_ignored(std::string_view reason) const {
  file_->warnings.push_back(where(tag()) + " is ignored: " + std::string(reason));
}

void SdfElement::warn_attribute_ignored(std::string_view name, std::string_view reason,
                                        std::string_view value) const {
  file_->warnings.push_back(where(std::string(tag()) + " " + std::string(name)) +
                            " is ignored: " + std::string(reason) + " (" + shown(value) + ")");
}

std::optional<SdfElement> SdfElement::child(std::string_view tag) {
  const std::string name(tag);
  tinyxml2::XMLElement* found = xml_->FirstChildElement(name.c_str());
  if (!found) return std::nullopt;
  if (tinyxml2::XMLElement* second = found->NextSiblingElement(name.c_str())) {
    SdfElement(*second, *file_)
        .fail("may stand only once", "first in line " + std::to_string(found->GetLineNum()));
  }
  found->SetUserData(file_);
  return SdfElement(*found, *file_);
}

SdfElement SdfElement::required_child(std::string_view tag) {
  if (std::optional<SdfElement> found = child(tag)) return *found;
  fail("needs a <" + std::string(tag) + ">");
}

std::vector<SdfElement> SdfElement::children(std::initializer_list<std::string_view> tags) {
  std::vector<SdfElement> found;
  for (auto* c = xml_->FirstChildElement(); c; c = c->NextSiblingElement()) {
    if (std::find(tags.begin(), tags.end(), std::string_view(c->Name())) == tags.end()) continue;
    c->SetUserData(file_);
    found.emplace_back(*c, *file_);
  }
  return found;
}

void SdfElement::refuse(std::string_view tag, std::string_view reason) {
  for (const SdfElement& found : children({tag})) found.fail(reason);
}

std::optional<std::string> SdfElement::attribute(std::string_view name) {
  const tinyxml2::XMLAttribute* found = xml_->FindAttribute(std::string(name).c_str());
  if (!found) return std::nullopt;
  known_attributes_.push_back(found);
  return found->Value();
}

std::string SdfElement::required_attribute(std::string_view name) {
  if (std::optional<std::string> value = attribute(name)) return *value;
  fail("needs an attribute \"" + std::string(name) + "\"");
}

void SdfElement::finish() {
  finish_attributes();
  finish_children();
}

void SdfElement::finish_attributes() {
  for (const tinyxml2::XMLAttribute* a = xml_->FirstAttribute(); a; a = a->Next()) {
    const std::string_view name = a->Name();
    if (std::find(known_attributes_.begin(), known_attributes_.end(), a) != known_attributes_.end()) continue;
    if (name.starts_with("xmlns")) continue;
    if (name.starts_with(kOwnPrefix)) fail_attribute(name, "unknown attribute", a->Value());
    warn_attribute_ignored(name, kNotInSubset, a->Value());
  }
}

void SdfElement::finish_children() {
  for (tinyxml2::XMLNode* node = xml_->FirstChild(); node; node = node->NextSibling()) {
    if (const tinyxml2::XMLText* text = node->ToText(); text && !is_blank(*text)) {
      file_->warnings.push_back(where(tag()) + " has a text that is ignored: only tags belong here (" +
                                shown(trimmed(text->Value())) + ")");
    }
    tinyxml2::XMLElement* element = node->ToElement();
    if (!element || element->GetUserData()) continue;
    const SdfElement unknown(*element, *file_);
    if (unknown.tag().starts_with(kOwnPrefix))
      unknown.fail("unknown here", "inside <" + std::string(tag()) + ">");
    unknown.warn_ignored(kNotInSubset);
  }
}

std::string SdfElement::to_text() {
  std::string text;
  for (const tinyxml2::XMLNode* node = xml_->FirstChild(); node; node = node->NextSibling()) {
    if (const tinyxml2::XMLElement* element = node->ToElement())
      fail("must be a plain value, has a tag", element->Name());
    if (const tinyxml2::XMLText* part = node->ToText()) text += std::string(part->Value()) + " ";
  }
  finish_attributes();
  return std::string(trimmed(text));
}

double SdfElement::parse_number(std::string_view token) const {
  double value = 0.0;
  const char* last = token.data() + token.size();
  const std::from_chars_result end = std::from_chars(token.data(), last, value);
  if (end.ec == std::errc::result_out_of_range) fail("is beyond the range of a double", token);
  if (end.ec != std::errc() || end.ptr != last) fail("is not a number", token);
  if (!std::isfinite(value)) fail("must be finite", token);
  return value;
}

std::vector<double> SdfElement::to_numbers() {
  const std::string text = to_text();
  std::vector<double> numbers;
  for (const std::string_view token : split(text)) numbers.push_back(parse_number(token));
  return numbers;
}

std::vector<double> SdfElement::to_numbers(std::size_t count) {
  std::vector<double> numbers = to_numbers();
  if (numbers.size() == count) return numbers;
  fail("must be " + std::to_string(count) + (count == 1 ? " number, is " : " numbers, is ") +
           std::to_string(numbers.size()),
       to_text());
}

double SdfElement::to_number(Range range) {
  const double value = to_numbers(1)[0];
  if (range == Range::non_negative && value < 0.0) fail("must be >= 0", to_text());
  if (range == Range::positive && value <= 0.0) fail("must be > 0", to_text());
  if (range == Range::zero_to_one && (value < 0.0 || value > 1.0)) fail("must be in 0..1", to_text());
  return value;
}

Vec3 SdfElement::to_vector() {
  const std::vector<double> n = to_numbers(3);
  return Vec3(n[0], n[1], n[2]);
}

int SdfElement::to_integer(int least, int most) {
  const std::string text = to_text();
  int value = 0;
  const std::from_chars_result end = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool all_read = end.ec == std::errc() && end.ptr == text.data() + text.size();
  if (!all_read || value < least || value > most) {
    fail("must be an integer in " + std::to_string(least) + ".." + std::to_string(most), text);
  }
  return value;
}

bool SdfElement::to_flag() {
  const std::string text = to_text();
  if (text == "true" || text == "1") return true;
  if (text == "false" || text == "0") return false;
  fail("must be true or false", text);
}

std::optional<double> SdfElement::number(std::string_view tag, Range range) {
  std::optional<SdfElement> found = child(tag);
  if (!found) return std::nullopt;
  return found->to_number(range);
}

std::optional<Vec3> SdfElement::vector(std::string_view tag) {
  std::optional<SdfElement> found = child(tag);
  if (!found) return std::nullopt;
  return found->to_vector();
}

std::optional<bool> SdfElement::flag(std::string_view tag) {
  std::optional<SdfElement> found = child(tag);
  if (!found) return std::nullopt;
  return found->to_flag();
}

std::optional<std::string> SdfElement::text(std::string_view tag) {
  std::optional<SdfElement> found = child(tag);
  if (!found) return std::nullopt;
  return found->to_text();
}

bool SdfElement::has_same_content(const SdfElement& other) const {
  return is_same(*xml_, *other.xml_);
}

}  // namespace tumble
