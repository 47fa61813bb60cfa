#define DOCTEST_CONFIG_IMPLEMENT
#include <doctest/doctest.h>

#include "support/verification_listener.hpp"

#include <cstdio>

namespace {
unsigned n_matched = 0;

// Only counts the cases that the filters let through; doctest itself calls an empty run a success.
struct Counter : doctest::IReporter {
    explicit Counter(const doctest::ContextOptions&) {}
    void report_query(const doctest::QueryData& data) override { n_matched += data.run_stats->numTestCasesPassingFilters; }
    void test_run_start() override {}
    void test_run_end(const doctest::TestRunStats& stats) override { n_matched += stats.numTestCasesPassingFilters; }
    void test_case_start(const doctest::TestCaseData&) override {}
    void test_case_reenter(const doctest::TestCaseData&) override {}
    void test_case_end(const doctest::CurrentTestCaseStats&) override {}
    void test_case_exception(const doctest::TestCaseException&) override {}
    void subcase_start(const doctest::SubcaseSignature&) override {}
    void subcase_end() override {}
    void log_assert(const doctest::AssertData&) override {}
    void log_message(const doctest::MessageData&) override {}
    void test_case_skipped(const doctest::TestCaseData&) override {}
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
