#define DOCTEST_CONFIG_IMPLEMENT
#include <doctest/doctest.h>

#include "support/listener.hpp"
#include "support/verification_listener.hpp"

#include <cstdio>

namespace {
unsigned n_matched = 0;

// Only counts the cases that the filters let through; doctest itself calls an empty run a success.
struct Counter : knap::tests::Listener {
    explicit Counter(const doctest::ContextOptions&) {}
    void report_query(const doctest::QueryData& data) override {
        n_matched += data.run_stats->numTestCasesPassingFilters;
    }
    void test_run_end(const doctest::TestRunStats& stats) override { n_matched += stats.numTestCasesPassingFilters; }
};
}  // namespace

REGISTER_LISTENER("counter", 1, Counter);

int main(int argc, char** argv) {
    doctest::Context context(argc, argv);
    context.setOption("no-intro", true);
    const int result = context.run();
    if (n_matched == 0) {
        std::fputs("no test case matched\n", stderr);
        return 1;
    }
    return result;
}
