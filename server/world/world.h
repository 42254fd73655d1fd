// The world: creates and destroys bodies, steps them, answers for them. A regular value: copying it copies model,
// state and scratch, so a copy is a snapshot that continues with the same bits. No clock, thread or socket in here.
#pragma once

#include <algorithm>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "collision/broad_phase.h"
#include "dynamics/flight.h"
#include "world/clear_pairs.h"
#include "world/contact_graph.h"
#include "world/definition.h"
#include "world/diagnostics.h"
#include "world/options.h"
#include "world/part.h"
#include "world/scratch.h"

namespace tumble {

/// A geometry as it hangs on a body: pose in the body frame B, not the link's.
struct Geometry {
  std::uint32_t body = 0;
  Shape shape;
  Pose X_BS;
  Material material;
  double radius = 0.0;          ///< Of a ball about S's origin that holds the shape [m].
  double reach = 0.0;           ///< Of a ball about the centre of mass that holds it [m].
  double fat_margin = 0.0;      ///< Slack of its broad-phase box [m].
  double contact_margin = 0.0;  ///< Gap at which its contacts start [m].
};

/// What a body is: constant after creation, read rarely.
struct Body {
  bool exists = false;
  std::uint32_t generation = 0;
  BodyType type = BodyType::fixed;
  Vec3 p_LB = Vec3::Zero();  ///< Centre of mass in the link frame.
  double linear_damping = 0.0, angular_damping = 0.0;
  bool gravity = true;
  std::vector<std::uint32_t> geometries;
  BodyDefinition definition;  ///< As created: names, colours, link-frame poses.
};

class World {
 public:
  explicit World(const Options& options = {});  ///< Throws std::invalid_argument for options out of range.

  // Creation: all throw std::invalid_argument("field: reason (value)") and then have changed nothing.
  BodyId create_body(const BodyDefinition& definition);
  /// Also removes its springs, ropes, joints and pushes, and wakes what it touched. False: no such body (stale id).
  bool destroy_body(BodyId id);
  void create_spring(const SpringDefinition& definition);
  void create_rope(const RopeDefinition& definition);
  void create_joint(const JointDefinition& definition);

  // Commands between steps.
  /// Starts a push at the next step. Throws for non-finite or out-of-range values, stale ids, fixed bodies.
  void push(const Push& push);
  /// Teleports: pose of the link frame, velocities of the centre of mass.
  void set_motion(BodyId id, const Pose& X_WL, const Vec3& v_WB, const Vec3& w_WB);
  void wake(BodyId id);
  /// Of all steps from here on [s]; throws where Options would. Pushes keep their time, contacts their forces.
  void set_time_step(double time_step);

  void step();
  /// The same, and calls `stage_done(stage)` at the end of every stage.
  void step(const std::function<void(Stage)>& stage_done);

  // Reading. Bodies are addressed by slot (0 .. body_capacity()) where all are visited.
  std::uint64_t step_count() const { return step_count_; }
  double time() const {
    return time_before_ + static_cast<double>(step_count_ - steps_before_) * options_.time_step;
  }
  const Options& options() const { return options_; }
  std::uint32_t body_capacity() const { return static_cast<std::uint32_t>(bodies_.size()); }
  std::uint32_t body_count() const { return body_count_; }
  const Body& body(std::uint32_t slot) const { return bodies_[slot]; }
  /// Of a body aloft it is evaluated here: reading costs, not reading costs nothing, and the state is the same.
  Motion motion(std::uint32_t slot) const;
  const MassProperties& mass_properties(std::uint32_t slot) const { return masses_[slot]; }
  /// A dynamic body that is not stepped until something near it changes.
  bool resting(std::uint32_t slot) const { return movable(slot) && !awake(slot); }
  BodyId id(std::uint32_t slot) const { return {slot, bodies_[slot].generation}; }
  bool is_valid(BodyId id) const;
  std::optional<BodyId> find(std::string_view name) const;
  /// Pose of the link frame.
  Pose link_pose(std::uint32_t slot) const;
  const ContactGraph& contacts() const { return contacts_; }
  const std::vector<Geometry>& geometries() const { return geometries_; }
  Pose geometry_pose(const Geometry& geometry) const;
  /// For queries: between steps every box holds its geometry where it is, and is going in the next step.
  const BroadPhase& broad_phase() const { return broad_phase_; }
  /// Rises whenever a body is created or destroyed: the catalogue's epoch.
  std::uint64_t model_epoch() const { return model_epoch_; }

