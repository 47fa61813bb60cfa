// The fan solver against an independent judge on random fans, and where the answer is known.
#include "nonsmooth/fan_solver.hpp"
#include "nonsmooth/fan_lcp.hpp"
#include "support/fan_judge.hpp"
#include "support/random_fans.hpp"

#include "support/relative.hpp"
#include "support/verification.hpp"

#include <doctest/doctest.h>

namespace fan_solver_test {

using namespace knap;
using namespace knap::tests;

namespace {

/// A body on the support at one point whose frame is turned by 45 degrees: W = [[1, .8], [.8, 1]] in (N, T).
FanProblem coupled_contact(double friction, double q_N, double q_T) {
    const FanLink link = contact_without_cohesion(-1, 0, Vec2(M_SQRT1_2, M_SQRT1_2), friction);
    FanProblem fan;
    fan.drift_time = 1;
    fan.bodies = {{.velocity = Vec2::Zero(),
                   .free_velocity = q_N * link.normal + q_T * turned_left(link.normal),
                   .inverse_mass = Vec2(0.2, 1.8)}};
    fan.links = {link};
    return fan;
}

/// The solution of a fan by a new solver.
FanResult solved(const FanProblem& fan, FanSolution::Status* status = nullptr) {
    FanResult result;
    const FanSolution solution = FanSolver().solve(fan, result);
    if (status) *status = solution.status;
    return result;
}

/// How many of {open, stick, slip forward, slip backward} solve that contact.
int n_solutions(double mu, double q_N, double q_T) {
    const double W_NN = 1, W_NT = 0.8, W_TT = 1;
    int count = q_N > 0;
    const double determinant = W_NN * W_TT - W_NT * W_NT;
    const double p = (-W_TT * q_N + W_NT * q_T) / determinant, P_T = (W_NT * q_N - W_NN * q_T) / determinant;
    count += p > 0 && std::abs(P_T) < mu * p;
    for (const double sign : {1.0, -1.0}) {
        const double p_slip = -q_N / (W_NN - sign * mu * W_NT);
        count += p_slip > 0 && sign * (q_T + W_NT * p_slip - sign * mu * W_TT * p_slip) > 0;
    }
    return count;
}

/// 1/2 sum m |v - v_free|^2 + sum C (V_N + gamma |V_T + u_T/h|), the convex function that the end velocities minimise
/// without friction.
double convex_energy(const FanProblem& fan, const std::vector<Vec2>& velocity) {
    double energy = 0;
    for (std::size_t b = 0; b < fan.bodies.size(); ++b)
        energy += 0.5 * (velocity[b] - fan.bodies[b].free_velocity).squaredNorm() / fan.bodies[b].inverse_mass.x();
    for (const FanLink& link : fan.links) {
        const Vec2 V = (link.after < 0 ? Vec2(Vec2::Zero()) : velocity[link.after]) -
                       (link.before < 0 ? Vec2(Vec2::Zero()) : velocity[link.before]);
        if (link.ramp > 0) {
            const double part = link.ramp_part(V);
            energy += link.cohesive * link.ramp * (part > 1 ? part - 0.5 : part > 0 ? 0.5 * part * part : 0);
            continue;
        }
        energy += link.cohesive * (link.normal.dot(V) +
                                   link.gamma * std::abs(turned_left(link.normal).dot(V) + link.u_T / fan.drift_time));
    }
    return energy;
}

void add_body(FanProblem& fan, double v_x, double v_y, double free_x, double free_y, double w) {
    fan.bodies.push_back({.velocity = {v_x, v_y}, .free_velocity = {free_x, free_y}, .inverse_mass = {w, w}});
}

void add_link(FanProblem& fan, Index before, Index after, double N_x, double N_y, double u_N, double u_T,
              double cohesive) {
    fan.links.push_back({.before = before,
                         .after = after,
                         .normal = {N_x, N_y},
                         .u_N = u_N,
                         .u_T = u_T,
                         .cohesive = cohesive,
                         .gamma = 1,
                         .friction = 0.7,
                         .restitution = 0,
                         .unbreakable = false});
}

/// What random fans, solved one after the other, gave.
struct Counted {
    int n_fallback = 0, n_unsolved = 0;
    double worst = 0;  // [-] violation, at this seed
    std::uint64_t worst_seed = 0;

