// MuJoCo by its C API; the scene becomes a model text. Its contacts are springs with dampers: restitution is said by
// their damping, a collision taking about 6 time steps.
#include <fmt/format.h>
#include <mujoco/mujoco.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "peers/peer.h"
#include "peers/solids.h"

namespace tumble::bench {
namespace {

struct Settings {
  const char* integrator;
  const char* cone;
  bool stiff;  ///< Contacts as stiff as MuJoCo allows at this step, and solved to the end.
};

std::string vector_text(const Vec3& v) {
  return fmt::format("{:.17g} {:.17g} {:.17g}", v.x(), v.y(), v.z());
}
std::string pose_text(const Pose& X) {
  return fmt::format(R"(pos="{}" quat="{:.17g} {:.17g} {:.17g} {:.17g}")", vector_text(X.p), X.q.w(), X.q.x(),
                     X.q.y(), X.q.z());
}

/// A pair takes the larger of two frictions: the body's is the pair's with the ground, the ground has none.
/// Exact for scenes with one ground friction whose bodies are all like it, or do not meet.
double ground_friction(const std::vector<Solid>& solids) {
  double mu = -1.0;
  for (const Solid& solid : solids) {
    if (solid.dynamic) continue;
    if (mu >= 0.0 && mu != solid.material.friction)
      throw std::invalid_argument("fixed bodies differ in friction");
    mu = solid.material.friction;
  }
  return std::max(mu, 0.0);
}

/// Of a spring and damper that give the ball back the share e of its speed.
std::string bounce_text(double e, double h) {
  const double rate = 1.0 / (2.0 * h), log_e = std::log(e);
  const double damping = -log_e / std::sqrt(std::numbers::pi * std::numbers::pi + log_e * log_e);
  return fmt::format(R"( solref="{:.17g} {:.17g}")", -rate * rate, -2.0 * damping * rate);
}

std::string geometry_text(const Solid& solid, double ground_mu, double h, const Settings& settings) {
  std::string text = "<geom ";
  if (const auto* box = std::get_if<Box>(&solid.shape)) {
    text += fmt::format(R"(type="box" size="{}")", vector_text(box->half_extents));
  } else if (const auto* sphere = std::get_if<Sphere>(&solid.shape)) {
    text += fmt::format(R"(type="sphere" size="{:.17g}")", sphere->radius);
  } else {
    text += R"(type="plane" size="0 0 1")";
  }
  const double mu = solid.dynamic ? pair_friction(solid.material.friction, ground_mu) : 0.0;
  text += fmt::format(R"( condim="{}" friction="{:.17g} 0 0")", mu > 0.0 ? 3 : 1, mu);
  if (solid.dynamic && solid.material.restitution > 0.0) {
    text += bounce_text(solid.material.restitution, h);
  } else if (settings.stiff) {
    text += fmt::format(R"( solref="{:.17g} 1" solimp="0.99 0.9999 0.001")", 2.0 * h);
  }
  if (!solid.dynamic) text.append(" ").append(pose_text(solid.X_WS));
  return text.append("/>");
}

std::string model_text(const Scene& scene, const std::vector<Solid>& solids, double h,
                       const Settings& settings) {
  std::string text = fmt::format(
      R"(<mujoco><size memory="200M"/><option timestep="{:.17g}" gravity="{}" integrator="{}" cone="{}"{}/><worldbody>)",
      h, vector_text(scene.options.gravity), settings.integrator, settings.cone,
      settings.stiff ? R"( iterations="200" tolerance="1e-12" impratio="10")" : "");
  const double mu = ground_friction(solids);
  for (const Solid& solid : solids) {
    const std::string geometry = geometry_text(solid, mu, h, settings);
    text += !solid.dynamic
                ? geometry
                : fmt::format(R"(<body {}><freejoint/><inertial pos="0 0 0" mass="{:.17g}" )"
                              R"(diaginertia="{}"/>{}</body>)",
                              pose_text(solid.X_WS), solid.mass.mass, vector_text(solid.mass.I), geometry);
  }
  return text.append("</worldbody></mujoco>");
}

class MujocoPeer final : public Peer {
 public:
  MujocoPeer(const Scene& scene, double h, const Settings& settings) {
    mju_user_warning = [](const char*) {};  // bad states show in the results
    const std::vector<Solid> solids = solids_of(scene);
    char error[1000] = "";
    const std::unique_ptr<mjSpec, void (*)(mjSpec*)> spec(
        mj_parseXMLString(model_text(scene, solids, h, settings).c_str(), nullptr, error, sizeof error),
        mj_deleteSpec);
    if (!spec) throw std::invalid_argument(error);
    model_.reset(mj_compile(spec.get(), nullptr));
    if (!model_) throw std::invalid_argument(mjs_getError(spec.get()));
    model_->opt.disableflags |= mjDSBL_AUTORESET;
    data_.reset(mj_makeData(model_.get()));
    const std::vector<Solid> dynamic = dynamic_of(solids);
    for (std::size_t i = 0; i < dynamic.size(); ++i) {
      const Vec3 w_B = dynamic[i].X_WS.q.conjugate() * dynamic[i].w;
      std::copy_n(dynamic[i].v.data(), 3, data_->qvel + 6 * i);
      std::copy_n(w_B.data(), 3, data_->qvel + 6 * i + 3);
    }
  }
  void step() override { mj_step(model_.get(), data_.get()); }
  Motion motion(std::size_t i) const override {
    const mjtNum *q = data_->qpos + 7 * i, *v = data_->qvel + 6 * i;
    Motion motion;
    motion.x = Vec3(q[0], q[1], q[2]);
    motion.q = Quat(q[3], q[4], q[5], q[6]);
    motion.v = Vec3(v[0], v[1], v[2]);
    motion.w = motion.q * Vec3(v[3], v[4], v[5]);
    return motion;
  }

 private:
  std::unique_ptr<mjModel, void (*)(mjModel*)> model_{nullptr, mj_deleteModel};
  std::unique_ptr<mjData, void (*)(mjData*)> data_{nullptr, mj_deleteData};
};

Method mujoco_method(const char* name, const Settings& settings, const char* text) {
  return {std::string("MuJoCo ") + mj_versionString(), name, text, [settings](const Scene& scene, double h) {
            return std::make_unique<MujocoPeer>(scene, h, settings);
          }};
}

}  // namespace

std::vector<Method> mujoco_methods() {
  return {mujoco_method("mujoco", {"Euler", "pyramidal", false}, "as it comes"),
          mujoco_method(kMujocoRungeKutta, {"RK4", "elliptic", false}, "Runge-Kutta 4, elliptic cone"),
          mujoco_method(
              "mujoco_stiff", {"implicitfast", "elliptic", true},
              "implicitfast, elliptic cone, solref 2 steps, solimp to 0.9999, impratio 10, 200 iterations")};
}

}  // namespace tumble::bench