  const Counters& counters() const { return counters_; }
  const StepReport& report() const { return report_; }
  Conserved compute_conserved() const;
  /// Over every body's id, pose, velocity and rest flag, and the step count.
  std::uint64_t state_hash() const;
  /// The same, and hands the motion of every body to `visit` on the way, so that a flight is evaluated once for both.
  std::uint64_t state_hash(const std::function<void(std::uint32_t slot, const Motion& motion)>& visit) const;
  /// Bodies that were held at their last good state because a step made them non-finite, in order of occurrence.
  const std::vector<BodyId>& contained() const { return contained_; }

 private:
  template <typename>
  friend struct Archived;  // its list of members, archive.cpp
  static constexpr std::uint32_t kWorld = 0xffffffffu;
  /// [m] at the start of a part of a step: what is nearer touches.
  static constexpr double kOpen = 1e-6;
  /// [m/s] to which parts are solved: what is wrong with forces would be accepted by every step that follows.
  static constexpr double kSharp = 1e-12;
  /// [m/s] rounding of velocities that something holds where a step or a part of it ends.
  static constexpr double kHeld = 1e-12;

  struct ActivePush {
    Push push;
    double steps_left;  // whole ones and a last fraction
  };
  enum class FlightState : std::uint8_t {
    none,    ///< Something acts on it: motions_ is its state.
    flying,  ///< Its flight is its state; motions_ holds the value of now.
    aloft,   ///< Its flight is its state; nobody evaluates it.
  };
  /// The flight of a body on which only constant forces act; see flight_step.cpp. Steps count from the world's start.
  struct FreeBody {
    Flight flight;
    std::uint64_t takeoff = 0;  ///< Where the flight's time starts,
    std::uint64_t last = 0;     ///< and where it starts anew, before its phases lose digits.
    std::uint64_t due = 0;      ///< It does not try to reach ahead again before this step.
    std::uint64_t boxed =
        0;  ///< Until this step its boxes hold its way; aloft: it has to reach ahead again then.
    std::uint64_t reach = 0;  ///< How far it tries to reach ahead next [steps].
  };
  struct Due {
    std::uint64_t step;
    std::uint32_t slot;
    auto operator<=>(const Due&) const = default;
  };
  /// A spring, rope or joint between two anchors in body frames; slot kWorld: p in W.
  struct Tie {
    std::uint32_t a, b;
    Vec3 pA, pB;
    std::variant<Spring, Rope, Joint> law;
    std::array<double, Joint::kMostRows> lambda{};  // of its rows: warm start [N s]
  };
  /// What takes part in one impact: bodies that act on each other through contacts and ties, and the pairs that strike.
  struct Blow {
    std::vector<std::uint32_t> members;  // movable slots, ascending
    std::vector<GeometryPair> struck;    // sorted
    std::vector<std::uint32_t> inner;    // contacts among members or with immovable bodies
    bool tired = false;                  // a member has reached its bound of impacts
    bool has(std::uint32_t slot) const { return std::binary_search(members.begin(), members.end(), slot); }
    bool strikes(GeometryPair pair) const { return std::binary_search(struck.begin(), struck.end(), pair); }
  };

  // world.cpp: slots and links.
  std::uint32_t take_slot();
  std::uint32_t add_geometry(std::uint32_t slot, const GeometryDefinition& definition);
  void resolve_anchor(const Anchor& anchor, std::uint32_t& slot, Vec3& p) const;
  /// Refuses ends that no law can join, and changes nothing.
  Tie make_tie(const std::string& name, const Anchor& a, const Anchor& b) const;
  void add_tie(const Tie& tie);
  Joint make_joint(JointKind kind, const Tie& tie) const;
  void check_live(BodyId id, const char* field) const;
  bool movable(std::uint32_t slot) const { return bodies_[slot].type == BodyType::dynamic; }
  bool awake(std::uint32_t slot) const { return awake_flag_[slot] != 0; }
  void wake_slot(std::uint32_t slot);

