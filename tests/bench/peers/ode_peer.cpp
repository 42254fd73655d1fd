// ODE with its iterative solver (QuickStep) and with Dantzig's (dWorldStep). Friction cones are pyramids.
#include <ode/ode.h>

#include <algorithm>
#include <array>
#include <cstdarg>

#include "peers/peer.h"
#include "peers/solids.h"

namespace tumble::bench {
namespace {

/// Initialised once a process.
void start_library() {
  struct Library {
    Library() {
      dInitODE2(0);
      dSetMessageHandler(
          [](int, const char*, va_list) {});  // what Dantzig's cannot solve shows in the results
    }
    ~Library() { dCloseODE(); }
  };
  static const Library library;
}

class OdePeer final : public Peer {
 public:
  /// No iterations: Dantzig.
  OdePeer(const Scene& scene, double h, int iterations) : h_(h), quick_(iterations > 0) {
    start_library();
    world_ = dWorldCreate();
    space_ = dHashSpaceCreate(nullptr);
    joints_ = dJointGroupCreate(0);
    const Vec3& gravity = scene.options.gravity;
    dWorldSetGravity(world_, gravity.x(), gravity.y(), gravity.z());
    if (quick_) dWorldSetQuickStepNumIterations(world_, iterations);
    solids_ = solids_of(scene);
    for (Solid& solid : solids_) add(solid);
  }
  ~OdePeer() override {
    dJointGroupDestroy(joints_);
    dSpaceDestroy(space_);
    dWorldDestroy(world_);
  }
  void step() override {
    dSpaceCollide(space_, this,
                  [](void* peer, dGeomID a, dGeomID b) { static_cast<OdePeer*>(peer)->meet(a, b); });
    quick_ ? dWorldQuickStep(world_, h_) : dWorldStep(world_, h_);
    dJointGroupEmpty(joints_);
  }
  Motion motion(std::size_t i) const override {
    const auto vector = [](const dReal* p) { return Vec3(p[0], p[1], p[2]); };
    const dReal* q = dBodyGetQuaternion(bodies_[i]);
    Motion motion;
    motion.x = vector(dBodyGetPosition(bodies_[i]));
    motion.q = Quat(q[0], q[1], q[2], q[3]);
    motion.v = vector(dBodyGetLinearVel(bodies_[i]));
    motion.w = vector(dBodyGetAngularVel(bodies_[i]));
    return motion;
  }

 private:
  dGeomID make_geometry(const Solid& solid) const {
    if (const auto* sphere = std::get_if<Sphere>(&solid.shape)) return dCreateSphere(space_, sphere->radius);
    if (const auto* box = std::get_if<Box>(&solid.shape)) {
      const Vec3 size = 2.0 * box->half_extents;
      return dCreateBox(space_, size.x(), size.y(), size.z());
    }
    const Plane plane = plane_of(solid);
    return dCreatePlane(space_, plane.normal.x(), plane.normal.y(), plane.normal.z(), plane.height);
  }

  void add(Solid& solid) {
    const dGeomID geometry = make_geometry(solid);
    dGeomSetData(geometry, &solid.material);
    const Vec3& p = solid.X_WS.p;
    const dQuaternion q = {solid.X_WS.q.w(), solid.X_WS.q.x(), solid.X_WS.q.y(), solid.X_WS.q.z()};
    if (solid.dynamic) {
      const dBodyID body = dBodyCreate(world_);
      dMass mass;
      dMassSetParameters(&mass, solid.mass.mass, 0, 0, 0, solid.mass.I.x(), solid.mass.I.y(),
                         solid.mass.I.z(), 0, 0, 0);
      dBodySetMass(body, &mass);
      dGeomSetBody(geometry, body);
      dBodySetLinearVel(body, solid.v.x(), solid.v.y(), solid.v.z());
      dBodySetAngularVel(body, solid.w.x(), solid.w.y(), solid.w.z());
      bodies_.push_back(body);
    }
    if (!std::holds_alternative<HalfSpace>(solid.shape)) {
      dGeomSetPosition(geometry, p.x(), p.y(), p.z());
      dGeomSetQuaternion(geometry, q);
    }
  }

  void meet(dGeomID a, dGeomID b) {
    const dBodyID body_a = dGeomGetBody(a), body_b = dGeomGetBody(b);
    if (!body_a && !body_b) return;
    std::array<dContactGeom, 8> points;
    const int count = dCollide(a, b, static_cast<int>(points.size()), points.data(), sizeof(dContactGeom));
    const auto& material_a = *static_cast<const Material*>(dGeomGetData(a));
    const auto& material_b = *static_cast<const Material*>(dGeomGetData(b));
    dContact contact{};
    contact.surface.mode = dContactApprox1 | dContactBounce;
    contact.surface.mu = pair_friction(material_a.friction, material_b.friction);
    contact.surface.bounce = std::max(material_a.restitution, material_b.restitution);
    contact.surface.bounce_vel = 0.01;
    for (int i = 0; i < count; ++i) {
      contact.geom = points[static_cast<std::size_t>(i)];
      dJointAttach(dJointCreateContact(world_, joints_, &contact), body_a, body_b);
    }
  }

  double h_;
  bool quick_;
  dWorldID world_ = nullptr;
  dSpaceID space_ = nullptr;
  dJointGroupID joints_ = nullptr;
  std::vector<Solid> solids_;
  std::vector<dBodyID> bodies_;
};

Method ode_method(const char* name, int iterations, const char* settings, Scope scope,
                  std::size_t most_bodies = 1000000) {
  return {
      "ODE 0.16",
      name,
      settings,
      [iterations](const Scene& scene, double h) { return std::make_unique<OdePeer>(scene, h, iterations); },
      scope,
      most_bodies};
}

}  // namespace

std::vector<Method> ode_methods() {
  constexpr std::size_t kDense = 30;  // Dantzig's matrix is dense: cubic in the contacts
  return {ode_method("ode", 20, "QuickStep; friction pyramid in proportion to the normal force", Scope::any),
          ode_method("ode_200", 200, "the same with 200 iterations", Scope::contact),
          ode_method("ode_dantzig", 0, "dWorldStep; the same friction", Scope::contact, kDense)};
}

}  // namespace tumble::bench
