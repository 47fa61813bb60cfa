#pragma once
// How a deformable piece rebounds with R_N, and R_T of its slip (ContactLaw::Rebound::of_bodies): the surface that it
// hits gives way (stepper/README.md#rebound-of-bodies). With the rates V_N, V_T of the contact point that the rigid
// motion of the pieces has, V_N0 and V_T0 of them at the first touch,
//
//     V_N < 0             the surface gives way with alpha |V_N|,  alpha = 1 - (R_N/e_0)^2:   loss alpha 1/2 m V_N0^2
//     V_N >= R_N V_N0     it pushes no more
//     |V_T| <= R_T |V_T0| it rubs no more
//
// An impact ends when nothing has touched for 6 passages of a wave through the piece, and after 100 of them: vibrations
// touch once more after the rebound. A slip is braked by friction alone after 24.
#include "stepper/common/obstacle_contacts.hpp"
#include "stepper/common/pieces_of_body.hpp"
#include "stepper/common/step_report.hpp"
#include "stepper/contact/face_contacts.hpp"

namespace knap {

/// What becomes of the law of a contact in this step.
struct GivingWay {
    double rate = 0;  // [m/s] with which the surface gives way
    bool pushes = true, rubs = true;
    bool lies_deep = false;  // where the surface gave way: no penetration
};

/// [-] With which a deformable piece of n triangles rebounds at least, whatever it hits: nearly all exceed it, most by
/// far (discs 0.95 to 0.97).
double natural_rebound(std::size_t n_triangles);

class Rebounds {
public:
    /// `dashpots` must outlive this.
    Rebounds(const Model& model, std::span<const Dashpot> dashpots);

    /// No law needs it.
    bool is_idle() const { return !is_needed_; }
    /// [-] Of an edge of the body: as deep does an obstacle, or do faces, give way.
    static double depth_of_obstacles();
    static double depth_of_faces();
    /// Takes over the impacts of the state that go on.
    void begin(const State& begin);
    GivingWay find(const FaceContact& contact, const ContactLaw& law, const State& begin);
    GivingWay find(const ObstacleContact& contact, const ContactLaw& law, const State& begin);
    void finish(State& end) const { end.impacts = impacts_; }
    /// What the surfaces could not take in this step.
    void report_lack(StepReport& report) const { report.add_rebound_lack(lack_, lack_place_); }

private:
    struct Piece {
        std::vector<Index> triangles;
        double size = 0;  // [m] root of its area
        bool held = false;
        bool is_known = false;  // of this step:
        Vec2 centre = Vec2::Zero(), velocity = Vec2::Zero();
        double spin = 0;
    };
    /// Two sides that meet: a piece, and another one or an obstacle.
    struct Sides {
        Index piece, other;  // lowest triangles; other < 0: obstacle -1 - other
    };
    Index piece_of(Index corner) const { return first_[model_.mesh.triangle_of(corner)]; }
    Sides sides_of(const FaceContact& contact) const;
    Sides sides_of(const ObstacleContact& contact) const;
    Impact* impact_of(const Sides& sides);
    Piece& motion_of(Index first_triangle, const State& begin);
    Vec2 velocity_at(Index first_triangle, const Vec2& place, const State& begin);
    GivingWay find(const Sides& sides, const Vec2& place, const Vec2& rate, double gap, double deepest_gap,
                   const ContactLaw& law, const State& begin);

    const Model& model_;
    std::span<const Dashpot> dashpots_;
    bool is_needed_ = false;
    double wave_speed_ = 0;         // [m/s] the largest
    std::ptrdiff_t n_broken_ = -1;  // points without cohesion for which the pieces were found
    std::vector<Index> first_;      // per triangle: the lowest one of its piece
    std::vector<Piece> pieces_;     // in the places of their lowest triangles
    double time_ = 0;               // [s]
    std::vector<Impact> impacts_;
    double lack_ = 0;                 // [-] of this step (StepReport::rebound_lack)
    Vec2 lack_place_ = Vec2::Zero();  // [m]
};

}  // namespace knap