  // step.cpp: the stages, in order.
  void save_work();
  void apply_pushes(const StepContext& step);
  /// Takes the load off bodies that it would make non-finite, so that they don't take others with them.
  void contain_overloaded(const StepContext& step);
  void update_pairs(const StepContext& step);
  /// Pairs that their ways keep apart are no contacts, until their time has come or a body leaves its way.
  void leave_clear_pairs(const StepContext& step);
  void recall_clear_pairs();
  /// Replaces the pairs with a surface by pairs with those of its triangles that meet the other's fat box.
  void split_surface_pairs();
  /// The boxes came apart, or this triangle is none of those that the other's new fat box meets.
  bool is_lost(GeometryPair pair) const;
  /// Pairs of geometries with a new box, sorted.
  void find_pairs();
  void update_contacts(const StepContext& step);
  double update_contact(std::uint32_t index, const StepContext& step);
  void refresh_active();
  void build_islands(const StepContext& step);
  void advance_islands(const StepContext& step);
  void update_boxes(const StepContext& step);
  void update_report();
  /// Held together by a joint: they do not collide.
  bool jointed(std::uint32_t a, std::uint32_t b) const;
  void find_jointed();
  /// Awake, or a kinematic body on the move: its contacts are looked at.
  bool takes_part(std::uint32_t slot) const;

  /// Puts the geometry, or puts it back, into the broad phase at its present place.
  void add_box(std::uint32_t index);
  void renew_boxes(std::uint32_t slot);
  /// Where the geometry, or a contact of it, can be while the body turns through a step of h.
  Aabb contact_bounds(const Geometry& geometry, double h) const;
  Contact make_contact(GeometryPair pair) const;
  double pair_margin(Contact& contact, const StepContext& step, std::uint64_t now) const;
  /// On a way that is known until something happens to it: in undamped flight, resting, or fixed.
  bool keeps_its_way(std::uint32_t slot) const;
  Vec3 acceleration_on_way(std::uint32_t slot) const;
  /// If the ways of the two keep them farther apart than `margin` [m] for some steps from `now` on: notes until when.
  bool leave_if_clear(const Contact& contact, double margin, std::uint64_t now);

  // flight_step.cpp: free bodies.
  bool aloft(std::uint32_t slot) const { return flight_state_[slot] == FlightState::aloft; }
  Motion motion_in_flight(std::uint32_t slot, std::uint64_t step) const;
  /// At step `now`, which is that of motions_: the end of the step while boxes are updated, else its start.
  Motion motion_at(std::uint32_t slot, std::uint64_t now) const {
    return aloft(slot) ? motion_in_flight(slot, now) : motions_[slot];
  }
  void advance_free(std::uint32_t slot, const StepContext& step);
  void follow_flight(std::uint32_t slot);
  void integrate_free(std::uint32_t slot, const StepContext& step);
  void take_off(std::uint32_t slot);
  /// Its trajectory from where the step is now, instead of the motion itself.
  void note_way(std::uint32_t slot, const StepContext& step);
  /// The same, of a body that was moved already, from `start`.
  void note_end(std::uint32_t slot, const Motion& start, const StepContext& step);
  using AdvanceIsland = void (World::*)(std::size_t island, const StepContext& step);
  /// Advances the island as in a step without impacts, and draws the way there between.
  void draw_way(std::size_t island, const StepContext& step, AdvanceIsland advance);
  /// At the end of a step: lets go of a body that meets nobody for some steps. False: it has to be visited.
  bool try_lift(std::uint32_t slot, const StepContext& step);
  bool lift(std::uint32_t slot, std::uint64_t now, const StepContext& step);
  /// Gives its geometries boxes that hold its way, if it is clear of all that these meet; of how many, or none.
  std::optional<std::size_t> reach_ahead(std::uint32_t slot, std::uint64_t now, std::uint64_t until,
                                         const StepContext& step);
  void renew_flights(const StepContext& step);
  /// Aloft no more, but on its flight as before.
  void descend(std::uint32_t slot, std::uint64_t now);
  /// Off its flight: something acts on it, or moves it elsewhere.
  void land(std::uint32_t slot);

