#include "analysis/collectors.hpp"

#include "base/quantile.hpp"
#include "mesh/polygon.hpp"
#include "model/model.hpp"

#include <algorithm>
#include <cmath>

namespace knap {
namespace {

constexpr double none = std::numeric_limits<double>::quiet_NaN();
constexpr double beyond = 1e-3;     // of its diameter: so far behind the line a piece has passed
constexpr double steady = 0.1;      // accelerations of two steps that differ by less are no blow
constexpr double steps_before = 3;  // looks before a piece can be at a line, from which its acceleration follows

/// Where the path from distance d0 to d1 with d(s) = d0 + s (d1 - d0) + s (s - 1) bend changes its sign, which d0 and
/// d1 do not share: in it there is one root.
double root(double d0, double d1, double bend) {
    const double b = d1 - d0 - bend;
    const double q = -0.5 * (b + std::copysign(std::sqrt(std::max(0.0, b * b - 4 * bend * d0)), b));
    const double far = bend == 0 ? infinity : q / bend, near = q == 0 ? 0 : d0 / q;
    const auto outside = [](double s) { return std::max({0.0, -s, s - 1}); };
    return std::clamp(outside(near) <= outside(far) ? near : far, 0.0, 1.0);
}

Passage passage(const MovingPiece& piece, std::size_t collector, int direction) {
    return {.collector = static_cast<double>(collector),
            .direction = static_cast<double>(direction),
            .label = piece.label_of_fragment(),
            .obstacle = piece.number_of_obstacle(),
            .mass = piece.mass,
            .diameter = piece.diameter(),
            .spin = piece.spin,
            .rotation = piece.energy_of_rotation()};
}

}  // namespace

std::span<const Measure<Passage>> passage_columns() {
    using P = Passage;
    static constexpr Measure<P> columns[] = {
        {"collector", "", "number of the [[collector]], from 0", [](const P& p) { return p.collector; }},
        {"time", "s", "time at which the centre of mass is on the line", [](const P& p) { return p.time; }},
        {"direction", "",
         "1: forward, from the left of the line to its right as seen from `from` to `to`, or towards "
         "larger x; -1: backward",
         [](const P& p) { return p.direction; }},
        {"label", "", "lowest triangle of the fragment, as in fragment_paths.csv; empty of an obstacle",
         [](const P& p) { return p.label; }},
        {"obstacle", "", "number of the free obstacle, from 0; empty of a fragment",
         [](const P& p) { return p.obstacle; }},
        {"mass", "kg", "mass", [](const P& p) { return p.mass; }},
        {"diameter", "m", "diameter of the circle of the same area", [](const P& p) { return p.diameter; }},
        {"x", "m", "x of the centre of mass", [](const P& p) { return p.place.x(); }},
        {"y", "m", "y of the centre of mass", [](const P& p) { return p.place.y(); }},
        {"height", "m",
         "y above the lower end of the line; of a vertical without ends above the highest surface of an "
         "obstacle below, empty where there is none",
         [](const P& p) { return p.height; }},
        {"velocity_x", "m/s", "velocity of the centre of mass, x", [](const P& p) { return p.velocity.x(); }},
        {"velocity_y", "m/s", "velocity of the centre of mass, y", [](const P& p) { return p.velocity.y(); }},
        {"speed", "m/s", "its magnitude", [](const P& p) { return p.velocity.norm(); }},
        {"spin", "rad/s", "angular momentum about the centre of mass over the moment of inertia",
         [](const P& p) { return p.spin; }},
        {"translation", "J", "kinetic energy of the centre of mass", [](const P& p) { return p.translation; }},
        {"rotation", "J", "kinetic energy of the spin", [](const P& p) { return p.rotation; }},
        {"energy", "J", "sum of both, without vibrations", [](const P& p) { return p.translation + p.rotation; }}};
    return columns;
}

std::span<const Measure<Passages>> collector_numbers() {
    using P = Passages;
    static constexpr Measure<P> rows[] = {
        {"*_passages", "", "number of passages through each [[collector]], by its name; their statistics follow",
         [](const P& p) { return double(p.mass.size()); }},
        {"*_mass", "kg", "mass that passed",
         [](const P& p) {
             double sum = 0;
             for (const double mass : p.mass) sum += mass;
             return sum;
         }},
        {"*_median_energy", "J", "median of the kinetic energies of the passages",
         [](const P& p) { return quantile(p.energy, 0.5); }},
        {"*_energy_95", "J", "95 % of them have at most this energy",
         [](const P& p) { return quantile(p.energy, 0.95); }},
        {"*_largest_energy", "J", "largest energy", [](const P& p) { return quantile(p.energy, 1); }},
        {"*_median_height", "m", "likewise of the heights", [](const P& p) { return quantile(p.height, 0.5); }},
        {"*_height_95", "m", "likewise", [](const P& p) { return quantile(p.height, 0.95); }},
        {"*_largest_height", "m", "likewise", [](const P& p) { return quantile(p.height, 1); }},
        {"*_median_speed", "m/s", "likewise of the speeds", [](const P& p) { return quantile(p.speed, 0.5); }},
        {"*_speed_95", "m/s", "likewise", [](const P& p) { return quantile(p.speed, 0.95); }},
        {"*_largest_speed", "m/s", "likewise", [](const P& p) { return quantile(p.speed, 1); }}};
    return rows;
}

Passages passages_of(const History& table, std::size_t number) {
    Passages found;
    if (table.rows.empty()) return found;
    const std::size_t collector = table.place_of("collector"), mass = table.place_of("mass"),
                      energy = table.place_of("energy"), height = table.place_of("height"),
                      speed = table.place_of("speed");
    for (const std::vector<double>& row : table.rows) {
        if (row[collector] != static_cast<double>(number)) continue;
        found.mass.push_back(row[mass]), found.energy.push_back(row[energy]);
        found.height.push_back(row[height]), found.speed.push_back(row[speed]);
    }
    return found;
}

Collectors::Collectors(const Model& model, const State& start, std::vector<CollectorOptions> collectors)
    : model_(model), collectors_(std::move(collectors)) {
    track_of_triangle_.assign(model.mesh.n_triangles(), -1);
    if (!collectors_.empty()) look(start);
}

/// [m] Positive on the right of the line.
double Collectors::signed_distance(std::size_t collector, const Vec2& place) const {
    const CollectorOptions& line = collectors_[collector];
    if (line.x) return place.x() - *line.x;
    return cross(place - line.from, (line.to - line.from).normalized());
}

bool Collectors::is_through(std::size_t collector, const Vec2& place) const {
    const CollectorOptions& line = collectors_[collector];
    const Vec2 along = line.to - line.from;
    const double s = along.dot(place - line.from);
    return line.x || (s >= 0 && s <= along.squaredNorm());
}

std::vector<std::vector<double>> Collectors::after_step(const State& now, double speed, bool changed) {
    if (collectors_.empty()) return {};
    for (std::size_t i = 0; i < model_.obstacles.size(); ++i)
        if (model_.obstacles[i].is_free()) speed = std::max(speed, now.obstacles[i].velocity.head<2>().norm());
    path_ += now.last_step * speed;
    changed_ = changed_ || changed;
    const double reach = path_ + steps_before * now.last_step * speed;
    if (reach < to_line_ && !(changed_ && reach >= to_piece_)) return {};
    return look(now);
}

/// The way of a piece since the last look, or of a part that has just broken off in the last step.
struct Collectors::Path {
    double h;                                    // [s]
    Vec2 begin, end, mean, bend = Vec2::Zero();  // [m], [m], [m/s], [m] 1/2 a h^2

