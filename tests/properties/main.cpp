// Random runs that must keep every law: properties [--flying [--rigid]] [--first-seed N] [--cases M] [--shrink]. A seed
// that fails is printed as the command that repeats it; with --shrink also the smallest flying scene that fails alike.
#include "properties/flying_run.hpp"
#include "properties/wild_run.hpp"

#include <sys/time.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <map>

using namespace knap;
using namespace knap::tests;

namespace {

// Of processor time for one case; a hundredth is usual, 20 s was seen (a run that is cut into forty times as many steps as planned).
#ifdef __SANITIZE_ADDRESS__
constexpr int max_seconds = 1200;  // about ten times as slow
#else
constexpr int max_seconds = 120;
#endif
const char* program = "properties";
bool flying = false, rigid = false;
std::uint64_t seed = 0;  // that runs

void say_how_to_repeat() {
    std::printf("    %s%s%s --first-seed %llu --cases 1\n", program, flying ? " --flying" : "", rigid ? " --rigid" : "",
                static_cast<unsigned long long>(seed));
}

/// A run that hangs: all is lost but its seed.
extern "C" void out_of_time(int) {
    std::printf("FAILED: no end after %d s\n", max_seconds);
    say_how_to_repeat();
    std::fflush(stdout);
    _exit(1);
}

void limit_time() {
    itimerval limit{};
    limit.it_value.tv_sec = max_seconds;
    setitimer(ITIMER_PROF, &limit, nullptr);
}

std::string text_of(const SchemeOptions& scheme) {
    return std::string(scheme.bulk == BulkScheme::explicit_lumped ? "explicit" : "implicit") + " bulk, " +
           (scheme.cohesion == CohesionScheme::explicit_beta ? "explicit" : "implicit") + " cohesion";
}

/// Why runs ended early.
struct Stops {
    int n = 0;
    std::string seeds;  // the first ones

    void add(std::uint64_t of) {
        if (++n <= 40) seeds += " " + std::to_string(of);
        if (n == 41) seeds += " ...";
    }
};

/// [s] Processor time so far.
double processor_time() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

struct Tally {
    int n = 0, n_stopped = 0, n_failed = 0;
    long n_steps = 0, n_cuts = 0, n_damaged = 0, n_broken = 0;
};

long long number_after(char** argv, int& i, int argc) {
    char* end = nullptr;
    const long long value = i + 1 < argc ? std::strtoll(argv[i + 1], &end, 10) : -1;
    if (value < 0 || !end || *end) {
        std::fprintf(stderr, "%s needs a whole number, 0 or more\n", argv[i]);
        std::exit(2);
    }
    ++i;
    return value;
}

/// Bodies that fly into each other; number of failures.
int run_flying_bodies(std::uint64_t first, long long n_cases, bool shrink) {
    int n_rejected = 0, n_refused = 0, n_failed = 0, n_contact = 0;
    long n_steps = 0, n_cuts = 0, n_contacts = 0, n_broken = 0, n_retired = 0;
    FlyingOutcome most;
    std::map<std::string, int> refusals;
    for (seed = first; seed < first + n_cases; ++seed) {
        limit_time();
        const FlyingScene scene = rigid ? FlyingScenes(seed).rigid_scene() : FlyingScenes(seed).scene();
        const FlyingOutcome outcome = run_flying(scene);
        n_rejected += outcome.rejected, n_refused += !outcome.refusal.empty(), n_contact += outcome.n_contacts > 0;
        n_steps += outcome.n_steps, n_cuts += outcome.n_cuts, n_contacts += outcome.n_contacts;
        n_broken += outcome.n_broken, n_retired += outcome.n_retired;
        for (const auto worst :
             {&FlyingOutcome::depth, &FlyingOutcome::overlap, &FlyingOutcome::injected, &FlyingOutcome::residual,
              &FlyingOutcome::energy_error, &FlyingOutcome::momentum_error, &FlyingOutcome::moment_error})
            most.*worst = std::max(most.*worst, outcome.*worst);
        if (!outcome.refusal.empty()) ++refusals[outcome.refusal];
        if (outcome.broken_law.empty()) continue;
        ++n_failed;
        std::printf("FAILED: %s\n", outcome.broken_law.c_str());
        say_how_to_repeat();
        if (shrink) std::printf("%s", text_of(shrunk(scene, outcome.broken_law)).c_str());
        std::fflush(stdout);
    }
    std::printf(
        "%lld flying scenes, %d rejected, %d in contact: %ld steps, %ld cut, %ld contacts, %ld points broken, %ld "
        "retired; %d refused, %d failed\n",
        n_cases, n_rejected, n_contact, n_steps, n_cuts, n_contacts, n_broken, n_retired, n_refused, n_failed);
    std::printf(
        "largest: depth %.2g, overlap %.2g, positive works %.2g, residual %.2g; errors of energy %.2g, momentum "
        "%.2g, angular momentum %.2g\n",
        most.depth, most.overlap, most.injected, most.residual, most.energy_error, most.momentum_error,
        most.moment_error);
    for (const auto& [reason, n] : refusals) std::printf("refused %d times: %s\n", n, reason.c_str());
    return n_failed;
}

}  // namespace

