// Every key of every built-in scenario, deleted, empty, with a wrong unit and of a wrong type: what failed to parse is
// not used afterwards. With meshes: tests/app/mutations.cpp.
#include "support/mutations.hpp"

#include "samples.hpp"
#include "scenario/built_in.hpp"
#include "scenario/write_scenario.hpp"

#include <doctest/doctest.h>

#include <map>

namespace mutations_test {

using namespace knap;

namespace {

void check(const BuiltIn& built_in, const tests::Mutation& mutation) {
    CAPTURE(built_in.name);
    CAPTURE(mutation.path);
    CAPTURE(mutation.value);
    try {
        const ReadResult read = tests::read_mutated(built_in.text, mutation, KNAP_SOURCE_DIR "/scenarios");
        CHECK_FALSE(full_listing(read).empty());
    } catch (const UserError& error) {
        CHECK_MESSAGE(tests::has_place(error, mutation), error.what());
    }
}

}  // namespace

TEST_CASE("mutations: every kind of key with a mistake is a scenario or an error with a place") {
    struct Chosen {
        const BuiltIn* in;
        tests::Mutation mutation;
    };
    std::map<std::string, Chosen> chosen;  // in the shortest scenario that has such a key, without patterns of bodies
    for (const BuiltIn& built_in : built_ins())
        for (const tests::Mutation& mutation : tests::mutations_of(built_in.text)) {
            const auto cost = [](const BuiltIn& one) {
                return one.text.size() + (one.text.find("[[bodies]]") != std::string::npos ? 100'000 : 0);
            };
            const auto [at, is_new] =
                chosen.try_emplace(pattern_of(mutation.path) + "=" + mutation.value, Chosen{&built_in, mutation});
            if (!is_new && cost(built_in) < cost(*at->second.in)) at->second = {&built_in, mutation};
        }
    CHECK(chosen.size() > 1000);
    for (const auto& [kind, one] : chosen) check(*one.in, one.mutation);
}

TEST_CASE("mutations: every key of every built-in scenario likewise" * doctest::test_suite("slow")) {
    for (const BuiltIn& built_in : built_ins())
        for (const tests::Mutation& mutation : tests::mutations_of(built_in.text)) check(built_in, mutation);
}

TEST_CASE("mutations: laws that are missing are not read by what names them") {
    const std::string
        body =
            "knap = 1\n[domain]\nshape = \"rectangle\"\nsize = [1, 1]\nrotation = \"large\"\n[mesh]\nsize = "
            "0.1\n[material.rock]\ndensity = 2600\nE = 3e10\nnu = 0.2\n[time]\nend = 1e-3\n",
        support = "[contact]\nfriction = 0.3\n[[support]]\non = \"bottom\"\nglued = true\ninterface = \"base\"\n",
        joints =
            "[[joints]]\nspacing = 0.3\nangle = 20\ninterface = \"filled\"\n[[pressure]]\npressure = "
            "1e6\njoints = \"filled\"\n";
    for (const std::string& more : {support, joints, support + joints}) {
        const std::vector<Diagnostic> found = samples::mistakes(body + more);
        CHECK(std::ranges::count(found, "missing-key", &Diagnostic::code) > 0);
    }
}

}  // namespace mutations_test
