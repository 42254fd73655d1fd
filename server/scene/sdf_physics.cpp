// See sdf_physics.h. Every option is checked as soon as it is set, so that the error names its own line.
#include "scene/sdf_physics.h"

#include <cmath>
#include <limits>

namespace tumble {
namespace {

void read_value(SdfElement& element, double& field) {
  field = element.to_number();
}
void read_value(SdfElement& element, bool& field) {
  field = element.to_flag();
}
void read_value(SdfElement& element, int& field) {
  field = element.to_integer(0, std::numeric_limits<int>::max());
}

void check(const SdfElement& element, const Options& options) {
  if (const std::string reason = check_options(options); !reason.empty()) element.fail(reason);
}

template <class Value>
void read_name(SdfElement& physics, const char* tag, std::optional<Value> (*from_name)(std::string_view),
               Value& field) {
  std::optional<SdfElement> element = physics.child(tag);
  if (!element) return;
  const std::optional<Value> value = from_name(element->to_text());
  if (!value) element->fail("unknown name", element->to_text());
  field = *value;
}

/// Pacing is the server's: it runs at real time or as fast as it can. A wish for anything else is not silently lost.
void read_pacing(SdfElement& physics, const Options& options) {
  if (std::optional<SdfElement> factor = physics.child("real_time_factor")) {
    if (factor->to_number(Range::non_negative) != 1.0) {
      factor->warn_ignored("the server's --rate or --fast decides (" + factor->to_text() + ")");
    }
  }
  if (std::optional<SdfElement> rate = physics.child("real_time_update_rate")) {
    if (std::abs(rate->to_number(Range::non_negative) * options.time_step - 1.0) > 1e-9) {
      rate->warn_ignored("the server's --rate or --fast decides (" + rate->to_text() + ")");
    }
  }
}

}  // namespace

void read_physics(SdfElement& physics, Options& options) {
  physics.attribute("name");
  physics.attribute("default");
  if (const std::string type = physics.attribute("type").value_or("tumble");
      type != "tumble" && type != "ignored") {
    physics.warn_attribute_ignored("type", "the engine is Tumble", type);
  }
  Accuracy accuracy = Accuracy::balanced;
  read_name(physics, "tumble:accuracy", accuracy_from_name, accuracy);
  if (accuracy != Accuracy::balanced) set_accuracy(options, accuracy);
  if (std::optional<SdfElement> step = physics.child("max_step_size")) {
    options.time_step = step->to_number(Range::positive);
    check(*step, options);
  }
  read_name(physics, "tumble:integrator", integrator_from_name, options.integrator);
  read_name(physics, "tumble:solver", solver_from_name, options.solver);
  for_each_option(options, [&](const char* name, auto& field) {
    std::optional<SdfElement> element = physics.child("tumble:" + std::string(name));
    if (!element) return;
    read_value(*element, field);
    check(*element, options);
  });
  read_pacing(physics, options);
  physics.finish();
}

}  // namespace tumble
