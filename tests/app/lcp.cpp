// knap lcp as a person runs it.
#include "app/program.hpp"

#include "lcp/matrix_market.hpp"

namespace lcp_test {

using namespace program;

namespace {

std::string stored(const std::string& name) { return "'" KNAP_SOURCE_DIR "/tests/lcp/data/" + name + "'"; }

}  // namespace

TEST_CASE("lcp solves a stored problem by either file or the stem") {
    for (const char* file : {"line_4", "line_4.L.mtx", "line_4.q.mtx"}) {
        const Answer answer = command("lcp " + stored(file));
        CAPTURE(answer.text);
        CHECK(answer.code == 0);
        CHECK(answer.has("45 unknowns"));
        CHECK(answer.has("solved"));
    }
}

TEST_CASE("lcp compares the solvers and tells spurious bond breaking from a solution") {
    const Answer answer = command("lcp --solver all --json " + stored("line_16_si"));
    CAPTURE(answer.text);
    CHECK(answer.code == 0);
    for (const char* words : {"\"default\"", "lemke", "newton", "interior_point", "scaled_residual", "cpu_s",
                              "\"bonds_spuriously_broken\": 0"})
        CHECK_MESSAGE(answer.has(words), words);
    const Answer middle = command("lcp --solver interior_point " + stored("trajH_s020"));
    CHECK(middle.code == 3);
    CHECK(middle.has("breaks_spuriously"));
}

TEST_CASE("lcp refuses what it cannot read and says when nothing solves a problem") {
    const Folder folder("lcp");
    CHECK(command("lcp no_such_problem").code == 2);
    CHECK(command("lcp").code == 2);
    CHECK(command("lcp --solver simplex " + stored("line_4")).code == 2);
    std::ofstream(folder.path / "bad.L.mtx") << "%%MatrixMarket matrix array real general\n1 1\nx\n";
    std::ofstream(folder.path / "bad.q.mtx") << "%%MatrixMarket matrix array real general\n1 1\n1\n";
    const Answer bad = command("lcp " + folder.in_shell("bad"));
    CHECK(bad.code == 2);
    CHECK(bad.has("bad.L.mtx:3"));
    CHECK(bad.has("3 | x"));
    std::ofstream(folder.path / "head.L.mtx") << "MatrixMarket matrix array real general\n1 1\n1\n";
    std::ofstream(folder.path / "head.q.mtx") << "%%MatrixMarket matrix array real general\n1 1\n1\n";
    CHECK(command("lcp " + folder.in_shell("head")).has("1 | MatrixMarket matrix array real general"));
    std::ofstream(folder.path / "head.L.mtx") << "%%MatrixMarket matrix array real general\n2 1\n1\n1\n";
    CHECK(command("lcp " + folder.in_shell("head")).has("is not square: 2 rows, 1 columns"));
    knap::write_lcp(folder.path / "infeasible",
                    knap::lcp_problem(-Eigen::MatrixXd::Identity(1, 1), -Eigen::VectorXd::Ones(1)));
    CHECK(command("lcp --solver all " + folder.in_shell("infeasible")).code == 3);
}

TEST_CASE("lcp with all solvers leaves out those that would take very long and says which") {
    const Folder folder("lcp_large");
    const int n = 3001;
    knap::LcpProblem problem{.M = knap::LcpMatrix(n, n), .q = Eigen::VectorXd::Constant(n, -1.0)};
    problem.M.setIdentity();
    knap::write_lcp(folder.path / "large", problem);
    const Answer all = command("lcp --solver all --json " + folder.in_shell("large"));
    CAPTURE(all.text);
    CHECK(all.code == 0);
    CHECK(
        all.has("left out: newton, lemke, interior_point, since each may take hours beyond 3000 unknowns (this problem "
                "has 3001)"));
    CHECK(all.has("--solver newton runs it"));
    CHECK_FALSE(all.has("\"solver\": \"lemke\""));
    CHECK(all.has("\"solver\": \"default\""));
}

TEST_CASE("lcp takes several problems and solves those of an unloaded beam") {
    const Answer two = command("lcp " + stored("dcb_unloaded") + " " + stored("line_4"));
    CAPTURE(two.text);
    CHECK(two.code == 0);
    CHECK(two.has("dcb_unloaded: 79 unknowns"));
    CHECK(two.has("45 unknowns"));
    CHECK(command("lcp --json " + stored("line_2") + " " + stored("line_4")).text.starts_with("["));
}

}  // namespace lcp_test