int main(int argc, char** argv) {
    program = argv[0];
    std::uint64_t first = 0;
    long long n_cases = 200;
    bool shrink = false;
    for (int i = 1; i < argc; ++i) {
        if (!std::strcmp(argv[i], "--first-seed")) {
            first = number_after(argv, i, argc);
        } else if (!std::strcmp(argv[i], "--cases")) {
            n_cases = number_after(argv, i, argc);
        } else if (!std::strcmp(argv[i], "--flying")) {
            flying = true;
        } else if (!std::strcmp(argv[i], "--rigid")) {
            rigid = true;
        } else if (!std::strcmp(argv[i], "--shrink")) {
            shrink = true;
        } else {
            std::fprintf(stderr, "usage: %s [--flying [--rigid] [--shrink]] [--first-seed N] [--cases M]\n", argv[0]);
            return 2;
        }
    }
    std::signal(SIGPROF, out_of_time);
    if (flying) return run_flying_bodies(first, n_cases, shrink) == 0 ? 0 : 1;
    std::map<std::string, Tally> tallies;
    std::map<std::string, Stops> stops;
    int n_failed = 0;
    std::uint64_t slowest = first;
    double longest = 0, start = processor_time();
    for (seed = first; seed < first + n_cases; ++seed) {
        limit_time();
        const WildBody wild = WildBodies(seed).body();
        WildOutcome outcome = run_wild(wild);
        std::string wrong = outcome.broken_law;
        if (wrong.empty() && seed % 4 == 0) wrong = difference_in_other_units(wild, outcome);
        Tally& tally = tallies[text_of(wild.body.scheme)];
        ++tally.n, tally.n_stopped += !outcome.stop.empty(), tally.n_failed += !wrong.empty();
        tally.n_steps += outcome.n_steps, tally.n_cuts += outcome.n_cuts, tally.n_damaged += outcome.n_damaged,
            tally.n_broken += outcome.n_broken;
        if (!outcome.stop.empty()) stops[outcome.stop.substr(0, 60)].add(seed);
        const double end = processor_time();
        if (end - start > longest) slowest = seed, longest = end - start;
        start = end;
        if (wrong.empty()) continue;
        ++n_failed;
        const CohesiveLaw& law = wild.body.input.laws[0];
        std::printf("FAILED: %s (%s, theta %g, %s mass, gamma %g, mu %g, e %g)\n", wrong.c_str(),
                    text_of(wild.body.scheme).c_str(), wild.body.scheme.theta,
                    wild.body.scheme.mass == MassMatrix::lumped ? "lumped" : "consistent", law.gamma, law.friction,
                    law.restitution);
        say_how_to_repeat();
        std::fflush(stdout);
    }
    for (const auto& [scheme, tally] : tallies)
        std::printf("%s: %d bodies, %ld steps, %ld cut, %d runs stopped, %ld points damaged, %ld broken; %d failed\n",
                    scheme.c_str(), tally.n, tally.n_steps, tally.n_cuts, tally.n_stopped, tally.n_damaged,
                    tally.n_broken, tally.n_failed);
    for (const auto& [reason, those] : stops)
        std::printf("stopped %d times: %s; seeds%s\n", those.n, reason.c_str(), those.seeds.c_str());
    std::printf("%.4g s of processor time, the longest %.3g s by seed %llu\n", start, longest,
                static_cast<unsigned long long>(slowest));
    if (n_cases > 0 && tallies.empty()) return 1;
    return n_failed == 0 ? 0 : 1;
}