  // smooth_step.cpp: smooth forces and nothing else. False: left to the steps of island_step.cpp, and nothing is moved.
  bool advance_smooth_body(std::uint32_t slot, const StepContext& step);
  bool advance_springs(std::size_t island, const StepContext& step);
  bool has_springs_only(std::size_t island) const;
  SmoothBody smooth_body(std::uint32_t slot) const;
  bool store_smooth_motion(const StepContext& step);

  // island_step.cpp: one island through one step.
  void advance_connected(std::size_t island, const StepContext& step);
  void bounce(ContactProblem& problem);
  void build_problem(std::size_t island, const StepContext& step);
  void begin_problem(double h);
  void end_problem();
  void solve_problem(const StepContext& step);
  bool solve_velocities(const StepContext& step);
  /// Solves the problem to the tolerance [m/s] or the step's own, whichever is less, with what is left of the work rate.
  SolverReport solve(const StepContext& step, double tolerance = kInfinity);
  void count_solution(const SolverReport& report);
  /// What overlaps at the start of the step, after its velocities are solved.
  void shift_apart(const StepContext& step);
  std::uint32_t problem_body(std::uint32_t slot, double h);
  void add_contact_rows(std::uint32_t contact_index, double h);
  void add_turning(const PointContact& row, const Contact& contact, const Vec3& moment);
  void add_tie_rows(std::uint32_t tie_index, const StepContext& step);
  void add_row(ScalarRow row, std::uint32_t tie_index, std::uint32_t index);
  void store_impulses();
  bool try_rest(double residual);
  void move_bodies(const StepContext& step);
  VelocityPath velocity_path(std::uint32_t problem_body, double share) const;
  /// Share of the mean velocity with which the bodies of the problem may drift, 0..1.
  double gainless_share(const StepContext& step) const;
  double turning_gain(double share, const StepContext& step) const;
  /// Adds what the shifts that take overlaps back give to `push_work`.
  void count_shifts();
  /// [J] of one that meets the body at q_WB with L about its centre of mass.
  double work_of_shift(std::uint32_t slot, const Quat& q, const Vec3& L, const Vec3& shift,
                       const Vec3& turn) const;
  /// Of forces that are the same at every orientation, and of gravity.
  Vec3 acceleration_of(std::uint32_t slot) const;
  /// Moves the body along the path, or notes that it will be.
  void move_body(std::uint32_t slot, const VelocityPath& path, const Vec3& shift, const Vec3& turn,
                 const StepContext& step);
  void velocities_after_forces(std::uint32_t slot, double h, Vec3& v, Vec3& L) const;
  static bool is_finite(const Motion& motion);
  void contain(std::uint32_t slot, const Motion& last_good);
  void hold(std::uint32_t slot, const Motion& at);

  // part_step.cpp: what steps in parts share.
  /// Of the island: no ties, no turning friction, no driven partner, at most so many movable bodies.
  bool may_be_cut(const StepContext& step, int most_bodies) const;
  double acceleration_at(const PointContact& contact) const;
  /// At the start of a part: apart, by more than forces and turning close within a step, or on the way to meet.
  bool is_open(const PointContact& contact, const StepContext& part) const;
  void leave_out_open_contacts(const StepContext& part);
  /// The island's problem where it is now, with impulses of so long a part to start from.
  void build_part(std::size_t island, const StepContext& part);
  /// Builds it and solves it sharply.
  void solve_part(std::size_t island, const StepContext& part);
  /// Moves the solved island smoothly through the rest of the step, or up to where a slide ends or it has turned far, and
  /// solves for what is then left.
  Advance advance_until_cut(std::size_t island, StepContext& rest, bool may_cut);
  void update_island_contacts(std::size_t island, const StepContext& part);
  /// That touch, and those with other triangles of the same surfaces, which points may go over to within the step.
  const std::vector<std::uint32_t>& contacts_of_island(std::size_t island);
  void add_other_triangles(std::uint32_t index, std::size_t touching);
  void note_island(std::size_t island, IslandState& state);
  void restore_island(std::size_t island, const IslandState& state);
  std::vector<Touch> note_touches(const StepContext& part) const;
  /// By its name, under which another triangle of a surface takes a point over. Null: not there.
  const Touch* find_touch(const std::vector<Touch>& touches, ContactSource source) const;
  /// The island as it is now, without forces, as a blow or a correction of velocities meets it.
  void build_instant_problem(std::size_t island, const StepContext& part);
  /// Takes from the velocities what the points that are pressed would approach, part or, where they stick, slide with:
  /// rounding, and what their arms turned since they were solved.
  void hold_touches(std::size_t island, const std::vector<Touch>& touches, const StepContext& part);
  // joint_step.cpp: joints by their arms in the middle of the step.
  bool may_refine_joints() const { return options_.joint_passes > 1 && solves_exactly(options_.solver); }
  /// And the problem has some.
  bool refines_joints() const;
  bool update_joint_arms(const StepContext& step, std::vector<SolverBody>& free);
  double turn_inertia(std::uint32_t problem_body, double h, SolverBody& free);
  void hold_joints(std::size_t island, const StepContext& part);
  void project_joints(std::size_t island, const StepContext& part);
  void build_joint_problem(std::size_t island, const StepContext& part);
  bool close_joints(const StepContext& part);

