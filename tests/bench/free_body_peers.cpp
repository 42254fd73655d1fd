// See free_body_peers.h. Damping, sleeping and collisions are off; all else is as the engines come.
#include "free_body_peers.h"

#include <btBulletDynamicsCommon.h>
#include <ode/ode.h>

#include <vector>

namespace tumble::bench {
namespace {

btVector3 to_bullet(const Vec3& v) {
  return {v.x(), v.y(), v.z()};
}
Vec3 from_bullet(const btVector3& v) {
  return {v.x(), v.y(), v.z()};
}

class BulletBodies final : public FreeBodies {
 public:
  BulletBodies(int count, const Vec3& I, const Vec3& w, const Vec3& v, const Vec3& gravity)
      : dispatcher_(&configuration_), world_(&dispatcher_, &broad_phase_, &solver_, &configuration_) {
    world_.setGravity(to_bullet(gravity));
    for (int i = 0; i < count; ++i) {
      btRigidBody::btRigidBodyConstructionInfo info(1.0, nullptr, &shape_, to_bullet(I));
      info.m_startWorldTransform.setIdentity();
      info.m_startWorldTransform.setOrigin(btVector3(10.0 * (i % 16), 10.0 * (i / 16), 0.0));
      auto body = std::make_unique<btRigidBody>(info);
      body->setFlags(BT_ENABLE_GYROSCOPIC_FORCE_IMPLICIT_BODY);
      body->setActivationState(DISABLE_DEACTIVATION);
      body->setLinearVelocity(to_bullet(v));
      body->setAngularVelocity(to_bullet(w));
      world_.addRigidBody(body.get());
      bodies_.push_back(std::move(body));
    }
  }
  ~BulletBodies() override {
    for (const auto& body : bodies_) world_.removeRigidBody(body.get());
  }
  void step(double h) override { world_.stepSimulation(h, 0); }
  Motion motion() const override {
    const btRigidBody& body = *bodies_.front();
    const btQuaternion q = body.getWorldTransform().getRotation();
    Motion motion;
    motion.x = from_bullet(body.getWorldTransform().getOrigin());
    motion.q = Quat(q.w(), q.x(), q.y(), q.z());
    motion.v = from_bullet(body.getLinearVelocity());
    motion.w = from_bullet(body.getAngularVelocity());
    return motion;
  }

 private:
  btSphereShape shape_{0.1};
  btDefaultCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_;
  btDbvtBroadphase broad_phase_;
  btSequentialImpulseConstraintSolver solver_;
  btDiscreteDynamicsWorld world_;
  std::vector<std::unique_ptr<btRigidBody>> bodies_;
};

class OdeBodies final : public FreeBodies {
 public:
  OdeBodies(int count, const Vec3& I, const Vec3& w, const Vec3& v, const Vec3& gravity) {
    dInitODE();
    world_ = dWorldCreate();
    dWorldSetGravity(world_, gravity.x(), gravity.y(), gravity.z());
    for (int i = 0; i < count; ++i) {
      const dBodyID body = dBodyCreate(world_);
      dMass mass;
      dMassSetParameters(&mass, 1.0, 0, 0, 0, I.x(), I.y(), I.z(), 0, 0, 0);
      dBodySetMass(body, &mass);
      dBodySetPosition(body, 10.0 * (i % 16), 10.0 * (i / 16), 0.0);
      dBodySetLinearVel(body, v.x(), v.y(), v.z());
      dBodySetAngularVel(body, w.x(), w.y(), w.z());
      if (i == 0) first_ = body;
    }
  }
  ~OdeBodies() override {
    dWorldDestroy(world_);
    dCloseODE();
  }
  void step(double h) override { dWorldQuickStep(world_, h); }
  Motion motion() const override {
    const auto vector = [](const dReal* p) { return Vec3(p[0], p[1], p[2]); };
    const dReal* q = dBodyGetQuaternion(first_);
    Motion motion;
    motion.x = vector(dBodyGetPosition(first_));
    motion.q = Quat(q[0], q[1], q[2], q[3]);
    motion.v = vector(dBodyGetLinearVel(first_));
    motion.w = vector(dBodyGetAngularVel(first_));
    return motion;
  }

 private:
  dWorldID world_ = nullptr;
  dBodyID first_ = nullptr;
};

}  // namespace

std::unique_ptr<FreeBodies> make_bullet(int count, const Vec3& I, const Vec3& w, const Vec3& v,
                                        const Vec3& gravity) {
  return std::make_unique<BulletBodies>(count, I, w, v, gravity);
}

std::unique_ptr<FreeBodies> make_ode(int count, const Vec3& I, const Vec3& w, const Vec3& v,
                                     const Vec3& gravity) {
  return std::make_unique<OdeBodies>(count, I, w, v, gravity);
}

}  // namespace tumble::bench
