#pragma once
// Collectors: lines that count the pieces passing through them, fragments of the body and free obstacles, as a barrier
// would meet them. The path of a piece is that of its centre of mass.
//
// Looks: no piece is searched for before it can be at a line. Between the steps t_n and t_n+1 = t_n + h the path is
//     c(s) = c_n + s (c_n+1 - c_n) + 1/2 s (s - 1) a h^2,   0 <= s <= 1,    v(s) = v_mean + (s - 1/2) a h
// with the acceleration a from the mean velocities of two steps, where that of the step before agrees with it within a
// tenth; else, as in a blow, a = 0. This is exact in free flight under a constant acceleration.
//
// Mass counts once. A piece has passed when it is a thousandth of its diameter beyond the line, so that one that lies
// on it does not pass again and again. When a piece breaks, a part whose own centre is on the other side of the line
// than that of the whole has either been counted with it, and its own passage is no other one; or it is counted now.
#include "analysis/moving_pieces.hpp"
#include "model/state.hpp"

#include <array>
#include <optional>

namespace knap {

struct CollectorOptions {
    std::string name;
    Vec2 from = Vec2::Zero(), to = Vec2::Zero();  // [m] its ends
    std::optional<double> x;                      // [m] instead: a vertical without ends
    enum class Direction { both, forward, backward } direction = Direction::both;
};

/// A line of passages.csv. All values are those of the moment at which the centre is on the line.
struct Passage {
    double collector = 0;            // number
    double time = 0;                 // [s]
    double direction = 0;            // 1: forward, from the left of the line to its right; -1
    double label = 0, obstacle = 0;  // lowest triangle of a fragment, number of an obstacle; NaN of the other
    double mass = 0, diameter = 0;   // [kg], [m] of the circle of the same area
    Vec2 place = Vec2::Zero();       // [m]
    double height = 0;               // [m] above the lower end, of a vertical without ends above the ground; NaN: none
    Vec2 velocity = Vec2::Zero();    // [m/s]
    double spin = 0;                 // [rad/s]
    double translation = 0, rotation = 0;  // [J]

    void serialize(auto& archive) {
        archive(collector, time, direction, label, obstacle, mass, diameter, place, height, velocity, spin, translation,
                rotation);
    }
};
std::span<const Measure<Passage>> passage_columns();

/// The passages of one collector, for the summary: rows after its name.
struct Passages {
    std::vector<double> mass, energy, height, speed;  // [kg], [J], [m], [m/s]
};
std::span<const Measure<Passages>> collector_numbers();
/// Those of collector `number` in the table of all.
Passages passages_of(const History& table, std::size_t number);

class Collectors {
public:
    Collectors(const Model& model, const State& start, std::vector<CollectorOptions> collectors);

    /// At the end of every step; `speed` [m/s]: at most that of any vertex; `changed`: interfaces broke. Returns the
    /// new lines of passages.csv.
    std::vector<std::vector<double>> after_step(const State& now, double speed, bool changed);

    void serialize(auto& archive) { archive(tracks_, track_of_triangle_, path_, to_line_, to_piece_, changed_); }

private:
    /// What is known of the way of a piece through one line.
    struct Crossing {
        int passed = 0;  // direction of the last passage, 0: none
        int owed = 0;    // a passage in this direction was counted with the whole of which the piece is a part
        std::optional<Passage> pending;  // on the line, but not yet beyond it

        void serialize(auto& archive) { archive(passed, owed, pending); }
    };
    struct Track {
        Index label = -1;  // lowest triangle; -1 - number of an obstacle
        Index n_triangles = 0;
        double time = 0, step = 0;                            // [s] of the last look, and of the step before it
        Vec2 centre = Vec2::Zero(), velocity = Vec2::Zero();  // [m], [m/s]
        std::optional<Vec2> acceleration;                     // [m/s2] from the last two steps
        std::vector<Crossing> at;                             // per collector

        bool is_all_of(const MovingPiece& piece) const {
            return label == piece.label && n_triangles == piece.n_triangles;
        }
        void serialize(auto& archive) { archive(label, n_triangles, time, step, centre, velocity, acceleration, at); }
    };
    struct Path;
    Path path_of(const MovingPiece& piece, const Track* before, const State& now, Track& track) const;
    void cross_line(std::size_t k, const MovingPiece& piece, const Path& path, const Vec2* whole, const State& now,
                    Crossing& at, const auto& pass) const;
    std::vector<std::vector<double>> look(const State& now);
    double signed_distance(std::size_t collector, const Vec2& place) const;
    bool is_through(std::size_t collector, const Vec2& place) const;

    const Model& model_;
    std::vector<CollectorOptions> collectors_;
    std::vector<Track> tracks_;
    std::vector<Index> track_of_triangle_;  // -1: excavated
    double path_ = 0;                       // [m] of the fastest vertex since the last look
    double to_line_ = 0, to_piece_ = 0;     // [m] shortest distances then, of a centre and of anything of a piece
    bool changed_ = false;                  // interfaces broke since then
};

}  // namespace knap