  // taut_step.cpp: islands whose joints pull hard, in parts of the step.
  double swing_phase();
  /// The solved island would swing too far in one step.
  bool is_taut();
  void advance_taut(std::size_t island, const StepContext& step);
  void solve_taut_part(std::size_t island, const StepContext& part);
  void note_opening();

  // slide_step.cpp: slides that end within the step.
  bool may_end_slides(const StepContext& step) const;
  std::optional<double> find_end_of_slide(std::size_t island, const StepContext& rest,
                                          const std::vector<std::size_t>& ending, double guess);
  /// If a contact of the solved island stops sliding within the rest of the step: moves the island there and solves for
  /// what is then left of the step, which is the rest from now on. False: solved as before.
  bool advance_slide(std::size_t island, StepContext& rest);

  // landing_step.cpp: contacts that close within the step, without restitution.
  /// If one does: moves the island there, stops it, and solves for what is then left of the step. False: as before.
  bool advance_landing(std::size_t island, StepContext& rest);
  double find_landing(const ContactProblem& start, const StepContext& rest, double& speed) const;
  double landing_gap(std::size_t island, const std::vector<Touch>& held);
  void land_island(std::size_t island, const StepContext& part);

  // midpoint_step.cpp: smooth motion in contact, of second order.
  /// Moves the solved island through the rest of the step, or where it may be cut through a part of it, and solves for
  /// what is then left. None: it does not suit, and nothing has changed.
  Advance advance_midpoint(std::size_t island, StepContext& rest, bool may_cut);
  bool may_step_by_midpoint(const StepContext& part) const;
  bool suits_midpoint(const StepContext& part, const std::vector<Touch>& touches) const;
  bool may_turn(const Touch& touch, const StepContext& part) const;
  double fastest_turning() const;
  double length_of_part(const StepContext& rest, double turning) const;
  bool try_midpoint(std::size_t island, const StepContext& part, Midpoint& way);
  bool shorten_to_end_of_slide(std::size_t island, StepContext& part, Midpoint& way);
  void finish_midpoint(std::size_t island, const StepContext& part, const Midpoint& way);
  void place_in_middle(const Midpoint& way, const StepContext& part);
  void build_mean_problem(std::size_t island, const StepContext& part, const std::vector<Touch>& touches);
  bool has_turned(const std::vector<Touch>& touches) const;
  bool solve_mean_problem(const StepContext& part, Midpoint& way);
  double update_ends(const StepContext& part, const std::vector<Motion>& start,
                     const std::vector<SolverBody>& free, std::vector<Motion>& ends,
                     std::vector<Vec3>& balance) const;
  Vec3 velocity_at_end(std::size_t row, const Midpoint& way, Vec3& n) const;
  double correct_bounds(const StepContext& part, const Midpoint& way);
  bool slides(const StepContext& part, const PointContact& contact) const;
  bool is_smooth(const StepContext& part, Midpoint& way) const;
  double slowest_slide(const StepContext& part, const PointContact& contact) const;

