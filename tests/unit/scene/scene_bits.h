// A scene as a list of 64-bit words that holds every bit of it: two scenes are the same iff their lists are.
#pragma once

#include <bit>
#include <cstdint>
#include <string>
#include <vector>

#include "scene/scene.h"
#include "scene/sdf_physics.h"

namespace tumble {

class SceneBits {
 public:
  explicit SceneBits(const Scene& scene) {
    add(scene.name);
    add(scene.options);
    for (const BodyDefinition& body : scene.bodies) add(body);
    for (const SceneSpring& spring : scene.springs) {
      add_ends(spring);
      for (const double x : {spring.spring.rest_length, spring.spring.stiffness, spring.spring.damping})
        add(x);
    }
    for (const SceneRope& rope : scene.ropes) {
      add_ends(rope);
      add(rope.rope.length);
      add(rope.rope.restitution);
    }
    for (const SceneJoint& joint : scene.joints) {
      add_ends(joint);
      add(static_cast<std::uint64_t>(joint.kind));
    }
  }
  bool operator==(const SceneBits&) const = default;
  std::size_t size() const { return words_.size(); }

 private:
  void add(std::uint64_t word) { words_.push_back(word); }
  void add(double x) { add(std::bit_cast<std::uint64_t>(x)); }
  void add(const std::string& text) {
    add(std::uint64_t{text.size()});
    for (const char c : text) add(static_cast<std::uint64_t>(c));
  }
  template <class Derived>
  void add(const Eigen::MatrixBase<Derived>& m) {
    for (const double x : m.reshaped()) add(x);
  }
  void add(const Pose& X) {
    add(X.q.coeffs());
    add(X.p);
  }
  void add(const Options& options) {
    add(options.time_step);
    add(options.gravity);
    add(static_cast<std::uint64_t>(options.integrator));
    add(static_cast<std::uint64_t>(options.solver));
    for_each_option(options, [&](const char*, const auto& field) { add(static_cast<double>(field)); });
  }
  void add(const HalfSpace&) {}
  void add(const Sphere& sphere) { add(sphere.radius); }
  void add(const Box& box) { add(box.half_extents); }
  template <class Round>
  requires requires(const Round& round) { round.half_length; }
  void add(const Round& round) {
    add(round.radius);
    add(round.half_length);
  }
  void add(const Ellipsoid& ellipsoid) { add(ellipsoid.half_axes); }
  void add(const HullPointer& hull) {
    for (const Vec3& p : hull->vertices) add(p);
    for (const std::uint32_t i : hull->loops) add(std::uint64_t{i});
    for (const Polytope::Face& face : hull->faces) {
      add(face.normal);
      add(face.offset);
    }
    for (const Polytope::Edge& edge : hull->edges) {
      for (const std::uint32_t i : {edge.tail, edge.head, edge.left_face, edge.right_face})
        add(std::uint64_t{i});
    }
  }
  void add(const TriangleMeshPointer& mesh) {
    for (const Vec3& p : mesh->vertices()) add(p);
    for (const TriangleMesh::Corners& corners : mesh->triangles()) {
      for (const std::uint32_t i : corners) add(std::uint64_t{i});
    }
  }
  void add(const HeightFieldPointer& field) {
    add(std::uint64_t{field->columns()});
    add(std::uint64_t{field->rows()});
    add(field->dx());
    add(field->dy());
    for (const double height : field->heights()) add(height);
  }
  void add(const GeometryDefinition& geometry) {
    add(geometry.name);
    add(std::uint64_t{geometry.shape.index()});
    std::visit([&](const auto& shape) { add(shape); }, geometry.shape);
    add(geometry.X_LS);
    for (const double x :
         {geometry.material.friction, geometry.material.restitution, geometry.material.density})
      add(x);
    for (const float channel : geometry.color) add(std::uint64_t{std::bit_cast<std::uint32_t>(channel)});
  }
  void add(const BodyDefinition& body) {
    add(body.name);
    add(static_cast<std::uint64_t>(body.type));
    add(body.X_WL);
    add(body.v_WB);
    add(body.w_WB);
    for (const GeometryDefinition& geometry : body.geometries) add(geometry);
    add(std::uint64_t{body.inertia.has_value()});
    if (body.inertia) {
      add(body.inertia->mass);
      add(body.inertia->center);
      add(body.inertia->moments);
    }
    add(body.linear_damping);
    add(body.angular_damping);
    add(std::uint64_t{body.gravity});
  }
  template <class Connection>
  void add_ends(const Connection& connection) {
    add(connection.name);
    for (const SceneAnchor* end : {&connection.a, &connection.b}) {
      add(end->body);
      add(end->p);
    }
  }

  std::vector<std::uint64_t> words_;
};

}  // namespace tumble
