#include "stepper/rigid/rigid_places.hpp"

#include <algorithm>
#include <cmath>

namespace knap {
namespace {

constexpr double allowed_depth = 1e-4;  // [-] of the edge: deeper overlaps are corrected
constexpr double corrected = 1e-6;      // [-] of the edge: smaller corrections end the search for them
constexpr int max_corrections = 20;     // sweeps
constexpr double near_in_depths = 10;   // of the largest correction: contacts further apart are not corrected
// [-] Of the edge, in a step: less than what the search of contacts finds without a history.
constexpr double most_corrected = 0.02;

/// [s] After the start of the step, of a contact whose gap closes in it.
double time_of_closing(const RigidRow& row, const RigidStep& step, const std::vector<MovingBody>& bodies) {
    constexpr int corrections = 3;  // of the turns
    const double a = rate(row, bodies, &MovingBody::acceleration).x(),
                 V = row.before.x() + rate(row, bodies, &MovingBody::kicked).x() - 0.5 * step.drift_time * a;
    double t = 2 * row.gap / (-V + std::sqrt(std::max(0.0, V * V - 2 * a * row.gap)));
    for (int i = 0; i < corrections && t > 0; ++i) {
        double gap = row.gap + (V + 0.5 * a * t) * t, speed = V + a * t;
        for (int k = 0; k < row.n_terms; ++k) {
            const MovingBody& body = bodies[row.terms[k].body];
            const Vec2 arm = row.place - body.centre, n = row.terms[k].along_N.head<2>();
            const double spin = body.flight.z();
            const Vec2 more = Rotation::by(spin * t).turned(arm) - arm;
            gap += n.dot(more - spin * t * turned_left(arm)), speed += spin * n.dot(turned_left(more));
        }
        if (speed < 0) t -= gap / speed;
    }
    return std::clamp(t, 0.0, step.drift_time);
}

}  // namespace

/// The impulses of a contact act at one place for all of its bodies: where those that are struck have moved it to.
void find_strikes(const RigidStep& step, std::vector<RigidRow>& rows, std::vector<MovingBody>& bodies) {
    bool any = false;
    for (MovingBody& body : bodies) body.flight = body.free;
    for (const RigidRow& row : rows)  // what something bears does not fly
        for (int k = 0; k < row.n_terms && (row.gap <= row.rounding || row.lasting.x() > 0); ++k) {
            MovingBody& body = bodies[row.terms[k].body];
            body.acceleration.setZero(), body.kicked.setZero();
            if (body.is_piece) body.flight = body.before;
        }
    for (RigidRow& row : rows) {
        ContactLaw& law = row.law;
        if (sides_of(row, bodies) != Sides::rigid) law.restitution = law.tangential = 0;  // they rebound by their waves
        const double push = row.before.x() - row.free.x();
        double approach = -row.before.x();
        if (row.gap > 0 && law.rebounds() &&
            row.gap + step.drift_time * rate(row, bodies, &MovingBody::flight).x() < 0) {
            const double a = rate(row, bodies, &MovingBody::acceleration).x(), tau = time_of_closing(row, step, bodies),
                         left = step.drift_time - tau;
            approach = -row.before.x() - rate(row, bodies, &MovingBody::kicked).x() - a * (tau - 0.5 * step.drift_time);
            if (2 * law.restitution * approach < -a * left) law.restitution = 0;  // it would come back within the step
            row.is_struck = tau > 0 && approach > 0 && (law.restitution > 0 || (law.tangential > 0 && approach > push));
            for (int k = 0; row.is_struck && k < row.n_terms; ++k) {
                MovingBody& body = bodies[row.terms[k].body];
                if (body.moves()) body.struck_at = body.struck_at > 0 ? std::min(body.struck_at, tau) : tau;
            }
            any = any || row.is_struck;
        }
        if (!row.is_struck && rests_under(law.restitution, approach, push)) law.restitution = 0;
        if (approach <= push || (row.gap > 0 && !row.is_struck)) law.tangential = 0;  // no impact
    }
    if (!any) return;
    for (MovingBody& body : bodies) {
        if (body.struck_at == 0) continue;
        if (!body.acceleration.isZero(0)) body.works_at = body.struck_at + 0.5 * (body.kick - step.drift_time);
        body.gained = body.works_at * body.acceleration;
    }
    for (RigidRow& row : rows) {
        const auto arm = [&](int k) -> Vec2 { return row.place - bodies[row.terms[k].body].centre; };
        const auto moved = [&](int k) -> Vec2 {  // the place on the body
            const MovingBody& body = bodies[row.terms[k].body];
            if (body.struck_at == 0) return Vec2::Zero();
            return body.struck_at * body.flight.head<2>() +
                   Rotation::by(body.struck_at * body.flight.z()).turned(arm(k)) - arm(k);
        };
        Vec2 place = Vec2::Zero();
        int n_struck = 0;
        for (int k = 0; k < row.n_terms; ++k) place += moved(k), n_struck += bodies[row.terms[k].body].struck_at > 0;
        if (n_struck == 0) continue;
        place /= n_struck;
        for (int k = 0; k < row.n_terms; ++k) {
            const MovingBody& body = bodies[row.terms[k].body];
            const Vec2 more = place - body.struck_at * body.flight.head<2>();
            for (Vec3* along : {&row.terms[k].along_N, &row.terms[k].along_T})
                along->z() += cross(more, Vec2(along->head<2>()));
        }
        row.before = rate(row, bodies, &MovingBody::before);
        complete(row, bodies);
    }
}

/// As contact_law(), of the velocities before and after the strike.
InterfaceLaw law_of_strike(const RigidRow& row, const RigidStep& step, const std::vector<MovingBody>& bodies,
                           double tolerance) {
    const Vec2 a = rate(row, bodies, &MovingBody::acceleration), gained = rate(row, bodies, &MovingBody::gained),
               kicked = rate(row, bodies, &MovingBody::kicked), before = row.before + 0.5 * kicked + gained,
               later = 0.5 * kicked - gained;
    const double approach = -before.x(),  // what separates is thrown back at its own speed at most
        stays = -0.5 * (gained.x() - 0.5 * (kicked.x() - step.drift_time * a.x())) - later.x(),
                 rebound =
                     approach > 0 ? std::min(std::max(row.law.restitution * approach, stays), approach) : approach;
    InterfaceLaw law{.contact = {true, rebound + later.x()}};
    for (const double slip : {row.law.tangential * before.y(), -before.y()})
        law.closed.add({.rate = slip + later.y(), .cohesive = 0, .friction = 0.5 * row.law.friction}, tolerance);
    return law;
}

double depth_at_end(const RigidRow& row, const RigidStep& step, const std::vector<MovingBody>& bodies) {
    double gap = row.apart + step.drift_time * rate(row, bodies, &MovingBody::end).x();
    for (int k = 0; k < row.n_terms; ++k) {
        const MovingBody& body = bodies[row.terms[k].body];
        gap += row.terms[k].along_N.dot(body.strike + body.shift);
    }
    return -gap;
}

/// Sequential shifts along the normals, weighted by the masses: the centre of mass of what presses on each other stays.
/// Two pieces that are shifted towards or away from each other while their velocities differ have another angular
/// momentum; both turn by the same rate to keep it.
void correct_places(const RigidStep& step, const std::vector<RigidRow>& rows, std::vector<MovingBody>& bodies) {
    struct Correction {
        const RigidRow* row;
        double depth, sum;  // [m], [kg m]
    };
    std::vector<Correction> active;
    double deepest = 0;
    const auto excess = [&](const RigidRow& row) {
        return depth_at_end(row, step, bodies) - allowed_depth * row.length;
    };
    for (const RigidRow& row : rows) {
        if (!(row.own_N > 0) || sides_of(row, bodies) != Sides::rigid) continue;
        const double depth = std::min(excess(row), most_corrected * row.length);
        if (depth > corrected * row.length) deepest = std::max(deepest, depth);
        if (depth > -row.length) active.push_back({&row, depth, 0});
    }
    if (deepest == 0) return;
    std::erase_if(active, [&](const Correction& at) { return at.depth < -near_in_depths * deepest; });
    bool any = true;
    for (int sweep = 0; any && sweep < max_corrections; ++sweep) {
        any = false;
        for (Correction& at : active) {
            const RigidRow& row = *at.row;
            double depth = at.depth;
            for (int k = 0; k < row.n_terms; ++k) depth -= row.terms[k].along_N.dot(bodies[row.terms[k].body].shift);
            const double change = std::max(-at.sum, depth / row.own_N);
            if (change == 0) continue;
            at.sum += change;
            for (int k = 0; k < row.n_terms; ++k) {
                MovingBody& body = bodies[row.terms[k].body];
                body.shift += change * body.inverse_mass.cwiseProduct(row.terms[k].along_N);
            }
            any = any || std::abs(change) * row.own_N > corrected * row.length;
        }
    }
    for (const Correction& at : active) {
        double gained = 0, inertia = 0;  // [kg m2/s], [kg m2]
        bool free = at.sum > 0 && at.row->n_terms > 1;
        for (int k = 0; free && k < at.row->n_terms; ++k) {
            const ClusterTerm& term = at.row->terms[k];
            const MovingBody& body = bodies[term.body];
            free = body.inverse_mass.minCoeff() > 0;
            gained += at.sum * cross(Vec2(term.along_N.head<2>()), Vec2(body.end.head<2>()));
            inertia += 1 / body.inverse_mass.z();
        }
        for (int k = 0; free && k < at.row->n_terms; ++k) {
            MovingBody& body = bodies[at.row->terms[k].body];
            body.couple -= gained / inertia / body.inverse_mass.z();
        }
    }
    for (MovingBody& body : bodies) body.end.z() += body.inverse_mass.z() * body.couple;
}

}  // namespace knap