    Vec2 place(double s) const { return begin + s * (end - begin) + s * (s - 1) * bend; }
    Vec2 velocity(double s) const { return h > 0 ? Vec2(mean + (2 * s - 1) / h * bend) : mean; }
};

/// The mean velocities of explicit steps are those of their middles; implicit steps have those of their ends. `track`
/// gets the acceleration.
Collectors::Path Collectors::path_of(const MovingPiece& piece, const Track* before, const State& now,
                                     Track& track) const {
    Path path{.h = now.last_step,
              .begin = piece.centre - now.last_step * piece.velocity,
              .end = piece.centre,
              .mean = piece.velocity};
    if (!before || !before->is_all_of(piece)) return path;
    path.h = now.time - before->time, path.begin = before->centre;
    if (path.h > now.last_step * (1 + 1e-9) || path.h == 0) return path;
    const bool ends = now.has_end_velocities();
    track.acceleration = (piece.velocity - before->velocity) / (ends ? path.h : 0.5 * (path.h + before->step));
    if (!before->acceleration) return path;
    const double larger = std::max(track.acceleration->norm(), before->acceleration->norm());
    if ((*track.acceleration - *before->acceleration).norm() > steady * larger) return path;
    path.bend = 0.5 * path.h * path.h * *track.acceleration;
    if (ends) path.mean = 0.5 * (piece.velocity + before->velocity);
    return path;
}

/// What a path means for one line. `whole`: where the centre was of which the piece is a part; null: of itself. Calls
/// pass(at, passage).
void Collectors::cross_line(std::size_t k, const MovingPiece& piece, const Path& path, const Vec2* whole,
                            const State& now, Crossing& at, const auto& pass) const {
    const auto distance = [&](const Vec2& place) { return signed_distance(k, place); };
    const auto passage_at = [&](double time, const Vec2& place, const Vec2& velocity, int direction) {
        Passage p = passage(piece, k, direction);
        p.time = time, p.place = place, p.velocity = velocity;
        p.height = place.y() - (collectors_[k].x ? ground_below(model_, now, place)
                                                 : std::min(collectors_[k].from.y(), collectors_[k].to.y()));
        p.translation = 0.5 * p.mass * velocity.squaredNorm();
        return p;
    };
    const auto meets = [&](const Vec2& a, const Vec2& b) {
        const double d0 = distance(a), d1 = distance(b);
        return (d0 < 0) != (d1 < 0) && is_through(k, a + d0 / (d0 - d1) * (b - a));
    };
    if (whole && meets(*whole, path.begin)) {  // the part is on the other side than the whole was
        const int side = distance(path.begin) < 0 ? -1 : 1;
        if (at.passed == -side) at.owed = -side;
        else if ((distance(piece.start) < 0) != (side < 0))
            pass(at, passage_at(now.time, piece.centre, piece.velocity, side));
    }
    const double d0 = distance(path.begin), d1 = distance(path.end);
    if ((d0 < 0) != (d1 < 0)) {
        const double s = root(d0, d1, distance(path.end + path.bend) - d1);
        const int direction = d1 < 0 ? -1 : 1;
        if (!is_through(k, path.place(s))) return;
        if (at.pending) at.pending.reset();  // back again
        else if (at.owed == direction) at.owed = 0;
        else
            at.owed = 0,
            at.pending = passage_at(now.time - (1 - s) * path.h, path.place(s), path.velocity(s), direction);
    }
    if (at.pending && std::abs(d1) > beyond * piece.diameter()) pass(at, Passage(*at.pending));
}

/// Finds all pieces, and what has passed since the last look.
std::vector<std::vector<double>> Collectors::look(const State& now) {
    std::vector<std::vector<double>> lines;
    const auto pass = [&](Crossing& at, const Passage& passage) {
        at.passed = passage.direction > 0 ? 1 : -1, at.pending.reset();
        const auto wanted = collectors_[static_cast<std::size_t>(passage.collector)].direction;
        using enum CollectorOptions::Direction;
        if (wanted == both || (wanted == forward) == (at.passed > 0))
            lines.push_back(values_of(passage_columns(), passage));
    };
    MovingPieces found = find_moving_pieces(model_, now);
    /// Of the piece to which this one belonged at the last look; obstacles, which come first, keep their places.
    const auto earlier = [&](std::size_t i) -> Track* {
        const Index label = found.pieces[i].label,
                    place = label < 0 ? static_cast<Index>(i) : track_of_triangle_[label];
        return tracks_.empty() || place < 0 ? nullptr : &tracks_[place];
    };
    for (std::size_t i = 0; i < found.pieces.size(); ++i)  // what is on the line and breaks has passed as a whole
        if (Track* const before = earlier(i); before && !before->is_all_of(found.pieces[i]))
            for (Crossing& at : before->at)
                if (at.pending) pass(at, Passage(*at.pending));

    std::vector<Track> tracks;
    to_line_ = to_piece_ = infinity;
    for (std::size_t i = 0; i < found.pieces.size(); ++i) {
        const MovingPiece& piece = found.pieces[i];
        const Track* const before = earlier(i);
        Track track{.label = piece.label,
                    .n_triangles = piece.n_triangles,
                    .time = now.time,
                    .step = now.last_step,
                    .centre = piece.centre,
                    .velocity = piece.velocity};
        track.at = before ? before->at : std::vector<Crossing>(collectors_.size());
        const Path path = path_of(piece, before, now, track);
        const Vec2* const whole = before && !before->is_all_of(piece) ? &before->centre : nullptr;
        for (std::size_t k = 0; k < collectors_.size(); ++k) {
            if (before) cross_line(k, piece, path, whole, now, track.at[k], pass);
            const CollectorOptions& line = collectors_[k];
            const double away = line.x ? std::abs(signed_distance(k, piece.centre))
                                       : distance_to_segment(line.from, line.to, piece.centre);
            to_line_ = std::min({to_line_, away, track.at[k].pending ? beyond * piece.diameter() : infinity});
            to_piece_ = std::min(to_piece_, away - piece.radius);
        }
        tracks.push_back(std::move(track));
    }
    tracks_ = std::move(tracks), track_of_triangle_ = std::move(found.piece_of_triangle);
    path_ = 0, changed_ = false;
    return lines;
}

}  // namespace knap
