// <physics> of SDF and our own options in it: one list of the options' names, for the reader and the writer.
#pragma once

#include "scene/sdf_element.h"
#include "world/options.h"

namespace tumble {

/// Sets what <physics> and its tumble: options say; the rest of `options` stays.
void read_physics(SdfElement& physics, Options& options);

/// Calls visit(name, field) for every plain option; in a file its tag is tumble:name. The fields are double, int, bool.
template <class OptionsType, class Visit>
void for_each_option(OptionsType& options, Visit&& visit) {
  visit("contact_margin", options.contact_margin);
  visit("fat_margin", options.fat_margin);
  visit("use_kept_manifold", options.narrow_phase.use_kept_manifold);
  visit("use_motion_bound", options.narrow_phase.use_motion_bound);
  visit("use_cached_axis", options.narrow_phase.use_cached_axis);
  visit("use_gjk", options.narrow_phase.use_gjk);
  visit("use_cached_facet", options.narrow_phase.use_cached_facet);
  visit("max_sweeps", options.solver_settings.max_sweeps);
  visit("tolerance", options.solver_settings.tolerance);
  visit("sub_steps", options.solver_settings.sub_steps);
  visit("longest_sub_step", options.solver_settings.longest_sub_step);
  visit("exact_work", options.solver_settings.exact_work);
  visit("exact_calm_factor", options.solver_settings.exact_calm_factor);
  visit("exact_calm_speed", options.solver_settings.exact_calm_speed);
  visit("keep_patterns", options.keep_patterns);
  visit("slop", options.bounds.slop);
  visit("sweep_slop", options.sweep_slop);
  visit("push_fraction", options.bounds.push_fraction);
  visit("push_speed", options.bounds.push_speed);
  visit("restitution_threshold", options.restitution_threshold);
  visit("max_impacts", options.max_impacts);
  visit("impact_events", options.impact_events);
  visit("slide_bodies", options.slide_bodies);
  visit("landing_bodies", options.landing_bodies);
  visit("max_cuts", options.max_cuts);
  visit("midpoint_bodies", options.midpoint_bodies);
  visit("midpoint_turn", options.midpoint_turn);
  visit("crowd_turning", options.crowd_turning);
  visit("taut_parts", options.taut_parts);
  visit("joint_passes", options.joint_passes);
  visit("work_rate", options.work_rate);
  visit("warm_start", options.warm_start);
  visit("rest_residual", options.rest.residual);
  visit("rest_speed", options.rest.speed);
  visit("rest_acceleration", options.rest.acceleration);
  visit("calm_speed", options.rest.calm_speed);
  visit("calm_time", options.rest.calm_time);
  visit("skip_resting", options.skip_resting);
  visit("skip_flying", options.skip_flying);
}

}  // namespace tumble
