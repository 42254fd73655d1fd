// Messages of a small world for the client's tests: spheres at given heights.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "tumble/catalog_t.hpp"
#include "tumble/state_t.hpp"

namespace tumble::client {

/// Bodies by id at z = height; generation 0, session 1, epoch 0.
inline state_t make_state(std::int64_t step, const std::map<std::int32_t, double>& heights) {
  state_t message{};
  message.utime = 1000 + step;
  message.session = 1;
  message.step = step;
  message.time = static_cast<double>(step) / 240.0;
  message.num_chunks = 1;
  message.num_bodies = message.n = static_cast<std::int32_t>(heights.size());
  for (const auto& [id, height] : heights) {
    message.id.push_back(id);
    message.pz.push_back(height);
  }
  message.generation.assign(heights.size(), 0);
  message.flags.assign(heights.size(), 0);
  message.qw.assign(heights.size(), 1.0);
  for (auto* zeros : {&message.px, &message.py, &message.qx, &message.qy, &message.qz, &message.vx,
                      &message.vy, &message.vz, &message.wx, &message.wy, &message.wz}) {
    zeros->assign(heights.size(), 0.0);
  }
  return message;
}

/// Spheres by id, over the whole range of ids; generation 0, session 1, epoch 0.
inline catalog_t make_catalog(const std::map<std::int32_t, std::string>& names) {
  catalog_t message{};
  message.utime = 1000;
  message.session = 1;
  message.num_bodies = message.n = message.num_shapes = static_cast<std::int32_t>(names.size());
  message.id_limit = message.end_id = names.empty() ? 0 : names.rbegin()->first + 1;
  for (const auto& [id, name] : names) {
    message.id.push_back(id);
    message.name.push_back(name);
    message.shape_body.push_back(id);
  }
  const std::size_t n = names.size();
  message.generation.assign(n, 0);
  message.type.assign(n, catalog_t::TYPE_DYNAMIC);
  message.body_shapes.assign(n, 1);
  message.mass.assign(n, 2.0);
  message.shape_number.assign(n, 0);
  message.shape_type.assign(n, catalog_t::SHAPE_SPHERE);
  message.shape_vertices.assign(n, 0);
  message.size_x.assign(n, 0.5);
  message.shape_qw.assign(n, 1.0);
  for (auto* zeros :
       {&message.ixx, &message.iyy, &message.izz, &message.ixy, &message.ixz, &message.iyz, &message.cx,
        &message.cy, &message.cz, &message.size_y, &message.size_z, &message.shape_px, &message.shape_py,
        &message.shape_pz, &message.shape_qx, &message.shape_qy, &message.shape_qz}) {
    zeros->assign(n, 0.0);
  }
  for (auto* looks : {&message.friction, &message.restitution, &message.red, &message.green, &message.blue,
                      &message.alpha}) {
    looks->assign(n, 0.5f);
  }
  return message;
}

}  // namespace tumble::client
