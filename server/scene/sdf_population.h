// <population> of SDF: many copies of a model, arranged in a grid, a row, evenly or at random in a region.
#pragma once

#include <string>
#include <vector>

#include "scene/sdf_model.h"

namespace tumble {

/// Places the copies NAME_0, NAME_1, ... of the model NAME. The same seed, population name and content give the same
/// bits; other populations have no influence.
std::vector<PlacedModel> read_population(SdfElement& population, const FrameLookup& find_frame,
                                         std::uint64_t seed);

}  // namespace tumble
