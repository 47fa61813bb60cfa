#pragma once
// A scenario compared with its mesh before a run: errors and warnings at the lines of the keys concerned.
#include "app/check/cost.hpp"
#include "model/model.hpp"
#include "scenario/read_scenario.hpp"

#include <vector>

namespace knap {

/// Throws UserError: a shape that cannot be meshed, a selection of nothing, loads that contradict each other, obstacles
/// in the body. Where
/// [adapt] does not pay, the scenario gets a uniform mesh instead, and a warning.
Model model_of(ReadResult& read);

/// Throws UserError: a step that the mesh does not allow.
StepPlan plan_of(const ReadResult& read, const Model& model, double until);

/// Throws UserError: a specimen that the loads do not test, `start = "equilibrium"` of a body without support,
/// obstacles that overlap. Returns warnings: obstacles that may meet.
std::vector<Diagnostic> check_model(const ReadResult& read, const Model& model);

/// Throws UserError: a picture that its format cannot have, or that needs more memory than there is. `extent` [m]: of
/// what it shows.
void check_picture_size(const FigureOptions& figure, const Vec2& extent);

/// Warnings: probes, regions and boxes outside the body.
std::vector<Diagnostic> findings_of_places(const ReadResult& read, const Model& model);

/// Warnings: probes outside the body, between two bodies or faces, far from the interface that they watch.
std::vector<Diagnostic> findings_of_probes(const ReadResult& read, const Model& model);

/// Warnings: collectors whose heights have no origin.
std::vector<Diagnostic> findings_of_collectors(const ReadResult& read, const Model& model);

/// Warnings: laws with which a Brazilian disc is crushed before it splits.
std::vector<Diagnostic> findings_of_crushed_discs(const ReadResult& read);

/// Warnings: supports between bodies that touch.
std::vector<Diagnostic> findings_of_supports(const ReadResult& read, const Model& model);

/// Pairs of which one is free: errors where they overlap at the start, warnings where they may meet. Errors where a
/// free one meets what is held.
std::vector<Diagnostic> findings_of_obstacles(const ReadResult& read, const Model& model);

/// Warnings: bodies and obstacles that meet at a speed which covers critical openings in a step, as far as it is known.
std::vector<Diagnostic> findings_of_impacts(const ReadResult& read, const Model& model, const StepPlan& plan);

/// Warnings: a [[pressure]] whose source touches no crack and no joint.
std::vector<Diagnostic> findings_of_fluids(const ReadResult& read, const Model& model);

/// Warnings: loads that rise within the passage of a wave through a few edges, by much of the strength.
std::vector<Diagnostic> findings_of_steep_loads(const ReadResult& read, const Model& model);

/// Warnings: bodies that rest by friction under a load which rises faster than they vibrate.
std::vector<Diagnostic> findings_of_resting_bodies(const ReadResult& read, const Model& model, const StepPlan& plan);

/// Warnings: temperatures at t = 0 that strain a body which starts undeformed, by much of the strength.
std::vector<Diagnostic> findings_of_hot_start(const ReadResult& read, const Model& model);

/// Warnings: slender parts with few edges of first order across, which something can bend.
std::vector<Diagnostic> findings_of_bending(const ReadResult& read, const Model& model);

/// Warnings: tables over time that steps do not resolve, tables over temperature that the run does not reach, fields of
/// temperature that the mesh does not resolve.
std::vector<Diagnostic> findings_of_tables(const ReadResult& read, const Model& model, const StepPlan& plan);

/// Warnings: on these places, supports, fluids, impacts, tables, bending, steep loads, resting bodies and hot starts,
/// the resolution of the process zone, the conduction of heat, jumps of prescribed displacements, details that reduce
/// the stable step, and implausible numbers of steps, frames, lines and pictures. Without `cost` it is estimated where
/// a run may be long.
std::vector<Diagnostic> findings_of_model(const ReadResult& read, const Model& model, const StepPlan& plan,
                                          const Cost* cost = nullptr);

}  // namespace knap
