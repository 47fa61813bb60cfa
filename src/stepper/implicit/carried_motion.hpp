#pragma once
// Damping of the pieces that nothing holds (common/pieces_of_body.hpp) in implicit steps: it acts on rates minus the
// rigid motion W of the piece, so that flight, fall, roll and slide lose nothing. W is that of the rates themselves,
//
//     alpha M (w - W),     W = R q,     R' M (w - R q) = 0     R: rigid motions of the pieces
//
// A matrix with W would be full. So the step is solved with a given q, and q = Q(w(q)) is found by Broyden's method,
// piece by piece, from the slope of a piece that others hold: 1 solution at rest, 3 where nothing touches it. The
// work -h alpha |w - W|_M^2 is never positive.
#include "stepper/common/pieces_of_body.hpp"
#include "stepper/common/step_scheme.hpp"
#include "stepper/implicit/implicit_bulk.hpp"
#include "stepper/implicit/rigid_pieces.hpp"

namespace knap {

class CarriedMotion {
public:
    static constexpr int max_rounds = 40;

    /// `bulk` gets W; it must outlive this.
    CarriedMotion(const Model& model, const SchemeOptions& options, ImplicitBulk& bulk)
        : model_(model),
          leaves_motion_(options.damping > 0 && options.damping_of == DampingOf::vibration),
          bulk_(bulk) {}

    /// After ImplicitBulk::begin_step: the pieces, and a first W from the motion so far.
    void begin(const StepContext& step);
    bool has_pieces() const { return !search_.empty(); }
    /// Whether a solution, of the rates [m/s] per corner, has the motion W with which it was found; else W changes.
    bool agrees(const std::vector<Vec2>& rate);
    /// The motions of the pieces at the start of the step.
    const std::vector<PieceMotion>& motions() const { return motions_; }

private:
    struct Search {
        Index first_triangle;
        double n_corners = 0;
        Eigen::Vector3d q = Eigen::Vector3d::Zero(), error = q, change = q;  // [m/s]
        Eigen::Matrix3d inverse_slope = Eigen::Matrix3d::Identity();         // [-]
    };
    void find(const State& begin);
    void set_carried();

    const Model& model_;
    bool leaves_motion_;
    ImplicitBulk& bulk_;
    std::ptrdiff_t n_broken_ = -1;  // points without cohesion for which the pieces were found
    std::vector<Index> piece_of_corner_;
    std::vector<Search> search_;  // per piece
    RigidPieces rigid_;
    std::vector<PieceMotion> motions_;
    std::vector<Vec2> carried_, of_corner_;  // [m/s] per corner: W; memory
    std::vector<Eigen::Vector3d> along_;
    bool is_first_ = true;
};

}  // namespace knap
