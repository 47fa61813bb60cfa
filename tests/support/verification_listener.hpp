#pragma once
// Appends what a test has verified to <KNAP_VERIFICATION>/cases.tsv (tools/verify: build/release/verification): a line C for the case, then T texts, N numbers, P pictures.
#include "support/listener.hpp"
#include "support/verification.hpp"

#include <sys/resource.h>

#include <fstream>
#include <iomanip>

namespace knap::tests {

class VerificationListener : public Listener {
public:
    explicit VerificationListener(const doctest::ContextOptions&) {}
    void test_case_start(const doctest::TestCaseData& data) override {
        data_ = &data;
        verification_notes() = {};
        start_ = processor_time();
    }
    void test_case_end(const doctest::CurrentTestCaseStats& stats) override {
        const auto folder = verification_folder();
        const VerificationNotes& notes = verification_notes();
        if (!folder || notes.numbers.empty()) return;
        std::ofstream out(*folder / "cases.tsv", std::ios::app);
        out << std::setprecision(3);
        out << "C\t" << data_->m_name << '\t' << data_->m_test_suite << '\t' << processor_time() - start_ << '\t'
            << (stats.failure_flags != 0) << '\n';
        for (const std::string& text : notes.texts) out << "T\t" << text << '\n';
        for (const Verified& number : notes.numbers)
            out << "N\t" << number.path << '\t' << number.quantity << '\t' << number.found << '\t' << number.reference
                << '\t' << number.kind << '\t' << number.deviation << '\t' << number.acc << '\t' << number.str << '\n';
        for (const std::string& picture : notes.pictures) out << "P\t" << picture << '\n';
    }

private:
    /// [s] of this program and of those that it has run.
    static double processor_time() {
        double sum = 0;
        for (const int who : {RUSAGE_SELF, RUSAGE_CHILDREN}) {
            rusage used{};
            getrusage(who, &used);
            for (const timeval& part : {used.ru_utime, used.ru_stime})
                sum += static_cast<double>(part.tv_sec) + 1e-6 * static_cast<double>(part.tv_usec);
        }
        return sum;
    }

    const doctest::TestCaseData* data_ = nullptr;
    double start_ = 0;  // [s]
};

}  // namespace knap::tests

REGISTER_LISTENER("verification", 2, knap::tests::VerificationListener);