    /// False: it was not solved, and says so.
    bool add(const FanProblem& fan, std::uint64_t seed, FanSolver& solver, FanResult& result) {
        const FanSolution solution = solver.solve(fan, result);
        if (solution.residual >= 1) return ++n_unsolved, false;  // relaxed or failed
        n_fallback += solution.status != FanSolution::Status::exact;
        const double violation = FanJudge(fan, result).verdict().worst();
        if (violation > worst) worst = violation, worst_seed = seed;
        return true;
    }
};

}  // namespace

TEST_CASE("a motion whose numbers are hardly different from zero is one of a body at rest") {
    FanSolver solver;
    FanResult result;
    for (const double speed : {3e-320, 1e-310, 1e-200}) {  // far ahead of a wave
        FanProblem fan = coupled_contact(0.3, -speed, 0.3 * speed);
        const FanSolution solution = solver.solve(fan, result);
        CHECK(solution.residual <= 1e-10);
        CHECK(solution.status == FanSolution::Status::exact);
        CHECK(result.velocity[0].norm() <= 2 * speed);
    }
}

TEST_CASE("random fans meet every law and no impact or friction gives energy") {
    FanSolver solver;
    FanResult result;
    for (const bool prescribed : {false, true})
        for (const bool friction : {false, true}) {
            const int n = 6000;
            int n_fallback = 0, n_relaxed = 0;
            double worst = 0;
            std::uint64_t worst_seed = 0;
            for (int seed = 0; seed < n; ++seed) {
                FanProblem fan = RandomFan(seed, {.friction = friction, .prescribed = prescribed}).problem();
                const FanSolution solution = solver.solve(fan, result);
                REQUIRE_MESSAGE(solution.status != FanSolution::Status::failed, "seed ", seed, ", friction ", friction,
                                ", prescribed ", prescribed);
                if (solution.status == FanSolution::Status::relaxed) {
                    ++n_relaxed;
                    continue;
                }
                n_fallback += solution.status == FanSolution::Status::by_lemke;
                const double violation = FanJudge(fan, result).verdict().worst();
                if (violation > worst) worst = violation, worst_seed = seed;
            }
            CHECK_MESSAGE(worst <= 1e-10, "seed ", worst_seed, ", friction ", friction, ", prescribed ", prescribed);
            MESSAGE("friction ", friction, ", prescribed ", prescribed, ": ", n_fallback, " of ", n,
                    " needed pivots, worst violation ", worst, " at seed ", worst_seed);
            CHECK(n_fallback < (friction ? 0.12 : 0.04) * n);
            // no solution: only where large friction wedges a driven body
            CHECK(n_relaxed <= (friction && prescribed ? 0.005 * n : 0));
        }
}

TEST_CASE("random fans with friction over pressure meet every law and no friction gives energy") {
    FanSolver solver;
    FanResult result;
    for (const bool prescribed : {false, true})
        for (const bool secant : {false, true}) {
            const int n = 6000;
            int n_beyond = 0;
            Counted counted;
            for (int seed = 0; seed < n; ++seed) {
                RandomFan random(seed, {.prescribed = prescribed, .secant = secant, .over_pressure = true});
                const FanProblem fan = random.problem();
                if (!counted.add(fan, seed, solver, result)) continue;
                for (std::size_t i = 0; i < fan.links.size(); ++i)
                    n_beyond += fan.links[i].pressed && fan.links[i].pressed.line_at(result.links[i].contact) > 0;
            }
            const auto& [n_fallback, n_unsolved, worst, worst_seed] = counted;
            MESSAGE("prescribed ", prescribed, ", secant ", secant, ": ", n_fallback, " of ", n, " needed pivots, ",
                    n_unsolved, " not solved, worst violation ", worst, " at seed ", worst_seed, ", ", n_beyond,
                    " links beyond the first line");
            CHECK_MESSAGE(worst <= 1e-10, "seed ", worst_seed, ", prescribed ", prescribed, ", secant ", secant);
            CHECK(n_fallback < 0.2 * n);
            CHECK(n_unsolved <= (prescribed ? 0.005 * n : 2));
            CHECK(n_beyond > 1000);
        }
}

TEST_CASE("random fans with secant and with vertical unloading meet every law") {
    FanSolver solver;
    FanResult result;
    for (const bool vertical : {false, true})
        for (const bool prescribed : {false, true})
            for (const bool friction : {false, true}) {
                const int n = 6000;
                int n_on_ramp = 0, n_empty = 0, n_full = 0;
                Counted counted;
                for (int seed = 0; seed < n; ++seed) {
                    FanProblem fan =
                        RandomFan(
                            seed,
                            {.friction = friction, .prescribed = prescribed, .secant = !vertical, .vertical = vertical})
                            .problem();
                    if (!counted.add(fan, seed, solver, result)) continue;
                    for (std::size_t i = 0; i < fan.links.size(); ++i)
                        if (const double cohesive_impulse = result.links[i].cohesive_impulse; fan.links[i].ramp > 0)
                            ++(cohesive_impulse >= fan.links[i].cohesive ? n_full
                               : cohesive_impulse > 0                    ? n_on_ramp
                                                                         : n_empty);
                }
                const auto& [n_fallback, n_unsolved, worst, worst_seed] = counted;
                CHECK_MESSAGE(worst <= 1e-10, "seed ", worst_seed, ", friction ", friction, ", prescribed ", prescribed,
                              ", vertical ", vertical);
                MESSAGE("vertical ", vertical, ", friction ", friction, ", prescribed ", prescribed, ": ", n_fallback,
                        " of ", n, " needed pivots, worst violation ", worst, " at seed ", worst_seed, "; links full ",
                        n_full, ", on the ramp ", n_on_ramp, ", empty ", n_empty, ", unsolved ", n_unsolved);
                CHECK(n_fallback < (friction ? 0.2 : 0.1) * n);
                // ramps of 1e-12 of the others, or large friction
                CHECK(n_unsolved <= (friction && prescribed ? 0.002 * n : 2));
                CHECK(n_on_ramp > 1000);
            }
}

TEST_CASE("the active set and Lemke's pivots find the same velocities where they are unique") {
    FanSolver solver;
    FanResult result;
    FanLcp pivots;
    int n_compared = 0, n_inexact = 0;
    for (int seed = 0; seed < 4000; ++seed) {
        FanProblem fan = RandomFan(seed, {.friction = false, .prescribed = true, .secant = seed >= 3000}).problem();
        if (solver.solve(fan, result).status != FanSolution::Status::exact) continue;
        const FanJudge judge(fan, result);
        std::vector<LinkState> states;
        for (const FanLink& link : fan.links)
            states.push_back({.law = link_law(link, fan.velocity_before(link.after) - fan.velocity_before(link.before),
                                              fan.drift_time, 1e-12 * judge.speed_scale())});
        FanMotion other{{std::vector<Vec2>(fan.bodies.size())}, std::vector<Vec2>(fan.links.size()), {}};
        const std::optional<double> residual = pivots.solve(fan, states, judge.speed_scale(), other);
        REQUIRE(residual);
        // ramps of 1e-12 of the others cost the pivots digits, and their residual says so
        if (seed >= 3000 && *residual > 1e-11) {
            ++n_inexact;
            continue;
        }
        double difference = 0;
        for (std::size_t b = 0; b < fan.bodies.size(); ++b)
            difference = std::max(difference, (other.velocity[b] - result.velocity[b]).cwiseAbs().maxCoeff());
        CHECK_MESSAGE(difference <= 1e-10 * judge.speed_scale(), "seed ", seed);
        ++n_compared;
    }
    CHECK(n_compared > 3600);
    CHECK(n_inexact < 25);
}

TEST_CASE("without friction no other admissible velocities have less energy") {
    FanSolver solver;
    FanResult result;
    Random random(1, "perturbation");
    int n_tried = 0;
    for (int seed = 0; seed < 2000; ++seed) {
        FanProblem fan =
            RandomFan(seed, {.friction = false, .prescribed = false, .units = false, .secant = seed >= 1000}).problem();
        solver.solve(fan, result);
        const FanJudge judge(fan, result);
        const std::vector<Vec2> found = result.velocity;
        const double least = convex_energy(fan, found), scale = judge.impulse_scale() * judge.speed_scale();
        for (int k = 0; k < 20; ++k) {
            std::vector<Vec2> other = found;
            const double size = judge.speed_scale() * std::pow(10, random.uniform(-6, 0));
            for (Vec2& v : other)
                if (random.uniform() < 0.5) v += size * Vec2(random.uniform(-1, 1), random.uniform(-1, 1));
            FanResult moved = result;
            moved.velocity = other;
            if (!FanJudge(fan, moved).admissible()) continue;
            CHECK_MESSAGE(convex_energy(fan, other) >= least - 1e-13 * scale, "seed ", seed);
            ++n_tried;
        }
    }
    CHECK(n_tried > 6000);
}

TEST_CASE("velocities do not depend on the first body of a closed chain") {
    FanSolver solver;
    FanResult result;
    int n_closed = 0;
    for (int seed = 0; seed < 2000; ++seed) {
        FanProblem fan = RandomFan(seed, {.friction = false}).problem();
        if (!fan.closed) continue;
        ++n_closed;
        const Index n = static_cast<Index>(fan.bodies.size()), shift = 1 + seed % (n - 1);
        FanProblem turned = fan;
        std::rotate(turned.bodies.begin(), turned.bodies.begin() + shift, turned.bodies.end());
        std::rotate(turned.links.begin(), turned.links.begin() + shift, turned.links.end());
        for (FanLink& link : turned.links)
            link.before = (link.before + n - shift) % n, link.after = (link.after + n - shift) % n;
        solver.solve(fan, result);
        FanResult of_turned;
        solver.solve(turned, of_turned);
        double difference = 0;
        for (Index b = 0; b < n; ++b)
            difference =
                std::max(difference, (of_turned.velocity[b] - result.velocity[(b + shift) % n]).cwiseAbs().maxCoeff());
        CHECK_MESSAGE(difference <= 1e-10 * FanJudge(fan, result).speed_scale(), "seed ", seed);
    }
    CHECK(n_closed > 500);
}

TEST_CASE("E4 one contact with coupled normal and tangential motion") {
    // q = (.3, 1), mu = 2 has three solutions: free, sliding, sticking. The solver returns one of them and always the
    // same
    const std::vector<Vec2> solutions = {{0, 0}, {0.5, -1}, {25.0 / 18, -38.0 / 18}};
    describe(
        "One contact, W = [[1, .8], [.8, 1]]: with mu = 2 and q = (.3, 1) it has three solutions, p = 0 (it "
        "separates), (.5, -1) (it slides) and (25, -38)/18 (it sticks). Unique for all q if and "
        "only if mu < 1.25.");
    CHECK(n_solutions(2, 0.3, 1) == 3);
    FanSolution::Status status;
    const FanResult first = solved(coupled_contact(2, 0.3, 1), &status);
    verify_that("mu = 2: solved exactly", status == FanSolution::Status::exact);
    double nearest = INFINITY;
    for (const Vec2& P : solutions)
        nearest = std::min(nearest, (Vec2(first.links[0].contact, first.links[0].tangential) - P).norm());
    verify_small("mu = 2: distance of the impulse from the nearest of the three", nearest, {1e-14});
    bool same = true;
    for (int i = 0; i < 10; ++i) same = same && solved(coupled_contact(2, 0.3, 1)).velocity[0] == first.velocity[0];
    verify_that("mu = 2: the same one in ten runs, to the bit", same);
    // what separates already is guessed to go on: exactly p = 0
    FanProblem separating = coupled_contact(2, 0.3, 1);
    separating.bodies[0].velocity = separating.bodies[0].free_velocity;
    const FanResult separated = solved(separating);
    verify_that("mu = 2: what separates already gets exactly p = 0", separated.links[0].impulse == Vec2(0, 0));
    CHECK((separated.velocity[0] - separating.bodies[0].free_velocity).norm() <= 1e-15);
    for (const double mu : {0.5, 1.2, 1.3, 2.0}) {
        int n_several = 0;
        double worst = 0;
        for (int i = 0; i < 360; ++i) {
            const double angle = (i + 0.5) * M_PI / 180, q_N = std::cos(angle), q_T = std::sin(angle);
            n_several += n_solutions(mu, q_N, q_T) > 1;
            const FanProblem fan = coupled_contact(mu, q_N, q_T);
            worst = std::max(worst, FanJudge(fan, solved(fan)).verdict().worst());
        }
        verify_small("residual of the laws for q in 360 directions, mu = " + digits(mu), worst, {1e-12});
        verify_that("several solutions for some of them if and only if mu > 1.25, mu = " + digits(mu),
                    (n_several > 0) == (mu > 1.25));  // unique if and only if mu |W_NT| < W_NN
    }
}

TEST_CASE("where friction wedges a driven body the laws are relaxed and nothing gains energy") {
    // the body is driven along x against an inclined support; friction lifts it into the support more than the contact
    // pushes it off
    FanLink link = contact_without_cohesion(-1, 0, Vec2(-0.6, -0.8), 100);
    link.restitution = 1;
    FanProblem fan;
    fan.drift_time = 1;
    fan.bodies = {{.velocity = Vec2(1, 1), .free_velocity = Vec2(0, 1), .inverse_mass = Vec2(0, 1)}};
    fan.links = {link};
    FanSolver solver;
    FanResult stopped, sliding;
    CHECK(solver.solve(fan, stopped).status == FanSolution::Status::relaxed);
    CHECK(stopped.velocity[0].norm() <= 1e-14);  // it cannot rebound but stops
    FanProblem driven = fan;
    driven.bodies[0].free_velocity.x() = 1;
    CHECK(solver.solve(driven, sliding).status == FanSolution::Status::relaxed);
    CHECK(sliding.velocity[0].y() == relative(-0.75));  // it cannot stop either: it slides off without friction
    for (const FanVerdict& verdict : {FanJudge(fan, stopped).verdict(), FanJudge(driven, sliding).verdict()}) {
        CHECK(verdict.balance <= 1e-14);
        CHECK(verdict.impact_work <= 0);
        CHECK(verdict.friction_work <= 0);
    }
}

TEST_CASE("fans of crushed bodies on which Lemke's method ends on a ray have lawful solutions") {
    // from runs with friction 0.7: some points slide, the others hold; the pivots end on a ray
    FanProblem two, five;
    two.closed = five.closed = true;
    two.drift_time = 7.090857521036211e-08;
    add_body(two, 0.98455142911481586, 1.298485679962752, 1.1382442528650136, 1.2469765636357903, 11360.7375037695);
    add_body(two, 0.98455142911481586, 1.298485679962752, 1.1152277171989211, 1.5957158121724053, 16177.01725149336);
    add_body(two, 0.9970863613611034, 1.1970277185809814, 0.87876253529436532, 1.689647647171268, 10280.244488558872);
    add_body(two, 0.95521683521145706, 1.2615187390431093, 1.0879066995749986, 1.489463487391584, 11760.898543017673);
    add_body(two, 0.95521683521145706, 1.2615187390431093, 1.1220597126437284, 1.1674758934296512, 14684.930334412662);
    add_body(two, 0.98455142911481586, 1.298485679962752, 1.0883958351597993, 0.91835699731702936, 9591.083151378356);
    add_link(two, 5, 0, -0.77910266607382128, -0.62689635165365554, 0, 0, 9.8202688971392679e-05);
    add_link(two, 0, 1, 0.28277245434272341, -0.95918701985848021, 0, 0, 7.616332158265388e-05);
    add_link(two, 1, 2, 0.91919596122218694, -0.39380043787789237, 3.6501074534276958e-09, 1.3395735464602584e-08,
             7.1667534123339718e-05);
    add_link(two, 2, 3, 0.83873847529765266, 0.54453445258805144, -1.8449544890286571e-21, -2.8417564908277957e-21,
             0.00010698715083318158);
    add_link(two, 3, 4, 0.075116029511106783, 0.99717480017822679, 0, 0, 7.5570568271959962e-05);
    add_link(two, 4, 5, -0.78333273403573345, 0.62160262852412618, 2.4608623223452573e-21, 1.3884128098627803e-08,
             7.546052324899574e-05);
    five.drift_time = 9.9255583126550873e-08;
    add_body(five, 1.7696741632150761, 0.32968741015278685, 1.9962341728705502, 0.16626494075442153,
             6623.5698637112409);
    add_body(five, 1.7696741632150761, 0.32968741015278685, 2.0187155097380032, 0.37695148189747574,
             7458.8261399490402);
    add_body(five, 1.7696741632150761, 0.32968741015278685, 2.1905472291504613, 0.63801457351137647,
             8181.3129056449707);
    add_body(five, 1.7696741632150761, 0.32968741015278685, 2.381228256813551, 0.60519623316171356, 7184.5849666235335);
    add_body(five, 1.7696741632150761, 0.32968741015278685, 1.1189117539924682, 0.27090709434858351,
             8547.0316337328877);
    add_body(five, 1.7696741632150761, 0.32968741015278685, 1.2597538737093616, 0.35905682522709498,
             6384.4209641255811);
    add_link(five, 5, 0, -0.98607446286217459, 0.16630440069665647, 0, 0, 0.00018882987129138594);
    add_link(five, 0, 1, -0.87526949315225366, -0.48363551808877409, 6.3916245931972448e-21, -5.5972531831685257e-09,
             0.00018036036740058116);
    add_link(five, 1, 2, -0.15223643082936647, -0.98834410461556121, -6.4106497472859645e-24, -1.1508174718719685e-08,
             0.00013093379998805823);
    add_link(five, 2, 3, 0.72453631798996065, -0.68923662403673147, -7.3122766149687646e-22, 1.9105262120755851e-08,
             0.00017169212286852268);
    add_link(five, 3, 4, 0.9283492341012195, 0.37170915988670372, 1.4004167770522759e-21, -2.0766474156779695e-08,
             0.00012312646620921838);
    add_link(five, 4, 5, -0.17573667473752333, 0.98443721036549492, -1.4119973056280182e-21, 6.9136638428086748e-09,
             0.00013503162856777544);
    for (const FanProblem& fan : {two, five}) {
        FanResult result;
        CHECK(FanSolver().solve(fan, result).status == FanSolution::Status::searched);
        CHECK(FanJudge(fan, result).verdict().worst() <= 1e-10);
    }
}

// Pieces of a fan that hold together and slide on an obstacle whose surface gives way under each of them at almost the
// same rate: the one that gives way less bears them. Lemke's method takes such rates for one.
TEST_CASE("of two contacts that bound the same motion the stricter one counts by however little") {
    for (const Index stricter : {0, 1})
        for (const double between : {1e-3, 1e-6, 1e-8, 1e-9, 1e-10, 1e-13}) {  // [m/s]
            CAPTURE(stricter);
            CAPTURE(between);
            FanProblem fan;
            fan.drift_time = 1e-4;
            const Vec2 v(3.3, -0.97), n(0.28, 0.96);
            fan.bodies = {
                {.velocity = v, .free_velocity = v + Vec2(0, -0.05), .inverse_mass = Vec2::Constant(0.011)},
                {.velocity = v, .free_velocity = v + Vec2(0.02, -0.03), .inverse_mass = Vec2::Constant(0.01)}};
            fan.links = {contact_without_cohesion(0, 1, Vec2(-0.8, -0.6), 0.6)};
            fan.links[0].cohesive = 90, fan.links[0].gamma = 1.5;
            for (const Index body : {0, 1}) {
                fan.bodies.push_back(
                    {.velocity = Vec2::Zero(), .free_velocity = Vec2::Zero(), .inverse_mass = Vec2::Zero()});
                fan.links.push_back(contact_without_cohesion(static_cast<Index>(fan.bodies.size()) - 1, body, n, 0.6));
                fan.links.back().given = 0.01 + (body == stricter ? 0 : between);
            }
            FanResult result;
            const FanSolution solution = FanSolver().solve(fan, result);
            CHECK(solution.status == FanSolution::Status::exact);
            CHECK(solution.residual < 1e-12);
            CHECK((result.velocity[0] - result.velocity[1]).norm() < 1e-14);
            CHECK(n.dot(result.velocity[0]) == relative(-0.01, 1e-12));
        }
}

TEST_CASE("between kinks nearer than rounding the force says which one holds") {
    // from a plate crushed with friction 0.7: rest and the zero crossing of a slip are 4.7e-12 m/s apart, and Lemke's
    // method solves the fan; at rest friction would have to do the work of the cohesion, along the slip. The second one
    // gave 5e-8 J in one step
    FanProblem kinks, later;
    kinks.closed = later.closed = true;
    kinks.drift_time = 5.2628413328521592e-08;
    add_body(kinks, 3.8793853710771065, 0.58257829216189327, 3.9229278711611126, 0.53628698397319663,
             18287.184728132223);
    add_body(kinks, 3.8699314082743705, 0.54759641733936038, 3.8640227916615255, 0.52742926704816373,
             23515.876925936518);
    add_body(kinks, 3.8699314082743705, 0.54759641733936038, 3.8567433694654687, 0.55097944310305891,
             18132.286228900866);
    add_body(kinks, 3.8699314082743705, 0.54759641733936038, 3.8759554534338956, 0.55664513277213556,
             18692.071184850363);
    add_body(kinks, 3.8793853710771065, 0.58257829216189327, 3.8818104113452288, 0.57306620624897586,
             18679.305845845811);
    add_body(kinks, 3.8793853710771065, 0.58257829216189327, 3.8894094249032154, 0.5567774042731457,
             24904.141618098547);
    add_link(kinks, 5, 0, 0.99990513694185035, 0.013773783695830035, 0, 0, 5.5453419869271505e-05);
    add_link(kinks, 0, 1, 0.28848857739218198, 0.95748333704260091, -6.720720079836105e-20, -2.4671859562128373e-19,
             2.0694243549887474e-07);
    add_link(kinks, 1, 2, -0.57380457978324617, 0.81899224918174418, 0, 0, 5.1986864374355627e-05);
    add_link(kinks, 2, 3, -0.91838020416632327, -0.39569912887877612, 0, 0, 4.6578279789476147e-05);
    add_link(kinks, 3, 4, -0.26089364698134737, -0.96536754915667844, 4.2396120668347293e-21, -2.2347379175077768e-19,
             1.8804163656497994e-06);
    add_link(kinks, 4, 5, 0.68965447517202716, -0.72413859507361955, -5.8883447846956446e-20, 5.607936601843967e-20,
             4.2718861168275721e-05);
    later.drift_time = 5.2628413328521592e-08;
    add_body(later, 3.184379866193912, 0.41299316547666637, 3.0641219062417568, 0.45137498967450312,
             23504.106430801974);
    add_body(later, 3.184379866193912, 0.41299316547666637, 3.1546446377727935, 0.52328755889989931,
             22807.758915826831);
    add_body(later, 3.184379866193912, 0.41299316547666637, 3.2277653499882124, 0.55445434014321249,
             24472.900847620469);
    add_body(later, 3.2127882182265051, 0.45167431019695031, 3.195131466536258, 0.37428158232337017,
             22578.928890725223);
    add_body(later, 3.2127882182265051, 0.45167431019695031, 3.1381231703498931, 0.42930344217024052,
             14157.645458323852);
    add_body(later, 3.2127882182265051, 0.45167431019695031, 3.1534770551004563, 0.46050314238718437,
             16841.15978844295);
    add_link(later, 5, 0, 0.82396015427771507, 0.56664774257261796, 1.018727886704731e-19, -2.3453956636992162e-19,
             7.005288867405246e-06);
    add_link(later, 0, 1, -0.25738637655848312, 0.96630857036564399, 2.6191846282044829e-20, -6.9764717158219878e-21,
             4.485961509102328e-05);
    add_link(later, 1, 2, -0.94883094394165224, 0.31578448318242758, 0, 0, 4.6936545327060004e-05);
    add_link(later, 2, 3, -0.5919350373701654, -0.80598567700274981, 0, 0, 4.9736912706467455e-06);
    add_link(later, 3, 4, 0.16649654205755163, -0.98604203839536064, 0, 0, 6.7442699002872791e-05);
    add_link(later, 4, 5, 0.79131268670835719, -0.61141167134296792, -2.3787797304421236e-19, -4.6784479066153589e-20,
             6.68042639075557e-05);
    for (const FanProblem& fan : {kinks, later}) {
        FanResult result;
        CHECK(FanSolver().solve(fan, result).residual <= 1e-10);
        CHECK(FanJudge(fan, result).verdict().worst() <= 1e-10);
    }
}

}  // namespace fan_solver_test