  // impact_step.cpp: the impacts of one step, in order of time.
  /// Whether the pair is left out of the smooth problem: it may strike, or is on its way apart.
  bool flies(const Contact& contact, double h) const;
  /// Of b relative to a, by forces [m/s^2].
  Vec3 relative_acceleration(const Contact& contact) const;
  void begin_impacts();
  /// A body of it has a contact that may strike in this step, or was struck.
  bool meets_flying(std::size_t island) const;
  void hold_struck_joints(const StepContext& step);
  /// Made when it is asked for, if the body has not been given one in this step.
  const Trajectory& way(std::uint32_t slot);
  void advance_impacts(const StepContext& step);
  void strike(const ImpactEvent& event, const StepContext& step);
  Blow gather_blow(const ImpactEvent& event);
  void join(Blow& blow, std::uint32_t a, std::uint32_t b);
  void absorb_tired(Blow& blow);
  void move_to(const Blow& blow, double time);
  void update_contacts_of(Blow& blow, const StepContext& rest);
  void resolve_blow(const Blow& blow, const StepContext& rest);
  void build_blow_problem(const Blow& blow);
  std::vector<std::uint32_t> ties_of(const Blow& blow) const;
  void add_held_rows(std::uint32_t tie_index);
  void store_blow();
  /// Bounces of the pair that are still to come end within the rest of the step.
  bool ends_bouncing(std::uint32_t contact_index, const StepContext& rest) const;
  void continue_from(const Blow& blow, const StepContext& rest);
  void foresee(const Blow& blow, const StepContext& rest);
  void foresee(const Contact& contact, const StepContext& rest);
  void renew_boxes_within(const Blow& blow, const StepContext& rest);
  void follow_those_aloft();
  /// The body goes on through the step on the flight that it has.
  void set_flight_trajectory(std::uint32_t slot);
  void index_contacts();
  void index_contacts_from(std::uint32_t first);

  Options options_;
  std::uint64_t step_count_ = 0;
  double time_before_ = 0.0;        // [s] until the step got its present length,
  std::uint64_t steps_before_ = 0;  // and the steps until then
  std::uint64_t model_epoch_ = 0;
  std::uint32_t body_count_ = 0, dynamic_count_ = 0;

  // Model.
  std::vector<Body> bodies_;
  std::vector<MassProperties> masses_;
  std::vector<Geometry> geometries_;
  std::vector<std::uint32_t> free_bodies_, free_geometries_;
  std::map<std::string, std::uint32_t, std::less<>> names_;

  // State, by slot: hot arrays.
  std::vector<Motion> motions_;  // out of date where aloft
  std::vector<FlightState> flight_state_;
  std::vector<FreeBody> free_;      // where in flight
  std::vector<std::uint32_t> way_;  // number of its flight or rest
  std::vector<std::uint8_t> awake_flag_;
  std::vector<std::uint8_t> pushed_;      // has an active push: must not rest
  std::vector<std::uint8_t> paired_;      // some contact, open or closed, has it
  std::vector<double> calm_for_;          // [s]
  std::vector<std::uint32_t> rest_next_;  // ring of the bodies that came to rest together

  BroadPhase broad_phase_;
  ContactGraph contacts_;
  ClearPairs clear_pairs_;
  std::vector<Tie> ties_;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> jointed_;  // slots, smaller first, ascending
  std::vector<ActivePush> pushes_;

  std::vector<Due> due_;  // heap, earliest first: boxes of bodies aloft that end; some are out of date
  std::uint32_t aloft_count_ = 0;

  // Who takes part in the step, ascending; rebuilt only when contacts or sleepers changed.
  bool active_stale_ = true;
  std::vector<std::uint32_t> awake_;            // movable bodies but those aloft
  std::vector<std::uint32_t> kinematic_;        // kinematic bodies
  std::vector<std::uint32_t> active_contacts_;  // with an awake or moving body
  std::uint32_t resting_points_ = 0;
  double resting_penetration_ = 0.0;
  double work_saved_ = 0.0;      // of options_.work_rate, in products of blocks; < 0: overdrawn
  double step_residual_ = 0.0;   // [m/s] largest of the step's islands
  double step_push_work_ = 0.0;  // [J] of all of them

  Counters counters_;
  StepReport report_;
  std::vector<BodyId> contained_;
  Scratch scratch_;
};

}  // namespace tumble
