// Tumble itself, as the others are run.
#include "peers/peer.h"

namespace tumble::bench {
namespace {

class TumblePeer final : public Peer {
 public:
  explicit TumblePeer(const Scene& scene) : world_(build_world(scene)) {
    for (const BodyDefinition& body : scene.bodies) {
      if (body.type == BodyType::dynamic) slots_.push_back(world_.find(body.name)->index);
    }
  }
  void step() override { world_.step(); }
  Motion motion(std::size_t i) const override { return world_.motion(slots_[i]); }

 private:
  World world_;
  std::vector<std::uint32_t> slots_;
};

Method tumble_method(const std::string& name, const std::string& settings, Scope scope,
                     const std::function<void(Options&)>& change) {
  return {"Tumble", name, settings,
          [change](const Scene& scene, double h) {
            Scene changed = scene;
            changed.options.time_step = h;
            change(changed.options);
            return std::make_unique<TumblePeer>(changed);
          },
          scope};
}

}  // namespace

std::vector<Method> tumble_methods() {
  std::vector<Method> methods = {tumble_method("default", "as it comes", Scope::any, [](Options&) {})};
  for (const auto& [name, level] :
       {std::pair("fast", Accuracy::fast), std::pair(kExactLevel, Accuracy::exact)}) {
    methods.push_back(
        tumble_method(name, std::string("accuracy ") + (level == Accuracy::fast ? "fast" : "exact"),
                      Scope::contact, [level = level](Options& options) { set_accuracy(options, level); }));
  }
  for (int i = 0; i < static_cast<int>(Solver::automatic); ++i) {
    const auto solver = static_cast<Solver>(i);
    methods.push_back(tumble_method(std::string("solver_") + solver_name(solver),
                                    std::string("solver ") + solver_name(solver), Scope::contact,
                                    [solver](Options& options) { options.solver = solver; }));
  }
  for (int i = 0; i < static_cast<int>(Integrator::closed_form); ++i) {
    const auto integrator = static_cast<Integrator>(i);
    methods.push_back(tumble_method(std::string("integrator_") + integrator_name(integrator),
                                    std::string("integrator ") + integrator_name(integrator),
                                    integrator == Integrator::course ? Scope::any : Scope::flight,
                                    [integrator](Options& options) { options.integrator = integrator; }));
  }
  return methods;
}

}  // namespace tumble::bench
