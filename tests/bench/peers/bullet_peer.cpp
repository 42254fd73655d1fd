// Bullet with sequential impulses. Its contacts' threshold of bouncing, 0.2 m/s as it comes, is 1 cm/s here.
#include <btBulletDynamicsCommon.h>

#include <algorithm>
#include <cmath>

#include "peers/peer.h"
#include "peers/solids.h"

namespace tumble::bench {
namespace {

btVector3 to_bullet(const Vec3& v) {
  return {v.x(), v.y(), v.z()};
}
btTransform to_bullet(const Pose& X) {
  return btTransform(btQuaternion(X.q.x(), X.q.y(), X.q.z(), X.q.w()), to_bullet(X.p));
}
Vec3 from_bullet(const btVector3& v) {
  return {v.x(), v.y(), v.z()};
}

std::unique_ptr<btCollisionShape> make_shape(const Solid& solid) {
  if (const auto* box = std::get_if<Box>(&solid.shape)) {
    return std::make_unique<btBoxShape>(to_bullet(box->half_extents));
  }
  if (const auto* sphere = std::get_if<Sphere>(&solid.shape))
    return std::make_unique<btSphereShape>(sphere->radius);
  const Plane plane = plane_of(solid);
  return std::make_unique<btStaticPlaneShape>(to_bullet(plane.normal), plane.height);
}

/// Bullet multiplies both as it comes; these hooks are its own.
void set_pair_rules() {
  gCalculateCombinedFrictionCallback = [](const btCollisionObject* a, const btCollisionObject* b) {
    return pair_friction(a->getFriction(), b->getFriction());
  };
  gCalculateCombinedRestitutionCallback = [](const btCollisionObject* a, const btCollisionObject* b) {
    return std::max(a->getRestitution(), b->getRestitution());
  };
}

class BulletPeer final : public Peer {
 public:
  BulletPeer(const Scene& scene, double h, int iterations)
      : h_(h), dispatcher_(&configuration_), world_(&dispatcher_, &broad_phase_, &solver_, &configuration_) {
    set_pair_rules();
    world_.setGravity(to_bullet(scene.options.gravity));
    world_.getSolverInfo().m_numIterations = iterations;
    world_.getSolverInfo().m_restitutionVelocityThreshold = 0.01;
    for (const Solid& solid : solids_of(scene)) add(solid);
  }
  ~BulletPeer() override {
    for (const auto& body : bodies_) world_.removeRigidBody(body.get());
  }
  void step() override { world_.stepSimulation(h_, 0); }
  Motion motion(std::size_t i) const override {
    const btRigidBody& body = *bodies_[dynamic_[i]];
    const btQuaternion q = body.getWorldTransform().getRotation();
    Motion motion;
    motion.x = from_bullet(body.getWorldTransform().getOrigin());
    motion.q = Quat(q.w(), q.x(), q.y(), q.z());
    motion.v = from_bullet(body.getLinearVelocity());
    motion.w = from_bullet(body.getAngularVelocity());
    return motion;
  }

 private:
  void add(const Solid& solid) {
    shapes_.push_back(make_shape(solid));
    btRigidBody::btRigidBodyConstructionInfo info(solid.mass.mass, nullptr, shapes_.back().get(),
                                                  to_bullet(solid.mass.I));
    const bool placed = !std::holds_alternative<HalfSpace>(solid.shape);  // a plane's place is in its shape
    info.m_startWorldTransform = placed ? to_bullet(solid.X_WS) : btTransform::getIdentity();
    info.m_friction = solid.material.friction;
    info.m_restitution = solid.material.restitution;
    auto body = std::make_unique<btRigidBody>(info);
    if (solid.dynamic) {
      dynamic_.push_back(bodies_.size());
      body->setFlags(BT_ENABLE_GYROSCOPIC_FORCE_IMPLICIT_BODY);
      body->setActivationState(DISABLE_DEACTIVATION);
      body->setLinearVelocity(to_bullet(solid.v));
      body->setAngularVelocity(to_bullet(solid.w));
    }
    world_.addRigidBody(body.get());
    bodies_.push_back(std::move(body));
  }

  double h_;
  btDefaultCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_;
  btDbvtBroadphase broad_phase_;
  btSequentialImpulseConstraintSolver solver_;
  btDiscreteDynamicsWorld world_;
  std::vector<std::unique_ptr<btCollisionShape>> shapes_;
  std::vector<std::unique_ptr<btRigidBody>> bodies_;
  std::vector<std::size_t> dynamic_;
};

Method bullet_method(const char* name, int iterations, const char* settings, Scope scope) {
  const std::string version =
      std::to_string(btGetVersion() / 100) + "." + std::to_string(btGetVersion() % 100);
  return {"Bullet " + version, name, settings,
          [iterations](const Scene& scene, double h) {
            return std::make_unique<BulletPeer>(scene, h, iterations);
          },
          scope};
}

}  // namespace

std::vector<Method> bullet_methods() {
  return {bullet_method("bullet", 10, "bounces from 0.01 m/s", Scope::any),
          bullet_method("bullet_100", 100, "bounces from 0.01 m/s; 100 iterations", Scope::contact)};
}

}  // namespace tumble::bench
